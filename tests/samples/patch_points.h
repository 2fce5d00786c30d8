// Points of patches, and how far they are from skeletons, in double precision.
#pragma once

#include "index/patches.h"
#include "samples/bodies.h"

namespace lumbrical::test {

/// [m] W, at barycentric coordinates u and v.
inline Vec3 point_on(const PatchShape& patch, double u, double v) {
  return point_of(patch.corner) + u * vec3_of(patch.edge[0]) + v * vec3_of(patch.edge[1]);
}

inline double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double square = dot(along, along), t = square > 0 ? clamp(dot(p - a, along) / square, 0, 1) : 0;
  return norm(p - (a + t * along));
}

/// From the polygon of the palm, p relative to its origin [m].
inline double distance_to_palm(Vec3 p, const PalmBody& palm) {
  const double x = dot(p, vec3_of(palm.axis[0])), y = dot(p, vec3_of(palm.axis[1])),
               z = dot(p, vec3_of(palm.axis[2]));
  double least = 1;
  bool inside = true;
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    const std::size_t next = (k + 1) % palm.corner_count;
    inside =
        inside && palm.edge[k].out_x * (x - palm.edge[k].x) + palm.edge[k].out_y * (y - palm.edge[k].y) <= 0;
    least = min(least, distance_to_segment({x, y, z}, {palm.edge[k].x, palm.edge[k].y, 0},
                                           {palm.edge[next].x, palm.edge[next].y, 0}));
  }
  return inside ? std::abs(z) : least;
}

}  // namespace lumbrical::test
