// Points of patches in double precision.
#pragma once

#include "index/patches.h"

namespace lumbrical::test {

inline Vec3 vec3_of(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

inline Vec3 point_of(const SplitPoint& p) {
  return {double{p.high[0]} + p.low[0], double{p.high[1]} + p.low[1], double{p.high[2]} + p.low[2]};
}

/// [m] W, at barycentric coordinates u and v.
inline Vec3 point_on(const PatchShape& patch, double u, double v) {
  return point_of(patch.corner) + u * vec3_of(patch.edge[0]) + v * vec3_of(patch.edge[1]);
}

}  // namespace lumbrical::test
