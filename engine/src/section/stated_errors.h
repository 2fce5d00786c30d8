// What the laws state as the error of a volume they compute "exactly".
#pragma once

namespace lumbrical {

/// What "exact" leaves in a volume, in units of R^3 (largest radius): no proof but more than was ever
/// measured against the reference, over millions of pairs (docs/mechanics.md, bench/results).
inline constexpr double kDiscError = 1e-11;     ///< discs in closed form, and slabs
inline constexpr double kFlatError = 2e-10;     ///< sides whose axis lies nearly along the plane, by nodes
inline constexpr double kBoundaryError = 1e-9;  ///< quadrature along the boundary
/// And in what lies between a border of two tiles and its chord. Nearly all have twelve digits, but the field
/// may pass over to another formula unseen between two nodes. In lanes, in units of R times the square of the
/// chord; one at a time, in those of R^3, and as a share of the volume between.
inline constexpr double kBulgeInLanesError = 4e-12, kBulgeAloneError = 6e-8, kBulgeAloneShare = 1e-6;
/// What rounding leaves in the height of a triangle's plane, over the distance of its farthest corner from
/// the primitive and the square of its longest edge by twice its area: times the area of a contact it is in
/// its volume's error. Only triangles far larger than R or very narrow ones feel it.
inline constexpr double kPlaneRounding = 1e-15;
inline constexpr double kColumnError = 1e-6;  ///< column law

}  // namespace lumbrical
