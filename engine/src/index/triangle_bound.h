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

}  // namespace lumbrical
