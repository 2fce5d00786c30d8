// Does a triangle touch a cube? By separating axes (Gottschalk, Lin, Manocha, OBBTree, 1996): the cube's
// three, the triangle's normal, and the nine cross products of the cube's edges with the triangle's.
#pragma once

#include <cmath>

#include "lumbrical/math.h"

namespace lumbrical {

/// Corners relative to the middle of the axis-aligned cube whose sides are 2 `half`. In doubt yes, if `half`
/// is taken larger by what rounding may do: then no triangle that touches is denied, whatever its shape.
inline bool touches_cube(Vec3 a, Vec3 b, Vec3 c, double half) {
  const auto apart = [&](double p, double q, double r, double reach) {
    return min(p, min(q, r)) > reach || max(p, max(q, r)) < -reach;
  };
  if (apart(a.x, b.x, c.x, half) || apart(a.y, b.y, c.y, half) || apart(a.z, b.z, c.z, half)) return false;
  for (const Vec3 e : {b - a, c - b, a - c}) {
    const double x = std::fabs(e.x), y = std::fabs(e.y), z = std::fabs(e.z);
    if (apart(e.y * a.z - e.z * a.y, e.y * b.z - e.z * b.y, e.y * c.z - e.z * c.y, half * (y + z)) ||
        apart(e.z * a.x - e.x * a.z, e.z * b.x - e.x * b.z, e.z * c.x - e.x * c.z, half * (z + x)) ||
        apart(e.x * a.y - e.y * a.x, e.x * b.y - e.y * b.x, e.x * c.y - e.y * c.x, half * (x + y)))
      return false;
  }
  const Vec3 n = cross(b - a, c - a);
  return !(std::fabs(dot(n, a)) > half * (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z)));
}

}  // namespace lumbrical
