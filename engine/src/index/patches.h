// The world as the rungs of samples see it: its triangles, the larger ones cut into patches, each with a
// fixed lattice of sample points (lattice.h). What is cut how finely depends on the mesh, the hand's radii
// and the precision asked for, never on a pose.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "index/patch_rules.h"
#include "index/split_point.h"
#include "lumbrical/model.h"

namespace lumbrical {

/// Share of their radii by which patches, blocks and bodies are taken to be nearer than they are: as much as
/// single precision may move a distance, generously. Searches allow for it too, or would find less than there
/// is.
inline constexpr double kDistanceSlack = 1e-5;

/// Sixteen patches that lie side by side, as far as classification asks.
struct alignas(64) PatchBlock {
  static constexpr std::uint32_t kWidth = 16;
  float centroid[2][3][kWidth];  ///< [m] W: rounded, and what rounding left out
  float radius[kWidth];          ///< [m] of the sphere about it; negative: an empty place
  float normal[3][kWidth];       ///< twice the integral of n dA, over the square of that radius
  float size[kWidth];            ///< what kPatchSizes counts (patch_rules.h)
};

/// A patch, as kernels want it.
struct PatchShape {
  SplitPoint corner;  ///< [m] W, the first
  float edge[2][3];   ///< [m] from it to the second and to the third
};

/// So many neighbouring blocks are a larger one; a sphere of the tree is round every second level of those.
inline constexpr std::size_t kBlocksInLarger = 4;
static_assert(kBlocksInLarger * kBlocksInLarger == SphereBlock::kWidth);

/// A block as one, for a body it lies inside of: samples of the field at its centre and to both sides of it
/// along three arms, with vectors for weights, so chosen that fields of second degree are integrated as the
/// patches themselves would be.
struct BlockSamples {
  SplitPoint centre;  ///< [m] W
  float radius;       ///< [m] of the sphere about it that holds patches and samples
  float size;         ///< [m] how far patches are from the centre, and more where they face different ways
  float normal[3];    ///< [m^2] twice the integral of n dA
  float arm[3][3];    ///< [m]
  float extent[3];    ///< how many arms far patches and samples are from the centre, to either side
  float weight[2][3][3];   ///< [m^2] of the samples at centre + arm and - arm: twice the share of n dA
  float centre_weight[3];  ///< [m^2]
};

struct Patches {
  PatchRules rules;
  SphereTree tree;                           ///< of spheres round the blocks, without triangles
  SharedArray<PatchBlock> block;             ///< in the order of the tree's leaves
  SharedArray<PatchShape> shape;             ///< of each patch, sixteen to a block
  SharedArray<BlockSamples> samples;         ///< of each block, of each larger one, and so on
  std::vector<std::uint32_t> first_samples;  ///< of each of these levels
  std::vector<float> least_size;             ///< [m] of each level's blocks
  std::vector<std::uint32_t> large;  ///< triangles that are cut where a hand comes near (cut_patches.h)
  SphereTree large_tree;             ///< of those
};

/// The patches of a world of that extent for a hand; null where no segment is felt by samples. On
/// `execution.threads` threads, with the same result for any number of them; of `execution` nothing else
/// counts.
std::shared_ptr<const Patches> build_patches(const Hand& hand, const Settings& settings,
                                             const Triangles& triangles, const Box& extent,
                                             const Execution& execution);

/// The blocks of a level as ones.
inline std::span<const BlockSamples> samples_of_level(const Patches& patches, std::size_t level) {
  const std::size_t first = patches.first_samples[level];
  const std::size_t end =
      level + 1 < patches.first_samples.size() ? patches.first_samples[level + 1] : patches.samples.size();
  return {patches.samples.data() + first, end - first};
}

}  // namespace lumbrical
