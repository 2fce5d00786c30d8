// Where a segment is nearest to a point.
#pragma once

#include "lumbrical/math.h"

namespace lumbrical {

/// The share of a segment's `axis` at its point nearest to one that lies `from` its beginning, 0 to 1; 0 of a
/// segment without length.
inline double share_along(Vec3 axis, Vec3 from) {
  const double square = dot(axis, axis);
  return square > 0 ? clamp(dot(from, axis) / square, 0, 1) : 0;
}

}  // namespace lumbrical
