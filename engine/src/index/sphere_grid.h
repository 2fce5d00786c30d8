// A grid of sphere trees for large environments: cells are found in sorted arrays, in the neighbourhood of a
// hand only, and every cell counts from an origin of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

/// Along an axis; a cell's index then takes 21 bits.
inline constexpr double kMostCells = 1048576;

/// Cells are `cell_size` wide, or the environment's extent / 2^20 if that is more.
SphereGrid build_grid(const Triangles& triangles, const Execution& execution);

/// The steps of it, for who builds one piece by piece. First: the box [m, W] round the centroids of triangles
/// `first` up to `last`, that one not included.
Box box_round_centres(const Triangles& triangles, std::uint32_t first, std::uint32_t last,
                      std::size_t threads);

/// Then: the grid of triangles with centroids in that box, still without cells.
SphereGrid plan_grid(const Box& centres, const Execution& execution);

/// The key of the cell a triangle is in; kWideCell, behind all others, if it is too wide for one.
inline constexpr std::uint64_t kWideCell = ~std::uint64_t{0};
std::uint64_t cell_of_triangle(const SphereGrid& grid, const Triangles& triangles, std::uint32_t triangle);

/// Of triangles sorted by cell, with `start` for each cell and behind the last: the heads of the cells'
/// trees, still plans, which lie one behind the other in the returned number of lines. At least one start.
std::uint64_t plan_trees(std::span<const std::size_t> start, const Execution& execution,
                         std::vector<TreeHead>& heads);

/// And the trees themselves; `members` ascending within a cell.
void build_trees(const Triangles& triangles, std::span<const std::uint32_t> members,
                 std::span<const std::size_t> start, const Execution& execution, std::span<TreeHead> heads,
                 TreeLine* lines);

/// Writes the numbers of the trees with triangles whose bounding spheres may meet the box [m, W] to `trees`,
/// which holds grid.tree.size(); returns how many.
std::size_t find_cells(const SphereGrid& grid, const Box& box, std::vector<std::uint32_t>& trees);

/// [bytes] a grid takes.
std::size_t byte_count(const SphereGrid& grid);

}  // namespace lumbrical
