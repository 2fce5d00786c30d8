// The world as the rungs of samples see it: its triangles, the larger ones cut into patches, each with a
// fixed lattice of sample points (lattice.h). What is cut how finely depends on the mesh, the hand's radii
// and the precision asked for, never on a pose.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "index/split_point.h"
#include "lumbrical/model.h"

namespace lumbrical {

/// A patch's size is one less than how many steps of a length of their own it is long, rounded up. Its class
/// is that, or by kPatchSizes more where a body's skeleton comes near (an axis, a centre, the palm's
/// polygon): there its field has a kink.
inline constexpr std::size_t kPatchSizes = 7, kPatchClasses = 2 * kPatchSizes;

/// The lattice with most steps: twice as many as a patch is long, where a skeleton comes near.
inline constexpr std::size_t kMostSteps = 2 * kPatchSizes;

/// Lattices of so many steps, whose number is even then, are gone through quarter by quarter of a patch, side
/// by side: where they are that fine, patches are few.
inline constexpr std::size_t kLeastStepsInQuarters = 8, kMostStepsAtOnce = kMostSteps / 2;
constexpr bool is_in_quarters(std::size_t steps) { return steps >= kLeastStepsInQuarters; }

/// Lattices from coarse to fine. How fine the one is by which a hand is felt depends on its force
/// (samples/levels.h).
inline constexpr std::size_t kLevels = 9;
/// Steps by level and, behind them, 1: one cell a patch, for a tick that must not take longer.
inline constexpr std::size_t kOneCell = kLevels;
using LatticeSteps = std::array<std::uint8_t, kLevels + 1>;

/// Sixteen patches that lie side by side, as far as classification asks.
struct alignas(64) PatchBlock {
  static constexpr std::uint32_t kWidth = 16;
  float centroid[2][3][kWidth];  ///< [m] W: rounded, and what rounding left out
  float radius[kWidth];          ///< [m] of the sphere about it; negative: an empty place
  float normal[3][kWidth];       ///< twice the integral of n dA, over the square of that radius
  float size[kWidth];            ///< kPatchSizes, above
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
  /// Felt by samples, a bit each: the palm and fingers of which every segment follows the field law with a
  /// precision above 0. A finger's segments share out space, which one rung has to do for all of them.
  std::uint32_t segments = 0;
  /// Steps of the lattices that a hand segment has in a patch of a class.
  std::array<std::array<LatticeSteps, kPatchClasses>, kSegmentCount> steps{};
  std::array<LatticeSteps, kPatchClasses> most_steps{};  ///< that any segment has
  std::array<bool, kPatchClasses> has_levels{};          ///< or do each segment's lattices agree?
  /// [m] Largest radius of a block that a segment takes as one.
  std::array<double, kSegmentCount> block_radius{};
  double block_above_palm = 0;  ///< [m] the same of the palm above its polygon
  /// [m] The same of blocks that a body's skin goes through, by level; 0 where the world has few as small.
  std::array<double, kLevels> block_on_skin{};
  bool has_wholes = false;                   ///< may any block be taken as one?
  double radius3 = 0;                        ///< [m^3] mean of the sampled segments' radii cubed
  SphereTree tree;                           ///< of spheres round the blocks, without triangles
  SharedArray<PatchBlock> block;             ///< in the order of the tree's leaves
  SharedArray<PatchShape> shape;             ///< of each patch, sixteen to a block
  SharedArray<BlockSamples> samples;         ///< of each block, of each larger one, and so on
  std::vector<std::uint32_t> first_samples;  ///< of each of these levels
  std::vector<float> least_size;             ///< [m] of each level's blocks
  double step = 0;                           ///< [m] that patches are measured in (patch_cuts.h)
  std::vector<std::uint32_t> large;  ///< triangles that are cut where they are touched (cut_patches.h)
  SphereTree large_tree;             ///< of those
};

/// The patches of a world of that extent for a hand; null where no segment is felt by samples. On
/// `execution.threads` threads, with the same result for any number of them.
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
