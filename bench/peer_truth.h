// Which triangles a hand touches, by brute force: what the contenders' contacts are held against.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/mesh.h"
#include "model/primitive.h"

namespace lumbrical::bench {

/// Of one pose. The tick of the exact rung adds force and area.
struct Truth {
  std::vector<std::uint32_t> touched, doubtful;  ///< triangles, ascending; doubtful: within 1 um of touching
  Vec3 force;                                    ///< [m^3] K_s = 1
  double area = 0;                               ///< [m^2]
};

/// What capsules of one radius each, `phalanges`, touch of the mesh; without force and area.
Truth touched_by(std::span<const Primitive> phalanges, const Mesh& mesh);

}  // namespace lumbrical::bench
