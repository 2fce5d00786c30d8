// Cuts the polygons of mesh files into triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lumbrical/mesh.h"

namespace lumbrical {

/// Convex polygons become fans from their first corner, and so do all others that such a fan does not fold
/// over; those that it does fold over are cut into ears, holes too that are joined to the outline by a cut. A
/// polygon that crosses itself has no cut without folds and keeps its fan.
class PolygonCutter {
 public:
  explicit PolygonCutter(Mesh& mesh) : mesh_(mesh) {}

  /// Appends the triangles of a polygon of at least three corners. Those may be vertices that are still to
  /// come. `place` says where in the file it stands.
  void append(const std::vector<std::uint32_t>& corners, std::size_t place);

  /// To be called once all vertices are there. The place of a polygon of too many concave corners to be cut,
  /// where there is one: then the mesh is no good.
  std::optional<std::size_t> finish();

 private:
  struct Waiting {
    std::size_t first;  // of its triangles
    std::uint32_t triangle_count;
    std::size_t place;
  };
  void recut(const Waiting& polygon);

  Mesh& mesh_;
  std::vector<Waiting> waiting_;  // for vertices
  std::optional<std::size_t> refused_;
};

/// What to tell of a polygon that is refused.
inline constexpr const char* kTooConcave =
    "the face has too many concave corners to be cut here; export the mesh as triangles";

}  // namespace lumbrical
