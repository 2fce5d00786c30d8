#include "index/patches.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "base/fixed_list.h"
#include "base/parallel.h"
#include "index/block_samples.h"
#include "index/patch_blocks.h"
#include "index/patch_cuts.h"
#include "index/spatial_order.h"
#include "index/sphere_tree.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

// [R] Longest steps of the lattices at a precision of 1e-4 of the hand's force, from the coarsest level to
// the finest, R the mean radius of what is sampled: all segments have the same lattices, so that patches of
// several go through kernels together. Measured: docs/mechanics.md; a user measures his own scene with
// `lumbrical run --compare-precision`. The error falls with the step's fourth power. The first two differ by
// the blocks that are taken as ones (kBlockOnSkin).
constexpr std::array<double, kLevels> kStep = {0.46, 0.46, 0.37, 0.3, 0.245, 0.2, 0.165, 0.132, 0.102};

// R is no less and no more than these shares of a segment's own radius.
constexpr double kThick = 0.5, kThin = 1.5;

// [R] The steps that patches are measured in, at a precision of 1e-4 and at coarser ones: of longer patches
// most would be nowhere near a finger.
constexpr double kSizeStep = 0.16;

// Steps are rounded up to an even number.
static_assert(kPatchSizes * kSizeStep <= (kMostSteps - 2) * kStep[kLevels - 1]);

// How many times finer than a patch is long in those, level by level, lattices are where a skeleton comes
// near.
constexpr std::array<double, kLevels> kNearSkeleton = {1, 1, 1, 1.25, 1.25, 1.5, 1.75, 1.75, 2};
static_assert(kStep[0] == kStep[1] && kNearSkeleton[0] == kNearSkeleton[1]);

// Patches of smaller sizes have the last of these on every level: theirs cost less than a second look would.
constexpr std::size_t kLeastSizeWithLevels = 4;

// [R] Largest radius of a block that is taken as one at a precision of 1e-4; the error falls with its third
// power.
constexpr double kBlockRadius = 0.3;

// The same above the palm's polygon, where its field is linear and forces exact whatever the size, and beside
// it, where its curvature jumps.
constexpr double kBlockAbovePalm = 2, kBlockBesidePalm = 0.25;

// [R] The same where a body's skin goes through, by level: the error falls with the size's fifth power or so,
// and with the hand's force.
constexpr std::array<double, kLevels> kBlockOnSkin = {0.24, 0.21, 0.17, 0.14, 0.12, 0.1, 0.087, 0.073, 0.06};

// A triangle that comes to about 2^20 patches or more is cut where it is touched (Patches::large).
constexpr std::size_t kMostDoublings = 20;

// About so many patches there may be beside one per triangle, or as many as there are triangles: some 80 MB.
constexpr std::size_t kSparePatches = std::size_t{1} << 19;

constexpr std::size_t kPatchPiece = 4096;  // triangles or patches, the least that is worth another thread

// By Newton's method, since the C library's differs between machines.
double cube_root(double x) {
  double root = max(x, 1);
  for (int i = 0; i < 60; ++i) root = (2 * root + x / (root * root)) / 3;
  return root;
}

double radius_of(const Hand& hand, std::size_t segment) {
  if (segment == kPalmSegment) return 0.5 * hand.palm.thickness;
  const auto [base, tip] = kPhalanxJoints[segment];
  return min(hand.radius[base], hand.radius[tip]);
}

std::uint32_t sampled_segments(const Settings& settings) {
  constexpr std::uint32_t kOfFinger = kPhalanxCount / kFingerCount, kFinger = (1u << kOfFinger) - 1;
  std::uint32_t segments = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    segments |= std::uint32_t{settings.law[i] == Law::field && settings.precision[i] > 0} << i;
  for (std::uint32_t first = 0; first < kPhalanxCount; first += kOfFinger) {
    if ((segments >> first & kFinger) != kFinger) segments &= ~(kFinger << first);
  }
  return segments;
}

double mean_radius(const Hand& hand, std::uint32_t segments) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if ((segments >> i & 1u) == 0) continue;
    sum += radius_of(hand, i);
    ++count;
  }
  return sum / count;
}

// [m] R, at a precision of 1e-4, as long as a segment's precision makes it.
double step_unit(const Hand& hand, const Settings& settings, std::size_t segment, double mean) {
  const double own = radius_of(hand, segment);
  return std::sqrt(std::sqrt(settings.precision[segment] / 1e-4)) * clamp(mean, kThick * own, kThin * own);
}

double block_radius_of(const Hand& hand, const Settings& settings, std::size_t segment, double share) {
  return share * cube_root(settings.precision[segment] / 1e-4) * radius_of(hand, segment);
}

void take_most(const LatticeSteps& steps, LatticeSteps& most) {
  for (std::size_t level = 0; level < steps.size(); ++level)
    most[level] = std::max(most[level], steps[level]);
}

bool has_area(const Corners& at) {
  const double area = norm(cross(at.b - at.a, at.c - at.a));
  return area > 0 && is_finite(area);
}

/// What becomes of the triangles.
struct Cutting {
  double step = 0;                   // [m] the least that any segment measures patches in
  std::vector<std::uint32_t> owner;  // of each patch
  std::vector<PatchPath> path;       // to it, of each patch
};

// How often one has to be doubled to come to so many patches.
std::size_t doublings(double patches) {
  const double most = std::ldexp(1.0, kMostDoublings);
  return static_cast<std::size_t>(std::bit_width(static_cast<std::uint32_t>(min(patches, most)))) - 1;
}

/// Triangles are cut that come to less than so many doublings, into about so many patches.
struct CutLimit {
  std::size_t doublings = 0, patches = 0;
};

// The highest one for whose patches there is room.
CutLimit cut_limit(const Triangles& triangles, double step, std::size_t threads) {
  std::array<std::atomic<std::uint64_t>, kMostDoublings> total{};  // patches of triangles by doublings
  parallel_pieces(triangles.size(), kPatchPiece, threads,
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    std::array<std::uint64_t, kMostDoublings> count{};
                    for (std::size_t i = first; i < last; ++i) {
                      const Corners at = corners_of(triangles, static_cast<std::uint32_t>(i));
                      if (!has_area(at)) continue;
                      const double patches = expected_patches(at, step);
                      const std::size_t power = doublings(patches);
                      if (power < kMostDoublings) count[power] += static_cast<std::uint64_t>(patches);
                    }
                    for (std::size_t k = 0; k < kMostDoublings; ++k) total[k] += count[k];
                  });
  const std::size_t room = triangles.size() + std::max(kSparePatches, triangles.size());
  CutLimit limit;
  while (limit.doublings < kMostDoublings && limit.patches + total[limit.doublings] <= room)
    limit.patches += total[limit.doublings++];
  return limit;
}

// The largest triangles are left where patches would take too much memory.
Cutting cut_triangles(const Triangles& triangles, double step, const Execution& execution, Patches& patches) {
  Cutting cutting;
  cutting.step = step;
  const CutLimit limit = cut_limit(triangles, step, execution.threads);
  cutting.owner.reserve(limit.patches);
  cutting.path.reserve(limit.patches);
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Corners at = corners_of(triangles, i);
    if (!has_area(at)) continue;
    if (doublings(expected_patches(at, step)) >= limit.doublings) {
      patches.large.push_back(i);
      continue;
    }
    cut_triangle(at, step, cutting.path);
    cutting.owner.resize(cutting.path.size(), i);
  }
  return cutting;
}

void put_large(const Triangles& triangles, const Execution& execution, Patches& patches) {
  std::vector<std::uint32_t> members = patches.large;
  if (!members.empty()) patches.large_tree = build_tree(triangles, members, execution);
}

Corners patch_at(const Triangles& triangles, const Cutting& cutting, std::uint32_t number) {
  return part_at(corners_of(triangles, cutting.owner[number]), cutting.step, cutting.path[number]);
}

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
  for (double& radius : patches.block_on_skin) {
    const auto small = std::count_if(lowest.begin(), lowest.end(),
                                     [&](const BlockSamples& block) { return double{block.size} <= radius; });
    if (3 * static_cast<std::size_t>(small) < 2 * lowest.size() || small == 0) radius = 0;
  }
}

// Blocks as ones, and blocks of those, level by level, as long as a segment may take one.
void put_samples(const Execution& execution, Patches& patches) {
  const double largest = max(patches.block_above_palm,
                             *std::max_element(patches.block_radius.begin(), patches.block_radius.end()));
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
    patches.has_wholes = patches.has_wholes || is_used;
    patches.first_samples.push_back(static_cast<std::uint32_t>(first));
    patches.least_size.push_back(least);
    if (count <= 1) break;
    std::swap(below, here);
  }
  leave_few_on_skin(samples, patches);
  patches.samples = std::move(samples);
}

// A block that is taken as one where its sphere meets a body has to be found there: round those that may be,
// spheres for each level of the tree; less than nothing where there are none.
std::vector<std::vector<Sphere>> spheres_on_skin(const Patches& patches, Vec3 origin) {
  const Sphere nothing{{}, -std::numeric_limits<double>::infinity()};
  const double largest = patches.block_on_skin[0];
  std::vector<std::vector<Sphere>> spheres;
  for (std::size_t level = 0; largest > 0 && level < patches.first_samples.size(); ++level) {
    const auto blocks = samples_of_level(patches, level);
    const std::size_t width = level % 2 == 0 ? 1 : kBlocksInLarger;  // as many have a sphere of the tree
    if (width > 1 || level == 0) spheres.emplace_back(piece_count(blocks.size(), width), nothing);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (double{blocks[i].size} > largest) continue;
      const Sphere own{point_of(blocks[i].centre) - origin, double{blocks[i].radius}};
      Sphere& round = spheres.back()[i / width];
      if (round.radius < 0) round = own;
      hold(own, round);
    }
  }
  return spheres;
}

void put_blocks(const Triangles& triangles, const Box& box, const Cutting& cutting,
                const Execution& execution, Patches& patches) {
  constexpr std::uint32_t kWidth = PatchBlock::kWidth;
  const Vec3 origin = box.middle();
  std::vector<std::uint32_t> order(cutting.owner.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const Box within{box.lower - origin, box.upper - origin};
  order_in_space(order, within, kWidth, execution.threads, [&](std::uint32_t number) {
    return sphere_round(patch_at(triangles, cutting, number), origin).centre;
  });
  std::vector<PatchBlock> blocks(piece_count(order.size(), kWidth));
  std::vector<PatchShape> shapes(blocks.size() * kWidth);
  std::vector<Sphere> leaves(blocks.size());
  parallel_pieces(blocks.size(), kPatchPiece / kWidth, execution.threads,
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    for (std::size_t i = first; i < last; ++i) {
                      const std::size_t begin = i * kWidth, end = std::min(begin + kWidth, order.size());
                      FixedList<Corners, kWidth> members;
                      for (std::size_t k = begin; k < end; ++k)
                        members.push_back(patch_at(triangles, cutting, order[k]));
                      leaves[i] = put_block({members.begin(), members.size()}, cutting.step, origin,
                                            blocks[i], shapes.data() + begin);
                    }
                  });
  patches.block = std::move(blocks);
  patches.shape = std::move(shapes);
  put_samples(execution, patches);
  patches.tree = build_levels(std::move(leaves), spheres_on_skin(patches, origin), origin, execution);
}

}  // namespace

std::shared_ptr<const Patches> build_patches(const Hand& hand, const Settings& settings,
                                             const Triangles& triangles, const Box& extent,
                                             const Execution& execution) {
  const std::uint32_t segments = sampled_segments(settings);
  if (segments == 0) return nullptr;
  const double mean = mean_radius(hand, segments);
  double least = std::numeric_limits<double>::infinity(), finest = least;
  std::array<double, kSegmentCount> unit{};
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if ((segments >> i & 1u) == 0) continue;
    unit[i] = step_unit(hand, settings, i, mean);
    least = min(least, kSizeStep * min(unit[i], mean));
    finest = min(finest, std::sqrt(std::sqrt(settings.precision[i] / 1e-4)));
  }
  auto patches = std::make_shared<Patches>();
  patches->segments = segments;
  double radius3 = 0, sampled = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if ((segments >> i & 1u) == 0) continue;
    const double radius = radius_of(hand, i);
    radius3 += radius * radius * radius;
    const bool is_palm = i == kPalmSegment;
    patches->block_radius[i] = block_radius_of(hand, settings, i, is_palm ? kBlockBesidePalm : kBlockRadius);
    if (is_palm) patches->block_above_palm = block_radius_of(hand, settings, i, kBlockAbovePalm);
    ++sampled;
    for (std::size_t k = 0; k < kPatchSizes; ++k) {
      const double size = least * static_cast<double>(k + 1);
      LatticeSteps& steps = patches->steps[i][k];
      for (std::size_t level = 0; level < kLevels; ++level)
        steps[level] = steps_for(size / (kStep[level] * unit[i]));
      steps[kOneCell] = 1;
      patches->has_levels[k] = patches->has_levels[k] || steps[0] != steps[kLevels - 1];
      LatticeSteps& near = patches->steps[i][kPatchSizes + k];
      const bool has_levels = k >= kLeastSizeWithLevels;
      const std::uint8_t own_size = steps_for(size / (kSizeStep * unit[i]));
      for (std::size_t level = 0; level < kLevels; ++level)
        near[level] = steps_for(kNearSkeleton[has_levels ? level : kLevels - 1] * own_size);
      near[kOneCell] = 1;
      patches->has_levels[kPatchSizes + k] = has_levels;
      for (const std::size_t patch_class : {k, kPatchSizes + k})
        take_most(patches->steps[i][patch_class], patches->most_steps[patch_class]);
    }
  }
  patches->radius3 = radius3 / sampled;
  for (std::size_t level = 0; level < kLevels; ++level)
    patches->block_on_skin[level] = kBlockOnSkin[level] * finest * mean;
  patches->step = least;
  const Cutting cutting = cut_triangles(triangles, least, execution, *patches);
  put_large(triangles, execution, *patches);
  put_blocks(triangles, extent, cutting, execution, *patches);
  return patches;
}

}  // namespace lumbrical
