#include "model/felt_surface.h"

#include "model/corner_normals.h"

namespace lumbrical {
namespace {

// [m] Longest edge times the farthest turn of a unit normal: four times the depth of a facet's middle below
// what it stands for. A finger is as wide as very many facets of less.
constexpr double kLeastTurn = 2e-4;

double square_of_longest_edge(const Mesh& mesh, const Triangle& triangle) {
  const Vec3 a = mesh.vertices[triangle[0]], b = mesh.vertices[triangle[1]], c = mesh.vertices[triangle[2]];
  return max(dot(b - a, b - a), max(dot(c - b, c - b), dot(a - c, a - c)));
}

bool is_turned(const Mesh& mesh, const Triangle& triangle, const std::array<Vec3, 3>& turn) {
  double most = 0;
  for (const Vec3 of_corner : turn) most = max(most, dot(of_corner, of_corner));
  return most * square_of_longest_edge(mesh, triangle) > kLeastTurn * kLeastTurn;
}

}  // namespace

void feel_of(const Surface& surface, const Mesh& mesh, FeltSurface& felt) {
  felt.grip = texture_means(surface.grip);
  felt.bumps = texture_means(surface.bumps);
  std::vector<std::array<Vec3, 3>> corners;
  if (surface.crease_angle > 0) corners = corner_normals(mesh, surface.crease_angle);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Vec3, 3> turn{};
    if (!corners.empty()) {
      const Vec3 normal = triangle_normal(mesh, mesh.triangles[t]);
      for (std::size_t k = 0; k < 3; ++k) turn[k] = corners[t][k] - normal;
    }
    const bool turned = is_turned(mesh, mesh.triangles[t], turn);
    const double rub = surface.friction_factor.empty() ? 0 : surface.friction_factor[t] - 1;
    if (rub == 0 && !turned) continue;
    if (!turned) turn = {};
    felt.triangle.push_back(t);
    felt.turn.push_back(turn);
    felt.rub.push_back(rub);
    felt.least_rub = min(felt.least_rub, rub);
    felt.most_rub = max(felt.most_rub, rub);
  }
}

}  // namespace lumbrical
