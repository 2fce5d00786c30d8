// The way from one orientation to another nearby, and on from one.
#pragma once

#include "lumbrical/math.h"

namespace lumbrical {

/// [rad] as a rotation vector in the frame of both: twice the sine of half the angle, which a tick's turn is.
inline Vec3 small_turn(Quat from, Quat to) {
  const Quat turn = to * conjugate(from);
  const double twice = turn.w < 0 ? -2 : 2;
  return twice * Vec3{turn.x, turn.y, turn.z};
}

/// The rotation by a small rotation vector [rad]; to be normalised.
inline Quat small_rotation(Vec3 turn) { return {1, 0.5 * turn.x, 0.5 * turn.y, 0.5 * turn.z}; }

}  // namespace lumbrical
