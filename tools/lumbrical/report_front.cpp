// See report_front.h.
#include "report_front.h"

#include <algorithm>

#include "output.h"
#include "report_json.h"

namespace lumbrical::tool {
namespace {

constexpr double kDenseTriangles = 9522;  // the finest of the paper's meshes
constexpr double kHuge = 1e6;             // triangles from which on a world counts as huge
constexpr double kTickPeriod = 1000;      // [us] of a haptic loop at 1 kHz
constexpr double kNoticeable = 0.07;      // of a force: docs/recording.md

/// What a picture asks of all that are in it.
struct Job {
  const char *title, *peer_scene, *benchmark;  // of bench_peers and of tick_bench; nullptr: not there
};
constexpr Job kJobs[] = {{"Whole hand, pressed in", "A drape", "A_drape"},
                         {"Four fingertips", "A tips", "A_tips"},
                         {"One finger", "A one finger", "A_one_finger"}};

Figure empty_figure() {
  Figure figure;
  figure.title = "Time of a tick against error of its force, job by job";
  figure.note =
      "Median of the hand's whole tick; error of the hand's force in the worst pose, relative to our exact "
      "rung's: 'exact' is exact to rounding. Lower and farther left is better; ringed is what nothing else "
      "on the same job beats in both. Other libraries and methods have no shape for a palm or a tapering "
      "finger, so one line is of a hand of capsules, the same for all, and one of the default hand with its "
      "palm, which is another job. What others leave out of our tick's work "
      "costs them no time. Where they have no area, their force is the sum of depths times normals, scaled "
      "by the constant that fits best. Bracketed numbers are references of the paper. Rest the pointer on a "
      "mark for its figures, what it leaves out, and the command that repeats it.";
  figure.x_label = "relative force error [1]";
  figure.y_label = "tick, median [us]";
  figure.zero = "exact";
  figure.deadline = kTickPeriod;
  figure.deadline_name = "deadline at 1 kHz";
  figure.limit = kNoticeable;
  figure.limit_name = "just noticeable";
  figure.joined = figure.front = true;
  return figure;
}

// "1e-4" of "ours, 1e-4".
std::string rung_of(const std::string& contender) { return contender.substr(contender.rfind(' ') + 1); }

std::string last_line(const std::string& text) { return text.substr(text.rfind('\n') + 1); }

std::string point_label(const std::string& who, double time, double error, const std::string& command) {
  return who + ": " + brief(time) + " us, force error " + (error > 0 ? scientific(error) : "0, to rounding") +
         (command.empty() ? "" : "\n" + command);
}

void add_peer(const PeerResult& peer, const std::string& command, Figure& figure, Plot& plot) {
  const std::string series = peer.is_ours()     ? "ours, the same hand of capsules"
                             : peer.is_method() ? "methods of the paper's related work"
                                                : "other libraries";
  const std::string name = peer.is_ours() ? rung_of(peer.contender) : peer.contender;
  std::string label = point_label(peer.contender, peer.median_us, peer.force_error, command);
  if (!peer.leaves_out.empty()) label += "\nleaves out " + peer.leaves_out;
  plot.points.push_back({peer.force_error, peer.median_us, index_of(figure.series, series), 0, label, name,
                         true, peer.is_ours()});
}

/// A benchmark of tick_bench as a point.
struct TickPoint {
  std::string series, name;
  bool compared = true;
};
void add_tick(const std::vector<Results>& all, const std::string& benchmark, const TickPoint& as,
              Figure& figure, Plot& plot) {
  for (const Results& results : all) {
    const auto found = results.counters.find(benchmark);
    if (found == results.counters.end()) continue;
    const auto& counters = found->second;
    if (!counters.contains("processor_p50_us") || !counters.contains("force_error")) continue;
    const double time = counters.at("processor_p50_us"), error = counters.at("force_error");
    if (!(time > 1e-100 && time < 1e100 && error >= 0 && error < 1e100)) continue;
    const std::string command =
        "build/release/bench/tick_bench --benchmark_filter='^" + benchmark + "(/real_time)?$'";
    plot.points.push_back({error < 1e-100 ? 0 : error, time, index_of(figure.series, as.series), 0,
                           point_label("tick_bench: " + benchmark, time, error, command), as.name,
                           as.compared});
  }
}

void add_rungs(const std::vector<Results>& all, const std::string& scene, double triangles, bool compared,
               const std::string& series, Figure& figure, Plot& plot) {
  for (const char* const rung : {"exact", "1e-5", "1e-4", "1e-3"}) {
    const std::string benchmark =
        scene + "/" + rung + "/" + std::to_string(static_cast<std::uint64_t>(triangles));
    add_tick(all, benchmark, {series, rung, compared}, figure, plot);
  }
}

// The finest mesh that is no finer than the dense one: a run to try things out has no other.
double densest(const std::vector<Results>& all, const std::string& scene) {
  double most = 0;
  for (const Results& results : all) {
    for (const PeerResult& peer : results.peers) {
      if (peer.scene == scene && peer.triangles <= kDenseTriangles) most = std::max(most, peer.triangles);
    }
  }
  return most;
}

void add_job(const Job& job, const std::vector<Results>& all, Figure& figure) {
  const double triangles = densest(all, job.peer_scene);
  if (triangles <= 0) return;
  Plot& plot = plot_of(figure, std::string(job.title) + ": " + count_text(triangles) + " triangles");
  for (const Results& one : all) {
    for (const PeerResult& peer : one.peers) {
      if (peer.scene == job.peer_scene && peer.triangles == triangles)
        add_peer(peer, last_line(one.command), figure, plot);
    }
  }
  add_rungs(all, job.benchmark, triangles, false, "ours, the default hand with its palm", figure, plot);
}

// The largest world that was measured, be it ever finer (A) or ever wider (B).
void add_huge(const std::vector<Results>& all, Figure& figure) {
  double most = 0;
  for (const Results& results : all) {
    for (const auto& [name, counters] : results.counters) {
      const auto triangles = counters.find("triangles");
      if (name.starts_with("A_drape/") && triangles != counters.end())
        most = std::max(most, triangles->second);
    }
  }
  if (most < kHuge) return;
  Plot& plot = plot_of(figure, "A huge world: " + count_text(most) + " triangles");
  add_rungs(all, "A_drape", most, true, "ours, a field 0.3 m wide, the default hand", figure, plot);
  add_rungs(all, "B_drape", most, false, "ours, triangles of 5 mm, the default hand", figure, plot);
}

// The paper's own rate is no benchmark of ours: its machine was of 2008, its error that of its law.
void add_paper(const std::vector<Results>& all, Figure& figure) {
  constexpr const char *kOurLaw = "table2_row_10/field/9522/levels_6",
                       *kPaperLaw = "table2_row_10/max-depth/9522/levels_6";
  for (const Results& results : all) {
    const auto found = results.counters.find(kPaperLaw);
    if (found == results.counters.end() || !found->second.contains("paper_hz")) continue;
    const auto& counters = found->second;
    if (!counters.contains("force_error") || !(counters.at("paper_hz") > 0) ||
        !(counters.at("force_error") > 1e-100 && counters.at("force_error") < 1e100))
      continue;
    Plot& plot = plot_of(figure, "The paper's Table 2, row 10: 52 contacts");
    add_tick(all, kOurLaw, {"ours, field law, 1e-4", "field law, 1e-4"}, figure, plot);
    add_tick(all, kPaperLaw, {"ours, the paper's law", "the paper's law"}, figure, plot);
    const double time = 1e6 / counters.at("paper_hz"), error = counters.at("force_error");
    plot.points.push_back({error, time, index_of(figure.series, "the paper, by its own figures"), 0,
                           point_label("the paper, Table 2, row 10", time, error, ""), "the paper"});
    return;
  }
}

std::string time_and_error(const PeerResult& peer) {
  return brief(peer.median_us) + " us " +
         (peer.force_error > 0 ? "at an error of " + scientific(peer.force_error) : "without an error");
}

// The default rung, the exact one, and the fastest library, as a sentence; empty where there are no rungs.
std::string answer(const Job& job, const std::vector<Results>& all) {
  const double triangles = densest(all, job.peer_scene);
  const PeerResult *sampled = nullptr, *exact = nullptr, *fastest = nullptr;
  for (const Results& one : all) {
    for (const PeerResult& peer : one.peers) {
      if (peer.scene != job.peer_scene || peer.triangles != triangles) continue;
      if (peer.contender == "ours, 1e-4") sampled = &peer;
      if (peer.contender == "ours, exact") exact = &peer;
      if (peer.is_library() && (fastest == nullptr || peer.median_us < fastest->median_us)) fastest = &peer;
    }
  }
  if (sampled == nullptr || exact == nullptr) return {};
  std::string text = std::string(job.title) + ", " + count_text(triangles) + " triangles: a tick takes " +
                     time_and_error(*sampled) + ", or " + time_and_error(*exact) + ".";
  if (fastest != nullptr)
    text += " The fastest of other libraries, " + fastest->contender + ", takes " + time_and_error(*fastest) +
            ".";
  return text;
}

}  // namespace

std::vector<std::string> front_words(const std::vector<Results>& results) {
  std::vector<std::string> words;
  for (const Job& job : kJobs)
    if (std::string text = answer(job, results); !text.empty()) words.push_back(std::move(text));
  return words;
}

Figure front_figure(const std::vector<Results>& results) {
  Figure figure = empty_figure();
  for (const Job& job : kJobs) add_job(job, results, figure);
  add_paper(results, figure);
  add_huge(results, figure);
  return figure;
}

}  // namespace lumbrical::tool
