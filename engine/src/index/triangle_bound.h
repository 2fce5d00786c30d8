// The sphere round a triangle's centroid: what trees and grid are built from, and patches are found by.
#pragma once

#include <cmath>

#include "index/sphere_tree.h"
#include "model/corners.h"

namespace lumbrical {

/// Relative to `origin`, because far from the world's own a millimetre has few digits left.
inline Sphere bound_triangle(const Triangles& triangles, std::uint32_t triangle, Vec3 origin) {
  const Corners at = corners_of(triangles, triangle);
  const Vec3 a = at.a - origin, b = at.b - origin, c = at.c - origin;
  const Vec3 centre = a + ((b - a) + (c - a)) / 3.0;
  const Vec3 pa = a - centre, pb = b - centre, pc = c - centre;
  return {centre, std::sqrt(max(dot(pa, pa), max(dot(pb, pb), dot(pc, pc))))};
}

/// The same of a triangle or a part of one [m, W]; the last digit may be another.
inline Sphere sphere_round(const Corners& at, Vec3 origin) {
  const Vec3 a = at.a - origin, ab = at.b - at.a, ac = at.c - at.a, from_centre = (ab + ac) / 3.0;
  const Vec3 b = ab - from_centre, c = ac - from_centre;
  return {a + from_centre, std::sqrt(max(dot(from_centre, from_centre), max(dot(b, b), dot(c, c))))};
}

}  // namespace lumbrical
