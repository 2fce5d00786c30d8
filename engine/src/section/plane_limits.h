// When a triangle has a plane, and an axis a direction in it: the same in lanes and for one pair at a time.
#pragma once

namespace lumbrical {

/// A triangle's normal is rounding noise where twice its area is below this share of its longest edge
/// squared.
inline constexpr double kNoNormal = 1e-15;

/// [m^2] Twice the area, and the longest edge squared, beyond which numbers run out.
inline constexpr double kLeastTwiceArea = 1e-290, kMostEdgeSquared = 1e150;

/// Sine of the axis angle below which the direction of the projected axis is rounding noise.
inline constexpr double kNoDirection = 1e-15;

}  // namespace lumbrical
