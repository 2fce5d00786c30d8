#include "bullet/steady_points.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <algorithm>
#include <array>

#include "bullet/hull_shape.h"

namespace lumbrical {
namespace {

// [kUnitsPerMetre] Where points differ by no more in depth, they all may carry: a body sinks by as much.
constexpr double kAlike = 2e-5 * kUnitsPerMetre;

// A new point has to make the square of the area that a body stands on larger by this, so that none goes for
// rounding.
constexpr double kWider = 1.02;

// Cosine of the angle from which on normals are of another face, such as a wall beside a floor.
constexpr double kSameFace = 0.9;

/// Four that are kept, and a new one.
constexpr std::size_t kNew = MANIFOLD_CACHE_SIZE;
static_assert(kNew == 4);
struct Points {
  std::array<btVector3, kNew + 1> at;
  std::array<double, kNew + 1> height;        ///< above the other body, below 0 in it
  std::array<bool, kNew + 1> is_on_its_face;  ///< of the new one
};

// Of twice the quadrangle with these corners, in whatever order: of the lines that join them, its diagonals
// have the largest product.
double square_of_area(const btVector3& a, const btVector3& b, const btVector3& c, const btVector3& d) {
  return std::max(
      {(a - b).cross(c - d).length2(), (a - c).cross(b - d).length2(), (a - d).cross(b - c).length2()});
}

double square_of_area_without(std::size_t left_out, const Points& points) {
  std::array<btVector3, kNew + 1> at = points.at;
  std::swap(at[left_out], at[kNew]);
  return square_of_area(at[0], at[1], at[2], at[3]);
}

// Which one on the new one's face a body can do without: what stands off, or else what the others reach as
// far without.
std::size_t least_needed(const Points& points) {
  std::size_t deepest = kNew, highest = kNew;
  for (std::size_t i = 0; i < kNew; ++i) {
    if (!points.is_on_its_face[i]) continue;
    if (points.height[i] < points.height[deepest]) deepest = i;
    if (points.height[i] > points.height[highest]) highest = i;
  }
  if (points.height[highest] - points.height[deepest] > kAlike) return highest;
  std::size_t least = kNew;
  double widest = kWider * square_of_area_without(kNew, points);
  for (std::size_t i = 0; i < kNew; ++i) {
    const double square = square_of_area_without(i, points);
    if (points.is_on_its_face[i] && square > widest) {
      widest = square;
      least = i;
    }
  }
  return least;
}

class SteadyPoints : public btManifoldResult {
 public:
  using btManifoldResult::btManifoldResult;

  void addContactPoint(const btVector3& normal, const btVector3& on_second, btScalar height) override {
    if (height > m_manifoldPtr->getContactBreakingThreshold()) return;
    if (make_room(normal, on_second + height * normal, height))
      btManifoldResult::addContactPoint(normal, on_second, height);
  }

 private:
  // False: the new point is the one to do without. What is the first on its face is left to Bullet.
  bool make_room(const btVector3& normal, const btVector3& on_first, double height) {
    btPersistentManifold& kept = *m_manifoldPtr;
    const btVector3 at = kept.getBody0()->getWorldTransform().invXform(on_first);
    const bool is_known = kept.getCacheEntry({at, at, normal, height}) >= 0;
    if (is_known || kept.getNumContacts() < static_cast<int>(kNew)) return true;
    Points points;
    for (std::size_t i = 0; i < kNew; ++i) {
      const btManifoldPoint& point = kept.getContactPoint(static_cast<int>(i));
      points.at[i] = point.m_localPointA;
      points.height[i] = point.getDistance();
      points.is_on_its_face[i] = point.m_normalWorldOnB.dot(normal) > kSameFace;
    }
    points.at[kNew] = at;
    points.height[kNew] = height;
    points.is_on_its_face[kNew] = true;
    if (std::count(points.is_on_its_face.begin(), points.is_on_its_face.end(), true) == 1) return true;
    const std::size_t least = least_needed(points);
    if (least == kNew) return false;
    kept.removeContactPoint(static_cast<int>(least));
    return true;
  }
};

bool is_mesh(const btCollisionObject& object) {
  return object.getCollisionShape()->getShapeType() == TRIANGLE_MESH_SHAPE_PROXYTYPE;
}

// As Bullet makes it for a whole object.
btCollisionObjectWrapper wrapped(const btCollisionObject& object) {
  return {nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1, -1};
}

}  // namespace

void find_steady_points(btBroadphasePair& pair, btCollisionDispatcher& dispatcher,
                        const btDispatcherInfo& info) {
  const auto* const first = static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  const auto* const second = static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  if (!is_mesh(*first) && !is_mesh(*second)) return dispatcher.defaultNearCallback(pair, dispatcher, info);
  if (!dispatcher.needsCollision(first, second)) return;
  const btCollisionObjectWrapper a = wrapped(*first), b = wrapped(*second);
  if (pair.m_algorithm == nullptr)
    pair.m_algorithm = dispatcher.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
  if (pair.m_algorithm == nullptr) return;
  SteadyPoints points(&a, &b);
  pair.m_algorithm->processCollision(&a, &b, info, &points);
}

}  // namespace lumbrical
