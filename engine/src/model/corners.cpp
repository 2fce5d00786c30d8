#include "model/corners.h"

#include <cstddef>
#include <vector>

#include "base/parallel.h"

namespace lumbrical {

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
