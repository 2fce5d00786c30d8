// The loop of `lumbrical run`: motion in, ticks, recording out, and the figures worth printing afterwards.
#pragma once

#include <array>
#include <cstdint>

#include "lumbrical/model.h"
#include "lumbrical/motion.h"
#include "lumbrical/recording.h"
#include "output.h"

namespace lumbrical::tool {

struct RunStatistics {
  std::uint64_t ticks = 0;
  double wall_seconds = 0;  ///< of the whole loop
  TickTimes tick_times;     ///< of tick() alone
  std::uint64_t deadline_misses =
      0;                       ///< paced: results later than their period's end; else ticks longer than one
  std::uint64_t contacts = 0;  ///< sum over all ticks
  std::uint32_t max_contacts = 0;                     ///< of one tick
  std::array<double, kFingerCount + 1> peak_force{};  ///< [N] per finger (its segments' sum) and of the palm
  std::array<double, kSegmentCount> peak_torque{};    ///< [N m] about each segment's base joint
  std::array<std::uint64_t, 32> flag_ticks{};         ///< ticks in which TickFlag bit i was set
  Status recording_error;                             ///< that ended the recording before the session
  std::uint64_t not_recorded = 0;                     ///< ticks the recorder had no room for
  bool interrupted = false;                           ///< by SIGINT or SIGTERM
};

/// Runs `ticks` ticks, tick i at session time i / settings.rate. Paced: tick i starts that long after the
/// first by the wall clock. Otherwise as fast as it goes. `recorder` may be null. SIGINT and SIGTERM end the
/// loop after the tick at hand. A recording that fails (disk full) is told on standard error at once and ends
/// the session, or where `unrecorded` not.
RunStatistics run_session(const Model& model, const Motion& motion, std::uint64_t ticks, bool paced,
                          Recorder* recorder, bool unrecorded);

}  // namespace lumbrical::tool
