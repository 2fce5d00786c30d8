// The ladder of precision: integrals of the field over a small region by one, three or seven points, each
// with an error bound known beforehand, and the bounds of what is exact to rounding.
#pragma once

#include "pressure.h"

namespace lumbrical {

/// What "exact" leaves in a volume, in units of R^3 (largest radius): no proof but more than was ever
/// measured against the reference, over millions of pairs (docs/mechanics.md, bench/results).
inline constexpr double kDiscError = 1e-11;       ///< discs in closed form
inline constexpr double kDiscErrorSingle = 3e-5;  ///< the same in single precision, for cosines >= 0.2
inline constexpr double kBoundaryError = 1e-9;    ///< quadrature along the boundary
inline constexpr double kColumnError = 1e-6;      ///< column law, equal radii
inline constexpr double kColumnConeError = 1e-3;  ///< column law, different radii

/// Integrates phi over the region by the cheapest rule whose error bound is at most `tolerance` times R times
/// the area. False, and nothing set, where none is good enough.
///
/// With l the reach of the region from its centroid and d the centroid's distance from the axis:
///   one point (any region)      |error| <= area l^2 / (2 (d - l)),  for |D^2 phi| <= 1 / distance to the
///   axis m-th degree (a triangle)    |error| <= 2 area d 2 / (2m + 1) (l / d)^(m + 1) / (1 - l / d)
/// the latter from the expansion of the distance in Legendre polynomials, where the triangle lies on one side
/// of the field's borders. Three points have degree 2, seven have 5.
bool field_by_points(const Section& section, const AreaMoments& area, bool whole_triangle, double tolerance,
                     PressureMoments& moments);

}  // namespace lumbrical
