#include "model/mesh_edges.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"

namespace lumbrical {
namespace {

constexpr std::size_t kVertexPiece = 16384;  // vertices

template <class Visit>
void for_each_half_edge(const Mesh& mesh, const std::vector<std::uint32_t>& first, const Visit& visit) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = merged_corners(mesh.triangles[i], first);
    if (corners_coincide(t)) continue;
    for (std::size_t k = 0; k < 3; ++k) visit(i, t[k], t[(k + 1) % 3]);
  }
}

}  // namespace

MeshEdges edges_of(const Mesh& mesh, const std::vector<std::uint32_t>& first, std::size_t threads) {
  assert(mesh.triangles.size() < std::size_t{1} << 31);
  MeshEdges edges;
  std::vector<std::uint64_t>& start = edges.start;
  start.assign(mesh.vertices.size() + 1, 0);
  for_each_half_edge(mesh, first,
                     [&](std::size_t, std::uint32_t from, std::uint32_t to) { ++start[std::min(from, to)]; });
  std::uint64_t sum = 0;
  for (std::uint64_t& entry : start) entry = sum += entry;  // ends, which filling moves to the starts
  edges.half.resize(sum);
  for_each_half_edge(mesh, first, [&](std::size_t i, std::uint32_t from, std::uint32_t to) {
    const std::uint64_t high = std::max(from, to);
    edges.half[--start[std::min(from, to)]] = {high << 32 | i << 1 | (from < to ? 1u : 0u)};
  });
  parallel_pieces(mesh.vertices.size(), kVertexPiece, threads,
                  [&](std::size_t, std::size_t begin, std::size_t end) {
                    const auto at = [&](std::uint64_t place) {
                      return edges.half.begin() + static_cast<std::ptrdiff_t>(place);
                    };
                    for (std::size_t v = begin; v < end; ++v) std::sort(at(start[v]), at(start[v + 1]));
                  });
  return edges;
}

}  // namespace lumbrical
