// Finds vertices that lie at exactly the same position.
#pragma once

#include <cstdint>
#include <vector>

#include "lumbrical/mesh.h"

namespace lumbrical {

/// For every vertex the index of the first vertex at the same position (its own index where it is the first).
/// Positions are equal when all three coordinates are, -0 and +0 alike. O(n log n); at most 2^32 - 2
/// vertices.
std::vector<std::uint32_t> first_at_same_position(const std::vector<Vec3>& vertices);

/// Joins vertices at the same position, keeps the order of their first occurrence, renames the triangles'
/// corners. Triangles whose corners coincide stay.
void merge_vertices(Mesh& mesh);

}  // namespace lumbrical
