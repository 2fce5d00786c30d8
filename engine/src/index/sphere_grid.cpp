#include "index/sphere_grid.h"

#include <algorithm>
#include <cmath>

#include "index/sphere_tree.h"

namespace lumbrical {
namespace {

constexpr double kMostCells = 1048576;  // along an axis; a cell's index then takes 21 bits

struct Cell {
  std::uint64_t x, y, z;
};

// Monotone in every coordinate, so a box of points lies in a box of cells.
Cell cell_at(const SphereGrid& grid, Vec3 p) {
  const auto index = [&](double x, double low) {
    return static_cast<std::uint64_t>(clamp((x - low) / grid.cell_size, 0, kMostCells));
  };
  return {index(p.x, grid.origin.x), index(p.y, grid.origin.y), index(p.z, grid.origin.z)};
}

std::uint64_t key_of(Cell cell) { return cell.z << 42 | cell.y << 21 | cell.x; }

Cell cell_of(std::uint64_t key) { return {key & 0x1fffff, key >> 21 & 0x1fffff, key >> 42}; }

// From a cell beside the box low .. high, the next in the order of keys that may be in it.
Cell re_entry(Cell cell, Cell low, Cell high) {
  if (cell.y < low.y) return {low.x, low.y, cell.z};
  if (cell.y > high.y) return {low.x, low.y, cell.z + 1};
  if (cell.x < low.x) return {low.x, cell.y, cell.z};
  return {low.x, cell.y + 1, cell.z};
}

struct Member {
  std::uint64_t cell;
  std::uint32_t triangle;
  friend bool operator<(const Member& a, const Member& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.triangle < b.triangle;
  }
};

}  // namespace

SphereGrid build_grid(const Triangles& triangles, const Execution& execution) {
  SphereGrid grid;
  const auto count = static_cast<std::uint32_t>(triangles.size());
  if (count == 0) return grid;
  std::vector<TriangleBound> bounds(count);
  Box box;
  for (std::uint32_t i = 0; i < count; ++i) {
    bounds[i] = bound_triangle(triangles, i, {});
    box.add(bounds[i].centre);
  }
  const Vec3 extent = box.upper - box.lower;
  grid.origin = box.lower;
  grid.cell_size = max(execution.cell_size, max(extent.x, max(extent.y, extent.z)) / (kMostCells - 1));
  std::vector<Member> members;
  std::vector<std::uint32_t> in_cell, wide;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (bounds[i].radius <= 0.5 * grid.cell_size) {
      members.push_back({key_of(cell_at(grid, bounds[i].centre)), i});
    } else {
      wide.push_back(i);
    }
  }
  std::sort(members.begin(), members.end());
  for (std::size_t first = 0; first < members.size();) {
    in_cell.clear();
    std::size_t last = first;
    for (; last < members.size() && members[last].cell == members[first].cell; ++last)
      in_cell.push_back(members[last].triangle);
    grid.cell.push_back(members[first].cell);
    grid.tree.push_back(build_tree(triangles, in_cell, execution));
    first = last;
  }
  grid.tree.push_back(build_tree(triangles, wide, execution));
  return grid;
}

std::size_t find_cells(const SphereGrid& grid, const Box& box, std::vector<std::uint32_t>& trees) {
  if (grid.tree.empty()) return 0;
  // A triangle's sphere reaches half a cell beyond the cell of its centre, and coordinates are rounded.
  const auto farthest = [](Vec3 p) { return max(std::fabs(p.x), max(std::fabs(p.y), std::fabs(p.z))); };
  const double reach = 0.500001 * grid.cell_size +
                       1e-14 * max(farthest(grid.origin), max(farthest(box.lower), farthest(box.upper)));
  const Vec3 margin{reach, reach, reach};
  const Cell low = cell_at(grid, box.lower - margin), high = cell_at(grid, box.upper + margin);
  std::size_t count = 0;
  const auto end = grid.cell.end();
  for (auto next = std::lower_bound(grid.cell.begin(), end, key_of(low));
       next != end && *next <= key_of(high);) {
    const Cell cell = cell_of(*next);
    if (cell.x >= low.x && cell.x <= high.x && cell.y >= low.y && cell.y <= high.y) {
      trees[count++] = static_cast<std::uint32_t>(next - grid.cell.begin());
      ++next;
    } else {
      next = std::lower_bound(next, end, key_of(re_entry(cell, low, high)));
    }
  }
  trees[count++] = static_cast<std::uint32_t>(grid.cell.size());
  return count;
}

std::size_t byte_count(const SphereGrid& grid) {
  std::size_t bytes = grid.cell.size() * sizeof(std::uint64_t);
  for (const SphereTree& tree : grid.tree) bytes += byte_count(tree);
  return bytes;
}

}  // namespace lumbrical
