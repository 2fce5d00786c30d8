// A world of triangles that share no vertices.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical::test {

inline Triangles loose_triangles(const std::vector<std::array<Vec3, 3>>& triangles) {
  std::vector<double> x, y, z;
  std::array<std::vector<std::uint32_t>, 3> corner;
  for (const std::array<Vec3, 3>& at : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      corner[i].push_back(static_cast<std::uint32_t>(x.size()));
      x.push_back(at[i].x);
      y.push_back(at[i].y);
      z.push_back(at[i].z);
    }
  }
  return {std::move(x),         std::move(y),         std::move(z),
          std::move(corner[0]), std::move(corner[1]), std::move(corner[2])};
}

}  // namespace lumbrical::test
