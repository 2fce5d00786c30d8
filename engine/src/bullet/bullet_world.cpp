// The seam to Bullet: see lumbrical/bullet.h.
#include "lumbrical/bullet.h"

#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "bullet/hull_shape.h"

namespace lumbrical {

struct BulletBodies {
  /// One body, and what it refers to.
  struct Given {
    HullShape shape;
    std::unique_ptr<btRigidBody> body;
    btTransform X_OC;       ///< its centre of mass and main axes in O, in Bullet's units
    std::size_t place = 0;  ///< in Model::apart
    bool moved_here = false;
  };
  std::vector<Given> given;
  // What stands still.
  std::vector<btScalar> points;
  std::vector<int> corners;
  std::unique_ptr<btTriangleIndexVertexArray> arrays;
  std::unique_ptr<btBvhTriangleMeshShape> mesh;
  std::unique_ptr<btStaticPlaneShape> plane;
  std::vector<std::unique_ptr<btRigidBody>> still;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

namespace {

constexpr double kSquare = kUnitsPerMetre * kUnitsPerMetre;

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
  if (!make_hull_shape(object.shape->triangles, added.X_OC.inverse(), added.shape))
    return Status::error("object \"" + object.name +
                         "\" has a part that is flat, which has no body in Bullet; give it some thickness");
  btRigidBody::btRigidBodyConstructionInfo info(properties.mass, nullptr, added.shape.whole.get(), moments);
  info.m_startWorldTransform = to_bullet(object.start) * added.X_OC;
  info.m_friction = friction;
  added.body = std::make_unique<btRigidBody>(info);
  if (!added.moved_here)
    added.body->setCollisionFlags(added.body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  added.body->setActivationState(DISABLE_DEACTIVATION);  // a finger may push at any time
  return {};
}

void add_still(btCollisionShape& shape, double friction, BulletBodies& bodies) {
  btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, &shape);
  info.m_friction = friction;
  bodies.still.push_back(std::make_unique<btRigidBody>(info));
}

void add_world(const Triangles& triangles, double friction, BulletBodies& bodies) {
  if (triangles.size() == 0) return;
  for (std::uint32_t i = 0; i < triangles.x.size(); ++i) {
    const Vec3 p = kUnitsPerMetre * triangles.vertex(i);
    bodies.points.insert(bodies.points.end(), {p.x, p.y, p.z});
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t corner : {triangles.a[t], triangles.b[t], triangles.c[t]})
      bodies.corners.push_back(static_cast<int>(corner));
  }
  bodies.arrays = std::make_unique<btTriangleIndexVertexArray>(
      static_cast<int>(triangles.size()), bodies.corners.data(), static_cast<int>(3 * sizeof(int)),
      static_cast<int>(triangles.x.size()), bodies.points.data(), static_cast<int>(3 * sizeof(btScalar)));
  bodies.mesh = std::make_unique<btBvhTriangleMeshShape>(bodies.arrays.get(), true);
  bodies.mesh->setMargin(0);
  add_still(*bodies.mesh, friction, bodies);
}

void add_ground(const Ground& ground, double friction, BulletBodies& bodies) {
  bodies.plane =
      std::make_unique<btStaticPlaneShape>(to_bullet(ground.normal, 1), kUnitsPerMetre * ground.offset);
  // Bullet multiplies the frictions of two that touch.
  add_still(*bodies.plane, friction > 0 ? ground.friction / friction : 0, bodies);
}

}  // namespace

Status make_bullet_world(const Model& model, const BulletOptions& options, BulletWorld& world) {
  if (!(options.friction >= 0 && options.friction <= 10))
    return Status::error("the friction between bodies is out of range: give 0 to 10");
  if (model.world) return Status::error("a world in a file can't be Bullet's too; make it a scene in memory");
  auto bodies = std::make_shared<BulletBodies>();
  const double friction = std::sqrt(options.friction);
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    if (model.apart[i].mechanism.mobility != Mobility::given) continue;
    if (Status status = add_given(model.apart[i], i, friction, *bodies); !status.ok()) return status;
  }
  add_world(model.triangles, friction, *bodies);
  if (model.ground) add_ground(*model.ground, friction, *bodies);
  bodies->world.setGravity(to_bullet(model.gravity, kUnitsPerMetre));
  for (const BulletBodies::Given& body : bodies->given) bodies->world.addRigidBody(body.body.get());
  for (const auto& body : bodies->still) bodies->world.addRigidBody(body.get());
  world.bodies = std::move(bodies);
  return {};
}

void push_bodies(BulletWorld& world, std::span<const ObjectOutput> outputs) {
  for (BulletBodies::Given& body : world.bodies->given) {
    const ObjectOutput& out = outputs[body.place];
    if (!body.moved_here) continue;
    const Vec3 centre = from_bullet(body.body->getWorldTransform().getOrigin(), 1 / kUnitsPerMetre);
    const Vec3 torque = out.wrench.torque - cross(centre - out.pose.position, out.wrench.force);
    body.body->applyCentralForce(to_bullet(out.wrench.force, kUnitsPerMetre));
    body.body->applyTorque(to_bullet(torque, kSquare));
  }
}

void move_bodies(BulletWorld& world, double dt, std::span<ObjectFrame> given) {
  std::vector<BulletBodies::Given>& bodies = world.bodies->given;
  for (std::size_t i = 0; i < bodies.size() && i < given.size(); ++i)
    if (!bodies[i].moved_here) bodies[i].body->setWorldTransform(to_bullet(given[i].pose));
  world.bodies->world.stepSimulation(dt, 0);
  for (std::size_t i = 0; i < bodies.size() && i < given.size(); ++i)
    if (bodies[i].moved_here)
      given[i].pose = from_bullet(bodies[i].body->getWorldTransform() * bodies[i].X_OC.inverse());
}

btDiscreteDynamicsWorld& dynamics_of(BulletWorld& world) { return world.bodies->world; }

}  // namespace lumbrical
