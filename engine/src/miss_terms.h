// Pairs of one round primitive with many triangles, and which of them certainly miss: what the narrowphase
// asks the SIMD kernels before it looks closer. Structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lumbrical/math.h"

namespace lumbrical {

struct MissTerms {
  static constexpr std::size_t kCapacity = 64;
  std::size_t count = 0;
  Vec3 end1, axis;                            ///< [m] W: first end; unit vector to the second
  double length = 0;                          ///< [m] between the ends
  double radius1 = 0, radius2 = 0, most = 0;  ///< [m], and the larger of both
  alignas(64) double a[3][kCapacity], b[3][kCapacity], c[3][kCapacity];  ///< [m] W, corners
  alignas(64) double miss[kCapacity];  ///< out: 1 where there is certainly no common area, else 0
};

}  // namespace lumbrical
