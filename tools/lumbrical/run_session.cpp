// See run_session.h.
#include "run_session.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <limits>
#include <thread>

#include "lumbrical/tick.h"

namespace lumbrical::tool {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t stop_requested = 0;
volatile std::time_t asked_at = 0;  // s, monotonic

// One Ctrl-C often arrives twice (once for the process, once for its group): only a signal that comes a
// second or more after the first is somebody losing patience, and kills as usual.
extern "C" void request_stop(int signal) {
  const int error = errno;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (stop_requested == 0) {
    asked_at = now.tv_sec;
    stop_requested = 1;
  } else if (now.tv_sec - asked_at > 1) {
    std::signal(signal, SIG_DFL);
    raise(signal);
  }
  errno = error;
}

// While it lives, SIGINT and SIGTERM only ask for a stop.
class StopSignals {
 public:
  StopSignals() {
    stop_requested = 0;
    struct sigaction action {};
    action.sa_handler = request_stop;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, &previous_interrupt_);
    sigaction(SIGTERM, &action, &previous_terminate_);
  }
  ~StopSignals() {
    sigaction(SIGINT, &previous_interrupt_, nullptr);
    sigaction(SIGTERM, &previous_terminate_, nullptr);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

 private:
  struct sigaction previous_interrupt_ {};
  struct sigaction previous_terminate_ {};
};

std::uint32_t nanoseconds_between(Clock::time_point start, Clock::time_point end) {
  const auto elapsed = std::chrono::duration_cast<std::chrono::nanoseconds>(end - start).count();
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(elapsed, 0, kMost));
}

// Every period is counted from the first one, so that rounding never adds up.
Clock::duration session_time(std::uint64_t tick, double rate) {
  return std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(static_cast<double>(tick) / rate));
}

void add_output(const ActuatorFrame& output, RunStatistics& statistics) {
  statistics.contacts += output.contact_count;
  statistics.max_contacts = std::max(statistics.max_contacts, output.contact_count);
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    Vec3 force;
    for (std::size_t s = 3 * finger; s < 3 * finger + 3; ++s) force += output.segment[s].force;
    statistics.peak_force[finger] = std::max(statistics.peak_force[finger], norm(force));
  }
  double& palm = statistics.peak_force[kFingerCount];
  palm = std::max(palm, norm(output.segment[kPalmSegment].force));
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    statistics.peak_torque[s] = std::max(statistics.peak_torque[s], norm(output.joint_torque[s]));
  }
  for (std::size_t bit = 0; bit < statistics.flag_ticks.size(); ++bit) {
    statistics.flag_ticks[bit] += (output.flags >> bit) & 1u;
  }
}

}  // namespace

RunStatistics run_session(const Model& model, const Motion& motion, std::uint64_t ticks, bool paced,
                          Recorder* recorder, bool unrecorded) {
  RunStatistics statistics;
  State state;
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = recorder != nullptr;
  const double rate = model.settings.rate;
  const bool still = motion.samples.size() == 1;  // a single pose is held for the whole session
  TickRecord record;
  Progress progress("running");
  const StopSignals stop_signals;
  const Clock::time_point first = Clock::now();
  const std::uint32_t period = nanoseconds_between({}, Clock::time_point(session_time(1, rate)));

  for (std::uint64_t i = 0; i < ticks && !statistics.interrupted; ++i) {
    if (paced) std::this_thread::sleep_until(first + session_time(i, rate));
    record.device = resample(motion, still ? motion.samples[0].time : static_cast<double>(i) / rate);
    const Clock::time_point start = Clock::now();
    record.output = tick(model, state, scratch, record.device);
    const Clock::time_point end = Clock::now();

    record.duration_ns = nanoseconds_between(start, end);
    const bool late = paced ? end > first + session_time(i + 1, rate) : record.duration_ns > period;
    statistics.deadline_misses += late ? 1 : 0;
    statistics.tick_times.add(record.duration_ns);
    add_output(record.output, statistics);
    ++statistics.ticks;
    if (recorder != nullptr) {
      record.stage_hash = scratch.stage_hash;
      record.state_hash = hash_state(state);
      if (!recorder->record(record)) ++statistics.not_recorded;
      if (statistics.recording_error.ok()) {
        statistics.recording_error = recorder->failure();
        if (!statistics.recording_error.ok()) fail(statistics.recording_error);
      }
      if (!statistics.recording_error.ok() && !unrecorded) break;
    }
    progress.update(i + 1, ticks);
    statistics.interrupted = stop_requested != 0;
  }
  statistics.wall_seconds = std::chrono::duration<double>(Clock::now() - first).count();
  return statistics;
}

}  // namespace lumbrical::tool
