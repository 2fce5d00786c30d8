// Two places nearer than half a cell share one in at least one of eight grids, shifted by half a cell along
// some of the axes. Found by sorting, as in vertex_merge.cpp.
#include "model/border_merge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>

#include "base/disjoint_sets.h"

namespace lumbrical {
namespace {

std::vector<std::uint32_t> border_vertices(const MeshEdges& edges) {
  std::vector<std::uint32_t> vertices;
  edges.for_each([&](std::uint32_t low, std::span<const HalfEdge> around) {
    if (around.size() == 1) vertices.insert(vertices.end(), {low, around[0].high()});
  });
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

struct Cell {
  std::array<double, 3> place{};
  std::uint32_t vertex = 0;
  friend bool operator<(const Cell& a, const Cell& b) {
    return std::tie(a.place, a.vertex) < std::tie(b.place, b.vertex);
  }
};

// False where no two share a cell that are not one already.
bool join_in_grid(const Mesh& mesh, const std::vector<std::uint32_t>& border, double width,
                  const std::array<double, 3>& shift, DisjointSets& joined) {
  std::vector<Cell> cells;
  cells.reserve(border.size());
  for (std::uint32_t i = 0; i < border.size(); ++i) {
    const Vec3& p = mesh.vertices[border[i]];
    cells.push_back({{std::floor(p.x / width + shift[0]), std::floor(p.y / width + shift[1]),
                      std::floor(p.z / width + shift[2])},
                     i});
  }
  std::sort(cells.begin(), cells.end());
  bool any = false;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    if (cells[i].place != cells[i - 1].place) continue;
    any = any || joined.find(cells[i].vertex) != joined.find(cells[i - 1].vertex);
    joined.join(cells[i].vertex, cells[i - 1].vertex);
  }
  return any;
}

}  // namespace

bool merge_borders(const Mesh& mesh, const MeshEdges& edges, double width,
                   std::vector<std::uint32_t>& first) {
  if (!(width > 0 && std::isfinite(width))) return false;
  const std::vector<std::uint32_t> border = border_vertices(edges);
  DisjointSets joined(border.size());  // of places in `border` here
  bool any = false;
  for (const double x : {0.0, 0.5})
    for (const double y : {0.0, 0.5})
      for (const double z : {0.0, 0.5}) any = join_in_grid(mesh, border, width, {x, y, z}, joined) || any;
  if (!any) return false;

  std::vector<std::uint32_t> renamed(mesh.vertices.size());
  std::iota(renamed.begin(), renamed.end(), 0u);
  for (std::uint32_t i = 0; i < border.size(); ++i) renamed[border[i]] = border[joined.find(i)];
  if (first.empty()) {
    first = std::move(renamed);
  } else {
    for (std::uint32_t& name : first) name = renamed[name];
  }
  return true;
}

}  // namespace lumbrical
