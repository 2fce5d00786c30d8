// What is taken of where a given object is told to be.
#pragma once

#include <cmath>

#include "lumbrical/math.h"

namespace lumbrical {

/// Is it a place and, but for rounding, a rotation?
inline bool is_pose(const Pose& pose) {
  const double square = dot(pose.orientation, pose.orientation);
  return is_finite(pose.position) && square > 0.25 && square < 4;
}

/// Whether an object that is told so has not been moved within a tick, but lost: by more than 0.1 m, or by
/// half an angle with a cosine below 0.9. Orientations are of length 1.
inline bool is_jump(const Pose& before, const Pose& now) {
  return norm(now.position - before.position) > 0.1 ||
         std::fabs(dot(now.orientation, before.orientation)) < 0.9;
}

}  // namespace lumbrical
