// Terms of the field law's integral: what the narrowphase hands to the SIMD kernels, structure of arrays.
//
// The field of a sphere or capsule is made of three discs (field_batch.cpp): every edge of a triangle,
// clipped to one of them, is a term, and a pair's integral is the sum of its terms. Terms know nothing of
// each other, so they are computed in lanes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lumbrical {

/// Terms, or inside triangles, per kernel call; a multiple of every lane count.
inline constexpr std::size_t kTermCapacity = 256;

/// A directed line segment against a disc. Plane coordinates (x, y) [m] of the triangle's plane with origin
/// under the primitive's first end; disc coordinates are (scale x + shift, y).
template <class T>
struct DiscTerms {
  std::size_t count = 0;
  alignas(64) T x1[kTermCapacity], y1[kTermCapacity];  ///< [m] from
  alignas(64) T x2[kTermCapacity], y2[kTermCapacity];  ///< [m] to; the region is on the left
  alignas(64) T scale[kTermCapacity], shift[kTermCapacity], per_scale[kTermCapacity];  ///< 1 / scale
  alignas(64) T radius[kTermCapacity];    ///< [m] R of the field phi = R - sqrt(r^2 + height^2)
  alignas(64) T height[kTermCapacity];    ///< [m] >= 0, below R
  alignas(64) T h1[kTermCapacity];        ///< [m] height of the first end over the plane, for the depth
  alignas(64) T span[kTermCapacity];      ///< [m] x of the second end
  alignas(64) T rise[kTermCapacity];      ///< [m] >= 0, height of the second end over the first
  alignas(64) T cosine[kTermCapacity];    ///< of the angle between axis and normal, >= 0
  alignas(64) T per_span[kTermCapacity];  ///< [1/m] 1 / span, 0 without one
  std::uint16_t pair[kTermCapacity];      ///< which pair of the chunk it belongs to

  alignas(64) T area[kTermCapacity];                               ///< [m^2]
  alignas(64) T area_x[kTermCapacity], area_y[kTermCapacity];      ///< [m^3] first moments of the area
  alignas(64) T volume[kTermCapacity];                             ///< [m^3] of phi
  alignas(64) T volume_x[kTermCapacity], volume_y[kTermCapacity];  ///< [m^4] first moments of phi
  alignas(64) T depth[kTermCapacity];  ///< [m] the largest along the segment's part inside the section
};

}  // namespace lumbrical
