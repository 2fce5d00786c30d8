// The seam to Bullet: see lumbrical/bullet.h.
#include "lumbrical/bullet.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

#include "base/wrench.h"
#include "bullet/flat_faces.h"
#include "bullet/hull_shape.h"
#include "bullet/skin_springs.h"
#include "bullet/steady_points.h"
#include "objects/move_on.h"
#include "objects/pushing_hands.h"
#include "objects/told_pose.h"

namespace lumbrical {

struct BulletBodies {
  /// One body, and what it refers to.
  struct Given {
    HullShape shape;
    std::unique_ptr<btRigidBody> body;
    std::unique_ptr<SkinSprings> skin;  ///< of one that is moved here
    btTransform X_OC;                   ///< its centre of mass and main axes in O, in Bullet's units
    std::size_t place = 0;              ///< in Model::apart
    bool moved_here = false;
    bool told = false;     ///< where it is, of one that goes where it is told
    btTransform from, to;  ///< in a tick, of such a one
  };
  std::vector<Given> given;
  PushingHands hands;
  /// Triangles that stand still: the world's, or those of an object apart.
  struct StillMesh {
    HullShape convex;  ///< parts that are
    std::vector<btScalar> points;
    std::vector<int> corners;
    std::unique_ptr<btTriangleIndexVertexArray> arrays;
    std::unique_ptr<btBvhTriangleMeshShape> shape;
  };
  std::vector<StillMesh> meshes;
  std::unique_ptr<btStaticPlaneShape> plane;
  std::vector<std::unique_ptr<btRigidBody>> still;
  btRigidBody fixed{0, nullptr, nullptr};
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  SoftSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

namespace {

constexpr double kSquare = kUnitsPerMetre * kUnitsPerMetre;

// Bullet's own 10 leave a stack of things of unequal weight, and light ones at 500 Hz, unsteady.
constexpr int kIterations = 30;

// [s] Where a hand presses much harder than by a body's weight, what the solver leaves over in a longer step
// shakes the body, tips it over or throws it off: 20 g on a table under 3 N at 1 kHz, in one step.
constexpr double kLongestStep = 2.5e-4;

// The root of the friction between bodies that share none: something that the ground's can be a multiple of.
constexpr double kLeastFriction = 1e-3;

btVector3 to_bullet(Vec3 p, double scale) { return {scale * p.x, scale * p.y, scale * p.z}; }
Vec3 from_bullet(const btVector3& p, double scale) { return {scale * p.x(), scale * p.y(), scale * p.z()}; }

btTransform to_bullet(const Pose& pose) {
  const Quat q = pose.orientation;
  return btTransform(btQuaternion(q.x, q.y, q.z, q.w), to_bullet(pose.position, kUnitsPerMetre));
}
Pose from_bullet(const btTransform& pose) {
  const btQuaternion q = pose.getRotation();
  return {from_bullet(pose.getOrigin(), 1 / kUnitsPerMetre), {q.w(), q.x(), q.y(), q.z()}};
}

// Where the inertia's main axes are, and the moments about them.
btTransform main_axes(const MassProperties& properties, btVector3& moments) {
  const auto& [xx, yy, zz, xy, yz, zx] = properties.inertia;
  btMatrix3x3 inertia(xx, xy, zx, xy, yy, yz, zx, yz, zz), axes;
  inertia.diagonalize(axes, 1e-9, 30);
  moments = kSquare * btVector3(inertia[0][0], inertia[1][1], inertia[2][2]);
  return btTransform(axes, to_bullet(properties.centre, kUnitsPerMetre));
}

Status add_given(const ApartObject& object, std::size_t place, double friction, BulletBodies& bodies) {
  BulletBodies::Given& added = bodies.given.emplace_back();
  const MassProperties& properties = object.mechanism.body;
  added.place = place;
  added.moved_here = properties.mass > 0;
  added.X_OC.setIdentity();
  btVector3 moments(0, 0, 0);
  if (added.moved_here) added.X_OC = main_axes(properties, moments);
  if (!make_hull_shape(object.shape->triangles, added.X_OC.inverse(), !added.moved_here, added.shape))
    return Status::error("object \"" + object.name +
                         "\" has a part that is flat, which has no body in Bullet; give it some thickness");
  btRigidBody::btRigidBodyConstructionInfo info(properties.mass, nullptr, added.shape.whole.get(), moments);
  info.m_startWorldTransform = to_bullet(object.start) * added.X_OC;
  info.m_friction = friction;
  added.body = std::make_unique<btRigidBody>(info);
  if (!added.moved_here)
    added.body->setCollisionFlags(added.body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  // Friction that stops speeds only lets what rests on each other creep, by 0.1 mm a second at 500 Hz.
  added.body->setCollisionFlags(added.body->getCollisionFlags() | btCollisionObject::CF_HAS_FRICTION_ANCHOR);
  added.body->setActivationState(DISABLE_DEACTIVATION);  // a finger may push at any time
  if (added.moved_here) added.skin = std::make_unique<SkinSprings>(*added.body, bodies.fixed);
  return {};
}

void add_still(btCollisionShape& shape, const Pose& pose, double friction, BulletBodies& bodies) {
  btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, &shape);
  info.m_startWorldTransform = to_bullet(pose);
  info.m_friction = friction;
  bodies.still.push_back(std::make_unique<btRigidBody>(info));
}

void add_still_mesh(const Triangles& triangles, const Pose& pose, double friction, BulletBodies& bodies) {
  if (triangles.size() == 0) return;
  BulletBodies::StillMesh& still = bodies.meshes.emplace_back();
  const std::vector<std::uint32_t> others = take_convex_parts(triangles, still.convex);
  if (!still.convex.hulls.empty()) add_still(*still.convex.whole, pose, friction, bodies);
  if (others.empty()) return;
  const Mesh mesh = with_whole_faces(triangles, others);
  if (mesh.triangles.empty()) return;
  for (const Vec3 p : mesh.vertices)
    still.points.insert(still.points.end(),
                        {kUnitsPerMetre * p.x, kUnitsPerMetre * p.y, kUnitsPerMetre * p.z});
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) still.corners.push_back(static_cast<int>(corner));
  }
  still.arrays = std::make_unique<btTriangleIndexVertexArray>(
      static_cast<int>(mesh.triangles.size()), still.corners.data(), static_cast<int>(3 * sizeof(int)),
      static_cast<int>(mesh.vertices.size()), still.points.data(), static_cast<int>(3 * sizeof(btScalar)));
  still.shape = std::make_unique<btBvhTriangleMeshShape>(still.arrays.get(), true);
  still.shape->setMargin(0);
  add_still(*still.shape, pose, friction, bodies);
}

void add_ground(const Ground& ground, double friction, BulletBodies& bodies) {
  bodies.plane =
      std::make_unique<btStaticPlaneShape>(to_bullet(ground.normal, 1), kUnitsPerMetre * ground.offset);
  // Bullet multiplies the frictions of two that touch.
  add_still(*bodies.plane, {}, ground.friction / friction, bodies);
}

// As a tick takes it: what is no pose leaves it where it is, and what jumps has not been moved there, so it
// has no speed.
void tell(const Pose& pose, BulletBodies::Given& given) {
  given.from = given.to = given.body->getWorldTransform();
  if (!is_pose(pose)) return;
  const Pose now{pose.position, normalized(pose.orientation)};
  given.to = to_bullet(now);
  if (!given.told || is_jump(from_bullet(given.from), now)) {
    given.from = given.to;
    given.body->setInterpolationWorldTransform(given.to);
  }
  given.told = true;
}

// As far as this share of the tick.
void go(double share, BulletBodies::Given& given) {
  if (!given.told) return;
  const btQuaternion turned = given.from.getRotation().slerp(given.to.getRotation(), share);
  given.body->setWorldTransform(
      btTransform(turned, given.from.getOrigin().lerp(given.to.getOrigin(), share)));
}

Pose pose_of(const BulletBodies::Given& given) {
  return from_bullet(given.body->getWorldTransform() * given.X_OC.inverse());
}

Twist speed_of(const btRigidBody& body) {
  return {from_bullet(body.getLinearVelocity(), 1 / kUnitsPerMetre),
          from_bullet(body.getAngularVelocity(), 1)};
}

// By what hands do as a step of `dt` [s] begins, and by how that changes as the body gives way: at the speed
// that it has, here, and as that changes, by springs. How soft skin is where it slips or lifts off tells the
// step that the body would take with nothing else about. Returns the touches with such springs.
std::vector<Touch> push(const Model& model, double dt, std::span<const Touch> touches,
                        BulletBodies::Given& given) {
  given.skin->clear();
  std::vector<Touch> soft(touches.begin(), touches.end());
  if (touches.empty()) return soft;
  const ApartObject& object = model.apart[given.place];
  const Pose pose = pose_of(given);
  const Twist speed = speed_of(*given.body);
  Wrench wrench = wrench_on_object(touches, transform(pose, object.mechanism.body.centre));
  ObjectState alone{pose, speed.velocity, speed.angular_velocity};
  move_on(model, object, alone, dt, soft, alone);
  Matrix6 stiffness{};
  for (std::size_t i = 0; i < touches.size(); ++i) {
    soft[i].wrench = touches[i].wrench;
    const Wrench change = change_of(soft[i].spring, speed, dt);
    wrench += about(soft[i].spring.arm, change);
    add_spring(soft[i].spring, 1, stiffness);
  }
  given.body->applyCentralForce(to_bullet(wrench.force, kUnitsPerMetre));
  given.body->applyTorque(to_bullet(wrench.torque, kSquare));
  given.skin->set(stiffness, dt);
  return soft;
}

// What touches have become after a step.
void go_on(double dt, std::span<Touch> soft, const BulletBodies::Given& given, std::span<Touch> touches) {
  give_way(speed_of(*given.body), dt, soft);
  for (std::size_t i = 0; i < touches.size(); ++i) touches[i].wrench = soft[i].wrench;
}

void step(const Model& model, double dt, double share, BulletBodies& bodies) {
  std::vector<std::vector<Touch>> soft(bodies.given.size());
  for (std::size_t i = 0; i < bodies.given.size(); ++i) {
    BulletBodies::Given& one = bodies.given[i];
    if (one.moved_here)
      soft[i] = push(model, dt, bodies.hands.touches[one.place], one);
    else
      go(share, one);
  }
  bodies.world.stepSimulation(dt, 0);
  for (std::size_t i = 0; i < bodies.given.size(); ++i)
    if (bodies.given[i].moved_here)
      go_on(dt, soft[i], bodies.given[i], bodies.hands.touches[bodies.given[i].place]);
}

}  // namespace

Status make_bullet_world(const Model& model, const BulletOptions& options, BulletWorld& world) {
  if (!(options.friction >= 0 && options.friction <= 10))
    return Status::error("the friction between bodies is out of range: give 0 to 10");
  if (model.world) return Status::error("a world in a file can't be Bullet's too; make it a scene in memory");
  auto bodies = std::make_shared<BulletBodies>();
  const double friction = max(std::sqrt(options.friction), kLeastFriction);
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    const ApartObject& object = model.apart[i];
    if (object.mechanism.mobility == Mobility::fixed)
      add_still_mesh(object.shape->triangles, object.start, friction, *bodies);
    if (object.mechanism.mobility != Mobility::given) continue;
    if (Status status = add_given(object, i, friction, *bodies); !status.ok()) return status;
  }
  add_still_mesh(model.triangles, {}, friction, *bodies);
  if (model.ground) add_ground(*model.ground, friction, *bodies);
  bodies->world.getSolverInfo().m_numIterations = kIterations;
  bodies->dispatcher.setNearCallback(find_steady_points);
  bodies->world.setGravity(to_bullet(model.gravity, kUnitsPerMetre));
  bodies->hands.touches = std::vector<PushingHands::OfAll>(model.apart.size());
  for (const BulletBodies::Given& body : bodies->given) {
    bodies->world.addRigidBody(body.body.get());
    if (body.skin) bodies->world.addConstraint(body.skin.get());
  }
  for (const auto& body : bodies->still) bodies->world.addRigidBody(body.get());
  world.bodies = std::move(bodies);
  return {};
}

void push_bodies(BulletWorld& world, const Model& model, Scratch& scratch) {
  if (scratch.touches) add_hand(model, model, scratch, world.bodies->hands);
}

void move_bodies(BulletWorld& world, const Model& model, std::span<ObjectFrame> given) {
  BulletBodies& bodies = *world.bodies;
  const std::size_t count = std::min(bodies.given.size(), given.size());
  for (std::size_t i = 0; i < count; ++i)
    if (!bodies.given[i].moved_here) tell(given[i].pose, bodies.given[i]);
  const double dt = 1 / model.settings.rate;
  const int steps = static_cast<int>(std::ceil(dt / kLongestStep * (1 - 1e-9)));
  for (int i = 0; i < steps; ++i) step(model, dt / steps, (i + 1.0) / steps, bodies);
  forget_hands(bodies.hands);
  for (std::size_t i = 0; i < count; ++i)
    if (bodies.given[i].moved_here) given[i].pose = pose_of(bodies.given[i]);
}

}  // namespace lumbrical
