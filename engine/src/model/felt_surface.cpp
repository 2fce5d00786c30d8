#include "model/felt_surface.h"

#include "model/corner_normals.h"

namespace lumbrical {
namespace {

constexpr double kLeastTurn = 0.0044;  // of a unit normal: a quarter of a degree

bool is_turned(const std::array<Vec3, 3>& turn) {
  double most = 0;
  for (const Vec3 of_corner : turn) most = max(most, dot(of_corner, of_corner));
  return most > kLeastTurn * kLeastTurn;
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
      if (!is_turned(turn)) turn = {};
    }
    const double rub = surface.friction_factor.empty() ? 0 : surface.friction_factor[t] - 1;
    if (rub == 0 && !is_turned(turn)) continue;
    felt.triangle.push_back(t);
    felt.turn.push_back(turn);
    felt.rub.push_back(rub);
    felt.least_rub = min(felt.least_rub, rub);
    felt.most_rub = max(felt.most_rub, rub);
  }
}

}  // namespace lumbrical
