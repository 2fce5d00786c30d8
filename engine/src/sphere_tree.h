// Bounding sphere tree: built once, traversed breadth first, eight spheres at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "primitive.h"

namespace lumbrical {

/// Sorts the triangles along a Morton curve, bounds every `leaf_size` of them (their bound_triangle spheres)
/// by a leaf sphere and every eight spheres by one above, until eight or fewer are left or there are `levels`
/// levels (0: no limit; 1: the leaves alone, a linear scan).
SphereTree build_tree(const Triangles& triangles, std::uint32_t leaf_size, std::uint32_t levels);

/// Leaves whose sphere may meet the primitive's hull; none that does is left out. `frontier` is working
/// memory, each of frontier_capacity(tree), and holds the answer.
std::span<const std::uint32_t> query_tree(const SphereTree& tree, const Primitive& primitive,
                                          std::array<std::vector<std::uint32_t>, 2>& frontier);
std::size_t frontier_capacity(const SphereTree& tree);

}  // namespace lumbrical
