#include "index/patches.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

#include "base/fixed_list.h"
#include "base/parallel.h"
#include "index/block_levels.h"
#include "index/patch_blocks.h"
#include "index/patch_cuts.h"
#include "index/spatial_order.h"
#include "index/sphere_tree.h"
#include "index/triangle_bound.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

// A triangle that comes to about 2^20 patches or more is cut where it is touched (Patches::large).
constexpr std::size_t kMostDoublings = 20;

// About so many patches there may be beside one per triangle, or as many as there are triangles: some 80 MB.
constexpr std::size_t kSparePatches = std::size_t{1} << 19;

/// What becomes of the triangles.
struct Cutting {
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
Cutting cut_triangles(const Triangles& triangles, const Execution& execution, Patches& patches) {
  Cutting cutting;
  const double step = patches.rules.step;
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

Corners patch_at(const Triangles& triangles, const Cutting& cutting, double step, std::uint32_t number) {
  return part_at(corners_of(triangles, cutting.owner[number]), step, cutting.path[number]);
}

void put_blocks(const Triangles& triangles, const Box& box, const Cutting& cutting,
                const Execution& execution, Patches& patches) {
  constexpr std::uint32_t kWidth = PatchBlock::kWidth;
  const Vec3 origin = box.middle();
  const double step = patches.rules.step;
  std::vector<std::uint32_t> order(cutting.owner.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const Box within{box.lower - origin, box.upper - origin};
  order_in_space(order, within, kWidth, execution.threads, [&](std::uint32_t number) {
    return sphere_round(patch_at(triangles, cutting, step, number), origin).centre;
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
                        members.push_back(patch_at(triangles, cutting, step, order[k]));
                      leaves[i] = put_block(members, step, origin, blocks[i], shapes.data() + begin);
                    }
                  });
  patches.block = std::move(blocks);
  patches.shape = std::move(shapes);
  put_block_levels(execution, patches);
  patches.tree = build_levels(std::move(leaves), spheres_on_skin(patches, origin), origin, execution);
}

}  // namespace

std::shared_ptr<const Patches> build_patches(const Hand& hand, const Settings& settings,
                                             const Triangles& triangles, const Box& extent,
                                             const Execution& execution) {
  const PatchRules rules = patch_rules(hand, settings);
  if (rules.segments == 0) return nullptr;
  auto patches = std::make_shared<Patches>();
  patches->rules = rules;
  // What is a block, which are taken as ones and in which order they are summed all go by the trees: so these
  // are always built alike.
  Execution own;
  own.threads = execution.threads;
  const Cutting cutting = cut_triangles(triangles, own, *patches);
  put_large(triangles, own, *patches);
  put_blocks(triangles, extent, cutting, own, *patches);
  return patches;
}

}  // namespace lumbrical
