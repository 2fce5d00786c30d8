// The sphere round a triangle: what sphere trees and the grid are built from.
#pragma once

#include <cmath>

#include "model/corners.h"

namespace lumbrical {

struct TriangleBound {
  Vec3 centre;        ///< [m] the triangle's centroid, relative to the origin given
  double radius = 0;  ///< [m] to its farthest corner
};

/// Relative to `origin`, because far from the world's own a millimetre has few digits left.
inline TriangleBound bound_triangle(const Triangles& triangles, std::uint32_t triangle, Vec3 origin) {
  const Corners at = corners_of(triangles, triangle);
  const Vec3 a = at.a - origin, b = at.b - origin, c = at.c - origin;
  const Vec3 centre = a + ((b - a) + (c - a)) / 3.0;
  const Vec3 pa = a - centre, pb = b - centre, pc = c - centre;
  return {centre, std::sqrt(max(dot(pa, pa), max(dot(pb, pb), dot(pc, pc))))};
}

/// An axis-aligned box round points.
struct Box {
  Vec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};  ///< [m]
  void add(Vec3 p, double r = 0) {
    lower = {min(lower.x, p.x - r), min(lower.y, p.y - r), min(lower.z, p.z - r)};
    upper = {max(upper.x, p.x + r), max(upper.y, p.y + r), max(upper.z, p.z + r)};
  }
  [[nodiscard]] Vec3 middle() const { return 0.5 * lower + 0.5 * upper; }
};

}  // namespace lumbrical
