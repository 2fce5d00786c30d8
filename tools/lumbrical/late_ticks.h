// Why ticks were late, and what would help: the slowest of them computed again, stage by stage and otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/recording.h"
#include "lumbrical/tick.h"
#include "output.h"

namespace lumbrical::tool {

/// What came in for a tick, by hand: of a session of one hand the first alone counts.
using TickFrames = std::array<DeviceFrame, kMostHands>;

/// What was behind deadlines that were missed: of each the longest of the three counts.
struct LateTicks {
  std::uint64_t woken_late = 0;                 ///< other work had the processor when the tick was due
  std::uint64_t slow = 0;                       ///< the tick itself
  std::uint64_t beside = 0;                     ///< motion, device, recording
  std::vector<TickFrames> slowest;              ///< some of them, the slowest
  std::vector<std::uint32_t> slowest_duration;  ///< [ns] theirs

  /// Room for what is kept, so that keeping allocates nothing.
  void reserve();
  void add(std::int64_t wake_up_ns, std::int64_t tick_ns, std::int64_t all_ns, const TickFrames& frames);
};

/// A change of the session, and what one of its late ticks takes with it.
struct Remedy {
  std::string change;
  double microseconds = 0;
};

struct LateReport {
  double microseconds = 0;                        ///< of a late tick, the median, computed again
  std::array<double, kStageCount> stage_share{};  ///< of that
  std::vector<Remedy> remedies;                   ///< those that help, best first
};

/// Nothing where no tick was slow. Builds the scene once more for each remedy that is tried.
/// `models`: of the session's hands.
LateReport study(const LateTicks& late, const Scene& scene, const std::vector<Model>& models);

Json late_json(const LateTicks& late, const LateReport& report);
void add_late(const LateTicks& late, const LateReport& report, double period_us, Table& table);

}  // namespace lumbrical::tool
