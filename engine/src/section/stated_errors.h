// What the laws state as the error of a volume they compute "exactly".
#pragma once

namespace lumbrical {

/// What "exact" leaves in a volume, in units of R^3 (largest radius): no proof but more than was ever
/// measured against the reference, over millions of pairs (docs/mechanics.md, bench/results).
inline constexpr double kDiscError = 1e-11;       ///< discs in closed form
inline constexpr double kBoundaryError = 1e-9;    ///< quadrature along the boundary
inline constexpr double kColumnError = 1e-6;      ///< column law, equal radii
inline constexpr double kColumnConeError = 1e-3;  ///< column law, different radii

}  // namespace lumbrical
