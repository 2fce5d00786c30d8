// See run_session.h.
#include "run_session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "lumbrical/tick.h"
#include "lumbrical/world.h"
#include "ways_out.h"

namespace lumbrical::tool {
namespace {

// What is computed before a device is armed [s]: the first ticks meet cold caches and unmapped pages.
constexpr double kWarmUp = 0.05;

// Above ordinary work, below the kernel's own threads for clocks and migration.
constexpr int kTickPriority = 80;

std::uint32_t nanoseconds_between(std::int64_t start, std::int64_t end) {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(end - start, 0, kMost));
}

// Every period is counted from the first one, so that rounding never adds up.
std::int64_t session_ns(std::uint64_t tick, double rate) {
  return static_cast<std::int64_t>(static_cast<double>(tick) * 1e9 / rate);
}

void add_output(const ActuatorFrame& output, const State& state, RunStatistics& statistics) {
  const bool starting = statistics.starting_ticks == statistics.ticks;
  if (starting && state.rise > 0 && (output.flags & kFading) != 0) ++statistics.starting_ticks;
  statistics.contacts += output.contact_count;
  statistics.max_contacts = std::max(statistics.max_contacts, output.contact_count);
  statistics.max_evaluations = std::max(statistics.max_evaluations, output.evaluations);
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    Vec3 force;
    for (std::size_t s = 3 * finger; s < 3 * finger + 3; ++s) force += output.segment[s].force;
    statistics.peak_force[finger] = std::max(statistics.peak_force[finger], norm(force));
  }
  double& palm = statistics.peak_force[kFingerCount];
  palm = std::max(palm, norm(output.segment[kPalmSegment].force));
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    statistics.peak_segment[s] = std::max(statistics.peak_segment[s], norm(output.segment[s].force));
    statistics.peak_torque[s] = std::max(statistics.peak_torque[s], norm(output.joint_torque[s]));
  }
  for (std::size_t bit = 0; bit < statistics.flag_ticks.size(); ++bit) {
    statistics.flag_ticks[bit] += (output.flags >> bit) & 1u;
  }
}

// Ticks as the session's first one, whose forces go nowhere: the device is not armed.
void tick_unarmed(const Model& model, const Motion& motion, double seconds, Scratch& scratch,
                  DeviceLoop& device) {
  State state;
  TickRecord record;
  const auto ticks = static_cast<std::uint64_t>(std::ceil(seconds * model.settings.rate));
  const std::int64_t first = clock_ns();
  for (std::uint64_t i = 0; i < ticks && !stop_requested(); ++i) {
    sleep_until_ns(first + session_ns(i, model.settings.rate));
    record.device = resample(motion, motion.samples[0].time);
    device.before(record.device);
    record.output = tick(model, state, scratch, record.device);
    device.after(scratch, record.device, record.output, record);
  }
}

}  // namespace

bool measure_device(const Model& model, const Motion& motion, double seconds, DeviceLoop& device) {
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = false;
  tick_unarmed(model, motion, seconds, scratch, device);
  return !stop_requested();
}

RunStatistics run_session(const Model& model, const Motion& motion, std::uint64_t ticks,
                          const SessionParts& parts) {
  RunStatistics statistics;
  State state;
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = parts.recorder != nullptr;
  const double rate = model.settings.rate;
  const bool still = motion.samples.size() == 1;  // a single pose is held for the whole session
  TickRecord record;
  Progress progress("running");
  WorldPager pager(model, {});  // before real time, so that its thread has none of that
  pager.hand_at(resample(motion, motion.samples[0].time));
  pager.catch_up();
  if (parts.paced) {
    const auto pageable = model.world ? std::span(model.world->bytes.get(), model.world->byte_count)
                                      : std::span<const std::byte>();
    statistics.real_time = enter_real_time(kTickPriority, Pinning::last_processor, pageable);
  }
  if (parts.device != nullptr) {
    parts.device->measure_again();
    tick_unarmed(model, motion, kWarmUp, scratch, *parts.device);
    parts.device->arm();  // last of all: from now on a tick that does not come is a fault
    statistics.interrupted = stop_requested();
  }
  statistics.late.reserve();
  const std::uint64_t faults_before = page_faults();
  const std::int64_t begin = clock_ns();
  std::int64_t first = begin;  // moves on where a device's session has fallen behind
  const std::int64_t period = session_ns(1, rate);
  bool stopped = false;

  for (std::uint64_t i = 0; i < ticks && !statistics.interrupted && !stopped; ++i) {
    const std::int64_t moment = first + session_ns(i, rate);
    if (parts.paced) {
      sleep_until_ns(moment);
      statistics.wake_ups.add(nanoseconds_between(moment, clock_ns()));
    }
    const std::int64_t start = clock_ns();
    record.device = resample(motion, still ? motion.samples[0].time : static_cast<double>(i) / rate);
    if (parts.device != nullptr) parts.device->before(record.device);
    pager.hand_at(record.device);
    const std::int64_t tick_start = clock_ns();
    record.output = tick(model, state, scratch, record.device);
    const std::int64_t tick_end = clock_ns();
    record.duration_ns = nanoseconds_between(tick_start, tick_end);
    if (pager.changed()) {  // neither device nor recording learn of this tick
      statistics.world_error = pager.failure();
      break;
    }
    if (parts.device != nullptr)
      stopped = !parts.device->after(scratch, record.device, record.output, record);

    const std::int64_t end = clock_ns();
    const bool late = parts.paced ? end > moment + period : record.duration_ns > period;
    statistics.deadline_misses += late ? 1 : 0;
    if (late && parts.paced)
      statistics.late.add(start - moment, record.duration_ns, end - moment, record.device);
    if (parts.device != nullptr) {
      statistics.loop_times.add(nanoseconds_between(start, end));
      if (parts.paced && end > moment + 2 * period) first += end - (moment + period);
    }
    statistics.tick_times.add(record.duration_ns);
    if (record.output.evaluations > 0) {
      statistics.evaluations += static_cast<double>(record.output.evaluations);
      statistics.evaluating_ns += record.duration_ns;
    }
    if (parts.view != nullptr) parts.view->put(record);
    add_output(record.output, state, statistics);
    statistics.world_held = std::max(statistics.world_held, pager.held_bytes());
    ++statistics.ticks;
    if (parts.recorder != nullptr) {
      record.stage_hash = scratch.stage_hash;
      record.state_hash = hash_state(state);
      static_cast<void>(parts.recorder->record(record));  // what became of it, close() tells
      if (statistics.recording_error.ok()) {
        statistics.recording_error = parts.recorder->failure();
        if (!statistics.recording_error.ok()) fail(statistics.recording_error);
      }
      if (!statistics.recording_error.ok() && !parts.unrecorded) break;
    }
    if (parts.device == nullptr) progress.update(i + 1, ticks);
    statistics.interrupted = stop_requested();
  }
  statistics.page_faults = page_faults() - faults_before;
  statistics.wall_seconds = static_cast<double>(clock_ns() - begin) * 1e-9;
  leave_real_time(statistics.real_time);
  return statistics;
}

}  // namespace lumbrical::tool
