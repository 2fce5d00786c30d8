// Blocks of patches as one (patches.h), and how numbers of patches are put into single precision.
#pragma once

#include <span>

#include "index/patches.h"
#include "model/corners.h"

namespace lumbrical {

/// At least one patch, all with an area.
BlockSamples samples_of(std::span<const Corners> patches);

inline void put(Vec3 v, float (&to)[3]) {
  to[0] = static_cast<float>(v.x);
  to[1] = static_cast<float>(v.y);
  to[2] = static_cast<float>(v.z);
}
inline void put_split(Vec3 p, float (&to)[2][3]) {
  const double at[3] = {p.x, p.y, p.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [high, low] = split_number(at[axis]);
    to[0][axis] = high;
    to[1][axis] = low;
  }
}

}  // namespace lumbrical
