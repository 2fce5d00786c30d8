// The sphere round a triangle that every broadphase tests last and the sphere tree bounds in its leaves.
#pragma once

#include <cmath>

#include "lumbrical/model.h"

namespace lumbrical {

struct TriangleBound {
  Vec3 centre;        ///< [m] W: the triangle's centroid
  double radius = 0;  ///< [m] to its farthest corner
};

inline TriangleBound bound_triangle(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 centre = a + ((b - a) + (c - a)) / 3.0;
  const Vec3 pa = a - centre, pb = b - centre, pc = c - centre;
  return {centre, std::sqrt(max(dot(pa, pa), max(dot(pb, pb), dot(pc, pc))))};
}

inline TriangleBound bound_triangle(const Triangles& triangles, std::uint32_t triangle) {
  return bound_triangle(triangles.vertex(triangles.a[triangle]), triangles.vertex(triangles.b[triangle]),
                        triangles.vertex(triangles.c[triangle]));
}

}  // namespace lumbrical
