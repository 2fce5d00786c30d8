// The clock of whatever has to do with a device.
#pragma once

#include <chrono>
#include <cstdint>

namespace lumbrical {

/// [ns] of the steady clock.
inline std::int64_t steady_ns() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

inline double in_seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }
inline std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace lumbrical
