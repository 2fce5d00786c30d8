// The loop of `lumbrical run`: motion in, ticks, recording out, and the figures worth printing afterwards.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "device_session.h"
#include "given_objects.h"
#include "late_ticks.h"
#include "live_view.h"
#include "lumbrical/model.h"
#include "lumbrical/motion.h"
#include "lumbrical/real_time.h"
#include "lumbrical/recording.h"
#include "moved_objects.h"
#include "output.h"

namespace lumbrical::tool {

/// What one hand of the session felt.
struct HandFigures {
  std::uint64_t contacts = 0;                         ///< sum over all ticks
  std::uint32_t max_contacts = 0;                     ///< of one tick
  std::array<double, kFingerCount + 1> peak_force{};  ///< [N] per finger (its segments' sum) and of the palm
  std::array<double, kSegmentCount> peak_segment{};   ///< [N] per segment: what Settings::max_force bounds
  std::array<double, kSegmentCount> peak_torque{};    ///< [N m] about each segment's base joint
  std::array<std::uint64_t, 32> flag_ticks{};         ///< ticks in which TickFlag bit i was set
  std::uint64_t starting_ticks = 0;    ///< the first ones, in which forces rose as at every start
  std::vector<std::string> untouched;  ///< where it touched nothing: how near it came
  Json clearance;                      ///< the same; null where it touched something
};

struct RunStatistics {
  std::uint64_t ticks = 0;
  std::vector<HandFigures> hands;    ///< one, or two
  std::vector<MovedObject> objects;  ///< of Model::apart
  double wall_seconds = 0;           ///< of the whole loop
  TickTimes tick_times;              ///< of tick() alone, of both hands together
  TickTimes loop_times;              ///< with a device: of everything done for a tick
  TickTimes wake_ups;                ///< paced: how late after its moment a tick began that could have begun
  RealTime real_time;                ///< paced: what the system allowed
  std::uint64_t page_faults = 0;     ///< of the ticking thread during the session
  /// With SessionParts::stages: of each stage of the ticks of all hands, and all of it together [us].
  std::array<TickTimes, kStageCount> stage_times;
  std::array<double, kStageCount> stage_sums{};
  std::uint64_t deadline_misses = 0;          ///< paced: results later than their period's end
  LateTicks late;                             ///< paced: what was behind them
  SlowTicks slowest_by_samples;               ///< paced: of ticks with evaluations, late or not
  std::uint64_t max_evaluations = 0;          ///< of fields by samples, in one hand's tick
  double evaluations = 0, evaluating_ns = 0;  ///< sums over the ticks in which there were any
  Status recording_error;                     ///< that ended the recording before the session
  std::uint64_t not_recorded = 0;             ///< ticks that are not in the file
  Status world_error;                         ///< that ended the session: its file was changed
  bool interrupted = false;                   ///< by a signal (ways_out.h)
  std::size_t world_held = 0;                 ///< [bytes] of a world file, at most
};

/// Whether no tick knew where the hand is.
inline bool lost_throughout(const RunStatistics& run, const HandFigures& hand) {
  constexpr auto kBit = static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(kInputLost)));
  return hand.flag_ticks[kBit] == run.ticks;
}

/// A hand of a session, and how it moves.
struct SessionHand {
  const Model& model;
  const Motion& motion;
};

/// What a session has besides a model and a motion; each may be absent.
struct SessionParts {
  bool paced = false;               ///< tick i starts i / settings.rate after the first by the clock
  Recorder* recorder = nullptr;     ///< open
  bool unrecorded = false;          ///< goes on when the recording fails; else that ends the session
  DeviceSession* device = nullptr;  ///< open and certified by measure_device
  std::size_t device_hand = 0;      ///< which hand it drives
  LiveView* view = nullptr;         ///< started
  GivenObjects* given = nullptr;    ///< started
  bool silent = false;              ///< shows no progress
  bool stages = false;              ///< measures each
};

/// Runs `ticks` ticks of each hand, one hand after the other, tick i at session time i / settings.rate, paced
/// or as fast as it goes. StopSignals end the loop after the tick at hand. A recording that fails (disk full)
/// is told on standard error at once. A paced session with a device that has fallen behind by more than one
/// period does not catch up by a burst of ticks: the clock of the session stands still for what was missed.
/// The device is armed last of all, after real time and a warm-up, and closed before real time is left.
RunStatistics run_session(const std::vector<SessionHand>& hands, std::uint64_t ticks,
                          const SessionParts& parts);

/// Certifies the device by what it and the ticks exchange in `seconds` without forces. The hand is as at the
/// session's start. False: a signal came.
bool measure_device(const SessionHand& hand, double seconds, DeviceSession& device);

}  // namespace lumbrical::tool
