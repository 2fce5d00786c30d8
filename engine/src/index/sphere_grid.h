// A grid of sphere trees for large environments: cells are found in sorted arrays, in the neighbourhood of a
// hand only, and every cell counts from an origin of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "index/triangle_bound.h"
#include "lumbrical/model.h"

namespace lumbrical {

/// Cells are `cell_size` wide, or the environment's extent / 2^20 if that is more.
SphereGrid build_grid(const Triangles& triangles, const Execution& execution);

/// Writes the numbers of the trees with triangles whose bounding spheres may meet the box [m, W] to `trees`,
/// which holds grid.tree.size(); returns how many.
std::size_t find_cells(const SphereGrid& grid, const Box& box, std::vector<std::uint32_t>& trees);

/// [bytes] a grid takes.
std::size_t byte_count(const SphereGrid& grid);

}  // namespace lumbrical
