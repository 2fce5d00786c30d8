// How often a sensor tells something new: one that is slower than the bus tells angles that are older than
// their replies, and nothing that is measured of the bus knows.
#pragma once

#include <cstdint>

namespace lumbrical {

/// What is remembered of one angle.
struct AnglePace {
  float value = 0;
  std::int64_t changed = 0;  ///< [ns] when it was first asked for and was `value`; 0: not yet
  int asked = 0;             ///< times since then
  double way = 0;            ///< [rad] that it has changed by then
  int changes = 0;           ///< while the joint moved on
  int answers = 0;           ///< in the time between these
  double between = 0;        ///< [s] likewise
};

/// Changes that are enough to tell.
inline constexpr int kEnoughChanges = 20;

/// What the device said of an angle that it was asked for at `asked` [ns]; `step` [rad] of its encoder.
void note_angle(float angle, std::int64_t asked, double step, AnglePace& pace);

/// [s] between two changes of the angle of a joint that moves on, where the device answers at least twice in
/// between; 0: there is none, or not enough is known.
double slow_pace(const AnglePace& pace);

}  // namespace lumbrical
