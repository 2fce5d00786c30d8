// Finds vertices that lie at exactly the same position, by sorting: the order of the result depends on the
// order of the vertices only, and no input can make it slow, as could happen with a hash table.
#include "model/vertex_merge.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <tuple>

namespace lumbrical {
namespace {

/// A position as bits: any total order will do for finding equals, and this one also holds for NaN.
struct PositionKey {
  std::uint64_t x, y, z;
  std::uint32_t vertex;
  friend bool operator<(const PositionKey& a, const PositionKey& b) {
    return std::tie(a.x, a.y, a.z, a.vertex) < std::tie(b.x, b.y, b.z, b.vertex);
  }
  bool same_position(const PositionKey& other) const { return x == other.x && y == other.y && z == other.z; }
};

std::uint64_t bits(double coordinate) { return std::bit_cast<std::uint64_t>(coordinate + 0.0); }  // -0 to +0

}  // namespace

std::vector<std::uint32_t> first_at_same_position(const std::vector<Vec3>& vertices) {
  std::vector<PositionKey> keys;
  keys.reserve(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3& p = vertices[i];
    keys.push_back({bits(p.x), bits(p.y), bits(p.z), static_cast<std::uint32_t>(i)});
  }
  std::sort(keys.begin(), keys.end());

  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const bool repeats = i > 0 && keys[i].same_position(keys[i - 1]);
    first[keys[i].vertex] = repeats ? first[keys[i - 1].vertex] : keys[i].vertex;
  }
  return first;
}

void merge_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> renamed = first_at_same_position(mesh.vertices);
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < renamed.size(); ++i) {
    if (renamed[i] == i) {
      mesh.vertices[kept] = mesh.vertices[i];
      renamed[i] = kept++;
    } else {
      renamed[i] = renamed[renamed[i]];  // the first one came earlier and has its new name already
    }
  }
  mesh.vertices.resize(kept);
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner = renamed[corner];
  }
}

}  // namespace lumbrical
