#include "search/tree_search.h"

#include <utility>

#include "base/share_along.h"

namespace lumbrical {
namespace {

// Shorter axes are taken for points; that much is added to the reach.
constexpr double kShortest = 1e-15;

// [m] From the segment between the ends, the first of which is at `from`.
double reach_of(Vec3 from, Vec3 axis, const Primitive& primitive) {
  const double size = largest_of(from) + norm(axis);
  return 1.00001 * max(primitive.radius1, primitive.radius2) + kFloatSlack * size + kShortest;
}

}  // namespace

bool may_reach(const TreeHead& tree, const Primitive& primitive) {
  const Vec3 axis = primitive.end2 - primitive.end1, from = tree.centre - (primitive.end1 - tree.origin);
  const Vec3 gap = from - share_along(axis, from) * axis;
  const double reach = (1 + 1e-6) * (max(primitive.radius1, primitive.radius2) + tree.radius);
  return dot(gap, gap) <= reach * reach;
}

bool may_reach(const SphereTree& tree, const Primitive& primitive) {
  const Vec3 end1 = primitive.end1 - tree.head.origin, end2 = primitive.end2 - tree.head.origin;
  const double reach = reach_of(end1, end2 - end1, primitive);
  Box hull;
  hull.add(end1, reach);
  hull.add(end2, reach);
  return hull.meets(tree.box);
}

SphereQuery query_of(const TreeHead& tree, const Primitive& primitive) {
  const Vec3 from = primitive.end1 - tree.origin, axis = primitive.end2 - primitive.end1;
  const double square = dot(axis, axis);
  return {static_cast<float>(from.x),
          static_cast<float>(from.y),
          static_cast<float>(from.z),
          static_cast<float>(axis.x),
          static_cast<float>(axis.y),
          static_cast<float>(axis.z),
          static_cast<float>(square > kShortest * kShortest ? 1 / square : 0),
          static_cast<float>(reach_of(from, axis, primitive))};
}

std::span<const std::uint32_t> search_leaves(const TreeHead& tree, const TreeLayout& layout,
                                             const TreeLine* lines, const SphereQuery& query,
                                             const ExactKernels& kernels,
                                             std::array<std::vector<std::uint32_t>, 2>& frontier) {
  if (tree.level_count == 0) return {};
  std::size_t level = tree.level_count;
  std::size_t count = layout.blocks[level - 1];
  for (std::size_t block = 0; block < count; ++block) frontier[0][block] = static_cast<std::uint32_t>(block);
  // A sphere that was hit is the bound of the block of the same number one level down.
  for (const SphereBlock* blocks = blocks_of(lines); level-- > 0; blocks += layout.blocks[level]) {
    count = kernels.sphere_hits(blocks, query, frontier[0].data(), count, frontier[1].data());
    std::swap(frontier[0], frontier[1]);
  }
  if (tree.blocks_per_leaf == 1) return {frontier[0].data(), count};
  std::size_t block_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::uint32_t k = 0; k < tree.blocks_per_leaf; ++k)
      frontier[1][block_count++] = frontier[0][i] * tree.blocks_per_leaf + k;
  }
  std::swap(frontier[0], frontier[1]);
  return {frontier[0].data(), block_count};
}

}  // namespace lumbrical
