// The point of a triangle nearest to a point, and the side it is seen from: normals weighted by angle at
// corners (Baerentzen, Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005).
#pragma once

#include <cmath>

#include "base/elementary.h"
#include "lumbrical/math.h"

namespace lumbrical {

struct NearestPoint {
  Vec3 gap;                ///< from it to the point
  double square = 1e300;   ///< of the gap's length
  int corner = kNoCorner;  ///< 0 .. 2 where it is one of the triangle's

  static constexpr int kNoCorner = -1;
};

/// The triangle may be degenerate.
inline NearestPoint nearest_point(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 normal = cross(b - a, c - a);
  const double square = dot(normal, normal);
  const auto inner = [&](Vec3 from, Vec3 to) { return dot(cross(to - from, p - from), normal) >= 0; };
  if (square > 0 && inner(a, b) && inner(b, c) && inner(c, a)) {
    const double height = dot(p - a, normal);
    return {height / square * normal, height * height / square};
  }
  NearestPoint nearest;
  const Vec3 corner[3] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    const Vec3 from = corner[i], along = corner[(i + 1) % 3] - from;
    const double length2 = dot(along, along), t = length2 > 0 ? dot(p - from, along) / length2 : 0;
    if (t >= 1) continue;  // the next corner is nearer
    const Vec3 gap = p - from - (t > 0 ? t * along : Vec3{});
    if (dot(gap, gap) < nearest.square) nearest = {gap, dot(gap, gap), t > 0 ? NearestPoint::kNoCorner : i};
  }
  return nearest;
}

/// Positive in front of the triangle, negative behind it. Where several triangles of a closed surface share
/// the nearest point, the sign of the sum of theirs tells outside from inside. 0 for a degenerate triangle.
inline double side_of(const NearestPoint& nearest, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 normal = cross(b - a, c - a), corner[3] = {a, b, c};
  const double square = dot(normal, normal);
  if (!(square > 0)) return 0;
  const double height = dot(nearest.gap, normal / std::sqrt(square));
  if (nearest.corner == NearestPoint::kNoCorner) return height;
  const Vec3 from = corner[nearest.corner], along = corner[(nearest.corner + 1) % 3] - from,
             back = corner[(nearest.corner + 2) % 3] - from;
  return height * arc_tan2(norm(cross(along, back)), dot(along, back));
}

}  // namespace lumbrical
