// See compare_precision.h.
#include "compare_precision.h"

#include <algorithm>
#include <array>

#include "hand_force.h"
#include "stage_clock.h"

namespace lumbrical::tool {
namespace {

constexpr std::array<double, 4> kRungs = {0, 1e-5, 1e-4, 1e-3};
constexpr std::uint64_t kMostMoments = 2000;

/// One rung's session.
struct Rung {
  Model model;
  State state;
  Scratch scratch;
  ActuatorFrame output;
  std::vector<double> microseconds, wall_microseconds, hand_error, segment_error;
  std::uint64_t coarsened = 0, max_evaluations = 0;
};

/// Of a tick [us].
struct TickTime {
  double work = 0, wall = 0;
};

double share_of(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

TickTime time_tick(const DeviceFrame& frame, std::span<const ObjectFrame> given, Rung& rung) {
  const clockid_t clock = work_clock(rung.model.execution.threads);
  const std::int64_t wall = read_clock(CLOCK_MONOTONIC), work = read_clock(clock);
  rung.output = tick(rung.model, rung.state, rung.scratch, frame, given);
  const std::int64_t work_end = read_clock(clock), wall_end = read_clock(CLOCK_MONOTONIC);
  return {1e-3 * static_cast<double>(work_end - work), 1e-3 * static_cast<double>(wall_end - wall)};
}

// Of a grasp the forces nearly cancel: what they come to together is no measure.
double force_size(const ActuatorFrame& output) {
  double sum = 0;
  for (const Wrench& wrench : output.segment) sum += norm(wrench.force);
  return sum;
}

void add_errors(const ActuatorFrame& exact, Rung& rung) {
  const double force = force_size(exact);
  double worst = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    worst = std::max(worst, norm(rung.output.segment[i].force - exact.segment[i].force));
  rung.hand_error.push_back(norm(hand_force(rung.output) - hand_force(exact)) / force);
  rung.segment_error.push_back(worst / force);
}

PrecisionFigures figures_of(double precision, Rung& rung) {
  PrecisionFigures figures;
  figures.precision = precision;
  figures.median_us = share_of(rung.microseconds, 0.5);
  figures.p99_us = share_of(rung.microseconds, 0.99);
  figures.wall_median_us = share_of(rung.wall_microseconds, 0.5);
  figures.wall_p99_us = share_of(rung.wall_microseconds, 0.99);
  figures.coarsened = rung.coarsened;
  figures.max_evaluations = rung.max_evaluations;
  figures.hand_error = share_of(rung.hand_error, 0.98);
  figures.worst_hand_error = share_of(rung.hand_error, 1);
  figures.segment_error = share_of(rung.segment_error, 0.98);
  return figures;
}

std::size_t advised_rung(const std::vector<PrecisionFigures>& rungs, double wanted) {
  std::size_t advised = 0;
  for (std::size_t i = 1; i < rungs.size(); ++i) {
    const bool is_exact = rungs[i].worst_hand_error == 0;  // by law: no precision would change anything
    const bool keeps = rungs[i].hand_error <= wanted && !is_exact;
    if (keeps && rungs[i].median_us < rungs[advised].median_us) advised = i;
  }
  return advised;
}

// The best of those that keep within the effort, or the least of those that can't.
std::size_t best_within_effort(const std::vector<PrecisionFigures>& rungs, std::uint32_t effort) {
  const auto excess = [&](std::size_t i) {
    return std::max<std::uint64_t>(rungs[i].max_evaluations, effort);
  };
  std::size_t best = 1;
  for (std::size_t i = 2; i < rungs.size(); ++i) {
    const bool is_as_busy = excess(i) == excess(best);
    if (is_as_busy ? rungs[i].hand_error < rungs[best].hand_error : excess(i) < excess(best)) best = i;
  }
  return best;
}

// Exact is no answer where an effort is to be kept: it knows no bound.
void advise(double wanted, PrecisionComparison& comparison) {
  const std::vector<PrecisionFigures>& rungs = comparison.rungs;
  comparison.advised = advised_rung(rungs, wanted);
  const auto is_cut = [](const PrecisionFigures& rung) { return rung.coarsened > 0; };
  comparison.cut_by_effort =
      comparison.advised == 0 && wanted > 0 && std::any_of(rungs.begin(), rungs.end(), is_cut);
  if (comparison.cut_by_effort) comparison.advised = best_within_effort(rungs, comparison.settings.effort);
}

// The finest of the segments that may be felt by samples at all. Exact ones among them say nothing of how
// well the others are to be felt; where all are exact, so is what is wanted.
double precision_wanted(const Settings& settings) {
  double finest = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const double precision = settings.precision[i];
    if (settings.law[i] != Law::field || precision == 0) continue;
    finest = finest == 0 ? precision : std::min(finest, precision);
  }
  return finest;
}

Settings without_limits(Settings settings) {
  settings.max_force = 1e6;
  settings.fade_time = 0;
  return settings;
}

Settings at_precision(const Settings& given, double precision) {
  Settings settings = without_limits(given);
  settings.precision.fill(precision);
  return settings;
}

// Where laws are mixed nothing can be felt once, and by no rung is.
bool feels_once_by_samples(const Settings& settings) {
  return settings.felt_once == FeltOnce::by_samples &&
         std::all_of(settings.law.begin(), settings.law.end(), [](Law law) { return law == Law::field; });
}

// Of the exact rung too what the others feel once is felt once, or it would not be what they are held
// against.
Settings settings_of(const Settings& given, double precision) {
  Settings settings = at_precision(given, precision);
  if (given.felt_once != FeltOnce::by_samples) return settings;
  if (!feels_once_by_samples(given))
    settings.felt_once = FeltOnce::never;
  else if (precision == 0)
    settings.felt_once = FeltOnce::always;
  return settings;
}

Status make_rung(Scene scene, const Settings& settings, const Execution& execution, Rung& rung) {
  scene.settings = settings;
  if (Status status = build_model(scene, execution, rung.model); !status.ok()) return status;
  rung.scratch = make_scratch(rung.model);
  rung.state = make_state(rung.model);
  rung.scratch.hash_stages = false;
  return {};
}

// Does a tick feel something else after others?
bool remembers(const Model& model) {
  return !model.apart.empty() || model.settings.proxy_stiffness > 0 || model.settings.pad.damping > 0;
}

using Rungs = std::vector<Rung>;

void compare_at(const DeviceFrame& frame, std::span<const ObjectFrame> given, Rungs& rungs,
                PrecisionComparison& comparison) {
  std::vector<TickTime> times(rungs.size());
  for (std::size_t i = 0; i < rungs.size(); ++i) times[i] = time_tick(frame, given, rungs[i]);
  if (!(force_size(rungs[0].output) > kLeastForce)) return;
  ++comparison.ticks;
  comparison.contacts += rungs[0].output.contact_count;
  for (std::size_t i = 0; i < rungs.size(); ++i) {
    Rung& rung = rungs[i];
    rung.microseconds.push_back(times[i].work);
    rung.wall_microseconds.push_back(times[i].wall);
    rung.coarsened += (rung.output.flags & kCoarsened) != 0 ? 1 : 0;
    rung.max_evaluations = std::max(rung.max_evaluations, rung.output.evaluations);
    add_errors(rungs[0].output, rung);
  }
}

// Moments of a motion that touches what stands still.
void compare_moments(const Motion& motion, double rate, std::uint64_t ticks, Rungs& rungs,
                     PrecisionComparison& comparison) {
  const std::uint64_t moments = std::min(ticks, kMostMoments);
  for (std::uint64_t moment = 0; moment < moments; ++moment) {
    const double time = static_cast<double>(moment * ticks / moments) / rate;
    compare_at(resample(motion, time), {}, rungs, comparison);
  }
}

// Moments of a session, each from its state.
void compare_session(const Motion& motion, double rate, std::uint64_t ticks, const GivenAt& given_at,
                     Rung& session, Rungs& rungs, PrecisionComparison& comparison) {
  const std::uint64_t moments = std::min(ticks, kMostMoments);
  std::uint64_t moment = 0;
  for (std::uint64_t i = 0; i < ticks; ++i) {
    const double time = static_cast<double>(i) / rate;
    const DeviceFrame frame = resample(motion, time);
    const std::span<const ObjectFrame> given =
        given_at ? given_at(time, session.model, i > 0 ? &session.scratch : nullptr)
                 : std::span<const ObjectFrame>();
    if (moment < moments && i == moment * ticks / moments) {
      for (Rung& rung : rungs) rung.state = session.state;
      compare_at(frame, given, rungs, comparison);
      ++moment;
    }
    tick(session.model, session.state, session.scratch, frame, given);
  }
}

}  // namespace

Status compare_precision(const Scene& scene, const Execution& execution, const Motion& motion, double seconds,
                         const GivenAt& given_at, PrecisionComparison& comparison) {
  std::vector<Settings> settings;
  for (const double precision : kRungs) settings.push_back(settings_of(scene.settings, precision));
  const bool for_each_too = feels_once_by_samples(scene.settings);
  if (for_each_too) settings.push_back(at_precision(scene.settings, 0));
  const auto& precision = scene.settings.precision;
  const bool mixed = std::any_of(precision.begin(), precision.end(),
                                 [&](double of_segment) { return of_segment != precision[0]; });
  if (mixed) settings.push_back(without_limits(scene.settings));
  Rungs rungs(settings.size());
  for (std::size_t i = 0; i < rungs.size(); ++i)
    if (Status status = make_rung(scene, settings[i], execution, rungs[i]); !status.ok()) return status;
  const double rate = scene.settings.rate;
  const std::uint64_t ticks = tick_count(seconds, rate);
  if (remembers(rungs[0].model)) {
    Rung session;
    if (Status status = make_rung(scene, without_limits(scene.settings), execution, session); !status.ok())
      return status;
    compare_session(motion, rate, ticks, given_at, session, rungs, comparison);
  } else {
    compare_moments(motion, rate, ticks, rungs, comparison);
  }
  comparison.contacts /= std::max<double>(1, static_cast<double>(comparison.ticks));
  for (std::size_t i = 0; i < kRungs.size(); ++i) comparison.rungs.push_back(figures_of(kRungs[i], rungs[i]));
  if (for_each_too) comparison.exact_for_each = figures_of(0, rungs[kRungs.size()]);
  if (for_each_too && !(comparison.exact_for_each->worst_hand_error > 0)) comparison.exact_for_each.reset();
  if (mixed) comparison.own = figures_of(precision_wanted(scene.settings), rungs.back());
  comparison.settings = scene.settings;
  comparison.by_processor_time = execution.threads <= 1;
  advise(precision_wanted(scene.settings), comparison);
  return {};
}

}  // namespace lumbrical::tool
