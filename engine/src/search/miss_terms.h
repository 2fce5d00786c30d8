// Pairs of one primitive, or of a round hull of it, with many triangles, and which of them certainly miss:
// every other pair is a candidate. Structure of arrays.
#pragma once

#include <cstddef>

#include "lumbrical/math.h"

namespace lumbrical {

struct MissTerms {
  static constexpr std::size_t kCapacity = 64;
  static constexpr int kPlaneCapacity = 18;
  struct Plane {
    Vec3 normal;        ///< unit
    double height = 0;  ///< [m] of the plane over end1
  };
  std::size_t count = 0;
  Vec3 end1, axis;                            ///< [m] W: first end; unit vector to the second
  double length = 0;                          ///< [m] between the ends
  double radius1 = 0, radius2 = 0, most = 0;  ///< [m], and the larger of both
  int plane_count = 0;                        ///< half-spaces that bound the primitive as well
  Plane plane[kPlaneCapacity];
  alignas(64) double a[3][kCapacity], b[3][kCapacity], c[3][kCapacity];  ///< [m] W, corners
  alignas(64) double miss[kCapacity];  ///< out: 1 where there is certainly no common area, else 0
};

}  // namespace lumbrical
