// Convex polygons in the xz-plane; y goes along.
#pragma once

#include <vector>

#include "lumbrical/math.h"

namespace lumbrical {

/// Twice the area of the triangle in the xz-plane: positive where c lies left of the way from a to b.
inline double turn(Vec3 a, Vec3 b, Vec3 c) { return (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x); }

/// The corners of the convex hull of points, counterclockwise in the sense of `turn`. One is left out where
/// `turn` of it between its neighbours, as they stand then, is no more than `hair` [m^2]: with 0 it is exact.
std::vector<Vec3> convex_hull(std::vector<Vec3> points, double hair);

}  // namespace lumbrical
