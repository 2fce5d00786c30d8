// Making the ticking thread hard to disturb: locked memory, real-time priority, a processor of its own, and a
// clock of absolute deadlines. What the system does not allow is told, not fatal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lumbrical {

struct RealTime {
  bool memory_locked = false;
  int priority = 0;                  ///< SCHED_FIFO of the calling thread; 0: an ordinary thread
  int cpu = -1;                      ///< the calling thread is pinned to; -1: to none
  std::vector<int> cpus;             ///< that it might use before
  std::vector<std::string> refused;  ///< what was not allowed, and what would help
};

enum class Pinning { none, last_processor };

/// For the calling thread, with SCHED_FIFO at `priority`; memory is locked for the whole process, but for
/// `pageable`: a mapped file that does not fit.
RealTime enter_real_time(int priority, Pinning pinning, std::span<const std::byte> pageable = {});
/// Undoes enter_real_time for the calling thread and the process.
void leave_real_time(const RealTime& real_time);

/// The steady clock [ns], which goes on while the machine is asleep (CLOCK_BOOTTIME).
std::int64_t clock_ns();

/// Sleeps until `deadline` [ns]. SIGINT and the like don't wake it early.
void sleep_until_ns(std::int64_t deadline);

/// Ticks by the clock: tick i is due i periods after the first, so that rounding never adds up.
struct Pace {
  double rate = 1000;      ///< [Hz]
  std::int64_t first = 0;  ///< [ns] when tick 0 was due
};
Pace start_pace(double rate);  ///< tick 0 is due now
std::int64_t period_of(const Pace& pace);
std::int64_t moment_of(const Pace& pace, std::uint64_t tick);
/// After a tick that ended at `end`: more than a period late, it is not caught up with by a burst of ticks;
/// the clock of the session stands still for what was missed.
void forgive_late(std::uint64_t tick, std::int64_t end, Pace& pace);

}  // namespace lumbrical
