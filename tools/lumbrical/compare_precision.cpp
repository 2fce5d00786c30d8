// See compare_precision.h.
#include "compare_precision.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "lumbrical/tick.h"

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
  std::vector<double> microseconds, hand_error, segment_error;
};

Vec3 hand_force(const ActuatorFrame& output) {
  Vec3 sum;
  for (const Wrench& wrench : output.segment) sum += wrench.force;
  return sum;
}

double share_of(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double time_tick(const DeviceFrame& frame, Rung& rung) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  rung.output = tick(rung.model, rung.state, rung.scratch, frame);
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
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
  figures.hand_error = share_of(rung.hand_error, 0.98);
  figures.worst_hand_error = share_of(rung.hand_error, 1);
  figures.segment_error = share_of(rung.segment_error, 0.98);
  return figures;
}

std::size_t advised_rung(const std::vector<PrecisionFigures>& rungs, double wanted) {
  std::size_t advised = 0;
  for (std::size_t i = 1; i < rungs.size(); ++i) {
    const bool keeps = rungs[i].hand_error <= wanted;
    if (keeps && rungs[i].median_us < rungs[advised].median_us) advised = i;
  }
  return advised;
}

// Of the exact rung too what the others feel once is felt once, or it would not be what they are held
// against.
Settings settings_of(const Settings& given, double precision) {
  Settings settings = given;
  settings.max_force = 1e6;
  settings.fade_time = 0;
  settings.precision.fill(precision);
  const bool by_field =
      std::all_of(given.law.begin(), given.law.end(), [](Law law) { return law == Law::field; });
  if (precision == 0 && by_field && given.felt_once == FeltOnce::by_samples)
    settings.felt_once = FeltOnce::always;
  return settings;
}

}  // namespace

Status compare_precision(const Scene& scene, const Execution& execution, const Motion& motion, double seconds,
                         PrecisionComparison& comparison) {
  std::array<Rung, kRungs.size()> rungs;
  Scene free = scene;
  for (std::size_t i = 0; i < kRungs.size(); ++i) {
    free.settings = settings_of(scene.settings, kRungs[i]);
    if (Status status = build_model(free, execution, rungs[i].model); !status.ok()) return status;
    rungs[i].scratch = make_scratch(rungs[i].model);
    rungs[i].state = make_state(rungs[i].model);
    rungs[i].scratch.hash_stages = false;
  }
  const double rate = scene.settings.rate;
  const auto ticks = static_cast<std::uint64_t>(std::max(1.0, seconds * rate));
  const std::uint64_t moments = std::min(ticks, kMostMoments);
  for (std::uint64_t moment = 0; moment < moments; ++moment) {
    const double time = static_cast<double>(moment * ticks / moments) / rate;
    const DeviceFrame frame = resample(motion, time);
    std::array<double, kRungs.size()> microseconds;
    for (std::size_t i = 0; i < rungs.size(); ++i) microseconds[i] = time_tick(frame, rungs[i]);
    if (!(force_size(rungs[0].output) > kLeastForce)) continue;
    ++comparison.ticks;
    comparison.contacts += rungs[0].output.contact_count;
    for (std::size_t i = 0; i < rungs.size(); ++i) {
      rungs[i].microseconds.push_back(microseconds[i]);
      add_errors(rungs[0].output, rungs[i]);
    }
  }
  comparison.contacts /= std::max<double>(1, static_cast<double>(comparison.ticks));
  for (std::size_t i = 0; i < rungs.size(); ++i) comparison.rungs.push_back(figures_of(kRungs[i], rungs[i]));
  const auto& wanted = scene.settings.precision;
  const double finest = *std::min_element(wanted.begin(), wanted.end());
  comparison.advised = advised_rung(comparison.rungs, finest);
  return {};
}

}  // namespace lumbrical::tool
