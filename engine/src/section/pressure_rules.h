// The ladder of precision: integrals of the field over a small region by a few points, each rule with an
// error bound known beforehand.
#pragma once

#include "section/pressure.h"
#include "section/stated_errors.h"

namespace lumbrical {

/// Integrates phi over the region by the cheapest rule whose error bound is at most `tolerance` times R times
/// the area. False, and nothing set, where none is good enough.
///
/// With l the reach of the region from its centroid and d the centroid's distance from the axis:
///   one point (any region)     |error| <= area l^2 / (2 (d - l)),  for |D^2 phi| <= 1 / distance to the axis
///   degree n - 1 (a triangle)  |error| <= area 2 p / (n - 1) d (l / d)^n / (1 - l / d)
/// the latter where the triangle lies on one side of the field's borders; p = |P_k(0)| of Legendre's
/// polynomial, k the even one of n and n - 1. There phi is linear but for a distance, on the side that from
/// the axis line times the cosine of the cone's angle: l and d are then taken across the axis, and d times
/// that cosine. The distance of a point l off at an angle with cosine z is
///   d sqrt(1 - 2 z t + t^2) = d sum of f_n(z) t^n,  t = l / d,  f_n = (P_(n - 2) - P_n) / (2n - 1),
/// and no |f_n| exceeds p / (n - 1): as (1 - z^2) f'' + n (n - 1) f = 0 and f' = - P_(n - 1),
///   S = f^2 + (1 - z^2) f'^2 / (n (n - 1))  has  S' = - 2 z f'^2 / (n (n - 1)),
/// so S, and f^2 <= S, is at most S(0), where one of f and f' is zero: f = +-p / (n - 1) for even n, else f'
/// = +-p. Weights are positive and nodes inside, so integral and rule both are at most area d sum |f_i|
/// t^i, i >= n, on what they do not agree on; and p / (n - 1) falls with n.
///
/// Added is what rounding leaves of the area, a few ulps of R times the region's size.
bool field_by_points(const Section& section, const AreaMoments& area, bool whole_triangle, double tolerance,
                     PressureMoments& moments);

}  // namespace lumbrical
