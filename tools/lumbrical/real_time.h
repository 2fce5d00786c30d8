// Making the ticking thread hard to disturb: locked memory, real-time priority, a processor of its own, and a
// clock of absolute deadlines. What the system does not allow is told, not fatal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lumbrical::tool {

struct RealTime {
  bool memory_locked = false;
  int priority = 0;                  ///< SCHED_FIFO of the calling thread; 0: an ordinary thread
  int cpu = -1;                      ///< the calling thread is pinned to; -1: to none
  std::vector<std::string> refused;  ///< what was not allowed, and what would help
};

enum class Pinning { none, last_processor };

/// For the calling thread, with SCHED_FIFO at `priority`; memory is locked for the whole process, but for
/// `pageable`: a mapped file that does not fit.
RealTime enter_real_time(int priority, Pinning pinning, std::span<const std::byte> pageable = {});
/// Undoes enter_real_time for the calling thread and the process.
void leave_real_time(const RealTime& real_time);

std::int64_t clock_ns();

/// The time of day, "2026-03-01T12:34:56.123456789Z".
std::string utc_text();  ///< the steady clock

/// Sleeps until `deadline` [ns]. SIGINT and the like don't wake it early.
void sleep_until_ns(std::int64_t deadline);

/// Page faults of the calling thread so far, minor and major.
std::uint64_t page_faults();

}  // namespace lumbrical::tool
