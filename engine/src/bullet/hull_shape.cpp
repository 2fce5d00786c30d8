#include "bullet/hull_shape.h"

#include <cmath>

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include "base/disjoint_sets.h"
#include "model/vertex_merge.h"

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

// Those at one place too: meshes whose faces have corners of their own hang together by nothing else.
DisjointSets joined_parts_of(const Triangles& triangles) {
  DisjointSets parts = parts_of(triangles);
  std::vector<Vec3> vertices;
  for (std::uint32_t i = 0; i < triangles.x.size(); ++i) vertices.push_back(triangles.vertex(i));
  const std::vector<std::uint32_t> first = first_at_same_position(vertices);
  for (std::uint32_t i = 0; i < first.size(); ++i) parts.join(i, first[i]);
  return parts;
}

void add_hull(const btVector3& first, int count, double margin, HullShape& shape) {
  auto hull = std::make_unique<btConvexHullShape>(&first.x(), count, static_cast<int>(sizeof(btVector3)));
  hull->setMargin(margin);
  shape.whole->addChildShape(btTransform::getIdentity(), hull.get());
  shape.hulls.push_back(std::move(hull));
}

bool add_hull(const std::vector<btVector3>& points, bool thickened, HullShape& shape) {
  const int count = static_cast<int>(points.size());
  constexpr double kOwn = kMargin * kUnitsPerMetre;
  btConvexHullComputer computer;
  const double off =
      count < 4 ? 0 : computer.compute(&points[0].x(), sizeof(btVector3), count, kOwn, kMostOff);
  if (off > 0 && computer.vertices.size() >= 4)
    add_hull(computer.vertices[0], computer.vertices.size(), off, shape);
  else if (thickened)
    add_hull(points[0], count, kOwn, shape);
  else
    return false;
  return true;
}

bool add_hulls(const Triangles& triangles, const btTransform& X_CO, DisjointSets parts, bool thickened,
               HullShape& shape) {
  shape = {};
  shape.whole = std::make_unique<btCompoundShape>();
  std::vector<std::vector<btVector3>> points(triangles.x.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3 p = kUnitsPerMetre * triangles.vertex(i);
    points[parts.find(i)].push_back(X_CO * btVector3(p.x, p.y, p.z));
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    std::vector<btVector3>& own = points[parts.find(triangles.a[t])];
    if (own.empty()) continue;  // done already
    if (!add_hull(own, thickened, shape)) return false;
    own.clear();
  }
  return true;
}

// Hulls of more corners take longer than their triangles, and parts of more triangles are no table.
constexpr int kMostCorners = 500;
constexpr std::size_t kMostTriangles = 100000;

// A convex part and its hull have as much room, but for rounding.
constexpr double kSameVolume = 1e-6;

double volume_of(const btConvexHullComputer& hull) {
  double sum = 0;
  for (int i = 0; i < hull.faces.size(); ++i) {
    const btConvexHullComputer::Edge* const first = &hull.edges[hull.faces[i]];
    const btVector3& a = hull.vertices[first->getSourceVertex()];
    for (auto edge = first->getNextEdgeOfFace(); edge->getNextEdgeOfFace() != first;
         edge = edge->getNextEdgeOfFace())
      sum += a.triple(hull.vertices[edge->getSourceVertex()], hull.vertices[edge->getTargetVertex()]) / 6;
  }
  return std::fabs(sum);
}

// Three of each triangle.
std::vector<btVector3> points_of(const Triangles& triangles, const std::vector<std::uint32_t>& part) {
  std::vector<btVector3> corners;
  for (const std::uint32_t t : part) {
    for (const std::uint32_t corner : {triangles.a[t], triangles.b[t], triangles.c[t]}) {
      const Vec3 p = kUnitsPerMetre * triangles.vertex(corner);
      corners.emplace_back(p.x, p.y, p.z);
    }
  }
  return corners;
}

bool is_convex(const std::vector<btVector3>& corners) {
  std::vector<btVector3> about;
  for (const btVector3& corner : corners) about.push_back(corner - corners[0]);
  double sum = 0;
  for (std::size_t i = 0; i < about.size(); i += 3) sum += about[i].triple(about[i + 1], about[i + 2]) / 6;
  btConvexHullComputer hull;
  hull.compute(&about[0].x(), sizeof(btVector3), static_cast<int>(about.size()), 0, 0);
  const double volume = volume_of(hull);
  return hull.vertices.size() <= kMostCorners && volume > 0 &&
         std::fabs(std::fabs(sum) - volume) <= kSameVolume * volume;
}

}  // namespace

std::vector<std::uint32_t> take_convex_parts(const Triangles& triangles, HullShape& convex) {
  convex.whole = std::make_unique<btCompoundShape>();
  DisjointSets parts = joined_parts_of(triangles);
  std::vector<std::vector<std::uint32_t>> part(triangles.x.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) part[parts.find(triangles.a[t])].push_back(t);
  std::vector<std::uint32_t> others;
  for (const std::vector<std::uint32_t>& one : part) {
    const bool may_be = !one.empty() && one.size() <= kMostTriangles;
    const std::vector<btVector3> points = may_be ? points_of(triangles, one) : std::vector<btVector3>();
    if (!may_be || !is_convex(points) || !add_hull(points, false, convex))
      others.insert(others.end(), one.begin(), one.end());
  }
  return others;
}

bool make_hull_shape(const Triangles& triangles, const btTransform& X_CO, bool thickened, HullShape& shape) {
  return add_hulls(triangles, X_CO, parts_of(triangles), false, shape) ||
         add_hulls(triangles, X_CO, joined_parts_of(triangles), thickened, shape);
}

}  // namespace lumbrical
