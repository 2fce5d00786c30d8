// See report_results.h.
#include "report_results.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "output.h"
#include "report_google.h"
#include "report_json.h"
#include "report_origin.h"

namespace lumbrical::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 64u << 20;  // [bytes] results are some kilobytes
constexpr const char* kRemedy = "; repeat the benchmark that writes it, or take it out of the folder";

void add_origin(const Json& json, Results& results) {
  for (const char* const key : {"cpu", "isa", "compiler", "flags"})
    results.origin.emplace_back(key, text_at(json, key, ""));
  add_build(json, results);
  results.command = text_at(json, "command", "");
}

// ---- accuracy ----

// The mean over the angle classes, which hold equally many pairs; that is how accuracy's own table has it.
double speed_of(const Json& speeds, const std::string& law, const std::string& precision,
                const std::string& shape) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const std::string where = place("speeds", i);
    const Json& speed = speeds[i];
    if (text_at(speed, "law", where) != law || text_at(speed, "precision", where) != precision ||
        text_at(speed, "shape", where) != shape)
      continue;
    sum += positive_at(speed, "ns_per_pair", where);
    ++count;
  }
  if (count == 0)
    throw std::runtime_error("speeds: has no time for " + law + ", " + precision + ", " + shape);
  return sum / count;
}

void read_accuracy(const Json& json, Results& results) {
  results.title = "Laws against the reference";
  add_origin(json, results);
  results.origin.emplace_back("pairs", count_text(positive_at(json, "pairs", "")));
  results.table.head = {"law",  "precision", "shape", "ns per pair", "quantity",
                        "unit", "median",    "98 %",  "worst"};
  Figure& figure = results.figures.emplace_back();
  figure.title = "Time against error, one pair of hand part and triangle";
  figure.note =
      "Each law against its own definition, in multiple precision, over random pairs of every angle. R is "
      "the "
      "larger radius of the hand part. The error is that of the volume [R^3]; under the law point, of the "
      "depth [R]. Ringed: no other law and precision is both faster and more accurate for that shape.";
  figure.x_label = "error [R^3; law point: R]";
  figure.y_label = "time [ns per pair]";
  figure.front = true;
  const Json& errors = array_at(json, "errors");
  const Json& speeds = array_at(json, "speeds");
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const std::string where = place("errors", i);
    const Json& row = errors[i];
    const std::string law = text_at(row, "law", where), quantity = text_at(row, "quantity", where);
    const std::string precision = text_at(row, "precision", where), shape = text_at(row, "shape", where);
    const std::string unit = text_at(row, "unit", where);
    if (text_at(row, "angle", where) != "all" || law == "every" || quantity.find("volume") != 0) continue;
    const double time = speed_of(speeds, law, precision, shape);
    const Json& absolute = object_at(row, "absolute", where);
    const std::string in_absolute = where + ".absolute";
    const double most = amount_at(absolute, "p98", in_absolute);
    const double worst = amount_at(absolute, "worst", in_absolute);
    const std::size_t series = index_of(figure.series, law);
    const std::size_t marker = index_of(figure.markers, precision);
    const std::string label = law + ", " + precision + ", " + shape + ": " + brief(time) + " ns, ";
    plot_of(figure, shape + ", 98 % of the pairs")
        .points.push_back({most, time, series, marker, label + scientific(most) + " " + unit});
    plot_of(figure, shape + ", worst pair")
        .points.push_back({worst, time, series, marker, label + scientific(worst) + " " + unit});
    results.table.rows.push_back({law, precision, shape, brief(time), quantity, unit,
                                  scientific(amount_at(absolute, "median", in_absolute)), scientific(most),
                                  scientific(worst)});
  }
  if (results.table.rows.empty()) throw std::runtime_error("errors: has no volume over all angles");
}

// ---- bench_peers ----

std::string percent(double share) { return share == 0 ? "0" : brief(100 * share, 2) + " %"; }

std::vector<Figure> peer_figures(const std::string& clock) {
  Figure error, size;
  error.title = "Tick time against force error";
  error.note =
      "Median of the hand's whole tick, in " + clock +
      " time. The error is that of the hand's force in the worst pose, relative to the exact pressure "
      "field's, "
      "which is therefore at 0. What has no area gets the sum of depth times normal, scaled by the constant "
      "that fits best. Ringed: no other is both faster and more accurate.";
  error.x_label = "relative force error [1]";
  error.front = true;
  size.joined = true;
  size.title = "Tick time against triangle count";
  size.note = "Scene A is 300 mm wide, ever finer; in scene B triangles measure 5 mm and it grows.";
  size.x_label = "triangles in the scene";
  size.y_label = error.y_label = "tick, median [us]";
  return {error, size};
}

bool has_value(const Json& row, const char* key) { return row.contains(key) && !row[key].is_null(); }

// What a contender need not have.
std::string share_or_none(const Json& row, const char* key, const std::string& where) {
  return has_value(row, key) ? percent(amount_at(row, key, where)) : "none";
}

PeerResult peer_at(const Json& row, const std::string& where) {
  PeerResult peer;
  peer.scene = text_at(row, "scene", where);
  peer.contender = text_at(row, "contender", where);
  if (row.contains("leaves_out")) peer.leaves_out = text_at(row, "leaves_out", where);
  peer.triangles = positive_at(row, "triangles", where);
  peer.median_us = positive_at(row, "median_us", where);
  peer.force_error = amount_at(row, "force_error", where);
  if (row.contains("times_1e-4")) peer.times_ours = positive_at(row, "times_1e-4", where);
  peer.has_area = peer.is_ours() || has_value(row, "area_error");
  return peer;
}

std::vector<std::string> peer_row(const Json& row, const PeerResult& peer, const std::string& where) {
  const auto times = [&](const char* key) {
    return has_value(row, key) ? brief(positive_at(row, key, where)) : "";
  };
  const bool fitted = row.contains("fitted") && row["fitted"] == true;
  return {peer.scene,
          count_text(peer.triangles),
          brief(amount_at(row, "touched", where)),
          peer.contender,
          brief(peer.median_us),
          brief(amount_at(row, "p99_us", where)),
          times("times_exact"),
          times("times_1e-4"),
          brief(amount_at(row, "contacts", where)),
          share_or_none(row, "missed", where),
          share_or_none(row, "extra", where),
          has_value(row, "area_error") ? scientific(amount_at(row, "area_error", where)) : "none",
          scientific(peer.force_error) + (fitted ? " fitted" : ""),
          brief(amount_at(row, "build_ms", where)),
          peer.leaves_out};
}

void read_peers(const Json& json, Results& results) {
  results.title = "The hand's tick beside other libraries";
  add_origin(json, results);
  results.origin.emplace_back("poses", count_text(positive_at(json, "poses", "")));
  results.table.head = {"scene",  "triangles",   "touched",     "contender", "median us",
                        "p99 us", "times exact", "times 1e-4",  "contacts",  "missed",
                        "extra",  "area error",  "force error", "build ms",  "leaves out"};
  results.figures = peer_figures(text_at(json, "clock", ""));
  Figure& by_error = results.figures[0];
  Figure& by_size = results.figures[1];
  const Json& rows = array_at(json, "rows");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string where = place("rows", i);
    const PeerResult& peer = results.peers.emplace_back(peer_at(rows[i], where));
    const std::string scene = peer.scene + ", " + count_text(peer.triangles) + " triangles";
    const bool misses = has_value(rows[i], "missed") && amount_at(rows[i], "missed", where) > 0;
    const std::size_t series = index_of(by_error.series, peer.contender);
    by_size.series = by_error.series;
    const std::string label =
        peer.contender + ", " + scene + ": " + brief(peer.median_us) + " us, force error " +
        scientific(peer.force_error) +
        (misses ? ", misses " + share_or_none(rows[i], "missed", where) + " of the contacts" : "");
    plot_of(by_error, scene).points.push_back({peer.force_error, peer.median_us, series, 0, label});
    plot_of(by_size, peer.scene).points.push_back({peer.triangles, peer.median_us, series, 0, label});
    results.table.rows.push_back(peer_row(rows[i], peer, where));
  }
  if (rows.empty()) throw std::runtime_error("rows: is empty");
}

// ---- mesh_grasps ----

Figure mesh_figure() {
  Figure figure;
  figure.title = "Tick time against force error, real meshes";
  figure.note =
      "The built-in grasp round each mesh, by precision: median of a tick that touches; error of the hand's "
      "force that 98 % of the ticks keep, as a share of the segments' forces together.";
  figure.x_label = "relative force error, 98 % of ticks [1]";
  figure.y_label = "tick, median [us]";
  figure.zero = "exact";
  figure.series = {"ours"};
  figure.joined = true;
  return figure;
}

// Every part of the hand by itself, beside the rung exact that feels once what several parts hold.
constexpr const char* kExactForEach = "exact for each";

void add_left_out(const Json& json, Results& results) {
  for (const Json& one : array_at(json, "left_out")) {
    if (!one.is_string()) throw std::runtime_error("left_out: is not a list of texts");
    results.notes.push_back("Left out: " + one.get<std::string>());
  }
}

void read_meshes(const Json& json, Results& results) {
  results.title = "The built-in grasp on real meshes";
  add_origin(json, results);
  if (json.contains("left_out")) add_left_out(json, results);
  results.table.head = {"mesh",       "triangles",   "contacts",     "rung",
                        "median us",  "p99 us",      "times exact",  "times exact, felt once",
                        "hand, 98 %", "hand, worst", "segment, 98 %"};
  Figure& figure = results.figures.emplace_back(mesh_figure());
  const Json& rows = array_at(json, "meshes");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string where = place("meshes", i);
    const Json& row = rows[i];
    const std::string mesh = text_at(row, "mesh", where), rung = text_at(row, "rung", where);
    auto& counters = results.counters["meshes/" + mesh + "/" + rung];
    for (const char* const key : {"median_us", "p99_us"}) counters[key] = positive_at(row, key, where);
    for (const char* const key : {"processor_p50_us", "processor_p99_us"})
      if (row.contains(key)) counters[key] = positive_at(row, key, where);
    for (const char* const key : {"hand_error", "worst_hand_error", "segment_error"})
      counters[key] = amount_at(row, key, where);
    const double time = counters["median_us"], error = counters["hand_error"];
    // Exact for each part by itself is no error, but another question.
    if (rung != kExactForEach)
      plot_of(figure, mesh + ", " + count_text(positive_at(row, "triangles", where)) + " triangles")
          .points.push_back(
              {error, time, 0, 0,
               mesh + ", " + rung + ": " + brief(time) + " us, force error " + scientific(error), rung});
    const auto times = [&](const char* key) {
      return row.contains(key) ? brief(positive_at(row, key, where)) : "";
    };
    results.table.rows.push_back(
        {mesh, count_text(positive_at(row, "triangles", where)), brief(amount_at(row, "contacts", where)),
         rung, brief(time), brief(counters["p99_us"]), times("times_exact"), times("times_exact_felt_once"),
         scientific(error), scientific(counters["worst_hand_error"]), scientific(counters["segment_error"])});
  }
  if (rows.empty()) throw std::runtime_error("meshes: is empty");
}

// ---- paper_experiments ----

std::vector<double> numbers_at(const Json& object, const char* key, const std::string& where) {
  const Json& member = member_at(object, key, where);
  std::vector<double> numbers;
  for (const Json& number : member) {
    const double value = number.is_number() ? number.get<double>() : HUGE_VAL;
    if (!(std::fabs(value) <= 1e100)) refuse(where, key, "is not a list of numbers up to 1e100");
    numbers.push_back(value);
  }
  if (!member.is_array() || numbers.empty()) refuse(where, key, "is not a list of numbers up to 1e100");
  return numbers;
}

Curve curve_at(const Json& json, const std::string& where, CurveFigure& figure) {
  Curve curve;
  curve.series = index_of(figure.series, text_at(json, "series", where));
  const std::vector<double> x = numbers_at(json, "x", where), y = numbers_at(json, "y", where);
  if (x.size() != y.size()) refuse(where, "y", "is not as long as x");
  for (std::size_t i = 0; i < x.size(); ++i) curve.points.emplace_back(x[i], y[i]);
  return curve;
}

void add_panel(const Json& json, const std::string& where, ResultTable& table, CurveFigure& figure) {
  CurvePanel& panel = figure.panels.emplace_back();
  panel.title = text_at(json, "title", where);
  panel.x_label = text_at(json, "x_label", where);
  panel.y_label = text_at(json, "y_label", where);
  const Json& curves = member_at(json, "curves", where);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string at = where + "." + place("curves", i);
    const Curve& curve = panel.curves.emplace_back(curve_at(curves.at(i), at, figure));
    const auto [least, most] =
        std::minmax_element(curve.points.begin(), curve.points.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; });
    table.rows.push_back({figure.title, panel.title, figure.series[curve.series], panel.y_label,
                          count_text(static_cast<double>(curve.points.size())), brief(least->second),
                          brief(most->second)});
  }
}

void read_curves(const Json& json, Results& results) {
  results.title = text_at(json, "title", "");
  results.command = text_at(json, "command", "");
  add_build(json, results);
  results.table.head = {"figure", "panel", "curve", "of", "points", "least", "most"};
  const Json& figures = array_at(json, "figures");
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::string where = place("figures", i);
    CurveFigure& figure = results.curves.emplace_back();
    figure.title = text_at(figures[i], "title", where);
    figure.note = text_at(figures[i], "note", where);
    const Json& panels = member_at(figures[i], "panels", where);
    for (std::size_t k = 0; k < panels.size(); ++k)
      add_panel(panels.at(k), where + "." + place("panels", k), results.table, figure);
  }
  if (results.table.rows.empty()) throw std::runtime_error("figures: has no curve");
}

// ---- stage_times ----

void read_stages(const Json& json, Results& results) {
  results.title = "Where a tick's time goes";
  add_origin(json, results);
  BarFigure& figure = results.bars.emplace_back();
  figure.title = "A tick, stage by stage";
  figure.note = text_at(json, "note", "");
  figure.unit = "us";
  for (const Json& stage : array_at(json, "stages")) {
    if (!stage.is_string()) throw std::runtime_error("stages: is not a list of names");
    figure.parts.push_back(stage.get<std::string>());
  }
  results.table.head = {"scene"};
  for (const std::string& stage : figure.parts) results.table.head.push_back(stage + " [us]");
  const Json& scenes = array_at(json, "scenes");
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const std::string where = place("scenes", i);
    Bar& bar = figure.bars.emplace_back();
    bar.name = bar.label = text_at(scenes[i], "scene", where);
    bar.parts = numbers_at(scenes[i], "stage_us", where);
    if (bar.parts.size() != figure.parts.size()) refuse(where, "stage_us", "is not as long as stages");
    std::vector<std::string>& row = results.table.rows.emplace_back(std::vector{bar.name});
    for (const double time : bar.parts) {
      if (time < 0) refuse(where, "stage_us", "has a negative time");
      row.push_back(brief(time));
    }
  }
  if (scenes.empty()) throw std::runtime_error("scenes: is empty");
}

// ---- Files ----

// Line and column of a byte, both from 1.
std::string line_and_column(const std::string& text, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte > 0 ? byte - 1 : 0, text.size()));
  const auto line = 1 + std::count(text.begin(), end, '\n');
  const std::size_t start =
      text.rfind('\n', static_cast<std::size_t>(end - text.begin()) - (end != text.begin()));
  const bool in_first = line == 1 || start == std::string::npos;
  const auto column = end - text.begin() - (in_first ? -1 : static_cast<std::ptrdiff_t>(start));
  return std::to_string(line) + ":" + std::to_string(column);
}

Status read_text(const std::string& path, std::string& text) {
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    return Status::error(path + ": is no file that can be read" + kRemedy);
  if (fs::file_size(path, error) > kLargestFile)
    return Status::error(path + ": is larger than 64 MB, and so no result of a benchmark" + kRemedy);
  std::ostringstream stream;
  std::ifstream file(path, std::ios::binary);
  if (file) stream << file.rdbuf();
  if (!file || stream.fail()) return Status::error(path + ": cannot be read, or is empty" + kRemedy);
  text = stream.str();
  return {};
}

// Of repetitions Google Benchmark writes their deviation over their mean, which for errors of 0 is NaN, and
// so no JSON. Nothing reads that number.
std::string without_nan(std::string text) {
  if (text.find("\"aggregate_name\": \"cv\"") == std::string::npos) return text;
  for (const std::string_view word : {"\": NaN", "\": -NaN", "\": Infinity", "\": -Infinity"}) {
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos;)
      text.replace(at, word.size(), "\": null");
  }
  return text;
}

void interpret(const Json& json, Results& results) {
  if (json.is_object() && json.contains("context") && json.contains("benchmarks")) {
    read_google(json, results);
  } else if (json.is_object() && json.contains("speeds") && json.contains("errors")) {
    read_accuracy(json, results);
  } else if (json.is_object() && json.contains("poses") && json.contains("rows")) {
    read_peers(json, results);
  } else if (json.is_object() && json.contains("meshes")) {
    read_meshes(json, results);
  } else if (json.is_object() && json.contains("figures")) {
    read_curves(json, results);
  } else if (json.is_object() && json.contains("stages") && json.contains("scenes")) {
    read_stages(json, results);
  } else {
    throw std::runtime_error(
        "is no result of accuracy, bench_peers, mesh_grasps, paper_experiments, stage_times or "
        "--benchmark_out_format=json");
  }
}

}  // namespace

std::string origin_value(const Results& results, std::string_view name) {
  for (const auto& [key, value] : results.origin)
    if (key == name) return value;
  return {};
}

Status read_results(const std::string& path, Results& results) {
  std::string text;
  if (Status status = read_text(path, text); !status.ok()) return status;
  text = without_nan(std::move(text));
  results = {};
  results.file = fs::path(path).filename().string();
  try {
    interpret(Json::parse(text), results);
  } catch (const Json::parse_error& error) {
    return Status::error(path + ":" + line_and_column(text, error.byte) + ": is not JSON" + kRemedy);
  } catch (const std::exception& error) {
    return Status::error(path + ": " + error.what() + kRemedy);
  }
  return {};
}

}  // namespace lumbrical::tool
