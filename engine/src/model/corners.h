// The corners of the world's triangles.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

struct Corners {
  Vec3 a, b, c;  ///< [m] W
};

/// The last point of a triangle on the way from one of its own to another of its plane.
inline Vec3 last_within(const Corners& at, Vec3 from, Vec3 to) {
  const Vec3 normal = cross(at.b - at.a, at.c - at.a);
  double share = 1;
  for (const auto& [corner, next] : {std::pair{at.a, at.b}, {at.b, at.c}, {at.c, at.a}}) {
    const Vec3 inward = cross(normal, next - corner);
    const double before = max(0, dot(inward, from - corner)), after = dot(inward, to - corner);
    if (after < 0) share = min(share, before / (before - after));
  }
  return from + share * (to - from);
}

inline Corners corners_of(const Triangles& world, std::uint32_t triangle) {
  return {world.vertex(world.a[triangle]), world.vertex(world.b[triangle]), world.vertex(world.c[triangle])};
}

/// Those of meshes, one after the other. `turned` tells for each mesh whose last two corners change places;
/// empty: none of its.
Triangles gather_triangles(std::span<const Mesh* const> meshes, std::span<const std::vector<bool>> turned,
                           std::size_t threads);

/// Round the vertices that triangles name: scans carry stray ones far away. Empty where there are none.
Box box_round(const Triangles& world, std::size_t threads);

}  // namespace lumbrical
