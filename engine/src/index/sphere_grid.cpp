#include "index/sphere_grid.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "index/sphere_tree.h"
#include "index/triangle_bound.h"

namespace lumbrical {
namespace {

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

constexpr std::size_t kGridPiece = 16384;  // triangles, the least that is worth another thread

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

}  // namespace

Box box_round_centres(const Triangles& triangles, std::uint32_t first, std::uint32_t last,
                      std::size_t threads) {
  const std::size_t count = last - first;
  std::vector<Box> boxes(piece_count(count, kGridPiece));
  parallel_pieces(count, kGridPiece, threads, [&](std::size_t piece, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      boxes[piece].add(bound_triangle(triangles, first + static_cast<std::uint32_t>(i), {}).centre);
  });
  Box all;
  for (const Box& box : boxes) all.add(box);
  return all;
}

SphereGrid plan_grid(const Box& centres, const Execution& execution) {
  SphereGrid grid;
  const Vec3 extent = centres.upper - centres.lower;
  grid.origin = centres.lower;
  grid.cell_size = max(execution.cell_size, max(extent.x, max(extent.y, extent.z)) / (kMostCells - 1));
  return grid;
}

std::uint64_t cell_of_triangle(const SphereGrid& grid, const Triangles& triangles, std::uint32_t triangle) {
  const Sphere bound = bound_triangle(triangles, triangle, {});
  return bound.radius > 0.5 * grid.cell_size ? kWideCell : key_of(cell_at(grid, bound.centre));
}

void build_trees(const Triangles& triangles, std::span<const std::uint32_t> members,
                 std::span<const std::size_t> start, const Execution& execution, std::span<TreeHead> heads,
                 TreeLine* lines) {
  Execution serial = execution;
  serial.threads = 1;
  parallel_chunks(heads.size(), 1, execution.threads, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> in_cell;
    for (std::size_t i = first; i < last; ++i) {
      const auto these = members.subspan(start[i], start[i + 1] - start[i]);
      in_cell.assign(these.begin(), these.end());
      build_tree(triangles, in_cell, serial, heads[i], lines + heads[i].first_line);
    }
  });
}

std::uint64_t plan_trees(std::span<const std::size_t> start, const Execution& execution,
                         std::vector<TreeHead>& heads) {
  std::uint64_t lines = 0;
  heads.resize(start.size() - 1);
  for (std::size_t i = 0; i < heads.size(); ++i) {
    heads[i] = plan_tree(start[i + 1] - start[i], execution);
    heads[i].first_line = lines;
    lines += layout_of(heads[i]).lines;
  }
  return lines;
}

SphereGrid build_grid(const Triangles& triangles, const Execution& execution) {
  const std::size_t threads = execution.threads;
  const auto count = static_cast<std::uint32_t>(triangles.size());
  if (count == 0) return {};
  const Box box = box_round_centres(triangles, 0, count, threads);
  SphereGrid grid = plan_grid(box, execution);
  std::vector<std::uint32_t> members, wide;
  for (std::uint32_t i = 0; i < count; ++i)
    (cell_of_triangle(grid, triangles, i) == kWideCell ? wide : members).push_back(i);
  const ShortKey key = short_key(grid, box.upper);
  sort_by_code(members, key.x + key.y + key.z, threads,
               [&](std::uint32_t i) { return key(cell_of(cell_of_triangle(grid, triangles, i))); });
  std::vector<std::uint64_t> cells;
  std::vector<std::size_t> start;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const std::uint64_t cell = cell_of_triangle(grid, triangles, members[i]);
    if (!cells.empty() && cells.back() == cell) continue;
    cells.push_back(cell);
    start.push_back(i);
  }
  start.push_back(members.size());
  start.push_back(members.size() + wide.size());
  std::vector<TreeHead> heads;
  const auto line_count = static_cast<std::size_t>(plan_trees(start, execution, heads));
  const auto lines = make_lines(line_count);
  build_trees(triangles, members, start, execution, std::span(heads).first(cells.size()), lines.get());
  build_tree(triangles, wide, execution, heads.back(), lines.get() + heads.back().first_line);
  for (const TreeHead& head : heads)
    grid.frontier = std::max(grid.frontier, static_cast<std::uint32_t>(frontier_capacity(head)));
  grid.cell = std::move(cells);
  grid.tree = std::move(heads);
  grid.lines = {lines.get(), line_count, lines};
  return grid;
}

std::size_t find_cells(const SphereGrid& grid, const Box& box, std::vector<std::uint32_t>& trees) {
  if (grid.tree.empty()) return 0;
  // A triangle's sphere reaches half a cell beyond the cell of its centre, and coordinates are rounded.
  const double reach =
      0.500001 * grid.cell_size +
      1e-14 * max(largest_of(grid.origin), max(largest_of(box.lower), largest_of(box.upper)));
  const Vec3 margin{reach, reach, reach};
  const Cell low = cell_at(grid, box.lower - margin), high = cell_at(grid, box.upper + margin);
  std::size_t count = 0;
  const std::uint64_t* const end = grid.cell.end();
  for (const std::uint64_t* next = std::lower_bound(grid.cell.begin(), end, key_of(low));
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
  return grid.cell.size() * sizeof(std::uint64_t) + grid.tree.size() * sizeof(TreeHead) +
         grid.lines.size() * sizeof(TreeLine);
}

}  // namespace lumbrical
