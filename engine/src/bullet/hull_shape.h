// The shape that Bullet gives a body: the convex hulls of a mesh's parts.
#pragma once

#include <memory>
#include <vector>

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include "lumbrical/model.h"

namespace lumbrical {

/// Bullet's thresholds are made for things of some units; so they suit what a hand can hold.
inline constexpr double kUnitsPerMetre = 100;

/// A body's shape, and what it refers to.
struct HullShape {
  std::vector<std::unique_ptr<btCollisionShape>> hulls;
  std::unique_ptr<btCompoundShape> whole;
};

/// Of triangles [m] in O, as seen from a frame C [kUnitsPerMetre]; X_CO. False: a part is flat, which has no
/// body; `thickened`, Bullet's margin of 0.4 mm makes it one.
bool make_hull_shape(const Triangles& triangles, const btTransform& X_CO, bool thickened, HullShape& shape);

/// Of triangles that stand still: parts that are closed and convex as hulls, in O [kUnitsPerMetre]; returns
/// the triangles of the others, which take longer.
std::vector<std::uint32_t> take_convex_parts(const Triangles& triangles, HullShape& convex);

}  // namespace lumbrical
