// The corners of one triangle of the world.
#pragma once

#include "lumbrical/model.h"

namespace lumbrical {

struct Corners {
  Vec3 a, b, c;  ///< [m] W
};
inline Corners corners_of(const Triangles& world, std::uint32_t triangle) {
  return {world.vertex(world.a[triangle]), world.vertex(world.b[triangle]), world.vertex(world.c[triangle])};
}

}  // namespace lumbrical
