// How long a tick takes in any pose: random hands, also bent beyond their limits and folded to fists, at
// random places of a few worlds, exact and at 1e-4.
//
//   pose_times [SECONDS]      histograms, SECONDS (10) of each world and precision; the slowest poses by seed
//   pose_times --poses N      the same of seeds 0 to N - 1, however long that takes: the same poses
//   everywhere pose_times WORLD SEED     one of these poses again
//
// Within a hand's limits and beyond them (fists among these) the slowest are named apart.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "fists.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"
#include "pressed_hand.h"
#include "random.h"
#include "read_number.h"
#include "scenes.h"
#include "timing.h"
#include "usage.h"

namespace {

using namespace lumbrical;
using bench::thread_microseconds;
using test::kBeyond;

constexpr std::uint32_t kFewPairs = 8;  // with fewer the time per pair says nothing
constexpr std::size_t kSlowest = 5;     // that are named
constexpr double kPrecisions[] = {0, 1e-4};

struct World {
  std::string name;
  Mesh mesh;
};

std::vector<World> worlds() {
  return {{"mug", make_mug({})},
          {"box", make_box({0.06, 0.08, 0.05}, 1)},
          {"field", make_height_field(test::kWidthA, 69, 0.002, 0.04)},
          {"needles", bench::cut_plane(0.3, 800, bench::Cut::slivers, 1)}};
}

const char* precision_name(double precision) { return precision == 0 ? "exact" : "1e-4"; }

struct Session {
  Model model;
  State state;
  Scratch scratch;
  Box space;  // [m] where joints are put

  Session(const World& world, double precision) {
    Scene scene;
    scene.hand = test::loosened(default_hand(Side::right));
    scene.settings.precision.fill(precision);
    scene.objects = {{world.name, world.mesh}};
    if (const Status status = build_model(scene, {}, model); !status.ok()) {
      std::fprintf(stderr, "%s\n", status.message().c_str());
      std::exit(1);
    }
    scratch = make_scratch(model);
    scratch.hash_stages = scratch.keep_near = false;
    for (const Vec3 vertex : world.mesh.vertices) space.add(vertex, 0.01);
  }
};

// Of ten hands six keep their limits, two don't, and two are fists, bent to the last third or beyond.
constexpr std::size_t kManners = 10, kKeepLimits = 6, kNoFists = 8;

bool keeps_limits(std::uint64_t seed) { return test::Random(seed).below(kManners) < kKeepLimits; }

// One joint is somewhere in the world's box.
DeviceFrame pose_of(const Session& session, std::uint64_t seed) {
  test::Random random(seed);
  const Hand& hand = session.model.hand;
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  const std::size_t manner = random.below(kManners);
  std::array<double, kAngleCount> angles;
  for (std::size_t i = 0; i < kAngleCount; ++i) {
    const AngleLimit& loose = hand.finger[i / 4].limit[i % 4];
    const bool folds = manner >= kNoFists && i % 4 != 0;
    const double beyond = manner < kKeepLimits ? kBeyond : 0;
    const double lower = folds ? loose.lower + (loose.upper - loose.lower) * 2 / 3 : loose.lower + beyond;
    frame.angle[i] = static_cast<float>(random.between(lower, loose.upper - beyond));
    angles[i] = static_cast<double>(frame.angle[i]);
  }
  frame.base.orientation = random.rotation();
  std::array<Pose, kJointCount> X_WJ;
  forward_kinematics(hand, frame.base, angles, X_WJ);
  const auto& [low, high] = session.space;
  const Vec3 place{random.between(low.x, high.x), random.between(low.y, high.y),
                   random.between(low.z, high.z)};
  frame.base.position = place - X_WJ[random.below(kJointCount)].position;
  return frame;
}

// [us] of one tick.
double time_of(Session& session, const DeviceFrame& frame) {
  const double start = thread_microseconds();
  tick(session.model, session.state, session.scratch, frame);
  return thread_microseconds() - start;
}

// Counts by powers of two, and which poses were the slowest.
struct Histogram {
  static constexpr int kCount = 26;  // the first row has all below 1/64 us
  std::array<std::uint64_t, kCount> row{};
  std::uint64_t count = 0;
  struct Pose {
    double time = 0;  // [us]
    std::uint64_t seed = 0;
  };
  using Slowest = std::array<Pose, kSlowest>;
  Slowest within{}, beyond{};  // a hand's limits

  [[nodiscard]] bool is_slow(double time, std::uint64_t seed) const {
    return time > (keeps_limits(seed) ? within : beyond).back().time;
  }
  void add(double time, std::uint64_t seed) {
    const double scaled = std::clamp(time * 64, 0.0, 1e12);
    const auto bits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(scaled)));
    ++row[static_cast<std::size_t>(std::min(bits, kCount - 1))];
    ++count;
    if (!is_slow(time, seed)) return;
    Slowest& slowest = keeps_limits(seed) ? within : beyond;
    slowest.back() = {time, seed};
    std::sort(slowest.begin(), slowest.end(), [](const Pose& a, const Pose& b) { return a.time > b.time; });
  }
};

struct Times {
  std::string name;
  Histogram tick, pair;
};

// How much of each world and precision: so many poses, or seconds where there is no such number.
struct Amount {
  std::uint64_t poses = 0;
  double seconds = 10;
};

Times measure(const World& world, double precision, const Amount& amount) {
  Session session(world, precision);
  Times times{world.name + ", " + precision_name(precision), {}, {}};
  const double end = thread_microseconds() + 1e6 * amount.seconds;
  const auto goes_on = [&](std::uint64_t seed) {
    return amount.poses > 0 ? seed < amount.poses : thread_microseconds() < end;
  };
  for (std::uint64_t seed = 0; goes_on(seed); ++seed) {
    const DeviceFrame frame = pose_of(session, seed);
    double time = time_of(session, frame);
    const std::uint32_t pairs = session.scratch.candidate_count;
    const bool many = precision == 0 && pairs >= kFewPairs;
    // What looks slow is looked at again: a machine has other things to do.
    if (times.tick.is_slow(time, seed) || (many && times.pair.is_slow(time / pairs, seed)))
      time = std::min(time_of(session, frame), time_of(session, frame));
    times.tick.add(time, seed);
    if (many) times.pair.add(time / pairs, seed);
  }
  return times;
}

void print_histograms(const char* title, const std::vector<Times>& all, Histogram Times::*which) {
  int first = Histogram::kCount, last = 0;
  for (const Times& times : all) {
    for (int i = 0; i < Histogram::kCount; ++i) {
      if ((times.*which).row[static_cast<std::size_t>(i)] == 0) continue;
      first = std::min(first, i);
      last = std::max(last, i);
    }
  }
  std::printf("\n%s\n\n| us below |", title);
  for (const Times& times : all) std::printf(" %s |", times.name.c_str());
  std::printf("\n|---|");
  for (std::size_t i = 0; i < all.size(); ++i) std::printf("---|");
  for (int i = first; i <= last; ++i) {
    std::printf("\n| %g |", i == 0 ? 1.0 / 64 : static_cast<double>(1u << i) / 64);
    for (const Times& times : all)
      std::printf(" %llu |",
                  static_cast<unsigned long long>((times.*which).row[static_cast<std::size_t>(i)]));
  }
  std::printf("\n| all |");
  for (const Times& times : all)
    std::printf(" %llu |", static_cast<unsigned long long>((times.*which).count));
  for (const auto& [words, slowest] :
       {std::pair{"within", &Histogram::within}, {"beyond", &Histogram::beyond}}) {
    std::printf("\n| slowest %s a hand's limits: us (seed) |", words);
    for (const Times& times : all) {
      for (const auto& [time, seed] : (times.*which).*slowest) {
        if (time > 0) std::printf(" %.3g (%llu)", time, static_cast<unsigned long long>(seed));
      }
      std::printf(" |");
    }
  }
  std::printf("\n");
}

int print_all(const Amount& amount) {
  std::vector<Times> all, exact;
  for (const World& world : worlds()) {
    for (const double precision : kPrecisions) {
      all.push_back(measure(world, precision, amount));
      if (precision == 0) exact.push_back(all.back());
    }
  }
  print_histograms("Ticks by their time.", all, &Times::tick);
  print_histograms("Exact ticks of eight pairs and more, by their time per pair.", exact, &Times::pair);
  return 0;
}

int print_one(const std::string& name, std::uint64_t seed) {
  for (const World& world : worlds()) {
    if (world.name != name) continue;
    for (const double precision : kPrecisions) {
      Session session(world, precision);
      const DeviceFrame frame = pose_of(session, seed);
      double time = time_of(session, frame);
      for (int i = 0; i < 20; ++i) time = std::min(time, time_of(session, frame));
      std::printf("%s, %s: %.1f us, %u pairs\n", name.c_str(), precision_name(precision), time,
                  session.scratch.candidate_count);
    }
    return 0;
  }
  std::fprintf(stderr, "no world %s: mug, box, field or needles\n", name.c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  Amount amount;
  std::uint64_t seed = 0;
  const bool by_poses = argc == 3 && argv[1] == std::string("--poses");
  bool good = argc <= 3 && (by_poses || !bench::has_switch(argc, argv));
  if (argc == 2) good = good && bench::read_number(argv[1], 1e6, amount.seconds);
  if (by_poses) good = good && bench::read_number<std::uint64_t>(argv[2], 1000000000, amount.poses);
  if (argc == 3 && !by_poses) good = good && bench::read_number_or_0(argv[2], UINT64_MAX, seed);
  if (!good) return bench::tell_usage("pose_times [SECONDS] | --poses N | WORLD SEED", argc, argv);
  return argc == 3 && !by_poses ? print_one(argv[1], seed) : print_all(amount);
}
