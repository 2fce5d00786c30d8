// The clock of whatever has to do with a device. It goes on while the machine is asleep: a device does, too,
// and has let go when the machine awakes.
#pragma once

#include <cstdint>
#include <ctime>

namespace lumbrical {

#ifdef CLOCK_BOOTTIME
inline constexpr clockid_t kSteadyClock = CLOCK_BOOTTIME;
#else
inline constexpr clockid_t kSteadyClock = CLOCK_MONOTONIC;
#endif

/// [ns] by that clock. Safe in a signal handler.
inline std::int64_t steady_ns() {
  timespec now{};
  clock_gettime(kSteadyClock, &now);
  return now.tv_sec * 1000000000 + now.tv_nsec;
}

inline double in_seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }
inline std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace lumbrical
