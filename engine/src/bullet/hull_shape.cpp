#include "bullet/hull_shape.h"

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <numeric>

namespace lumbrical {
namespace {

// [m] Bullet keeps this much round a hull for itself; so the hull is made smaller by it.
constexpr double kMargin = 4e-4;

// The most that is taken off, as a share of a hull's inner radius.
constexpr double kMostOff = 0.2;

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// For each vertex the first of those it hangs together with.
std::vector<std::uint32_t> parts_of(const Triangles& triangles) {
  std::vector<std::uint32_t> parent(triangles.x.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto join = [&](std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = root_of(parent, i), b = root_of(parent, j);
    parent[std::max(a, b)] = std::min(a, b);
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    join(triangles.a[t], triangles.b[t]);
    join(triangles.a[t], triangles.c[t]);
  }
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = root_of(parent, i);
  return parent;
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
  const std::vector<std::uint32_t> part = parts_of(triangles);
  std::vector<std::vector<btVector3>> points(part.size());
  for (std::uint32_t i = 0; i < part.size(); ++i) {
    const Vec3 p = kUnitsPerMetre * triangles.vertex(i);
    points[part[i]].push_back(X_CO * btVector3(p.x, p.y, p.z));
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    std::vector<btVector3>& own = points[part[triangles.a[t]]];
    if (own.empty()) continue;  // done already
    if (!add_hull(own, shape)) return false;
    own.clear();
  }
  return true;
}

}  // namespace lumbrical
