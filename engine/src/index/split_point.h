// Points in single precision that lose nothing a kernel could tell: as two numbers a coordinate.
#pragma once

#include "lumbrical/math.h"

namespace lumbrical {

/// [m] What rounds to single precision, and what that leaves out.
struct SplitPoint {
  float high[3], low[3];
};
/// By Veltkamp's split: of a number that is narrowed and widened again in vectors, gcc 12 takes both for
/// nothing.
inline SplitPoint split_point(Vec3 p) {
  const double at[3] = {p.x, p.y, p.z};
  SplitPoint split;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double scaled = 536870913.0 * at[axis];  // 2^29 + 1: 24 digits are left
    const double high = scaled - (scaled - at[axis]);
    split.high[axis] = static_cast<float>(high);
    split.low[axis] = static_cast<float>(at[axis] - high);
  }
  return split;
}

/// [m] W, with all its digits again.
inline Vec3 point_of(const SplitPoint& p) {
  return {double{p.high[0]} + p.low[0], double{p.high[1]} + p.low[1], double{p.high[2]} + p.low[2]};
}

/// [m] One coordinate of a point, seen from another.
inline float difference(const SplitPoint& p, const SplitPoint& from, std::size_t axis) {
  return (p.high[axis] - from.high[axis]) + (p.low[axis] - from.low[axis]);
}

inline Vec3 vec3_of(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
inline void put(Vec3 v, float (&to)[3]) {
  to[0] = static_cast<float>(v.x);
  to[1] = static_cast<float>(v.y);
  to[2] = static_cast<float>(v.z);
}

}  // namespace lumbrical
