// What one primitive feels of one triangle, from the definitions alone and by brute quadrature: slow,
// precise, and independent of the engine, which is held against it.
#pragma once

#include "lumbrical/math.h"
#include "lumbrical/probe.h"

namespace lumbrical::test {

/// The contact of one triangle with one primitive, in the frame and units (m) of its input.
struct ContactReference {
  bool touches = false;    ///< triangle and primitive share an area; all the rest is 0 otherwise
  Vec3 normal;             ///< unit, counter-clockwise
  double area = 0;         ///< [m^2]
  Vec3 centroid;           ///< [m] of the contacted area
  double deepest = 0;      ///< [m] the largest depth along -normal to the primitive's surface
  double at_centroid = 0;  ///< [m] the depth at the centroid
  double field = 0;        ///< [m^3] integral of the largest R(t) - |p - c(t)| over the contacted area
  Vec3 field_centre;       ///< [m] its centre of pressure
  double column = 0;       ///< [m^3] integral of the depth
  Vec3 column_centre;      ///< [m] its centre of pressure
  /// Estimated errors of area, field and column, relative to the value itself. They are those of the coarser
  /// of the two last steps of the quadrature, hence pessimistic.
  double area_error = 0, field_error = 0, column_error = 0;
};

/// Milliseconds to a tenth of a second. Triangle a, b, c must have an area, the primitive must be one that
/// probe() takes.
ContactReference contact_reference(const ProbePrimitive& primitive, Vec3 a, Vec3 b, Vec3 c);

/// [m] depth of point p inside the primitive along -normal (unit) to the primitive's surface; below 0 where
/// the line through p along the normal misses the primitive or leaves it above p.
double reference_depth(const ProbePrimitive& primitive, Vec3 normal, Vec3 p);

/// [m] the largest R(t) - |p - c(t)| over the spheres between the ends of the primitive; of a flat cylinder R
/// less the distance from the axis.
double reference_field(const ProbePrimitive& primitive, Vec3 p);

}  // namespace lumbrical::test
