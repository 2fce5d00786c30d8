// How near two segments are to each other.
#pragma once

#include <cmath>

#include "base/share_along.h"
#include "lumbrical/math.h"

namespace lumbrical {

struct Segment {
  Vec3 end1, end2;  ///< [m]
};

/// [m] Least distance of two segments: of an end from the other one, or of the lines between their ends.
inline double segment_distance(const Segment& a, const Segment& b) {
  const auto square_of = [](Vec3 v) { return dot(v, v); };
  const auto from_point = [&](Vec3 p, const Segment& s) {
    const Vec3 axis = s.end2 - s.end1, from = p - s.end1;
    return square_of(from - share_along(axis, from) * axis);
  };
  double least = min(min(from_point(a.end1, b), from_point(a.end2, b)),
                     min(from_point(b.end1, a), from_point(b.end2, a)));
  const Vec3 u = a.end2 - a.end1, v = b.end2 - b.end1, w = b.end1 - a.end1, n = cross(u, v);
  const double square = square_of(n);
  if (square > 0) {
    const double s = dot(cross(w, v), n) / square, t = dot(cross(w, u), n) / square;
    if (s > 0 && s < 1 && t > 0 && t < 1) least = min(least, square_of(w + t * v - s * u));
  }
  return std::sqrt(least);
}

}  // namespace lumbrical
