// What one primitive feels of one triangle, from the definitions of the laws and to as many digits as the
// number type has: slow, precise, and without a formula or a line of the engine's, which is held against it.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

#include "vector.h"

namespace lumbrical::reference {

/// Fifty decimal digits.
using Multi =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

/// The part of space where dot(normal, p - point) <= 0.
struct HalfSpace {
  Vector<double> normal, point;  ///< [m]; the normal may have any length
};

/// The convex hull of two spheres (a sphere where they coincide or one holds the other), or a cylinder with
/// flat ends. Cuts take away contacted area but leave the depth below the rest as it was.
struct Solid {
  bool flat = false;
  Vector<double> end1, end2;        ///< [m]
  double radius1 = 0, radius2 = 0;  ///< [m] > 0; equal for a flat cylinder, whose ends must differ
  std::vector<HalfSpace> cuts{};
};

using Triangle = std::array<Vector<double>, 3>;  ///< [m]

/// The integral of a density over the contacted area.
template <class T>
struct Load {
  T amount{};        ///< [m^2] of the area itself, [m^3] of a depth
  T error{};         ///< estimate of the quadrature's error in `amount`, in the same unit
  Vector<T> centre;  ///< [m] where it acts; of no meaning where amount is 0
  T moment_error{};  ///< the same for amount times centre, relative to a point near the primitive
};

template <class T>
struct Contact {
  bool touches = false;  ///< triangle and primitive share an area; all the rest is 0 otherwise
  Vector<T> normal;      ///< unit, counter-clockwise
  Load<T> area;          ///< [m^2]
  Load<T> field;         ///< [m^3] of the largest R(t) - |p - c(t)| over the spheres between the ends
  Load<T> column;        ///< [m^3] of the depth along -normal to the primitive's surface
  T deepest{};           ///< [m] the largest such depth
  T at_centroid{};       ///< [m] the depth at the area's centroid
  int lines = 0;         ///< looked at, to judge the effort
};

/// What to spend time on beside the area.
struct Wanted {
  bool field = true, column = true, deepest = true;
};

/// For T = long double and Multi. The triangle must have an area. Half a millisecond or half a second.
template <class T>
Contact<T> contact(const Solid& solid, const Triangle& triangle, Wanted wanted = {});

/// [m] depth of point p inside the solid (uncut) along -normal to its surface; -1 where p is outside.
template <class T>
T depth_at(const Solid& solid, Vector<double> normal, Vector<double> p);

/// [m] the largest R(t) - |p - c(t)| over the spheres between the ends; of a flat cylinder R less the
/// distance from the axis' line.
template <class T>
T field_at(const Solid& solid, Vector<double> p);

}  // namespace lumbrical::reference
