// A primitive as sphere trees see it: a thick segment in single precision, widened for its rounding.
#pragma once

namespace lumbrical {

struct SphereQuery {
  float x, y, z;     ///< [m] first end, relative to the tree's origin
  float dx, dy, dz;  ///< [m] from it to the second
  float inverse;     ///< [1/m^2] 1 / |d|^2; 0 where both ends are one
  float reach;       ///< [m] the segment's thickness and what rounding may take away
};

}  // namespace lumbrical
