// Meshes with many triangles in a plane, which no convex solid has.
#pragma once

#include <algorithm>
#include <cmath>

#include "lumbrical/shapes.h"

namespace lumbrical::test {

/// 0.3 m wide, its rim 30 mm high, open above.
inline Mesh finely_cut_tray() {
  Mesh tray = make_plane(0.3, 20);
  for (Vec3& p : tray.vertices) p.z = std::max(std::fabs(p.x), std::fabs(p.y)) > 0.149 ? 0.03 : 0;
  return tray;
}

}  // namespace lumbrical::test
