// Ways across the region between a border and its chord: what border_bulge.cpp hands to the SIMD kernel.
#pragma once

#include <cstddef>

namespace lumbrical {

/// Structure of arrays; a way is a lane. It starts in the plane's point (x, y) and goes by `height` along
/// (across_x, across_y).
struct CrossingTerms {
  static constexpr std::size_t kCapacity = 64;
  // The tile and the plane, as in Section.
  double radius1, radius2, length;  ///< [m]
  double sine, cosine;              ///< of the cone's half angle
  double s, c, h1;                  ///< sine and cosine of the axis' angle; [m]
  double across_x, across_y;        ///< unit
  std::size_t count = 0;
  alignas(64) double x[kCapacity], y[kCapacity], height[kCapacity];  ///< [m]
  alignas(64) double mean[kCapacity];                                ///< [m] out: phi's mean along the way
  alignas(64) double lean[kCapacity];    ///< [m] out: of phi times the share of the way
  alignas(64) double smooth[kCapacity];  ///< out: 1, or 0 where a few nodes will not do
};

}  // namespace lumbrical
