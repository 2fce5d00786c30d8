#include "index/block_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/fixed_list.h"
#include "base/parallel.h"
#include "index/block_samples.h"
#include "index/patch_blocks.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

Corners corners_of(const PatchShape& shape) {
  const Vec3 a = point_of(shape.corner);
  return {a, a + vec3_of(shape.edge[0]), a + vec3_of(shape.edge[1])};
}

// Calls take(corners) for the patches of blocks `first` to `last`.
template <class Take>
void for_patches(const Patches& patches, std::size_t first, std::size_t last, const Take& take) {
  for (std::size_t i = first; i < std::min(last, patches.block.size()); ++i) {
    for (std::size_t lane = 0; lane < PatchBlock::kWidth; ++lane) {
      if (patches.block[i].radius[lane] >= 0) take(corners_of(patches.shape[i * PatchBlock::kWidth + lane]));
    }
  }
}

BlockMoments moments_of_block(const Patches& patches, std::size_t block) {
  FixedList<Corners, PatchBlock::kWidth> members;
  for_patches(patches, block, block + 1, [&](const Corners& at) { members.push_back(at); });
  return moments_of(std::span<const Corners>(members.begin(), members.end()));
}

// Of `width` blocks of patches from `first` on as one.
BlockSamples samples_of_blocks(const Patches& patches, const BlockMoments& moments, std::size_t first,
                               std::size_t width) {
  const Vec3 centre = centre_of(moments);
  const auto for_corners = [&](const auto& take) {
    for_patches(patches, first, first + width, [&](const Corners& at) {
      for (const Vec3 corner : {at.a, at.b, at.c}) take(corner - centre);
    });
  };
  double square = 0;
  for_corners([&](Vec3 from) { square = max(square, dot(from, from)); });
  BlockSamples samples = samples_of(moments, std::sqrt(square));
  const Vec3 arm[3] = {vec3_of(samples.arm[0]), vec3_of(samples.arm[1]), vec3_of(samples.arm[2])};
  double most[3] = {};
  for_corners([&](Vec3 from) {
    for (std::size_t k = 0; k < 3; ++k) most[k] = max(most[k], std::fabs(dot(from, arm[k])));
  });
  // The rectangle of the first two arms may have corners that no patch reaches.
  for (std::size_t k = 0; k < 3; ++k) {
    const double square_arm = dot(arm[k], arm[k]);
    samples.extent[k] = square_arm > 0 ? static_cast<float>((1 + 1e-5) * max(1, most[k] / square_arm)) : 0;
  }
  samples.radius = std::max(samples.radius, static_cast<float>((1 + 1e-6) * norm(arm[0] + arm[1])));
  return samples;
}

// Blocks are taken as ones on the skin where two thirds of them are as small as they may be: finer levels
// have to open what coarser ones take, so it must pay.
void leave_few_on_skin(std::span<const BlockSamples> samples, Patches& patches) {
  const auto lowest = samples.first(patches.block.size());
  for (double& radius : patches.rules.block_on_skin) {
    const auto small = std::count_if(lowest.begin(), lowest.end(),
                                     [&](const BlockSamples& block) { return double{block.size} <= radius; });
    if (3 * static_cast<std::size_t>(small) < 2 * lowest.size() || small == 0) radius = 0;
  }
}

}  // namespace

void put_block_levels(const Execution& execution, Patches& patches) {
  const double largest =
      max(patches.rules.block_above_palm,
          *std::max_element(patches.rules.block_size.begin(), patches.rules.block_size.end()));
  std::vector<BlockSamples> samples;
  std::vector<BlockMoments> below, here;
  for (std::size_t width = 1;; width *= kBlocksInLarger) {  // in blocks of patches
    const std::size_t first = samples.size(), count = piece_count(patches.block.size(), width);
    samples.resize(first + count);
    here.resize(count);
    const std::size_t piece = std::max<std::size_t>(1, kPatchPiece / (width * PatchBlock::kWidth));
    parallel_pieces(count, piece, execution.threads, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t members = i * kBlocksInLarger;
        here[i] = below.empty() ? moments_of_block(patches, i)
                                : moments_of(std::span<const BlockMoments>(below).subspan(
                                      members, std::min(kBlocksInLarger, below.size() - members)));
        samples[first + i] = samples_of_blocks(patches, here[i], i * width, width);
      }
    });
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t i = first; i < samples.size(); ++i) least = std::min(least, samples[i].size);
    const bool is_used = double{least} <= largest;
    if (!is_used && !patches.first_samples.empty()) {
      samples.resize(first);
      break;
    }
    patches.first_samples.push_back(static_cast<std::uint32_t>(first));
    patches.least_size.push_back(least);
    if (count <= 1) break;
    std::swap(below, here);
  }
  leave_few_on_skin(samples, patches);
  patches.samples = std::move(samples);
}

std::vector<std::vector<Sphere>> spheres_on_skin(const Patches& patches, Vec3 origin) {
  const Sphere nothing{{}, -std::numeric_limits<double>::infinity()};
  const double largest = patches.rules.block_on_skin[0];
  std::vector<std::vector<Sphere>> spheres;
  for (std::size_t level = 0; largest > 0 && level < patches.first_samples.size(); ++level) {
    const auto blocks = samples_of_level(patches, level);
    const std::size_t width = level % 2 == 0 ? 1 : kBlocksInLarger;  // as many have a sphere of the tree
    if (width > 1 || level == 0) spheres.emplace_back(piece_count(blocks.size(), width), nothing);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (double{blocks[i].size} > largest) continue;
      const Sphere own{point_of(blocks[i].centre) - origin, (1 + kDistanceSlack) * double{blocks[i].radius}};
      Sphere& round = spheres.back()[i / width];
      if (round.radius < 0) round = own;
      hold(own, round);
    }
  }
  return spheres;
}

}  // namespace lumbrical
