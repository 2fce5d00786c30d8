// Points of patches in double precision.
#pragma once

#include "index/patches.h"

namespace lumbrical::test {

/// [m] W, at barycentric coordinates u and v.
inline Vec3 point_on(const PatchShape& patch, double u, double v) {
  return point_of(patch.corner) + u * vec3_of(patch.edge[0]) + v * vec3_of(patch.edge[1]);
}

}  // namespace lumbrical::test
