// A world of one mesh for tests and benchmarks that need no more of a model.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

inline Triangles world_of(const Mesh& mesh) {
  std::vector<double> x, y, z;
  for (const Vec3& p : mesh.vertices) {
    x.push_back(p.x);
    y.push_back(p.y);
    z.push_back(p.z);
  }
  std::vector<std::uint32_t> a, b, c;
  for (const Triangle& t : mesh.triangles) {
    a.push_back(t[0]);
    b.push_back(t[1]);
    c.push_back(t[2]);
  }
  return {std::move(x), std::move(y), std::move(z), std::move(a), std::move(b), std::move(c)};
}

/// Adds a triangle with corners of its own.
inline void add_triangle(Vec3 a, Vec3 b, Vec3 c, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

}  // namespace lumbrical
