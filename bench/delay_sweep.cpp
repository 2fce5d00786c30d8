// Sweeps the loop with a device over delays, stiffness, hand, friction and rate, with all protections and
// with each left out; prints a table and draws the worst of each delay. Simulated time: the same on every
// machine.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <thread>

#include "delay_cells.h"
#include "delay_plot.h"
#include "print.h"
#include "usage.h"

namespace {

using namespace lumbrical;
using namespace lumbrical::bench;

constexpr double kMostGiven = 10e-3;  // [J]

struct Protection {
  const char* name;
  LoopOptions options;
};

std::vector<Protection> protections() {
  std::vector<Protection> list(6);
  list[0].name = "all";
  list[1].name = "without the limiter";
  list[1].options.limiter = false;
  list[2].name = "without the accounts";
  list[2].options.account = false;
  list[3].name = "certificate as at the start";
  list[3].options.follow = false;
  list[4].name = "no soft start after gaps";
  list[4].options.gaps = false;
  list[5].name = "without any";
  list[5].options.limiter = list[5].options.account = list[5].options.follow = list[5].options.gaps = false;
  return list;
}

struct Cell {
  Play play;
  std::size_t protection, stiffness, hand, bus;
  double friction, rate;
  LoopFelt felt;
};

// What the protections are compared on. Where the device has no friction, what is left out is missed most.
bool is_compared(const Cell& cell) {
  return (cell.play == Play::grasp || cell.play == Play::press) && cell.stiffness > 0 && cell.hand == 0 &&
         cell.friction == 0 && cell.rate == kRates[0];
}

// Cells of all protections where they were not tuned.
bool is_other(const Cell& cell) {
  return cell.play != Play::grasp && cell.stiffness == 1 && cell.friction == 0 && cell.rate == kRates[0];
}

// All protections meet everything in the play they were tuned on.
bool is_wanted(const Cell& cell, bool everything) {
  const bool fast = cell.rate == kRates[0], slippery = cell.friction == 0, demo = cell.stiffness == 1;
  if (!everything) return cell.protection == 0 && demo && cell.hand == 0 && slippery && fast;
  if (is_compared(cell)) return true;
  if (cell.protection > 0) return false;
  // A slower device adds little to a slow bus.
  return is_other(cell) || (cell.play == Play::grasp && (fast || (demo && slippery)));
}

std::vector<Cell> cells_of(bool everything) {
  std::vector<Cell> cells;
  const std::size_t buses = std::size(kBuses), hands = std::size(kHands), frictions = std::size(kFrictions),
                    rates = std::size(kRates), stiffnesses = std::size(kStiffnesses);
  for (std::size_t p = 0; p < protections().size(); ++p) {
    for (const Play play : kPlays) {
      for (std::size_t i = 0; i < stiffnesses * hands * frictions * rates * buses; ++i) {
        std::size_t rest = i;
        const auto next = [&rest](std::size_t count) {
          const std::size_t digit = rest % count;
          rest /= count;
          return digit;
        };
        const std::size_t bus = next(buses), rate = next(rates), friction = next(frictions),
                          hand = next(hands);
        const Cell cell{play, p, rest, hand, bus, kFrictions[friction], kRates[rate], {}};
        if (is_wanted(cell, everything)) cells.push_back(cell);
      }
    }
  }
  return cells;
}

using Models = std::vector<std::vector<Model>>;  // of a play and a stiffness

Status build(Models& models) {
  models.resize(std::size(kPlays));
  for (const Play play : kPlays) {
    for (const double stiffness : kStiffnesses) {
      Model& model = models[static_cast<std::size_t>(play)].emplace_back();
      if (Status status = build_play(play, stiffness, model); !status.ok()) return status;
    }
  }
  return {};
}

void run(const DeviceProfile& profile, const Models& models, std::vector<Cell>& cells) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < cells.size(); i = next++) {
      Cell& cell = cells[i];
      DelayedLoop loop;
      loop.bus = kBuses[cell.bus];
      loop.bus.rate = cell.rate;
      loop.human = kHands[cell.hand].hold;
      loop.friction = cell.friction;
      loop.options = protections()[cell.protection].options;
      const Model& model = models[static_cast<std::size_t>(cell.play)][cell.stiffness];
      cell.felt = run_delayed(model, play_motion(cell.play, model), profile, loop);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
}

struct Worst {
  int cells = 0, failed = 0;
  LoopFelt felt;
};

bool is_failed(const LoopFelt& felt) { return felt.shakes > 0 || felt.given > kMostGiven; }

void add(const LoopFelt& felt, Worst& worst) {
  ++worst.cells;
  worst.failed += is_failed(felt) ? 1 : 0;
  worst.felt.shakes += felt.shakes;
  worst.felt.given = std::max(worst.felt.given, felt.given);
  worst.felt.taken = std::min(worst.felt.taken, felt.taken);
  worst.felt.step = std::max(worst.felt.step, felt.step);
  worst.felt.torque += felt.torque;
}

std::string bus_name(const Bus& bus) {
  return print("%.0f ms, %s", 1e3 * bus.delay, kDelayNames[static_cast<std::size_t>(bus.kind)]);
}

template <class Wanted>
Worst worst_of(const std::vector<Cell>& cells, Wanted&& wanted) {
  Worst worst;
  for (const Cell& cell : cells) {
    if (wanted(cell)) add(cell.felt, worst);
  }
  return worst;
}

void print_row(const std::string& name, const Worst& worst) {
  std::printf("| %s | %d | %d | %llu | %.3f | %.1f | %.1f | %.1f |\n", name.c_str(), worst.cells,
              worst.failed, static_cast<unsigned long long>(worst.felt.shakes), 1e3 * worst.felt.given,
              1e3 * std::max(0.0, -worst.felt.taken), 1e3 * worst.felt.step,
              1e3 * worst.felt.torque / std::max(1, worst.cells));
}

void print_head(const char* title, const char* what) {
  std::printf(
      "\n## %s\n\n| %s | cells | failed | shakes | most energy into the hand [mJ] | out of the motors "
      "[mJ] | largest "
      "step [N mm] | mean torque [N mm] |\n|---|---|---|---|---|---|---|---|\n",
      title, what);
}

std::string draw(const std::vector<Cell>& cells) {
  std::vector<DelayCurve> curves;
  const std::vector<Protection> list = protections();
  for (std::size_t p = 0; p < list.size(); ++p) {
    DelayCurve curve{list[p].name, {}};
    for (std::size_t b = 0; b < std::size(kBuses); ++b) {
      const Worst worst = worst_of(cells, [&](const Cell& cell) {
        return cell.protection == p && cell.bus == b && is_compared(cell);
      });
      curve.points.push_back({bus_name(kBuses[b]), worst.felt.given, worst.felt.shakes});
    }
    curves.push_back(curve);
  }
  return plot_delays(curves, kMostGiven);
}

void print_about() {
  std::printf(
      "# The loop over delays\n\nSimulated time: repeat with `build/release/bench/delay_sweep "
      "examples/devices/exoskeleton.json delay_sweep.svg`.\n\n![sweep](delay_sweep.svg)\n\n"
      "The shipped exoskeleton on hands that touch something (`bench/delay_cells.h`). The control was tuned "
      "on "
      "the demo's grasp first;\nthe others, of other objects, hands and motions, were looked at while its "
      "last constants were chosen.\n"
      "A cell fails with a shake (two turning points of a joint less than 0.1 s apart, with more than 2 mrad "
      "to either side) or more than %.0f mJ\ninto the hand beyond what the device and the arm's motion took, "
      "per finger from the beginning of each touch. Out of the motors: net, before\nthe device's own damping "
      "and friction. The mean torque is the sum over 15 joints, over time and cells: what is felt at all.\n",
      1e3 * kMostGiven);
}

bool has_all(const Cell& cell) { return cell.protection == 0; }

void print_tuned(const std::vector<Cell>& cells) {
  const auto row = [&](const std::string& name, auto&& wanted) {
    print_row(name, worst_of(cells, [&](const Cell& cell) {
                return has_all(cell) && cell.play == Play::grasp && wanted(cell);
              }));
  };
  print_head("With all protections, where they were tuned: the demo's grasp", "exchange");
  for (std::size_t b = 0; b < std::size(kBuses); ++b)
    row(bus_name(kBuses[b]), [&](const Cell& cell) { return cell.bus == b; });
  print_head("The same, by what the cell is like", "cell");
  for (std::size_t k = 0; k < std::size(kStiffnesses); ++k)
    row(print("K_s %.0e N/m^3", kStiffnesses[k]), [&](const Cell& cell) { return cell.stiffness == k; });
  for (std::size_t h = 0; h < std::size(kHands); ++h)
    row(print("hand: %s", kHands[h].name), [&](const Cell& cell) { return cell.hand == h; });
  for (const double friction : kFrictions)
    row(print("friction: %s", friction > 0 ? "shipped" : "none"),
        [&](const Cell& cell) { return cell.friction == friction; });
  for (const double rate : kRates)
    row(print("device at %.0f Hz", rate), [&](const Cell& cell) { return cell.rate == rate; });
}

void print_others(const std::vector<Cell>& cells) {
  print_head("With all protections, where they were not tuned (demo's stiffness, no friction, 1 kHz)",
             "motion");
  for (const Play play : kPlays) {
    if (play == Play::grasp) continue;
    const auto wanted = [&](const Cell& cell) {
      return has_all(cell) && is_other(cell) && cell.play == play;
    };
    print_row(kPlayNames[static_cast<std::size_t>(play)], worst_of(cells, wanted));
  }
}

void print_left_out(const std::vector<Cell>& cells) {
  print_head(
      "With one protection left out (grasp and press, the stiffer two, relaxed hand, no friction, 1 kHz)",
      "protections");
  const std::vector<Protection> list = protections();
  for (std::size_t p = 0; p < list.size(); ++p)
    print_row(list[p].name,
              worst_of(cells, [&](const Cell& cell) { return cell.protection == p && is_compared(cell); }));
}

void print_failed(const std::vector<Cell>& cells) {
  std::printf("\n## Failed\n\n");
  for (const Cell& c : cells) {
    if (!has_all(c) || !is_failed(c.felt)) continue;
    std::printf("- %s: %s, K_s %.0e, %s hand, friction %.0f, %.0f Hz: %llu shakes, %.3f mJ\n",
                kPlayNames[static_cast<std::size_t>(c.play)], bus_name(kBuses[c.bus]).c_str(),
                kStiffnesses[c.stiffness], kHands[c.hand].name, c.friction, c.rate,
                static_cast<unsigned long long>(c.felt.shakes), 1e3 * c.felt.given);
  }
}

bool write_plot(const std::string& path, const std::vector<Cell>& cells) {
  std::ofstream file(path);
  file << draw(cells);
  file.close();
  return !file.fail();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3 || has_switch(argc, argv))
    return tell_usage("delay_sweep PROFILE [PLOT.svg | few]", argc, argv);
  DeviceProfile profile;
  Status status = load_patient_profile(argv[1], profile);
  Models models;
  if (status.ok()) status = build(models);
  if (!status.ok()) return std::fprintf(stderr, "%s\n", status.message().c_str()), 2;
  const std::string plot = argc > 2 ? argv[2] : "";
  std::vector<Cell> cells = cells_of(plot != "few");
  run(profile, models, cells);
  print_about();
  print_tuned(cells);
  print_others(cells);
  print_left_out(cells);
  const bool failed = worst_of(cells, has_all).failed > 0;
  if (failed) print_failed(cells);
  if (!plot.empty() && plot != "few" && !write_plot(plot, cells))
    return std::fprintf(stderr, "%s: can't be written\n", plot.c_str()), 2;
  return failed ? 1 : 0;
}
