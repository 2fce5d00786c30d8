// The way from one orientation to another nearby.
#pragma once

#include "lumbrical/math.h"

namespace lumbrical {

/// [rad] as a rotation vector in the frame of both: twice the sine of half the angle, which a tick's turn is.
inline Vec3 small_turn(Quat from, Quat to) {
  const Quat turn = to * conjugate(from);
  const double twice = turn.w < 0 ? -2 : 2;
  return twice * Vec3{turn.x, turn.y, turn.z};
}

}  // namespace lumbrical
