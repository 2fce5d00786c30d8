// See report_google.h.
#include "report_google.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "report_json.h"
#include "report_origin.h"

namespace lumbrical::tool {
namespace {

/// One benchmark, its name taken apart at the slashes.
struct Measured {
  std::string name;
  std::vector<std::string> parts;
  const Json* row = nullptr;
  std::string where;
  double microseconds = 0;  // per iteration
  std::size_t repetitions = 1;
  double spread = 0;  // of repetitions: standard deviation over median
};

double microseconds_per(const std::string& unit, const std::string& where) {
  if (unit == "ns") return 1e-3;
  if (unit == "us") return 1;
  if (unit == "ms") return 1e3;
  if (unit == "s") return 1e6;
  refuse(where, "time_unit", "is not ns, us, ms or s");
}

bool is_true(const Json& row, const char* key) { return row.contains(key) && row[key] == true; }

bool has_number(const Measured& measured, const char* key) {
  return measured.row->contains(key) && (*measured.row)[key].is_number();
}

std::string words(const std::vector<std::string>& parts, std::size_t first, std::size_t last) {
  std::string text;
  for (std::size_t i = first; i < std::min(last, parts.size()); ++i)
    text += (text.empty() ? "" : ", ") + parts[i];
  return text;
}

// The time that a benchmark is judged by: a tick's own, or one iteration's.
double judged_time(const Json& row) {
  const char* const key = row.contains("p50_us") ? "p50_us" : "real_time";
  return row.contains(key) && row[key].is_number() ? row[key].get<double>() : 0;
}

// How far repetitions went apart, of the two aggregates that stand beside each other in a file.
void add_spread(const Json& rows, std::vector<Measured>& all) {
  std::map<std::string, double> deviation;
  for (const Json& row : rows) {
    if (row.value("aggregate_name", Json()) == "stddev" && row.contains("run_name"))
      deviation[text_at(row, "run_name", "benchmarks")] = judged_time(row);
  }
  for (Measured& measured : all) {
    const Json& row = *measured.row;
    if (row.contains("repetitions"))
      measured.repetitions = static_cast<std::size_t>(amount_at(row, "repetitions", measured.where));
    const auto found = deviation.find(row.value("run_name", std::string()));
    if (found != deviation.end() && judged_time(row) > 0) measured.spread = found->second / judged_time(row);
  }
}

// Of repetitions only the median counts, where it was asked for; a benchmark that gave up has no time.
std::vector<Measured> measured_in(const Json& rows) {
  std::set<std::string> repeated;
  for (const Json& row : rows) {
    if (row.is_object() && row.value("aggregate_name", Json()) == "median" && row.contains("run_name"))
      repeated.insert(text_at(row, "run_name", "benchmarks"));
  }
  std::vector<Measured> all;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Measured measured;
    measured.row = &rows[i];
    measured.where = place("benchmarks", i);
    const Json& row = rows[i];
    const char* const key = row.is_object() && row.contains("run_name") ? "run_name" : "name";
    measured.name = text_at(row, key, measured.where);
    const bool is_median = row.value("aggregate_name", Json()) == "median";
    const bool is_aggregate = row.value("run_type", Json()) == "aggregate";
    if (is_true(row, "error_occurred") || is_true(row, "skipped")) continue;
    if (repeated.contains(measured.name) ? !is_median : is_aggregate) continue;
    measured.microseconds = positive_at(row, "real_time", measured.where) *
                            microseconds_per(text_at(row, "time_unit", measured.where), measured.where);
    std::istringstream name(measured.name);
    for (std::string part; std::getline(name, part, '/');) {
      if (part != "real_time") measured.parts.push_back(part);
    }
    measured.name = measured.name.substr(0, measured.name.find("/real_time"));
    all.push_back(std::move(measured));
  }
  add_spread(rows, all);
  return all;
}

// ---- Figures ----

constexpr std::string_view kErrorPrefix = "error_";

Figure pair_figure() {
  Figure figure;
  figure.title = "Time against error, field law, pairs in batches";
  figure.note =
      "Error: the largest difference of a volume from the exact rung, which is therefore at 0. R is the "
      "larger "
      "radius of the hand part; a triangle's size is in its name. Ringed: no other precision and instruction "
      "set is both faster and more accurate.";
  figure.x_label = "error of the volume [R^3]";
  figure.y_label = "time [ns per pair]";
  figure.front = true;
  return figure;
}

Figure size_figure(const char* title, const char* note, const char* y_label) {
  Figure figure;
  figure.title = title;
  figure.note = note;
  figure.x_label = "triangles in the scene";
  figure.y_label = y_label;
  figure.joined = true;
  return figure;
}

// pair/SHAPE/SIZE/PRECISION/ISA
void add_pair(const Measured& measured, Figure& figure) {
  const double time = positive_at(*measured.row, "ns_per_pair", measured.where);
  const double error = amount_at(*measured.row, "error_R3", measured.where);
  const std::size_t series = index_of(figure.series, words(measured.parts, 4, measured.parts.size()));
  const std::size_t marker = index_of(figure.markers, measured.parts[3]);
  plot_of(figure, words(measured.parts, 1, 3))
      .points.push_back({error, time, series, marker,
                         measured.name + ": " + brief(time) + " ns, " + scientific(error) + " R^3"});
}

// WHAT/HOW/SIZE, and perhaps more of how
void add_size(const Measured& measured, double value, const char* unit, Figure& figure) {
  const double triangles = positive_at(*measured.row, "triangles", measured.where);
  const std::string rest = words(measured.parts, 3, measured.parts.size());
  const std::string how = measured.parts[1] + (rest.empty() ? "" : ", " + rest);
  plot_of(figure, measured.parts[0])
      .points.push_back(
          {triangles, value, index_of(figure.series, how), 0,
           measured.name + ", " + brief(triangles) + " triangles: " + brief(value) + " " + unit});
}

// error_SCENE/LAW/PRECISION/WAY
void add_error(const Measured& measured, Figure& figure) {
  const double time = positive_at(*measured.row, "p50_us", measured.where);
  const double error = amount_at(*measured.row, "force_error", measured.where);
  const std::size_t series = index_of(figure.series, words(measured.parts, 1, 3));
  const std::size_t marker = index_of(figure.markers, words(measured.parts, 3, measured.parts.size()));
  plot_of(figure, measured.parts[0].substr(kErrorPrefix.size()))
      .points.push_back({error, time, series, marker,
                         measured.name + ": " + brief(time) + " us, force error " + scientific(error)});
}

Figure error_figure() {
  Figure figure;
  figure.title = "Tick time against force error, every law, precision, search and instruction set";
  figure.note =
      "Median of the whole tick. The error is that of the hand's force in the worst pose, relative to the "
      "exact pressure field's, which is therefore at 0; law point's force is first scaled by the constant "
      "that fits best. Ringed: nothing else is both faster and more accurate.";
  figure.x_label = "relative force error [1]";
  figure.y_label = "tick, median [us]";
  figure.front = true;
  return figure;
}

Figure named_figure(const char* title, const char* note, const char* x_label, const char* y_label) {
  Figure figure = size_figure(title, note, y_label);
  figure.x_label = x_label;
  return figure;
}

// WHAT/HOW/SIZE, over whatever counter the size is.
void add_over(const Measured& measured, const char* counter, double time, Figure& figure) {
  const double size = positive_at(*measured.row, counter, measured.where);
  plot_of(figure, measured.parts[0])
      .points.push_back({size, time, index_of(figure.series, measured.parts[1]), 0,
                         measured.name + ", " + brief(size) + " " + counter + ": " + brief(time) + " us"});
}

// Of everything that Google Benchmark measures, in the order of the page.
struct GoogleFigures {
  Figure errors = error_figure();
  Figure ticks = size_figure("Tick time against triangle count",
                             "Median of the whole tick. Scene A is 300 mm wide, ever finer; in scene B "
                             "triangles measure 5 mm and it grows.",
                             "tick, median [us]");
  Figure contacts = named_figure("Tick time against contacts", "Median of the whole tick.",
                                 "contacts of a tick", "tick, median [us]");
  Figure pairs = pair_figure();
  Figure searches = size_figure(
      "Search time against triangle count",
      "The search alone, for the whole pressed hand. Scene A is 300 mm wide, ever finer; in scene B "
      "triangles measure 5 mm and it grows.",
      "search [us]");
  Figure apart = named_figure("Search time against the extent of the world",
                              "Two objects of scene A, one under the hand, the other ever farther away.",
                              "metres", "search [us]");
  Figure builds = size_figure("Build time against triangle count",
                              "From a scene in memory to a model that ticks can run on.", "build [us]");
  Figure bytes =
      size_figure("Memory of a model against triangle count", "All included.", "bytes per triangle");
  Figure threads = size_figure("What threads bring",
                               "The exact rung's search, afresh and with lists that outlive a tick, its "
                               "contacts, and its whole tick, for a hand pressed into scene A. Wall time.",
                               "time [us]");
  Figure hands =
      named_figure("Time of a hand against hands in one call",
                   "Independent hands that grasp a mug, ticked by one call of tick_each. Wall time "
                   "of the call, by the number of hands.",
                   "hands", "tick of a hand [us]");
};

void add_to_figure(const Measured& measured, GoogleFigures& figures) {
  const std::size_t parts = measured.parts.size();
  const bool has_triangles = has_number(measured, "triangles");
  const bool has_tick = has_number(measured, "p50_us") && has_triangles;
  const bool has_search = has_number(measured, "candidates") && has_triangles;
  const auto median = [&] { return positive_at(*measured.row, "p50_us", measured.where); };
  const bool by_threads = parts >= 3 && measured.parts[1].starts_with("threads:");
  if (by_threads && has_number(measured, "hands")) {
    add_over(measured, "hands", measured.microseconds / positive_at(*measured.row, "hands", measured.where),
             figures.hands);
  } else if (by_threads && has_triangles) {
    add_over(measured, "triangles", measured.microseconds, figures.threads);
  } else if (parts >= 5 && has_number(measured, "ns_per_pair") && has_number(measured, "error_R3")) {
    add_pair(measured, figures.pairs);
  } else if (parts >= 4 && has_tick && measured.name.starts_with(kErrorPrefix)) {
    add_error(measured, figures.errors);
  } else if (parts >= 3 && has_tick && measured.parts[0] == "contacts") {
    add_over(measured, "contacts", median(), figures.contacts);
  } else if (parts >= 3 && has_tick && !has_number(measured, "paper_hz")) {
    add_size(measured, median(), "us", figures.ticks);
  } else if (parts >= 3 && has_search && has_number(measured, "metres")) {
    add_over(measured, "metres", measured.microseconds, figures.apart);
  } else if (parts >= 3 && has_search) {
    add_size(measured, measured.microseconds, "us", figures.searches);
  } else if (parts >= 3 && has_triangles && measured.name.starts_with("build_")) {
    add_size(measured, measured.microseconds, "us", figures.builds);
    if (has_number(measured, "bytes_per_triangle"))
      add_size(measured, positive_at(*measured.row, "bytes_per_triangle", measured.where), "bytes",
               figures.bytes);
  }
}

void add_figures(const std::vector<Measured>& all, Results& results) {
  GoogleFigures figures;
  for (const Measured& measured : all) add_to_figure(measured, figures);
  for (Figure* const figure :
       {&figures.errors, &figures.ticks, &figures.contacts, &figures.pairs, &figures.searches, &figures.apart,
        &figures.builds, &figures.bytes, &figures.threads, &figures.hands}) {
    if (!figure->plots.empty()) results.figures.push_back(std::move(*figure));
  }
}

// ---- Tables ----

// What Google Benchmark itself says of every benchmark; the rest are counters.
bool is_counter(const std::string& key, const Json& value) {
  static const std::set<std::string> kOwn = {"family_index", "per_family_instance_index",
                                             "repetitions",  "repetition_index",
                                             "threads",      "iterations",
                                             "real_time",    "cpu_time"};
  return value.is_number() && !kOwn.contains(key);
}

void add_table(const std::vector<Measured>& all, Results& results) {
  std::vector<std::string> counters;
  for (const Measured& measured : all) {
    for (const auto& [key, value] : measured.row->items()) {
      if (is_counter(key, value)) index_of(counters, key);
    }
  }
  const bool repeated =
      std::any_of(all.begin(), all.end(), [](const Measured& measured) { return measured.repetitions > 1; });
  results.table.head = {"benchmark", "us per iteration"};
  if (repeated) {
    results.table.head.insert(results.table.head.end(), {"repetitions", "spread"});
    results.notes.push_back(
        "Figures are medians of the repetitions; spread is the standard deviation over the median, of p50_us "
        "where there is one, else of the time per iteration.");
  }
  results.table.head.insert(results.table.head.end(), counters.begin(), counters.end());
  for (const Measured& measured : all) {
    auto& kept = results.counters[measured.name];
    kept["microseconds"] = measured.microseconds;
    std::vector<std::string>& row = results.table.rows.emplace_back();
    row = {measured.name, brief(measured.microseconds)};
    if (repeated) {
      row.push_back(std::to_string(measured.repetitions));
      row.push_back(measured.repetitions > 1 ? brief(100 * measured.spread, 2) + " %" : "");
    }
    for (const std::string& counter : counters) {
      const bool has = has_number(measured, counter.c_str());
      if (has) kept[counter] = (*measured.row)[counter].get<double>();
      row.push_back(has ? brief((*measured.row)[counter].get<double>()) : "");
    }
  }
}

// tools/bench adds processor, compiler and command to the context; without it there are cores and the
// program.
void add_context(const Json& context, Results& results) {
  for (const char* const key : {"cpu", "isa", "compiler", "date", "library_version"}) {
    if (context.contains(key)) results.origin.emplace_back(key, text_at(context, key, "context"));
  }
  add_build(context, results);
  if (!context.contains("cpu"))
    results.origin.emplace_back("cpu", brief(positive_at(context, "num_cpus", "context")) + " cores of " +
                                           brief(positive_at(context, "mhz_per_cpu", "context")) + " MHz");
  const std::string program = text_at(context, "executable", "context");
  results.title = program.substr(program.rfind('/') + 1);
  const bool knows_command = context.contains("command");
  results.command = knows_command ? text_at(context, "command", "context") : program;
  if ((results.command + " ").find(" --quick ") != std::string::npos) results.is_quick = true;
}

}  // namespace

void read_google(const Json& json, Results& results) {
  add_context(object_at(json, "context", ""), results);
  const std::vector<Measured> all = measured_in(array_at(json, "benchmarks"));
  if (all.empty()) throw std::runtime_error("benchmarks: has none that was measured");
  add_figures(all, results);
  add_table(all, results);
}

}  // namespace lumbrical::tool
