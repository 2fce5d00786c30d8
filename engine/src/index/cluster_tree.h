// Clusters: neighbouring triangles with the moments of their surface, from which the field's integral over
// all of them follows at once (docs/mechanics.md, "Clusters").
#pragma once

#include <cstddef>
#include <span>

#include "lumbrical/model.h"

namespace lumbrical {

/// Puts the triangles in an order in which every cluster is compact, sums the moments of every eight and
/// joins every four clusters to a larger one, until sixteen or fewer are left. The same whatever the
/// broadphase; execution says whether `place` is needed. There must be a triangle.
ClusterTree build_clusters(const Triangles& triangles, const Execution& execution);

/// The triangles of a cluster.
std::span<const std::uint32_t> triangles_of(const ClusterTree& tree, std::uint32_t cluster);

/// [bytes] it takes.
std::size_t byte_count(const ClusterTree& tree);

}  // namespace lumbrical
