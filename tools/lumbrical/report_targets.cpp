// See report_targets.h.
#include "report_targets.h"

#include <algorithm>
#include <array>
#include <optional>

#include "output.h"
#include "report_json.h"

namespace lumbrical::tool {
namespace {

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
constexpr Quantity kError = {"force_error", "", 1, false, "of the force"};
constexpr Quantity kBuild = {"microseconds", "", 1e-6, false, "s"};
constexpr Quantity kBytes = {"bytes_per_triangle", "", 1, false, "bytes per triangle"};

struct Target {
  const char* what;
  Quantity quantity;
  double limit;
  std::vector<const char*> benchmarks;  ///< the worst of these counts
};

const std::vector<Target>& all_targets() {
  static const std::vector<Target> targets = {
      {"A drape, 9.5k triangles, 1e-4", kTime, 45, {"A_drape/1e-4/9522"}},
      {"A drape, 9.5k triangles, 1e-4", kTail, 1.5, {"A_drape/1e-4/9522"}},
      {"A drape, 9.5k triangles, 1e-4", kError, 1e-4, {"A_drape/1e-4/9522"}},
      {"A drape, 9.5k triangles, 1e-5", kTime, 80, {"A_drape/1e-5/9522"}},
      {"A drape, 162 triangles, 1e-4", kTime, 45, {"A_drape/1e-4/162"}},
      {"A drape, 1.7k triangles, 1e-4", kTime, 35, {"A_drape/1e-4/1682"}},
      {"A drape, 4.8k triangles, 1e-4", kTime, 45, {"A_drape/1e-4/4802"}},
      {"A tips, 9.5k triangles, 1e-4", kTime, 22, {"A_tips/1e-4/9522"}},
      {"A tips, 9.5k triangles, 1e-3", kTime, 14, {"A_tips/1e-3/9522"}},
      {"B drape, 10M triangles, 1e-4", kTime, 60, {"B_drape/1e-4/9999392"}},
      {"B, 10M triangles, at a random place every tick, 1e-4", kTime, 90, {"B_jumping/1e-4/9999392"}},
      {"A drape, 100k triangles, 1e-4", kTime, 220, {"A_drape/1e-4/100352"}},
      {"A drape, 1M triangles, 1e-4", kTime, 600, {"A_drape/1e-4/1002528"}},
      {"A drape, 10M triangles, 1e-4", kTime, 1500, {"A_drape/1e-4/9999392"}},
      {"the paper's Table 2, row 10, 1e-4", kRate, 60, {"table2_row_10/field/9522/levels_6"}},
      {"the paper's Table 2, row 10, by the paper's law",
       kRate,
       30,
       {"table2_row_10/max-depth/9522/levels_6"}},
      {"A drape, 9.5k triangles, exact", kTime, 310, {"A_drape/exact/9522"}},
      {"empty space", kTime, 1, {"B_empty_space/1e-4/9522", "B_empty_space/1e-4/9999392"}},
      {"build, 1M triangles, 2 threads", kBuild, 0.2, {"build_A/tree/1002528/threads_2"}},
      {"build, 10M triangles, 2 threads", kBuild, 2.5, {"build_A/tree/9999392/threads_2"}},
      {"memory, all included",
       kBytes,
       50,
       {"build_A/tree/1002528/threads_2", "build_A/tree/9999392/threads_2",
        "build_B/grid/1002528/threads_2"}},
  };
  return targets;
}

using Counters = std::map<std::string, double>;

const Counters* counters_of(const std::vector<Results>& all, const std::string& benchmark) {
  for (const Results& results : all) {
    const auto found = results.counters.find(benchmark);
    if (found != results.counters.end()) return &found->second;
  }
  return nullptr;
}

// Nothing where the benchmark or one of its counters is not there.
std::optional<double> figure_of(const std::vector<Results>& all, const char* benchmark,
                                const Quantity& quantity) {
  const Counters* const counters = counters_of(all, benchmark);
  if (counters == nullptr || !counters->contains(quantity.counter)) return std::nullopt;
  double value = quantity.factor * counters->at(quantity.counter);
  if (*quantity.over != 0) {
    if (!counters->contains(quantity.over) || counters->at(quantity.over) <= 0) return std::nullopt;
    value /= counters->at(quantity.over);
  }
  if (!quantity.inverted) return value;
  return value > 0 ? std::optional(1 / value) : std::nullopt;
}

std::vector<std::string> row_of(const std::string& what, bool at_least, double limit, double reached,
                                const std::string& unit, const std::string& benchmark) {
  const bool met = at_least ? reached >= limit : reached <= limit;
  return {what, (at_least ? "at least " : "at most ") + brief(limit) + " " + unit,
          brief(reached) + " " + unit, met ? "yes" : "no", benchmark};
}

void add_target(const std::vector<Results>& all, const Target& target, ResultTable& table) {
  std::optional<double> worst;
  std::string at;
  for (const char* const benchmark : target.benchmarks) {
    const std::optional<double> figure = figure_of(all, benchmark, target.quantity);
    if (!figure) continue;
    if (worst && (target.quantity.inverted ? *figure >= *worst : *figure <= *worst)) continue;
    worst = figure;
    at = benchmark;
  }
  if (worst)
    table.rows.push_back(
        row_of(target.what, target.quantity.inverted, target.limit, *worst, target.quantity.unit, at));
}

// ---- Beside other libraries ----

// How many times our time the fastest of some contenders takes, in the scene where that is least.
struct Peers {
  const char* what;
  double limit;
  bool has_area;  // contenders that do the whole work, or those that find contacts only
  bool is_large;  // drapes of 9,000 triangles and more, or everything else
};
constexpr std::array<Peers, 4> kPeers = {{
    {"times faster than Bullet, FCL and ODE, drapes from 9.5k triangles on", 12, false, true},
    {"times faster than Bullet, FCL and ODE, smaller scenes and tips", 5, false, false},
    {"times faster than tree and scalar area, drapes from 9.5k triangles on", 5, true, true},
    {"times faster than tree and scalar area, smaller scenes and tips", 5, true, false},
}};

void add_peers(const std::vector<Results>& all, const Peers& peers, ResultTable& table) {
  std::map<std::string, double> fastest;  // by scene
  for (const Results& results : all) {
    for (const auto& [name, counters] : results.counters) {
      if (!counters.contains("times_ours")) continue;
      const std::size_t bar = name.find(" | ");
      const std::string scene = name.substr(0, bar), contender = name.substr(bar + 3);
      const bool is_large = scene.find("drape") != std::string::npos && counters.at("triangles") >= 9000;
      const bool has_area = contender.find("scalar area") != std::string::npos;
      if (contender.starts_with("ours") || is_large != peers.is_large || has_area != peers.has_area) continue;
      const double times = counters.at("times_ours");
      const auto [place, added] = fastest.emplace(scene, times);
      if (!added) place->second = std::min(place->second, times);
    }
  }
  if (fastest.empty()) return;
  const auto least = std::min_element(fastest.begin(), fastest.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; });
  table.rows.push_back(
      row_of(peers.what, true, peers.limit, least->second, "times", "bench_peers: " + least->first));
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
  for (const Peers& peers : kPeers) add_peers(results, peers, table);
  return table;
}

std::string table_markdown(const std::string& title, const ResultTable& table) {
  if (table.rows.empty()) return {};
  std::string text = "## " + markdown_cell(title) + "\n\n";
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
