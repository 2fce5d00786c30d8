// Which stage of a tick takes how long, and by which clock.
#pragma once

#include <array>
#include <cstdint>
#include <ctime>

#include "lumbrical/tick.h"

namespace lumbrical::tool {

inline constexpr const char* kStageWords[kStageCount] = {"input",    "hand pose", "search",
                                                         "contacts", "sums",      "limits"};

/// [ns]
inline std::int64_t read_clock(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

/// What a tick's work is measured by: the processor time of its thread, in which nothing is of other work. Of
/// several threads it would leave out the helpers'.
inline clockid_t work_clock(std::uint32_t threads) {
  return threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
}

/// For Scratch::watch: adds the time since the last stage's end to a stage. A tick begins with `begin`.
struct StageClock {
  clockid_t clock = CLOCK_MONOTONIC;
  std::array<double, kStageCount> microseconds{};
  std::int64_t last = 0;  ///< [ns]
  void begin() { last = read_clock(clock); }
  static void ended(void* self, Stage stage) {
    auto& times = *static_cast<StageClock*>(self);
    const std::int64_t now = read_clock(times.clock);
    times.microseconds[static_cast<std::size_t>(stage)] += 1e-3 * static_cast<double>(now - times.last);
    times.last = now;
  }
};

/// Objects go through the same stages.
inline void set_watch(const StageWatch& watch, Scratch& scratch) {
  scratch.watch = watch;
  if (scratch.apart) scratch.apart->watch = watch;
}

}  // namespace lumbrical::tool
