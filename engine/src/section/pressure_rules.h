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
///   one point (any region)       |error| <= area l^2 / (2 (d - l)),  for |D^2 phi| <= 1 / distance to the
///   axis n-th degree less one (a triangle)  |error| <= 2 area d p / (n - 1) (l / d)^n / (1 - l / d)
/// the latter where the triangle lies on one side of the field's borders, with p = |P_k(0)| of Legendre's
/// polynomial of even degree k = n or n - 1, and lengths taken across the axis on the side. For there phi is
/// a linear function less the distance from a point, of a point l off at an angle with cosine z
///   d sqrt(1 - 2 z t + t^2) = d sum of f_n(z) t^n,  t = l / d,  f_n = (P_(n - 2) - P_n) / (2n - 1),
/// and no f_n is larger than p / (n - 1). They solve (1 - z^2) f'' + n (n - 1) f = 0, f' = - P_(n - 1), so
///   S = f^2 + (1 - z^2) f'^2 / (n (n - 1)),  S' = - 2 z f'^2 / (n (n - 1)),
/// is largest at z = 0, where one of f and f' vanishes: f = +-p / (n - 1) for even n, else f' = +-p. As
/// weights are positive and nodes inside, what a rule leaves of the terms from t^n on is at most twice their
/// largest sum.
bool field_by_points(const Section& section, const AreaMoments& area, bool whole_triangle, double tolerance,
                     PressureMoments& moments);

}  // namespace lumbrical
