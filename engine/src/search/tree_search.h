// The search of a sphere tree: breadth first, sixteen spheres at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "exact/exact_kernels.h"
#include "index/sphere_tree.h"
#include "model/primitive.h"

namespace lumbrical {

/// Share by which single precision may move a coordinate of a query, generously.
inline constexpr double kFloatSlack = 1.6e-6;

/// Does the sphere round the whole tree reach the primitive's hull? In doubt yes.
bool may_reach(const TreeHead& tree, const Primitive& primitive);

/// The same of the box round all spheres: tighter where a world is flat.
bool may_reach(const SphereTree& tree, const Primitive& primitive);

/// The primitive's hull, from the tree's origin.
SphereQuery query_of(const TreeHead& tree, const Primitive& primitive);

/// Blocks of triangles' spheres under leaf spheres that may meet the query; none that does is left out.
/// `frontier` is working memory, each of frontier_capacity(tree), and holds the answer. A tree is searched
/// from its last level down.
std::span<const std::uint32_t> search_leaves(const TreeHead& tree, const TreeLayout& layout,
                                             const TreeLine* lines, const SphereQuery& query,
                                             const ExactKernels& kernels,
                                             std::array<std::vector<std::uint32_t>, 2>& frontier);

}  // namespace lumbrical
