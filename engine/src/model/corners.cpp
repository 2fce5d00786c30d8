#include "model/corners.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/parallel.h"

namespace lumbrical {

// Each of the six arrays is written from end to end by one thread, whose memory it then is.
Triangles gather_triangles(std::span<const Mesh* const> meshes, std::span<const std::vector<bool>> turned,
                           std::size_t threads) {
  constexpr std::array<double Vec3::*, 3> kAxis = {&Vec3::x, &Vec3::y, &Vec3::z};
  std::size_t vertex_count = 0, triangle_count = 0;
  for (const Mesh* const mesh : meshes) {
    vertex_count += mesh->vertices.size();
    triangle_count += mesh->triangles.size();
  }
  std::array<std::vector<double>, 3> numbers;
  std::array<std::vector<std::uint32_t>, 3> corners;
  parallel_chunks(6, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      if (k % 2 == 0) {
        numbers[k / 2].reserve(vertex_count);
        for (const Mesh* const mesh : meshes) {
          for (const Vec3& p : mesh->vertices) numbers[k / 2].push_back(p.*kAxis[k / 2]);
        }
        continue;
      }
      std::uint32_t first_vertex = 0;
      corners[k / 2].reserve(triangle_count);
      for (std::size_t i = 0; i < meshes.size(); ++i) {
        const Mesh& mesh = *meshes[i];
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
          const bool swap = k / 2 > 0 && !turned[i].empty() && turned[i][t];
          corners[k / 2].push_back(first_vertex + mesh.triangles[t][swap ? 3 - k / 2 : k / 2]);
        }
        first_vertex += static_cast<std::uint32_t>(mesh.vertices.size());
      }
    }
  });
  return {std::move(numbers[0]), std::move(numbers[1]), std::move(numbers[2]),
          std::move(corners[0]), std::move(corners[1]), std::move(corners[2])};
}

Box box_round(const Triangles& world, std::size_t threads) {
  constexpr std::size_t kPiece = 1 << 16;  // triangles, the least that is worth another thread
  std::vector<Box> boxes(piece_count(world.size(), kPiece));
  parallel_pieces(world.size(), kPiece, threads, [&](std::size_t piece, std::size_t first, std::size_t last) {
    Box box;
    for (std::size_t i = first; i < last; ++i) {
      const Corners at = corners_of(world, static_cast<std::uint32_t>(i));
      for (const Vec3 corner : {at.a, at.b, at.c}) box.add(corner);
    }
    boxes[piece] = box;
  });
  Box all;
  for (const Box& box : boxes) all.add(box);
  return all;
}

}  // namespace lumbrical
