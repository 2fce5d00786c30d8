// See report_targets.h.
#include "report_targets.h"

#include <algorithm>
#include <array>
#include <optional>

#include "output.h"
#include "report_json.h"

namespace lumbrical::tool {
namespace {

constexpr std::size_t kMetColumn = 3;
constexpr const char* kMet = "yes";
constexpr const char* kTriedOut = "quick";  // a time of a thousandth of a second meets and misses nothing

/// How a figure is made of a benchmark's counters, and which way it should go.
struct Quantity {
  const char *counter, *over;  ///< `over`: divides it, where it is not empty
  double factor;
  bool inverted;  ///< 1 over it: a rate, which should be at least the target
  const char* unit;
};
constexpr Quantity kTime = {"p50_us", "", 1, false, "us"};
constexpr Quantity kRate = {"p50_us", "", 1e-3, true, "kHz"};
constexpr Quantity kTail = {"processor_p99_us", "processor_p50_us", 1, false,
                            "times the median at p99 (processor time)"};
constexpr Quantity kTick99 = {"p99_us", "", 1, false, "us at p99"};
constexpr Quantity kError = {"force_error", "", 1, false, "of the force"};
constexpr Quantity kMostTicksError = {"hand_error", "", 1, false, "of the hand's force in 98 % of ticks"};
constexpr Quantity kSegmentError = {"segment_error", "", 1, false,
                                    "of the hand's force in 98 % of ticks, the worst segment's"};
constexpr Quantity kBuild = {"microseconds", "", 1e-6, false, "s"};
constexpr Quantity kBytes = {"bytes_per_triangle", "", 1, false, "bytes per triangle"};

// What a machine without AVX-512 should reach; one that has it may have to reach more.
struct Limit {
  double any, avx512 = 0;
};

struct Target {
  const char* what;
  Quantity quantity;
  Limit limit;
  std::vector<const char*> benchmarks;  ///< the worst of these counts; * stands for any text
};

const std::vector<Target>& all_targets() {
  static const std::vector<Target> targets = {
      {"A drape, 9.5k triangles, 1e-4", kTime, {60, 45}, {"A_drape/1e-4/9522"}},
      {"A drape, 9.5k triangles, 1e-4", kTail, {1.5}, {"A_drape/1e-4/9522"}},
      {"A drape, 9.5k triangles, 1e-4", kError, {1e-4}, {"A_drape/1e-4/9522"}},
      {"A drape, 9.5k triangles, 1e-5", kTime, {80}, {"A_drape/1e-5/9522"}},
      {"A drape, 9.5k triangles, 1e-5", kError, {2e-5}, {"A_drape/1e-5/9522"}},
      {"A drape, 162 triangles, 1e-4", kTime, {45}, {"A_drape/1e-4/162"}},
      {"A drape, 1.7k triangles, 1e-4", kTime, {35}, {"A_drape/1e-4/1682"}},
      {"A drape, 4.8k triangles, 1e-4", kTime, {45}, {"A_drape/1e-4/4802"}},
      {"A tips, 9.5k triangles, 1e-4", kTime, {22}, {"A_tips/1e-4/9522"}},
      {"A tips, 9.5k triangles, 1e-3", kTime, {14}, {"A_tips/1e-3/9522"}},
      {"B drape, 10M triangles, 1e-4", kTime, {60}, {"B_drape/1e-4/9999392"}},
      {"B, 10M triangles, at a random place every tick, 1e-4", kTime, {90}, {"B_jumping/1e-4/9999392"}},
      {"A drape, 100k triangles, 1e-4", kTime, {220}, {"A_drape/1e-4/100352"}},
      {"A drape, 1M triangles, 1e-4", kTime, {600}, {"A_drape/1e-4/1002528"}},
      {"A drape, 10M triangles, 1e-4", kTime, {1500}, {"A_drape/1e-4/9999392"}},
      {"the paper's Table 2, row 10, 1e-4", kRate, {45, 60}, {"table2_row_10/field/9522/levels_6"}},
      {"the paper's Table 2, row 10, by the paper's law",
       kRate,
       {30},
       {"table2_row_10/max-depth/9522/levels_6"}},
      {"real meshes, the built-in grasp, 1e-4", kTick99, {400}, {"meshes/*/1e-4"}},
      {"real meshes, the built-in grasp, 1e-4", kMostTicksError, {1e-4}, {"meshes/*/1e-4"}},
      {"real meshes, the built-in grasp, 1e-4", kSegmentError, {3e-4}, {"meshes/*/1e-4"}},
      {"the demo, every tick", kTime, {25}, {"demo/1e-4/mug_24/iterations:10000"}},
      {"the demo, every tick", kTick99, {50}, {"demo/1e-4/mug_24/iterations:10000"}},
      {"A drape, 9.5k triangles, exact", kTime, {550, 310}, {"A_drape/exact/9522"}},
      {"empty space", kTime, {1}, {"B_empty_space/1e-4/9522", "B_empty_space/1e-4/9999392"}},
      {"build, 1M triangles, 2 threads", kBuild, {0.2}, {"build_A/tree/1002528/threads_2"}},
      {"build, 10M triangles, 2 threads", kBuild, {2.5}, {"build_A/tree/9999392/threads_2"}},
      {"memory, all included",
       kBytes,
       {50},
       {"build_A/tree/1002528/threads_2", "build_A/tree/9999392/threads_2",
        "build_B/grid/1002528/threads_2"}},
  };
  return targets;
}

using Counters = std::map<std::string, double>;

// Nothing where a counter is not there.
std::optional<double> figure_of(const Counters& counters, const Quantity& quantity) {
  if (!counters.contains(quantity.counter)) return std::nullopt;
  double value = quantity.factor * counters.at(quantity.counter);
  if (*quantity.over != 0) {
    if (!counters.contains(quantity.over) || counters.at(quantity.over) <= 0) return std::nullopt;
    value /= counters.at(quantity.over);
  }
  if (!quantity.inverted) return value;
  return value > 0 ? std::optional(1 / value) : std::nullopt;
}

bool is_avx512(const Results& results) {
  return std::find(results.origin.begin(), results.origin.end(),
                   std::pair<std::string, std::string>("isa", "avx512")) != results.origin.end();
}

std::vector<std::string> row_of(const std::string& what, bool at_least, double limit, double reached,
                                const std::string& unit, const std::string& benchmark, bool is_quick) {
  const bool met = at_least ? reached >= limit : reached <= limit;
  const char* const verdict = is_quick ? kTriedOut : met ? kMet : "MISSED";
  return {what, (at_least ? "at least " : "at most ") + brief(limit) + " " + unit,
          brief(reached) + " " + unit, verdict, benchmark};
}

// The worst of the benchmarks that a target names, and where it stands.
struct Worst {
  std::optional<double> figure;
  std::string benchmark;
  const Results* results = nullptr;
};

// A * in the pattern, of which there is one at most, stands for any text.
bool matches(const std::string& name, const std::string& pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string::npos) return name == pattern;
  return name.size() + 1 >= pattern.size() && name.starts_with(pattern.substr(0, star)) &&
         name.ends_with(pattern.substr(star + 1));
}

void take_worst(const Results& results, const std::string& pattern, const Quantity& quantity, Worst& worst) {
  for (const auto& [name, counters] : results.counters) {
    if (!matches(name, pattern)) continue;
    const std::optional<double> figure = figure_of(counters, quantity);
    if (!figure) continue;
    if (worst.figure && (quantity.inverted ? *figure >= *worst.figure : *figure <= *worst.figure)) continue;
    worst = {figure, name, &results};
  }
}

void add_target(const std::vector<Results>& all, const Target& target, ResultTable& table) {
  Worst worst;
  for (const char* const pattern : target.benchmarks) {
    for (const Results& results : all) take_worst(results, pattern, target.quantity, worst);
  }
  if (!worst.figure) return;
  const bool wide = target.limit.avx512 > 0 && is_avx512(*worst.results);
  table.rows.push_back(row_of(target.what, target.quantity.inverted,
                              wide ? target.limit.avx512 : target.limit.any, *worst.figure,
                              target.quantity.unit, worst.benchmark, worst.results->is_quick));
}

// ---- Threads ----

// How many times as fast `benchmark` is with two threads.
struct Threads {
  const char *what, *benchmark;
  double limit;
};
constexpr std::array<Threads, 3> kThreads = {{
    {"two threads, A drape, 9.5k triangles, exact", "A_drape/exact/9522", 1.5},
    {"two threads where they don't pay, A drape, 9.5k triangles, 1e-4", "A_drape/1e-4/9522", 1},
    {"two threads, A drape, 1M triangles, 1e-4", "A_drape/1e-4/1002528", 1.5},
}};

void add_threads(const std::vector<Results>& all, const Threads& threads, ResultTable& table) {
  Worst one, two;
  for (const Results& results : all) {
    take_worst(results, threads.benchmark, kTime, one);
    take_worst(results, std::string(threads.benchmark) + "/2_threads", kTime, two);
  }
  if (one.figure && two.figure && *two.figure > 0)
    table.rows.push_back(row_of(threads.what, true, threads.limit, *one.figure / *two.figure, "times",
                                two.benchmark, one.results->is_quick || two.results->is_quick));
}

// ---- Beside other libraries ----

enum class PeerScene { drape, tips_162, rest };

// How many times our time at 1e-4 the fastest of some contenders takes, in the scene where that is least.
struct Peers {
  const char* what;
  double limit;
  bool has_area;  // contenders that do the whole work, or those that find contacts only
  PeerScene scene;
  double least;  // triangles of what counts as a drape; coarser ones are among the rest
};
constexpr std::array<Peers, 6> kPeers = {{
    {"times faster than tree and scalar area, drapes from 1.7k triangles on", 12, true, PeerScene::drape,
     1600},
    {"times faster than tree and scalar area, every other scene but tips on 162", 5, true, PeerScene::rest,
     1600},
    {"times faster than tree and scalar area, tips on 162 triangles", 1, true, PeerScene::tips_162, 1600},
    {"times faster than Bullet, FCL and ODE, drapes from 9.5k triangles on", 25, false, PeerScene::drape,
     9000},
    {"times faster than Bullet, FCL and ODE, every other scene but tips on 162", 8, false, PeerScene::rest,
     9000},
    {"times faster than Bullet, FCL and ODE, tips on 162 triangles", 2, false, PeerScene::tips_162, 9000},
}};

PeerScene scene_of(const PeerResult& peer, double least) {
  if (peer.scene.ends_with("drape") && peer.triangles >= least) return PeerScene::drape;
  return peer.scene.ends_with("tips") && peer.triangles <= 162 ? PeerScene::tips_162 : PeerScene::rest;
}

void add_peers(const std::vector<Results>& all, const Peers& peers, ResultTable& table) {
  const PeerResult* fastest = nullptr;
  bool is_quick = false;
  for (const Results& results : all) {
    for (const PeerResult& peer : results.peers) {
      if (!peer.is_library() || peer.times_ours <= 0 || peer.has_area != peers.has_area) continue;
      if (scene_of(peer, peers.least) != peers.scene) continue;
      if (fastest != nullptr && peer.times_ours >= fastest->times_ours) continue;
      fastest = &peer;
      is_quick = results.is_quick;
    }
  }
  if (fastest == nullptr) return;
  table.rows.push_back(row_of(peers.what, true, peers.limit, fastest->times_ours, "times",
                              "bench_peers: " + fastest->scene + ", " + count_text(fastest->triangles) +
                                  " triangles, " + fastest->contender,
                              is_quick));
}

std::string markdown_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find_first_of("|\n<", at)) != std::string::npos; ++at) text[at] = ' ';
  return text;
}

}  // namespace

ResultTable targets_of(const std::vector<Results>& results) {
  ResultTable table;
  table.head = {"what", "target", "reached", "met", "benchmark"};
  for (const Target& target : all_targets()) add_target(results, target, table);
  for (const Threads& threads : kThreads) add_threads(results, threads, table);
  for (const Peers& peers : kPeers) add_peers(results, peers, table);
  return table;
}

std::size_t judged_targets(const ResultTable& targets) {
  return static_cast<std::size_t>(
      std::count_if(targets.rows.begin(), targets.rows.end(),
                    [](const auto& row) { return row[kMetColumn] != kTriedOut; }));
}

std::size_t met_targets(const ResultTable& targets) {
  return static_cast<std::size_t>(std::count_if(targets.rows.begin(), targets.rows.end(),
                                                [](const auto& row) { return row[kMetColumn] == kMet; }));
}

std::string table_markdown(const std::string& title, const std::string& builds, const ResultTable& table) {
  if (table.rows.empty()) return {};
  std::string text = "## " + markdown_cell(title) + "\n\nOf " + markdown_cell(builds) + ".\n\n";
  const auto line = [&](const std::vector<std::string>& texts) {
    for (const std::string& one : texts) text += "| " + markdown_cell(one) + " ";
    text += "|\n";
  };
  line(table.head);
  line(std::vector<std::string>(table.head.size(), "---"));
  for (const std::vector<std::string>& row : table.rows) line(row);
  return text + "\n";
}

}  // namespace lumbrical::tool
