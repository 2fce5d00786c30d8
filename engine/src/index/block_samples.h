// Blocks of patches as one (patches.h). What they need to know of their patches adds up, from patches to
// blocks and from blocks to larger ones.
#pragma once

#include <array>
#include <span>

#include "index/patches.h"
#include "model/corners.h"

namespace lumbrical {

/// Integrals over a surface of 1, h and h h, h counted from some origin; of dA or of n dA, twice.
template <class Weight>
struct Moments {
  Weight sum{};
  std::array<Weight, 3> first{};   ///< x y z
  std::array<Weight, 6> second{};  ///< xx yy zz xy xz yz
};

struct BlockMoments {
  Vec3 origin;           ///< [m] W
  Moments<double> area;  ///< [m^2] and on
  Moments<Vec3> normal;  ///< the same
};

/// At least one patch, or block.
BlockMoments moments_of(std::span<const Corners> patches);
BlockMoments moments_of(std::span<const BlockMoments> blocks);

/// [m] W, of the area, or near slivers that in single precision have none.
Vec3 centre_of(const BlockMoments& block);

/// `radius` [m]: of the sphere about the centre that holds the patches. Without the extent.
BlockSamples samples_of(const BlockMoments& block, double radius);

}  // namespace lumbrical
