// Vectors that must not be too long.
#pragma once

#include "lumbrical/math.h"

namespace lumbrical {

/// As much of a vector as is no longer than `most`.
inline Vec3 shortened(Vec3 v, double most) {
  const double length = norm(v);
  return length > most ? (most / length) * v : v;
}

}  // namespace lumbrical
