// See late_ticks.h.
#include "late_ticks.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "lumbrical/batch.h"
#include "stage_clock.h"

namespace lumbrical::tool {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kKept = 32;
constexpr int kTimes = 3;             // that a tick is computed again, for its shortest time
constexpr double kWorthwhile = 0.95;  // of the time: less help is noise
constexpr std::uint32_t kMostThreads = 4;
constexpr double kMostEffort = 1e9;  // that settings may have

double microseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

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
double tick_all(const std::vector<Model>& models, std::vector<Scratch>& scratches, TickStart& start) {
  double evaluations = 0;
  for (std::size_t hand = 0; hand < models.size(); ++hand) {
    const ActuatorFrame output = tick(models[hand], start.state[hand], scratches[hand], start.frame[hand],
                                      std::span(start.given[hand]).first(start.given_count[hand]));
    evaluations += static_cast<double>(output.evaluations);
  }
  return evaluations;
}

struct TimedTick {
  double microseconds = 1e300;  // the shortest time
  double evaluations = 0;
};

TimedTick time_of(const std::vector<Model>& models, std::vector<Scratch>& scratches, const TickStart& tick) {
  TimedTick timed;
  for (int i = 0; i < kTimes; ++i) {
    TickStart again = tick;
    const Clock::time_point start = Clock::now();
    timed.evaluations = tick_all(models, scratches, again);
    timed.microseconds = std::min(timed.microseconds, microseconds_since(start));
  }
  return timed;
}

// [us] The median over the ticks.
double time_of(const std::vector<Model>& models, std::span<const TickStart> ticks) {
  std::vector<Scratch> scratches = fresh_scratches(models);
  std::vector<double> times;
  for (const TickStart& late : ticks) times.push_back(time_of(models, scratches, late).microseconds);
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

std::array<double, kStageCount> stage_shares(const std::vector<Model>& models,
                                             std::span<const TickStart> ticks) {
  std::vector<Scratch> scratches = fresh_scratches(models);
  StageClock times;
  for (Scratch& scratch : scratches) {
    scratch.watch = {&StageClock::ended, &times};
    if (scratch.apart) scratch.apart->watch = scratch.watch;  // objects go through the same stages
  }
  for (TickStart again : ticks) {
    times.last = Clock::now();
    tick_all(models, scratches, again);
  }
  const double all = std::accumulate(times.microseconds.begin(), times.microseconds.end(), 0.0);
  for (double& share : times.microseconds) share /= std::max(all, 1e-9);
  return times.microseconds;
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

LateReport study(const LateTicks& late, const Scene& scene, const std::vector<Model>& models,
                 bool with_device) {
  LateReport report;
  const std::span ticks = std::span(late.slowest.start).first(late.slowest.kept);
  report.microseconds = time_of(models, ticks);
  report.stage_share = stage_shares(models, ticks);
  const Execution& execution = models[0].execution;
  for (const auto& trial :
       {coarser(scene, execution), with_device ? std::nullopt : on_more_threads(scene, execution),
        of_fewer_triangles(scene, execution)}) {
    if (!trial) continue;
    const std::vector<Model> changed = changed_models(*trial, models);
    if (changed.empty()) continue;
    const double microseconds = time_of(changed, ticks);
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
  std::vector<Scratch> scratches = fresh_scratches(free), least_scratches = fresh_scratches(least);
  std::vector<EffortTimes> ticks;
  for (const TickStart& tick : std::span(slowest.start).first(slowest.kept)) {
    const TimedTick as_it_is = time_of(free, scratches, tick),
                    bounded = time_of(least, least_scratches, tick);
    report.least_microseconds = std::max(report.least_microseconds, bounded.microseconds);
    ticks.push_back({as_it_is.microseconds, bounded.microseconds, as_it_is.evaluations, bounded.evaluations});
  }
  const std::optional<double> fits = effort_within(0.5e6 / rate, ticks);
  if (fits) report.fits = std::min(std::floor(*fits / static_cast<double>(models.size())), kMostEffort);
  return report;
}

Json late_json(const LateTicks& late, const LateReport& report) {
  Json json = {{"woken_late", late.woken_late}, {"slow", late.slow}, {"beside", late.beside}};
  json["tick_us"] = report.microseconds;
  for (std::size_t i = 0; i < kStageCount; ++i) json["stage_share"][kStageWords[i]] = report.stage_share[i];
  json["remedies"] = Json::array();
  for (const Remedy& remedy : report.remedies)
    json["remedies"].push_back({{"change", remedy.change}, {"tick_us", remedy.microseconds}});
  return json;
}

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
  std::string stages;
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const double percent = 100 * report.stage_share[i];
    if (percent >= 5)
      stages += (stages.empty() ? "" : ", ") + std::string(kStageWords[i]) + " " + brief(percent, 2) + " %";
  }
  table.add("", "a late tick's work takes " + brief(report.microseconds) + " us: " + stages);
  for (const Remedy& remedy : report.remedies)
    table.add("", remedy.change + ": " + brief(remedy.microseconds) + " us" +
                      (remedy.microseconds < period_us ? ", within the period" : ""));
  if (report.microseconds < period_us)
    table.add("", "alone it is within the period: what delays it is other work on this machine");
}

}  // namespace lumbrical::tool
