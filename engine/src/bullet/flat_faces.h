// Flat faces of what stands still, cut into as few triangles as will do.
#pragma once

#include <cstdint>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

/// The chosen ones of some triangles, in O [m]. Those that lie in one plane, to 1e-6 m, hang together and
/// fill a convex polygon are cut anew, into as few as it takes: Bullet takes each by itself, many times as
/// long.
Mesh with_whole_faces(const Triangles& triangles, const std::vector<std::uint32_t>& chosen);

}  // namespace lumbrical
