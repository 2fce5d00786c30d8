// Time as a thread that sends commands counts it.
#pragma once

#include "lumbrical/math.h"

namespace lumbrical {

/// A thread kept from running for some milliseconds could not send anything in them. If it let that time pass
/// for its safety envelope as well, the first command afterwards would make a jump of what should have been a
/// slope, and hold against the ticks that they were asleep too. So a cycle counts for two of the usual ones
/// at most.
struct RunningTime {
  double usual;     ///< [s] a cycle, of late; grows and shrinks with what the bus takes
  double lost = 0;  ///< [s] what was not counted so far

  /// What a cycle of `elapsed` [s] counts for.
  double advance(double elapsed) {
    const double counted = min(elapsed, 2 * usual);
    lost += elapsed - counted;
    usual += (counted - usual) / 16;
    return counted;
  }
};

}  // namespace lumbrical
