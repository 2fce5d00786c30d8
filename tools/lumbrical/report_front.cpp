// See report_front.h.
#include "report_front.h"

#include <algorithm>

#include "output.h"
#include "report_json.h"

namespace lumbrical::tool {
namespace {

constexpr double kDenseTriangles = 9522;  // the finest of the paper's meshes
constexpr double kTickPeriod = 1000;      // [us] of a haptic loop at 1 kHz

Figure empty_figure() {
  Figure figure;
  figure.title = "Time of a tick against error of its force";
  figure.note =
      "Median of the hand's whole tick; error of the hand's force in the worst pose, relative to our exact "
      "rung's: 'exact' is exact to rounding. Lower and farther left is better. The other libraries have no "
      "shape for a palm or a tapering finger, so one line is of a hand of capsules, the same for all, and "
      "one of "
      "the default hand with its palm. What a library leaves out of our tick's work stands beside its name, "
      "and "
      "costs it no time. Where it has no area, its force is the sum of depths times normals, scaled by the "
      "constant that fits best.";
  figure.x_label = "relative force error [1]";
  figure.y_label = "tick, median [us]";
  figure.zero = "exact";
  figure.deadline = kTickPeriod;
  figure.deadline_name = "deadline at 1 kHz";
  figure.joined = true;
  return figure;
}

// "1e-4" of "ours, 1e-4".
std::string rung_of(const std::string& contender) { return contender.substr(contender.rfind(' ') + 1); }

std::string point_label(const std::string& who, double time, double error) {
  return who + ": " + brief(time) + " us, force error " + (error > 0 ? scientific(error) : "0, to rounding");
}

void add_peer(const PeerResult& peer, Figure& figure, Plot& plot) {
  const std::string series = peer.is_ours()            ? "ours, the same hand of capsules"
                             : peer.leaves_out.empty() ? peer.contender
                                                       : peer.contender + ", leaves out " + peer.leaves_out;
  const std::string name = peer.is_ours() ? rung_of(peer.contender) : peer.contender;
  plot.points.push_back({peer.force_error, peer.median_us, index_of(figure.series, series), 0,
                         point_label(peer.contender, peer.median_us, peer.force_error), name});
}

// Of tick_bench: the same scene under the default hand.
void add_default_hand(const std::vector<Results>& all, const std::string& scene, double triangles,
                      Figure& figure, Plot& plot) {
  for (const char* const rung : {"exact", "1e-5", "1e-4", "1e-3"}) {
    const std::string benchmark =
        scene + "/" + rung + "/" + std::to_string(static_cast<std::uint64_t>(triangles));
    for (const Results& results : all) {
      const auto found = results.counters.find(benchmark);
      if (found == results.counters.end()) continue;
      const auto& counters = found->second;
      if (!counters.contains("processor_p50_us") || !counters.contains("force_error")) continue;
      const double time = counters.at("processor_p50_us"), error = counters.at("force_error");
      if (!(time > 1e-100 && time < 1e100 && error >= 0 && error < 1e100)) continue;
      plot.points.push_back({error < 1e-100 ? 0 : error, time,
                             index_of(figure.series, "ours, the default hand with its palm"), 0,
                             point_label("tick_bench: " + benchmark, time, error), rung});
    }
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

}  // namespace

Figure front_figure(const std::vector<Results>& results) {
  Figure figure = empty_figure();
  for (const auto& [scene, benchmark] : {std::pair{"A drape", "A_drape"}, std::pair{"A tips", "A_tips"}}) {
    const double triangles = densest(results, scene);
    if (triangles <= 0) continue;
    Plot& plot =
        plot_of(figure, std::string(scene) + ", " + count_text(triangles) + " triangles, beside others");
    for (const Results& one : results) {
      for (const PeerResult& peer : one.peers) {
        if (peer.scene == scene && peer.triangles == triangles) add_peer(peer, figure, plot);
      }
    }
    add_default_hand(results, benchmark, triangles, figure, plot);
  }
  return figure;
}

}  // namespace lumbrical::tool
