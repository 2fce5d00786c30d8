#include "model/corner_normals.h"

#include "base/disjoint_sets.h"
#include "base/elementary.h"
#include "model/mesh_edges.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

// Least cosine of the angle between a corner's normal and its triangle's.
constexpr double kWidestTurn = 0.5;

std::uint32_t corner_at(const Mesh& mesh, const std::vector<std::uint32_t>& first, std::uint32_t triangle,
                        std::uint32_t vertex) {
  const Triangle corners = merged_corners(mesh.triangles[triangle], first);
  const std::uint32_t k = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
  return 3 * triangle + k;
}

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

// Corners that share a normal: 3 times the triangle plus 0, 1 or 2.
DisjointSets smooth_groups(const Mesh& mesh, const std::vector<Vec3>& normals, double crease_angle) {
  const std::vector<std::uint32_t> first = first_at_same_position(mesh.vertices);
  const double least = sin_cos(crease_angle).cos;
  DisjointSets groups(3 * mesh.triangles.size());
  edges_of(mesh, first).for_each([&](std::uint32_t low, std::span<const HalfEdge> edge) {
    if (edge.size() != 2 || edge[0].upwards() == edge[1].upwards()) return;
    const std::uint32_t t = edge[0].triangle(), u = edge[1].triangle();
    if (dot(normals[t], normals[u]) < least) return;
    for (const std::uint32_t vertex : {low, edge[0].high()})
      groups.join(corner_at(mesh, first, t, vertex), corner_at(mesh, first, u, vertex));
  });
  return groups;
}

}  // namespace

Vec3 triangle_normal(const Mesh& mesh, const Triangle& triangle) {
  const Vec3 a = mesh.vertices[triangle[0]];
  return unit_or(cross(mesh.vertices[triangle[1]] - a, mesh.vertices[triangle[2]] - a), {});
}

std::vector<std::array<Vec3, 3>> corner_normals(const Mesh& mesh, double crease_angle) {
  const std::vector<Vec3> normals = normals_of(mesh);
  DisjointSets groups = smooth_groups(mesh, normals, crease_angle);
  std::vector<Vec3> sum(3 * normals.size());
  for (std::uint32_t t = 0; t < normals.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k)
      sum[groups.find(3 * t + k)] += angle_at(mesh, mesh.triangles[t], k) * normals[t];
  }
  std::vector<std::array<Vec3, 3>> corners(normals.size());
  for (std::uint32_t t = 0; t < normals.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3 mean = unit_or(sum[groups.find(3 * t + k)], {});
      corners[t][k] = dot(mean, normals[t]) < kWidestTurn ? normals[t] : mean;
    }
  }
  return corners;
}

}  // namespace lumbrical
