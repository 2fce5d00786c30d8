// Integrals of depth over the contacted area: what the exact laws multiply with the stiffness.
#pragma once

#include "exact/exact_kernels.h"
#include "section/section.h"

namespace lumbrical {

/// Integral of a depth d over the region: of d, and of d times the plane coordinates.
struct PressureMoments {
  double volume = 0;   ///< [m^3]
  Point2 first{0, 0};  ///< [m^4]
  double error = 0;    ///< [m^3] bound of what the volume may be off
};

/// phi(p) = R - distance(p, axis): how far p is inside the primitive. For two radii the largest over all
/// spheres between the ends; for a flat cylinder the distance to its side. [m]
double field_at(const Section& section, Point2 p);

/// Integral of phi over what polygon and section have in common, of which area and boundary are known.
PressureMoments field_moments(const ExactKernels& kernels, const Section& section, const AreaMoments& area,
                              const Boundary& boundary);

/// Integral of d phi / dn, how fast phi changes along the normal of the plane, over the same region: of
/// itself [m^2], and times x, y [m^3], x^2, x y, y^2 [m^4].
struct SlopeMoments {
  double one = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void add(Point2 p, double share) {
    one += share;
    x += share * p.x;
    y += share * p.y;
    xx += share * p.x * p.x;
    xy += share * p.x * p.y;
    yy += share * p.y * p.y;
  }
};
SlopeMoments slope_moments(const Section& section, const AreaMoments& area, const Boundary& boundary);

/// Integral of the paper's depth (along -n to the primitive's surface) over the same region.
PressureMoments column_moments(const Section& section, const Boundary& boundary);

}  // namespace lumbrical
