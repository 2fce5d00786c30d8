// Near borders that run through triangles once: what the narrowphase hands to the SIMD kernel
// (border_bulges.h) and what it gets back. Structure of arrays; a tile's border in a triangle is a lane.
#pragma once

#include <cstddef>
#include <initializer_list>

namespace lumbrical {

/// What a border does in the triangle it crosses: it misses the section, all of which there belongs to one of
/// the two; a part of it lies in the section; or it is for `cut_at_borders`.
inline constexpr double kBorderOutside = 0, kBorderInside = 1, kBorderUnclear = 2;

/// A border steeper than this against its chord is not followed in lanes, and split elsewhere.
inline constexpr double kSteepestChord = 0.3;

struct BorderTerms {
  static constexpr std::size_t kCapacity = 64;
  std::size_t count = 0;

  // The tile, as in RoundTerms; all points are relative to its first end.
  alignas(64) double axis[3][kCapacity];
  alignas(64) double length[kCapacity], radius1[kCapacity], radius2[kCapacity];
  alignas(64) double sine[kCapacity], cosine[kCapacity];
  alignas(64) double a[3][kCapacity], b[3][kCapacity], c[3][kCapacity];  ///< [m] W, corners

  // The border (JointBorder): x^2 + y^2 = z^2, z along the cone.
  alignas(64) double joint[3][kCapacity];                                ///< [m] W
  alignas(64) double x[3][kCapacity], y[3][kCapacity], z[3][kCapacity];  ///< W
  alignas(64) double side[kCapacity];  ///< 1: the tile's part is inside the cone, -1: outside
  // Where both tiles' fields pass over to that of the joint's sphere, the product of this and a point from
  // the joint is 0.
  alignas(64) double ring[3][kCapacity];
  // Where it crosses the triangle's edges [m] W, from the joint; its kin's part lies to the right.
  alignas(64) double from[3][kCapacity], to[3][kCapacity];

  // Results. The chord of the part of the border inside the section, or the whole one; no more than `height`
  // lies between it and its border. Of a part inside what the tile gains beyond its chord, the moments about
  // the tile's first end.
  alignas(64) double status[kCapacity];
  alignas(64) double start[3][kCapacity], end[3][kCapacity];         ///< [m] W, of the chord, from the joint
  alignas(64) double across[3][kCapacity];                           ///< W, unit, into its kin's part
  alignas(64) double height[kCapacity];                              ///< [m]
  alignas(64) double area[kCapacity], volume[kCapacity];             ///< [m^2], [m^3]
  alignas(64) double area_first[3][kCapacity], first[3][kCapacity];  ///< [m^3], [m^4] W

  template <class Use>
  void for_each_row(const Use& use) {
    for (double* row : {length, radius1, radius2, sine, cosine, side}) use(row);
    for (auto* vector : {axis, a, b, c, joint, x, y, z, ring, from, to}) {
      for (int k = 0; k < 3; ++k) use(vector[k]);
    }
  }
};

}  // namespace lumbrical
