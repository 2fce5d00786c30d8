// Why ticks were late, what would help, and which bound on effort keeps a rate: the slowest ticks computed
// again, stage by stage and otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/recording.h"
#include "lumbrical/tick.h"
#include "output.h"

namespace lumbrical::tool {

/// What a tick came from, by hand: of a session of one hand the first alone counts.
struct TickStart {
  std::array<DeviceFrame, kMostHands> frame;
  std::array<std::uint32_t, kMostHands> given_count{};
  std::array<std::array<ObjectFrame, kMostObjects>, kMostHands> given;
  std::array<State, kMostHands> state;  ///< before it: where objects stood, where the proxy was
};

/// Some of the ticks that it was given: the slowest.
struct SlowTicks {
  std::vector<TickStart> start;
  std::vector<std::uint32_t> duration;  ///< [ns] by work_clock
  std::size_t kept = 0;                 ///< so many of both

  /// Room for what is kept, so that keeping allocates nothing: states are as large as those of `any`.
  void reserve(const TickStart& any);
  void add(std::int64_t nanoseconds, const TickStart& tick);
};

/// What a late tick's time went into [ns].
struct LateTime {
  std::int64_t behind = 0;   ///< ticks before it, which ended after it was due
  std::int64_t wake_up = 0;  ///< other work, which had the processor before the tick or amid it
  std::int64_t tick = 0;     ///< the tick itself, by work_clock
  std::int64_t beside = 0;   ///< motion, device, recording
};

/// What was behind deadlines that were missed: of each the longest of the three counts. Ticks that wait for
/// others before them have their causes.
struct LateTicks {
  std::uint64_t woken_late = 0;  ///< other work had the processor
  std::uint64_t slow = 0;        ///< ticks took long
  std::uint64_t beside = 0;      ///< motion, device, recording
  SlowTicks slowest;             ///< of those that took long

  void add(const LateTime& time, const TickStart& start);

 private:
  std::array<double, 3> owed_{};  // [ns] of the last late tick: woken_late, slow, beside
};

/// A change of the session, and what one of its late ticks takes with it.
struct Remedy {
  std::string change;
  double microseconds = 0;
};

/// What a tick is about.
struct TickLoad {
  std::size_t triangles = 0, thin_triangles = 0;  ///< that it touches, and those of them that are needles
  double evaluations = 0;                         ///< by samples, of all hands
};

struct LateReport {
  double microseconds = 0;                        ///< of a late tick, the median, computed again as it was:
                                                  ///< with what it met for the first time, where it did
  double again_microseconds = 0;                  ///< the same where the hand has been there just before
  double session_microseconds = 0;                ///< as the session measured it by work_clock
  TickLoad load;                                  ///< of such a tick
  std::array<double, kStageCount> stage_share{};  ///< of `microseconds`
  std::vector<Remedy> remedies;                   ///< those that help, best first
};

/// A tick that is computed again, by work_clock [us].
struct TimedTick {
  double first = 0;  ///< on memory that has met the ticks before it, and not this one
  double again = 0;  ///< the shortest on memory that has just met it
  double evaluations = 0;
};

/// Is what a session measured [us] nearer to the first visit?
bool was_first_visit(const TimedTick& tick, double session);

/// Of a session in which a tick was slow. Builds the scene once more for each remedy that is tried.
/// `models`: of the session's hands, which `scene` is felt by. With a device more threads are no remedy:
/// helpers have no real-time priority.
LateReport study(const LateTicks& late, const Scene& scene, const std::vector<Model>& models,
                 bool with_device);

/// A tick with no bound on its effort, and with the least effort there is.
struct EffortTimes {
  double microseconds = 0, least_microseconds = 0;
  double evaluations = 0, least_evaluations = 0;  ///< of all hands
};

/// Evaluations that keep each of the ticks within a time, by what a bound spares those that take longer.
/// Where none does, as many as the busiest takes and, since everything grows with what is near, so much more
/// as there is time for. Nothing: no bound does it.
std::optional<double> effort_within(double microseconds, std::span<const EffortTimes> ticks);

/// Which Settings::effort keeps the ticks within half a period of `rate`.
struct EffortReport {
  std::optional<double> fits;     ///< of each hand; nothing: none does, or there were no ticks
  double least_microseconds = 0;  ///< of the tick that takes longest with the least effort
};
EffortReport study_effort(const SlowTicks& slowest, double rate, const std::vector<Model>& models);

Json late_json(const LateTicks& late, const LateReport& report);
void add_late(const LateTicks& late, const LateReport& report, double period_us, Table& table);

}  // namespace lumbrical::tool
