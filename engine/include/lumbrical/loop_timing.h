// What a loop over a bus takes, followed exchange by exchange: known at once when it grows, forgotten slowly.
#pragma once

#include <array>
#include <cstdint>

namespace lumbrical {

/// What was measured of the loop, device excepted.
struct LoopTiming {
  double period = 0.001;  ///< [s] between two commands that reach the device
  double jitter = 0;      ///< [s] by which a period may be longer
  double delay = 0;       ///< [s] from reading an angle to its torque, beyond the hold of one period
};

/// The two largest values of the last second or so, and of how long they are remembered.
struct RecentPeak {
  std::array<double, 2> now{}, before{};  ///< largest and second largest of this half second and the last
  double value = 0;                       ///< what is held
};

/// Measures a loop. A lone late exchange in a second is let pass: what it may generate, the energy accounts
/// bound. The second one counts at once and in full; what has become faster is believed with the time
/// constant of kTimingMemory.
struct TimingMeter {
  RecentPeak interval, delay;  ///< [s]
  double usual = 0;            ///< [s] mean interval of late
  double half = 0;             ///< [s] since `now` of the peaks began
  std::uint64_t count = 0;     ///< exchanges measured
};

inline constexpr double kTimingMemory = 5;  ///< [s]

/// One exchange: `interval` [s] since the one before, `delay` [s] from the earliest moment at which the
/// angles behind its command can have been read to its reply.
void measure_exchange(double interval, double delay, TimingMeter& meter);

/// Two exchanges at least are needed: until then nothing is known, and the delay counts as infinite.
[[nodiscard]] bool is_measured(const TimingMeter& meter);
[[nodiscard]] LoopTiming timing_of(const TimingMeter& meter);

}  // namespace lumbrical
