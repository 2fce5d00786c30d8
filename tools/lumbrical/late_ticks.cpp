// See late_ticks.h.
#include "late_ticks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "lumbrical/batch.h"
#include "stage_clock.h"

namespace lumbrical::tool {
namespace {

constexpr std::size_t kKept = 32;
constexpr int kTimesAgain = 2;        // that a tick is repeated, for its shortest time
constexpr double kWorthwhile = 0.95;  // of the time: less help is noise
constexpr double kTold = 0.8;         // a figure that is less than this share of another is told beside it
constexpr double kThin = 20;          // heights that a needle is long
constexpr std::uint32_t kMostThreads = 4;
constexpr double kMostEffort = 1e9;  // that settings may have

std::vector<Scratch> fresh_scratches(const std::vector<Model>& models) {
  std::vector<Scratch> scratches;
  for (const Model& model : models) {
    Scratch& scratch = scratches.emplace_back(make_scratch(model));
    scratch.hash_stages = false;
    scratch.keep_near = false;  // the same pose again must not be spared its search
  }
  return scratches;
}

// Evaluations by samples, of all hands.
double tick_all(const std::vector<Model>& models, std::vector<Scratch>& scratches, TickStart start) {
  double evaluations = 0;
  for (std::size_t hand = 0; hand < models.size(); ++hand) {
    const ActuatorFrame output = tick(models[hand], start.state[hand], scratches[hand], start.frame[hand],
                                      std::span(start.given[hand]).first(start.given_count[hand]));
    evaluations += static_cast<double>(output.evaluations);
  }
  return evaluations;
}

double time_of(const std::vector<Model>& models, std::vector<Scratch>& scratches, TickStart start,
               double& evaluations) {
  const clockid_t clock = work_clock(models[0].execution.threads);
  const std::int64_t begin = read_clock(clock);
  evaluations = tick_all(models, scratches, std::move(start));
  return 1e-3 * static_cast<double>(read_clock(clock) - begin);
}

/// Slow ticks in the order of their session: on one memory each meets for the first time about what it met
/// then, since most of what is cut or found near a hand is kept for the ticks that follow.
struct Replayed {
  std::vector<const TickStart*> start;
  std::vector<double> session;  // [us]
  std::vector<bool> first;      // does the first visit count? Empty: not known yet
};

Replayed in_order(const SlowTicks& slow) {
  std::vector<std::size_t> order(slow.kept);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto number = [&](std::size_t i) { return slow.start[i].state[0].tick; };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return number(a) != number(b) ? number(a) < number(b) : a < b;
  });
  Replayed ticks;
  for (const std::size_t i : order) {
    ticks.start.push_back(&slow.start[i]);
    ticks.session.push_back(1e-3 * slow.duration[i]);
  }
  return ticks;
}

std::vector<TimedTick> times_of(const std::vector<Model>& models, const Replayed& ticks) {
  std::vector<Scratch> scratches = fresh_scratches(models);
  std::vector<TimedTick> times;
  for (const TickStart* start : ticks.start) {
    TimedTick& timed = times.emplace_back();
    timed.first = timed.again = time_of(models, scratches, *start, timed.evaluations);
    for (int i = 0; i < kTimesAgain; ++i)
      timed.again = std::min(timed.again, time_of(models, scratches, *start, timed.evaluations));
  }
  return times;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// [us] As in the session, tick by tick.
std::vector<double> as_they_were(const Replayed& ticks, const std::vector<TimedTick>& times) {
  std::vector<double> result;
  for (std::size_t i = 0; i < times.size(); ++i)
    result.push_back(ticks.first[i] ? times[i].first : times[i].again);
  return result;
}

void choose_visits(const std::vector<TimedTick>& times, Replayed& ticks) {
  for (std::size_t i = 0; i < times.size(); ++i)
    ticks.first.push_back(was_first_visit(times[i], ticks.session[i]));
}

std::array<double, kStageCount> stage_shares(const std::vector<Model>& models, const Replayed& ticks) {
  std::vector<Scratch> scratches = fresh_scratches(models);
  StageClock times;
  times.clock = work_clock(models[0].execution.threads);
  for (std::size_t i = 0; i < ticks.start.size(); ++i) {
    for (Scratch& scratch : scratches) set_watch({}, scratch);
    if (!ticks.first[i]) tick_all(models, scratches, *ticks.start[i]);
    for (Scratch& scratch : scratches) set_watch({&StageClock::ended, &times}, scratch);
    TickStart again = *ticks.start[i];
    times.begin();
    tick_all(models, scratches, std::move(again));
  }
  const double all = std::accumulate(times.microseconds.begin(), times.microseconds.end(), 0.0);
  for (double& share : times.microseconds) share /= std::max(all, 1e-9);
  return times.microseconds;
}

bool is_thin(const Triangles& all, std::uint32_t triangle) {
  const Vec3 a = all.vertex(all.a[triangle]), b = all.vertex(all.b[triangle]),
             c = all.vertex(all.c[triangle]);
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  return longest * longest > kThin * norm(cross(b - a, c - a));
}

void add_touched(std::span<const Contact> contacts, const Triangles& all, TickLoad& load) {
  std::vector<std::uint32_t> touched;
  for (const Contact& contact : contacts) touched.push_back(contact.triangle);
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  load.triangles += touched.size();
  load.thin_triangles += static_cast<std::size_t>(
      std::count_if(touched.begin(), touched.end(), [&](std::uint32_t t) { return is_thin(all, t); }));
}

TickLoad load_of(const std::vector<Model>& models, const TickStart& start) {
  std::vector<Scratch> scratches = fresh_scratches(models);
  TickLoad load;
  load.evaluations = tick_all(models, scratches, start);
  for (std::size_t hand = 0; hand < models.size(); ++hand) {
    const Model& model = models[hand];
    add_touched(find_contacts(model, scratches[hand]), model.triangles, load);
    for (std::size_t object = 0; object < model.apart.size(); ++object)
      add_touched(find_contacts(model, scratches[hand], object), model.apart[object].shape->triangles, load);
  }
  return load;
}

struct Trial {
  std::string change;
  Scene scene;
  Execution execution;
};

// One decade coarser, or from exact to samples; nothing where that is as far as it goes.
std::optional<Trial> coarser(const Scene& scene, const Execution& execution) {
  Trial trial{"", scene, execution};
  const double finest = *std::min_element(scene.settings.precision.begin(), scene.settings.precision.end());
  const double next = finest == 0 ? 1e-4 : 10 * finest;
  if (next > 0.011 || scene.world) return std::nullopt;
  trial.scene.settings.precision.fill(next);
  trial.change = "--precision " + brief(next, 1);
  return trial;
}

std::optional<Trial> on_more_threads(const Scene& scene, const Execution& execution) {
  const std::uint32_t threads = std::min(core_count(), kMostThreads);
  if (execution.threads >= threads) return std::nullopt;
  Trial trial{"--threads " + std::to_string(threads), scene, execution};
  trial.execution.threads = threads;
  return trial;
}

// Every other triangle: a hand that meets a coarser mesh meets about as many.
std::optional<Trial> of_fewer_triangles(const Scene& scene, const Execution& execution) {
  Trial trial{"half as many triangles (about)", scene, execution};
  std::size_t left = 0;
  for (SceneObject& object : trial.scene.objects) {
    std::vector<Triangle>& triangles = object.mesh.triangles;
    for (std::size_t i = 0; 2 * i < triangles.size(); ++i) triangles[i] = triangles[2 * i];
    triangles.resize((triangles.size() + 1) / 2);
    left += triangles.size();
  }
  return left > 500 ? std::optional(trial) : std::nullopt;
}

// The hands of `models` in another world; nothing where that can't be built.
std::vector<Model> changed_models(const Trial& trial, const std::vector<Model>& models) {
  std::vector<Model> changed(models.size());
  if (!build_model(trial.scene, trial.execution, changed[0]).ok()) return {};
  for (std::size_t hand = 1; hand < models.size(); ++hand)
    if (!share_world(changed[0], models[hand].hand, changed[hand]).ok()) return {};
  return changed;
}

// The same hands in the same world with another bound; nothing where that can't be.
std::vector<Model> models_with_effort(std::uint32_t effort, const std::vector<Model>& models) {
  std::vector<Model> changed(models.size());
  for (std::size_t hand = 0; hand < models.size(); ++hand) {
    Settings settings = models[hand].settings;
    settings.effort = effort;
    if (!change_settings(models[hand], settings, models[hand].execution.threads, changed[hand]).ok())
      return {};
  }
  return changed;
}

}  // namespace

void SlowTicks::reserve(const TickStart& any) {
  start.assign(kKept, any);
  duration.assign(kKept, 0);
}

void SlowTicks::add(std::int64_t nanoseconds, const TickStart& tick) {
  const auto lasted = static_cast<std::uint32_t>(std::min<std::int64_t>(nanoseconds, UINT32_MAX));
  const auto least = std::min_element(duration.begin(), duration.end());
  if (lasted <= *least) return;
  kept = std::min(kept + 1, start.size());
  *least = lasted;
  start[static_cast<std::size_t>(least - duration.begin())] = tick;
}

void LateTicks::add(const LateTime& time, const TickStart& start) {
  // What ticks before it owe, it owes for the same reasons.
  const double before = owed_[0] + owed_[1] + owed_[2];
  const double share = before > 0 ? static_cast<double>(time.behind) / before : 0;
  const std::array<std::int64_t, 3> own = {time.wake_up, time.tick, time.beside};
  for (std::size_t cause = 0; cause < own.size(); ++cause)
    owed_[cause] = share * owed_[cause] + static_cast<double>(own[cause]);
  const auto most = std::max_element(owed_.begin(), owed_.end());
  ++*std::array{&woken_late, &slow, &beside}[static_cast<std::size_t>(most - owed_.begin())];
  if (most == owed_.begin() + 1) slowest.add(time.tick, start);
}

bool was_first_visit(const TimedTick& tick, double session) {
  return std::abs(tick.first - session) < std::abs(tick.again - session);
}

LateReport study(const LateTicks& late, const Scene& scene, const std::vector<Model>& models,
                 bool with_device) {
  LateReport report;
  Replayed ticks = in_order(late.slowest);
  const std::vector<TimedTick> times = times_of(models, ticks);
  choose_visits(times, ticks);
  std::vector<double> again;
  for (const TimedTick& timed : times) again.push_back(timed.again);
  const std::vector<double> taken = as_they_were(ticks, times);
  report.microseconds = median(taken);
  report.again_microseconds = median(again);
  report.session_microseconds = median(ticks.session);
  const auto typical = std::find(taken.begin(), taken.end(), report.microseconds);
  report.load = load_of(models, *ticks.start[static_cast<std::size_t>(typical - taken.begin())]);
  report.stage_share = stage_shares(models, ticks);
  const Execution& execution = models[0].execution;
  for (const auto& trial :
       {coarser(scene, execution), with_device ? std::nullopt : on_more_threads(scene, execution),
        of_fewer_triangles(scene, execution)}) {
    if (!trial) continue;
    const std::vector<Model> changed = changed_models(*trial, models);
    if (changed.empty()) continue;
    const double microseconds = median(as_they_were(ticks, times_of(changed, ticks)));
    if (microseconds < kWorthwhile * report.microseconds)
      report.remedies.push_back({trial->change, microseconds});
  }
  std::sort(report.remedies.begin(), report.remedies.end(), [](const Remedy& a, const Remedy& b) {
    return a.microseconds != b.microseconds ? a.microseconds < b.microseconds : a.change < b.change;
  });
  return report;
}

std::optional<double> effort_within(double microseconds, std::span<const EffortTimes> ticks) {
  double slowest = 0, busiest = 0;
  std::optional<double> within;
  for (const EffortTimes& tick : ticks) {
    slowest = std::max(slowest, tick.microseconds);
    busiest = std::max(busiest, tick.evaluations);
    if (tick.microseconds <= microseconds) continue;
    if (tick.least_microseconds >= microseconds) return std::nullopt;
    const double share =
        (microseconds - tick.least_microseconds) / (tick.microseconds - tick.least_microseconds);
    const double of_tick = tick.least_evaluations + share * (tick.evaluations - tick.least_evaluations);
    within = std::min(within.value_or(of_tick), of_tick);
  }
  if (within || !(slowest > 0)) return within;
  return busiest * microseconds / slowest;
}

EffortReport study_effort(const SlowTicks& slowest, double rate, const std::vector<Model>& models) {
  EffortReport report;
  if (slowest.kept == 0) return report;
  const std::vector<Model> free = models_with_effort(0, models), least = models_with_effort(1, models);
  if (free.empty() || least.empty()) return report;
  Replayed replayed = in_order(slowest);
  choose_visits(times_of(models, replayed), replayed);
  const std::vector<TimedTick> as_it_is = times_of(free, replayed), bounded = times_of(least, replayed);
  const std::vector<double> taken = as_they_were(replayed, as_it_is),
                            least_taken = as_they_were(replayed, bounded);
  std::vector<EffortTimes> ticks;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    report.least_microseconds = std::max(report.least_microseconds, least_taken[i]);
    ticks.push_back({taken[i], least_taken[i], as_it_is[i].evaluations, bounded[i].evaluations});
  }
  const std::optional<double> fits = effort_within(0.5e6 / rate, ticks);
  if (fits) report.fits = std::min(std::floor(*fits / static_cast<double>(models.size())), kMostEffort);
  return report;
}

Json late_json(const LateTicks& late, const LateReport& report) {
  Json json = {{"woken_late", late.woken_late}, {"slow", late.slow}, {"beside", late.beside}};
  json["tick_us"] = report.microseconds;
  json["again_us"] = report.again_microseconds;
  json["session_us"] = report.session_microseconds;
  json["touched"] = {{"triangles", report.load.triangles}, {"thin", report.load.thin_triangles}};
  json["evaluations"] = report.load.evaluations;
  for (std::size_t i = 0; i < kStageCount; ++i) json["stage_share"][kStageWords[i]] = report.stage_share[i];
  json["remedies"] = Json::array();
  for (const Remedy& remedy : report.remedies)
    json["remedies"].push_back({{"change", remedy.change}, {"tick_us", remedy.microseconds}});
  return json;
}

namespace {

std::string stages_text(const LateReport& report) {
  std::string stages;
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const double percent = 100 * report.stage_share[i];
    if (percent >= 5)
      stages += (stages.empty() ? "" : ", ") + std::string(kStageWords[i]) + " " + brief(percent, 2) + " %";
  }
  return stages;
}

std::string load_text(const TickLoad& load) {
  std::string text = "it touches " + grouped(load.triangles) + " triangles";
  if (load.thin_triangles > 0)
    text += ", of which " + grouped(load.thin_triangles) + " are needles, " + brief(kThin, 2) +
            " times as long as high: rounder ones cost less";
  if (load.evaluations > 0)
    text += "; " + grouped(static_cast<std::uint64_t>(load.evaluations)) + " evaluations by samples";
  return text;
}

}  // namespace

void add_late(const LateTicks& late, const LateReport& report, double period_us, Table& table) {
  if (late.slow + late.woken_late + late.beside == 0) return;
  std::string causes;
  const auto add = [&causes](std::uint64_t count, const char* cause) {
    if (count > 0) causes += (causes.empty() ? "" : ", ") + grouped(count) + " since " + cause;
  };
  add(late.slow, "the tick took long");
  add(late.woken_late, "other work had the processor");
  add(late.beside, "what is beside the tick took long (device, motion, recording)");
  table.add("late", causes);
  if (late.slowest.kept == 0) return;
  table.add("", "a late tick's work takes " + brief(report.microseconds) + " us: " + stages_text(report));
  if (report.again_microseconds < kTold * report.microseconds)
    table.add("", "with what it meets for the first time: where the hand has just been it takes " +
                      brief(report.again_microseconds) + " us");
  if (report.microseconds < kTold * report.session_microseconds)
    table.add("", "in the session it took " + brief(report.session_microseconds) +
                      " us, on caches that it shared with other work");
  table.add("", load_text(report.load));
  for (const Remedy& remedy : report.remedies)
    table.add("", remedy.change + ": " + brief(remedy.microseconds) + " us" +
                      (remedy.microseconds < period_us ? ", within the period" : ""));
  if (std::max(report.microseconds, report.session_microseconds) < period_us)
    table.add("", "alone it is within the period: what delays it is other work on this machine");
}

}  // namespace lumbrical::tool
