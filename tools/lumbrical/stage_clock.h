// Which stage of a tick takes how long.
#pragma once

#include <array>
#include <chrono>

#include "lumbrical/tick.h"

namespace lumbrical::tool {

inline constexpr const char* kStageWords[kStageCount] = {"input",    "hand pose", "search",
                                                         "contacts", "sums",      "limits"};

/// For Scratch::watch: adds the time since the last stage's end to a stage. `last` is set before a tick.
struct StageClock {
  using Clock = std::chrono::steady_clock;
  std::array<double, kStageCount> microseconds{};
  Clock::time_point last;
  static void ended(void* self, Stage stage) {
    auto& times = *static_cast<StageClock*>(self);
    const Clock::time_point now = Clock::now();
    times.microseconds[static_cast<std::size_t>(stage)] +=
        std::chrono::duration<double, std::micro>(now - times.last).count();
    times.last = now;
  }
};

}  // namespace lumbrical::tool
