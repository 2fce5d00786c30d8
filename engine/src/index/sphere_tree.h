// Bounding sphere trees: built once over triangles in spatial order.
#pragma once

#include <cstdint>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

/// Sorts the triangles along a Morton curve, bounds every `leaf_size` of them by a leaf sphere and every
/// sixteen spheres by one above, until sixteen or fewer are left or there are `tree_levels` levels (0: no
/// limit; 1: the leaves alone, a linear scan). On `execution.threads` threads, with the same result for any
/// number of them.
SphereTree build_tree(const Triangles& triangles, const Execution& execution);

/// The same of some of the triangles only, given ascending; reorders `members`.
SphereTree build_tree(const Triangles& triangles, std::vector<std::uint32_t>& members,
                      const Execution& execution);

/// The most spheres of one level, or blocks of triangles, that a search can hit.
std::size_t frontier_capacity(const SphereTree& tree);

/// [bytes] a tree takes.
std::size_t byte_count(const SphereTree& tree);

}  // namespace lumbrical
