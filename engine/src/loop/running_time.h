// Time as a thread that sends commands counts it.
#pragma once

#include "lumbrical/device_link.h"
#include "lumbrical/math.h"

namespace lumbrical {

/// A thread kept from running for some milliseconds could not send anything in them. If it let that time pass
/// for its safety envelope as well, the first command afterwards would make a jump of what should have been a
/// slope, and hold against the ticks that they were asleep too. So a cycle counts for two of the usual ones
/// at most, as long as the device holds what it was told last: one that is lost has let go in the meantime.
struct RunningTime {
  double usual;     ///< [s] a cycle, of late; grows and shrinks with what the bus takes
  double lost = 0;  ///< [s] what was not counted so far

  /// What a cycle of `elapsed` [s] counts for.
  double advance(double elapsed) {
    const double counted = min(elapsed, 2 * usual);
    lost += elapsed - counted;
    usual += (counted - usual) / 8;
    return counted;
  }
};

/// How old a command is by that time.
struct RunningAge {
  double lost_before = 0;  ///< [s] of RunningTime::lost, what was not while the command was there

  void begin(const RunningTime& running) { lost_before = running.lost; }
  /// [s] of a command that came `age` [s] ago by the clock. Of a stall, no more than that is forgiven.
  double of(double age, const RunningTime& running) {
    lost_before = max(lost_before, running.lost - max(age, 0));
    return age - (running.lost - lost_before);
  }
};

/// [s] that a cycle waits, once it is due, for the tick that feels what the last reply, asked for at `asked`
/// [ns], has told: without it the command of a slow bus is older by a whole exchange. No longer than the
/// exchange took, so that little is lost where ticks are slower than the bus, and no longer than a command
/// may be held.
inline double wait_for_tick(const DeviceCommand& newest, std::int64_t asked, double exchange,
                            const SafetyTimes& times) {
  const bool made_of_angles = newest.feedback_time != 0;
  return made_of_angles && newest.feedback_time < asked ? min(exchange, times.tick_hold) : 0;
}

}  // namespace lumbrical
