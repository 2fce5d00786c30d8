// Results as the benchmark programs write them, and what a reader sees of the page that lumbrical report
// makes.
#pragma once

#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "program.h"

namespace lumbrical::test {

using Json = nlohmann::json;

struct Contender {
  const char *scene, *name;
  double triangles, microseconds, error;
};

// "their area" finds areas, and whatever of ours.
inline Json peers_of(const std::vector<Contender>& contenders) {
  Json rows = Json::array();
  for (const Contender& one : contenders) {
    double ours = 0;
    for (const Contender& other : contenders) {
      const bool same = other.scene == std::string(one.scene) && other.triangles == one.triangles;
      if (same && other.name == std::string("ours, 1e-4")) ours = other.microseconds;
    }
    const bool is_ours = std::string(one.name).starts_with("ours");
    const bool has_area = is_ours || one.name == std::string("their area");
    rows.push_back({{"scene", one.scene},
                    {"contender", one.name},
                    {"leaves_out", is_ours ? "" : "the <hard> part"},
                    {"triangles", one.triangles},
                    {"touched", 7},
                    {"median_us", one.microseconds},
                    {"p99_us", one.microseconds},
                    {"times_exact", 1},
                    {"times_1e-4", one.microseconds / ours},
                    {"contacts", 7},
                    {"missed", is_ours ? Json() : Json(0)},
                    {"extra", is_ours ? Json() : Json(0)},
                    {"area_error", has_area ? Json(0) : Json()},
                    {"force_error", one.error},
                    {"fitted", !has_area},
                    {"build_ms", 1}});
  }
  return {{"cpu", "x"}, {"compiler", "c"}, {"flags", ""}, {"isa", "sse2"}, {"command", "bench/peers"},
          {"poses", 4}, {"clock", "wall"}, {"rows", rows}};
}

// What Google Benchmark writes of rows with these counters; `isa`: where tick_bench says which.
inline Json google_of(const std::vector<std::pair<const char*, Json>>& benchmarks,
                      const char* isa = nullptr) {
  Json rows = Json::array();
  for (const auto& [name, counters] : benchmarks) {
    rows.push_back({{"name", name + std::string("/real_time")}, {"real_time", 150}, {"time_unit", "ms"}});
    rows.back().update(counters);
  }
  Json context = {{"executable", "bench/tick_bench"}, {"num_cpus", 2}, {"mhz_per_cpu", 2000}};
  if (isa != nullptr) context["isa"] = isa;
  return {{"context", context}, {"benchmarks", rows}};
}

// The first plot of that title; empty if there is none.
inline std::string plot_in(const std::string& page, const std::string& title) {
  const std::size_t at = page.find(">" + title + "</text>");
  if (at == std::string::npos) return {};
  return page.substr(at, page.find("</svg>", at) - at);
}

struct Mark {
  double x = 0, y = 0;
  bool on_front = false;
};

// By what stands before the colon of their labels.
inline std::map<std::string, Mark> marks_in(const std::string& plot) {
  static const std::regex pattern(
      R"re(<g class="point s\d( front)?" transform="translate\(([0-9.]+) ([0-9.]+)\)">.*<title>([^:<]*):)re");
  std::map<std::string, Mark> marks;
  for (std::sregex_iterator match(plot.begin(), plot.end(), pattern), end; match != end; ++match)
    marks[(*match)[4]] = {std::stod((*match)[2]), std::stod((*match)[3]), (*match)[1].matched};
  return marks;
}

// Where an axis has its labelled ticks: value and place.
inline std::map<double, double> ticks_in(const std::string& plot, char axis) {
  const std::regex pattern(std::string("<text class=\"") + axis +
                           R"re(" x="([0-9.]+)" y="([0-9.]+)"[^>]*>([-0-9.e]+)</text>)re");
  std::map<double, double> ticks;
  for (std::sregex_iterator match(plot.begin(), plot.end(), pattern), end; match != end; ++match)
    ticks[std::stod((*match)[3])] = std::stod((*match)[axis == 'x' ? 1 : 2]);
  return ticks;
}

// Read off the axis as a person would: from its outermost labels, on a logarithmic scale.
inline double read_off(std::map<double, double> ticks, double place) {
  ticks.erase(0);
  if (ticks.size() < 2) return NAN;
  const auto [low, low_place] = *ticks.begin();
  const auto [high, high_place] = *ticks.rbegin();
  return low * std::pow(high / low, (place - low_place) / (high_place - low_place));
}

inline std::set<std::string> front_of(const std::string& page, const std::string& title) {
  std::set<std::string> names;
  for (const auto& [name, mark] : marks_in(plot_in(page, title))) {
    if (mark.on_front) names.insert(name);
  }
  return names;
}

// Left and right end of a name on the picture, and its height.
struct Name {
  double left = 0, right = 0, y = 0;
};

inline std::map<std::string, Name> names_in(const std::string& plot) {
  static const std::regex pattern(
      R"re(<text class="name( left)?" x="([0-9.]+)" y="([0-9.]+)"[^>]*>([^<]*)</text>)re");
  std::map<std::string, Name> names;
  for (std::sregex_iterator match(plot.begin(), plot.end(), pattern), end; match != end; ++match) {
    const double x = std::stod((*match)[2]), width = 5 * static_cast<double>((*match)[4].length());
    const bool to_left = (*match)[1].matched;
    names[(*match)[4]] = {to_left ? x - width : x, to_left ? x : x + width, std::stod((*match)[3])};
  }
  return names;
}

}  // namespace lumbrical::test
