#include "model/corner_normals.h"

#include <cassert>

#include "base/disjoint_sets.h"
#include "base/elementary.h"
#include "model/mesh_edges.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

// Least cosine of the angle between a corner's normal and its triangle's.
constexpr double kWidestTurn = 0.5;

// A triangle lower than this share of its longest edge has next to no area and, by rounding, any normal.
constexpr double kLowest = 1e-5;

// More slivers in a row than this don't find out of themselves.
constexpr int kMostSlivers = 100;

// An edge, like the corner from which its triangle runs along it, is 3 times the triangle plus 0, 1 or 2.
constexpr std::uint32_t kNoEdge = ~0u;
std::uint32_t next_in_triangle(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

double angle_at(const Mesh& mesh, const Triangle& triangle, std::size_t k) {
  const Vec3 at = mesh.vertices[triangle[k]];
  const Vec3 to = mesh.vertices[triangle[(k + 1) % 3]] - at, from = mesh.vertices[triangle[(k + 2) % 3]] - at;
  return arc_tan2(norm(cross(to, from)), dot(to, from));
}

std::vector<Vec3> normals_of(const Mesh& mesh) {
  std::vector<Vec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles) normals.push_back(triangle_normal(mesh, triangle));
  return normals;
}

std::uint32_t corner_at(const Mesh& mesh, const std::vector<std::uint32_t>& first, std::uint32_t triangle,
                        std::uint32_t vertex) {
  const Triangle corners = merged_corners(mesh.triangles[triangle], first);
  const std::uint32_t k = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
  return 3 * triangle + k;
}

// For each edge, the same edge as the neighbour runs through it; none where not exactly two run through it,
// opposite ways.
std::vector<std::uint32_t> edges_across(const Mesh& mesh) {
  const std::vector<std::uint32_t> first = first_at_same_position(mesh.vertices);
  std::vector<std::uint32_t> across(3 * mesh.triangles.size(), kNoEdge);
  edges_of(mesh, first).for_each([&](std::uint32_t low, std::span<const HalfEdge> edge) {
    if (edge.size() != 2 || edge[0].upwards() == edge[1].upwards()) return;
    const auto from = [&](HalfEdge half) {
      return corner_at(mesh, first, half.triangle(), half.upwards() ? low : half.high());
    };
    across[from(edge[0])] = from(edge[1]);
    across[from(edge[1])] = from(edge[0]);
  });
  return across;
}

double square_of_edge(const Mesh& mesh, std::uint32_t edge) {
  const Triangle& triangle = mesh.triangles[edge / 3];
  const Vec3 way = mesh.vertices[triangle[(edge + 1) % 3]] - mesh.vertices[triangle[edge % 3]];
  return dot(way, way);
}

// Of its triangle.
std::uint32_t longest_but(const Mesh& mesh, std::uint32_t edge) {
  const std::uint32_t next = next_in_triangle(edge), last = next_in_triangle(next);
  return square_of_edge(mesh, last) > square_of_edge(mesh, next) ? last : next;
}
std::uint32_t longest_edge(const Mesh& mesh, std::uint32_t triangle) {
  const std::uint32_t other = longest_but(mesh, 3 * triangle);
  return square_of_edge(mesh, other) > square_of_edge(mesh, 3 * triangle) ? other : 3 * triangle;
}

bool is_sliver(const Mesh& mesh, std::uint32_t t) {
  const Triangle& triangle = mesh.triangles[t];
  const Vec3 a = mesh.vertices[triangle[0]];
  const Vec3 doubled_area = cross(mesh.vertices[triangle[1]] - a, mesh.vertices[triangle[2]] - a);
  return !(norm(doubled_area) > kLowest * square_of_edge(mesh, longest_edge(mesh, t)));
}

// The triangle that a sliver is in the edge of: across its longest edge and through all slivers there.
std::uint32_t beyond_slivers(const Mesh& mesh, const std::vector<std::uint32_t>& across,
                             std::uint32_t sliver) {
  std::uint32_t way = longest_edge(mesh, sliver);
  for (int i = 0; i < kMostSlivers; ++i) {
    const std::uint32_t into = across[way];
    if (into == kNoEdge) return sliver;
    if (!is_sliver(mesh, into / 3)) return into / 3;
    way = longest_but(mesh, into);
  }
  return sliver;
}

// Slivers fill what would be T-junctions: at their middle corner, half a turn wide, one facet has none of its
// own corners, and the sliver stands for it.
std::vector<Vec3> with_slivers_filled(const Mesh& mesh, const std::vector<std::uint32_t>& across,
                                      std::vector<Vec3> normals) {
  for (std::uint32_t t = 0; t < normals.size(); ++t) {
    if (is_sliver(mesh, t)) normals[t] = normals[beyond_slivers(mesh, across, t)];
  }
  return normals;
}

// Corners that share a normal.
DisjointSets smooth_groups(const std::vector<std::uint32_t>& across, const std::vector<Vec3>& normals,
                           double crease_angle) {
  const double least = sin_cos(crease_angle).cos;
  DisjointSets groups(across.size());
  for (std::uint32_t edge = 0; edge < across.size(); ++edge) {
    const std::uint32_t other = across[edge];
    if (other == kNoEdge || other < edge || dot(normals[edge / 3], normals[other / 3]) < least) continue;
    groups.join(edge, next_in_triangle(other));
    groups.join(next_in_triangle(edge), other);
  }
  return groups;
}

}  // namespace

Vec3 triangle_normal(const Mesh& mesh, const Triangle& triangle) {
  const Vec3 a = mesh.vertices[triangle[0]];
  return unit_or(cross(mesh.vertices[triangle[1]] - a, mesh.vertices[triangle[2]] - a), {});
}

std::vector<std::array<Vec3, 3>> corner_normals(const Mesh& mesh, double crease_angle) {
  assert(mesh.triangles.size() <= kMostSmoothed && "their edges have numbers");
  const std::vector<std::uint32_t> across = edges_across(mesh);
  const std::vector<Vec3> own = normals_of(mesh), normals = with_slivers_filled(mesh, across, own);
  DisjointSets groups = smooth_groups(across, normals, crease_angle);
  std::vector<Vec3> sum(3 * normals.size());
  for (std::uint32_t t = 0; t < normals.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k)
      sum[groups.find(3 * t + k)] += angle_at(mesh, mesh.triangles[t], k) * normals[t];
  }
  std::vector<std::array<Vec3, 3>> corners(normals.size());
  for (std::uint32_t t = 0; t < normals.size(); ++t) {
    const bool sliver = is_sliver(mesh, t);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3 mean = unit_or(sum[groups.find(3 * t + k)], {});
      corners[t][k] = sliver || dot(mean, normals[t]) < kWidestTurn ? own[t] : mean;
    }
  }
  return corners;
}

}  // namespace lumbrical
