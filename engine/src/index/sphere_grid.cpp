#include "index/sphere_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "base/parallel.h"
#include "base/parallel_sort.h"
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

constexpr std::size_t kPiece = 16384;  // triangles, the least that is worth another thread

Box box_round_centres(const Triangles& triangles, std::size_t threads) {
  std::vector<Box> boxes(piece_count(triangles.size(), kPiece));
  parallel_pieces(triangles.size(), kPiece, threads,
                  [&](std::size_t piece, std::size_t first, std::size_t last) {
                    for (std::size_t i = first; i < last; ++i)
                      boxes[piece].add(bound_triangle(triangles, static_cast<std::uint32_t>(i), {}).centre);
                  });
  Box all;
  for (const Box& box : boxes) {
    all.add(box.lower);
    all.add(box.upper);
  }
  return all;
}

bool is_wide(const TriangleBound& bound, const SphereGrid& grid) {
  return bound.radius > 0.5 * grid.cell_size;
}

// Keys of cells with no more bits than this grid needs, in the same order.
struct ShortKey {
  int x, y, z;  // bits
  [[nodiscard]] std::uint64_t operator()(Cell cell) const { return cell.z << (x + y) | cell.y << x | cell.x; }
};

ShortKey short_key(const SphereGrid& grid, Vec3 upper) {
  const Cell last = cell_at(grid, upper);
  const auto width = [](std::uint64_t cell) { return static_cast<int>(std::bit_width(cell)); };
  return {width(last.x), width(last.y), width(last.z)};
}

// One tree per run of triangles, which are sorted by cell. `start`: of each run, and behind the last.
void build_cells(const Triangles& triangles, std::span<const std::uint32_t> members,
                 std::span<const std::size_t> start, const Execution& execution, SphereGrid& grid) {
  Execution serial = execution;
  serial.threads = 1;
  parallel_chunks(grid.cell.size(), 1, execution.threads, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> in_cell;
    for (std::size_t i = first; i < last; ++i) {
      const auto these = members.subspan(start[i], start[i + 1] - start[i]);
      in_cell.assign(these.begin(), these.end());
      grid.tree[i] = build_tree(triangles, in_cell, serial);
    }
  });
}

}  // namespace

SphereGrid build_grid(const Triangles& triangles, const Execution& execution) {
  SphereGrid grid;
  const std::size_t threads = execution.threads;
  const auto count = static_cast<std::uint32_t>(triangles.size());
  if (count == 0) return grid;
  const Box box = box_round_centres(triangles, threads);
  const Vec3 extent = box.upper - box.lower;
  grid.origin = box.lower;
  grid.cell_size = max(execution.cell_size, max(extent.x, max(extent.y, extent.z)) / (kMostCells - 1));
  std::vector<std::uint32_t> narrow, wide;
  for (std::uint32_t i = 0; i < count; ++i)
    (is_wide(bound_triangle(triangles, i, {}), grid) ? wide : narrow).push_back(i);
  const auto cell_of_triangle = [&](std::uint32_t i) {
    return cell_at(grid, bound_triangle(triangles, i, {}).centre);
  };
  const ShortKey key = short_key(grid, box.upper);
  sort_by_code(narrow, key.x + key.y + key.z, 1, threads,
               [&](std::uint32_t i) { return key(cell_of_triangle(i)); });
  std::vector<std::size_t> start;
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    const std::uint64_t cell = key_of(cell_of_triangle(narrow[i]));
    if (!grid.cell.empty() && grid.cell.back() == cell) continue;
    grid.cell.push_back(cell);
    start.push_back(i);
  }
  start.push_back(narrow.size());
  grid.tree.resize(grid.cell.size() + 1);
  build_cells(triangles, narrow, start, execution, grid);
  grid.tree.back() = build_tree(triangles, wide, execution);
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
