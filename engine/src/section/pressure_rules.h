// The ladder of precision: integrals of the field over a small region by one, three or seven points, each
// with an error bound known beforehand.
#pragma once

#include "section/pressure.h"
#include "section/stated_errors.h"

namespace lumbrical {

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
