// The edges of a mesh, each with the triangles that share it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/mesh.h"

namespace lumbrical {

/// An edge as one triangle runs through it. Which vertex is its lower one says its place in MeshEdges.
struct HalfEdge {
  std::uint64_t key = 0;  ///< higher vertex << 32 | triangle << 1 | upwards
  [[nodiscard]] std::uint32_t high() const { return static_cast<std::uint32_t>(key >> 32); }
  [[nodiscard]] std::uint32_t triangle() const { return static_cast<std::uint32_t>(key) >> 1; }
  [[nodiscard]] bool upwards() const { return (key & 1) != 0; }  ///< from the lower vertex to the higher
  friend bool operator<(HalfEdge a, HalfEdge b) { return a.key < b.key; }
};

/// Half-edges by their lower vertex, then the higher one, then the triangle. Triangles whose corners coincide
/// have no edges to speak of and are left out.
struct MeshEdges {
  std::vector<std::uint64_t> start;  ///< of each vertex' half-edges; one more at the end
  std::vector<HalfEdge> half;

  /// Calls visit(lower vertex, half-edges of one edge) for every edge, in their order.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t low = 0; low + 1 < start.size(); ++low) {
      for (std::uint64_t begin = start[low], end = begin; begin < start[low + 1]; begin = end) {
        while (end < start[low + 1] && half[end].high() == half[begin].high()) ++end;
        visit(static_cast<std::uint32_t>(low), std::span<const HalfEdge>(&half[begin], end - begin));
      }
    }
  }
};

inline bool corners_coincide(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// A triangle's corners, each under the name of `first` (vertex_merge.h), or its own where that is empty.
inline Triangle merged_corners(const Triangle& t, const std::vector<std::uint32_t>& first) {
  return first.empty() ? t : Triangle{first[t[0]], first[t[1]], first[t[2]]};
}

/// Fewer than 2^31 triangles, their indices in range. Linear but for vertices of very many edges; 8 bytes per
/// half-edge and per vertex. The result does not depend on `threads`.
MeshEdges edges_of(const Mesh& mesh, const std::vector<std::uint32_t>& first, std::size_t threads = 1);

}  // namespace lumbrical
