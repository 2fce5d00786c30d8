// Pairs of the palm with many triangles under the field law: what the narrowphase hands to the SIMD kernel
// and what it gets back. Structure of arrays; a pair is a lane.
#pragma once

#include <cstddef>

#include "model/primitive.h"

namespace lumbrical {

struct PrismTerms {
  static constexpr std::size_t kCapacity = 64;
  std::size_t count = 0;

  // The faces, the palmar one first: dot(normal, p - origin) <= offset inside. W, unit; [m].
  int face_count = 0;
  double normal[Prism::kMaxFaces][3], offset[Prism::kMaxFaces];

  alignas(64) double a[3][kCapacity], b[3][kCapacity],
      c[3][kCapacity];  ///< [m] W, corners relative to the origin

  // Results; only where `simple` is 1: the triangle lies wholly inside, and behind all of it the same face is
  // the first one along -n.
  alignas(64) double simple[kCapacity];
  alignas(64) double area[kCapacity];          ///< [m^2]
  alignas(64) double volume[kCapacity];        ///< [m^3] integral of the depth below the palmar face
  alignas(64) double depth[kCapacity];         ///< [m] dl_max
  alignas(64) double direction[3][kCapacity];  ///< W, unit: the normal
  alignas(64) double centroid[3][kCapacity], centre[3][kCapacity];  ///< [m] of the area, of the depth
};

}  // namespace lumbrical
