#include "bullet/hull_shape.h"

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include "base/disjoint_sets.h"

namespace lumbrical {
namespace {

// [m] Bullet keeps this much round a hull for itself; so the hull is made smaller by it.
constexpr double kMargin = 4e-4;

// The most that is taken off, as a share of a hull's inner radius.
constexpr double kMostOff = 0.2;

// Vertices that hang together.
DisjointSets parts_of(const Triangles& triangles) {
  DisjointSets parts(triangles.x.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    parts.join(triangles.a[t], triangles.b[t]);
    parts.join(triangles.a[t], triangles.c[t]);
  }
  return parts;
}

bool add_hull(const std::vector<btVector3>& points, HullShape& shape) {
  if (points.size() < 4) return false;
  btConvexHullComputer computer;
  const double off = computer.compute(&points[0].x(), sizeof(btVector3), static_cast<int>(points.size()),
                                      kMargin * kUnitsPerMetre, kMostOff);
  if (!(off > 0) || computer.vertices.size() < 4) return false;
  auto hull = std::make_unique<btConvexHullShape>(&computer.vertices[0].x(), computer.vertices.size(),
                                                  static_cast<int>(sizeof(btVector3)));
  hull->setMargin(off);
  shape.whole->addChildShape(btTransform::getIdentity(), hull.get());
  shape.hulls.push_back(std::move(hull));
  return true;
}

}  // namespace

bool make_hull_shape(const Triangles& triangles, const btTransform& X_CO, HullShape& shape) {
  shape.whole = std::make_unique<btCompoundShape>();
  DisjointSets parts = parts_of(triangles);
  std::vector<std::vector<btVector3>> points(triangles.x.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3 p = kUnitsPerMetre * triangles.vertex(i);
    points[parts.find(i)].push_back(X_CO * btVector3(p.x, p.y, p.z));
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    std::vector<btVector3>& own = points[parts.find(triangles.a[t])];
    if (own.empty()) continue;  // done already
    if (!add_hull(own, shape)) return false;
    own.clear();
  }
  return true;
}

}  // namespace lumbrical
