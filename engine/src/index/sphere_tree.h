// Bounding sphere trees: built once over triangles in spatial order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

/// The most levels there are: 2^31 triangles have no more.
inline constexpr std::size_t kTreeLevels = 8;

inline constexpr std::size_t kLinesPerBlock = sizeof(SphereBlock) / sizeof(TreeLine);

/// Where things lie in a tree's lines.
struct TreeLayout {
  std::array<std::size_t, kTreeLevels> blocks{};  ///< of each level
  std::size_t upper = 0;                          ///< blocks of all levels
  std::size_t lowest = 0;                         ///< blocks of triangles' spheres
  std::size_t lines = 0;                          ///< of all
};

inline TreeLayout layout_of(const TreeHead& head) {
  static_assert(SphereBlock::kWidth * sizeof(std::uint32_t) == sizeof(TreeLine));
  TreeLayout layout;
  std::size_t spheres = head.leaf_count;
  for (std::size_t level = 0; level < head.level_count; ++level) {
    spheres = (spheres + SphereBlock::kWidth - 1) / SphereBlock::kWidth;
    layout.blocks[level] = spheres;
    layout.upper += spheres;
  }
  layout.lowest = std::size_t{head.leaf_count} * head.blocks_per_leaf;
  layout.lines = kLinesPerBlock * (layout.upper + layout.lowest) + layout.lowest;
  return layout;
}

/// The levels' blocks, the last level first; behind them the triangles' spheres.
inline const SphereBlock* blocks_of(const TreeLine* lines) {
  return reinterpret_cast<const SphereBlock*>(lines);
}
/// The numbers of the triangles, by the place of their spheres.
inline const std::uint32_t* numbers_of(const TreeLine* lines, const TreeLayout& layout) {
  return reinterpret_cast<const std::uint32_t*>(lines + kLinesPerBlock * (layout.upper + layout.lowest));
}

/// Puts the triangles in order (spatial_order.h), bounds every `leaf_size` of them by a leaf sphere and every
/// sixteen spheres by one above, until sixteen or fewer are left or there are `tree_levels` levels (0: no
/// limit; 1: the leaves alone, a linear scan). On `execution.threads` threads, with the same result for any
/// number of them.
SphereTree build_tree(const Triangles& triangles, const Execution& execution);

/// The same of some of the triangles only, given ascending; reorders `members`.
SphereTree build_tree(const Triangles& triangles, std::vector<std::uint32_t>& members,
                      const Execution& execution);

/// The same in memory of the caller's: `lines` as many as the layout of `head` has, which is a plan. Returns
/// SphereTree::box.
Box build_tree(const Triangles& triangles, std::vector<std::uint32_t>& members, const Execution& execution,
               TreeHead& head, TreeLine* lines);

/// A sphere [m], relative to its tree's origin.
struct Sphere {
  Vec3 centre;
  double radius = 0;
};

/// Puts it in its place among spheres in blocks of sixteen, widened by what rounding may take away.
void put_sphere(const Sphere& sphere, std::size_t place, SphereBlock* blocks);

/// A sphere round spheres, about the middle of their box.
Sphere bound(std::span<const Sphere> spheres);

/// Makes a sphere so large that it holds another.
void hold(const Sphere& other, Sphere& sphere);

/// A tree of levels alone, over leaves that are somebody else's: a search ends at their numbers. `leaves` are
/// in the order of spatial_order.h, `origin` [m, W] is what they are relative to. The spheres of each level
/// hold those of `held`, as far as there are any for it.
SphereTree build_levels(std::vector<Sphere> leaves, std::span<const std::vector<Sphere>> held, Vec3 origin,
                        const Execution& execution);

/// The head of a tree of so many triangles, as far as that depends on nothing else: enough for its layout.
TreeHead plan_tree(std::size_t triangle_count, const Execution& execution);

/// The most spheres of one level, or blocks of triangles, that a search can hit.
std::size_t frontier_capacity(const TreeHead& head);

/// [bytes] a tree takes.
std::size_t byte_count(const SphereTree& tree);

/// Lines whose content is not defined yet.
std::shared_ptr<TreeLine[]> make_lines(std::size_t count);

}  // namespace lumbrical
