// Nodes of the field law's boundary quadrature: what pressure_field.cpp hands to the SIMD kernels.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lumbrical {

/// Where phi is this small a share of R along a whole strip, its closed form would cancel.
inline constexpr double kShallowStrip = 0.05;

/// The numbers of a Section (section.h) that phi depends on.
struct StripSection {
  enum Kind : std::uint8_t { sphere, side_only, hull } kind;
  double radius1, radius2;  ///< [m]
  double h1, h2, x2;        ///< [m]
  double s, c, length;      ///< sine and cosine of the axis' angle; [m]
  double sine, cosine;      ///< of the cone's half angle; 0 and 1 for a capsule
};

/// Quadrature nodes of one section, structure of arrays.
struct StripNodes {
  static constexpr std::size_t kCapacity = 512;
  std::size_t count = 0;
  alignas(64) double x[kCapacity], y[kCapacity];  ///< [m]
  alignas(64) double weight[kCapacity];           ///< [m], along x
  alignas(64) double zeroth[kCapacity];           ///< [m^2] out: integral from y' = 0 to y of the integrand f
  alignas(64) double first[kCapacity];            ///< [m^3] out: of y' f
};

}  // namespace lumbrical
