// Bullet 3: fingertips are spheres on springs to their tracked places, as virtual couplings have it.
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <memory>

#include "hold.h"

namespace lumbrical::bench {
namespace {

constexpr double kUnits = 100;  // per metre: Bullet's thresholds are made for things of some units

btVector3 to_bullet(Vec3 p) { return {kUnits * p.x, kUnits * p.y, kUnits * p.z}; }
Vec3 from_bullet(const btVector3& p) { return {p.x() / kUnits, p.y() / kUnits, p.z() / kUnits}; }

struct BulletHold {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;  // the held one, then the fingertips
  std::vector<Vec3> felt;

  btRigidBody& add(std::unique_ptr<btCollisionShape> shape, double mass, Vec3 place, double friction) {
    btVector3 inertia;
    shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
    info.m_startWorldTransform.setIdentity();
    info.m_startWorldTransform.setOrigin(to_bullet(place));
    info.m_friction = std::sqrt(friction);  // that of two is multiplied
    info.m_spinningFriction = std::sqrt(friction) * kTwistRadius * kUnits;
    shapes.push_back(std::move(shape));
    bodies.push_back(std::make_unique<btRigidBody>(info));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get());
    return *bodies.back();
  }
  void step(std::span<const Vec3> tips) {
    for (std::size_t i = 0; i < tips.size(); ++i) {
      btRigidBody& tip = *bodies[i + 1];
      const Vec3 place = from_bullet(tip.getWorldTransform().getOrigin());
      const Vec3 speed = from_bullet(tip.getLinearVelocity());
      const double damping = 2 * std::sqrt(kCoupling * kTipMass);
      const Vec3 pull = kCoupling * (tips[i] - place) - damping * speed;
      tip.applyCentralForce(to_bullet(pull));
      felt[i] = -pull;
    }
    world.stepSimulation(kHoldTick, 0);
  }
};

std::shared_ptr<BulletHold> make_hold(const HeldBody& body, std::span<const Vec3> tips) {
  const auto hold = std::make_shared<BulletHold>();
  hold->felt.resize(tips.size());
  const btVector3 half = to_bullet(body.half);
  std::unique_ptr<btCollisionShape> shape;
  if (body.cylinder)
    shape = std::make_unique<btCylinderShapeZ>(half);
  else
    shape = std::make_unique<btBoxShape>(half);
  hold->add(std::move(shape), body.mass, {}, body.friction);
  for (const Vec3 tip : tips) {
    btRigidBody& sphere =
        hold->add(std::make_unique<btSphereShape>(kUnits * kTipRadius), kTipMass, tip, body.friction);
    sphere.setAngularFactor(0);  // it turns with the finger, not by itself
  }
  hold->world.setGravity(to_bullet(body.gravity));
  for (std::size_t i = 1; i < hold->bodies.size(); ++i) hold->bodies[i]->setGravity({0, 0, 0});
  return hold;
}

}  // namespace

void add_bullet_holders(std::vector<HoldEngine>& engines) {
  engines.push_back({"Bullet 3.24", [](const HeldBody& body, std::span<const Vec3> tips) {
                       const auto hold = make_hold(body, tips);
                       return Holder{
                           [hold](std::span<const Vec3> now) { hold->step(now); },
                           [hold] {
                             const btTransform pose = hold->bodies[0]->getWorldTransform();
                             const btQuaternion q = pose.getRotation();
                             return Pose{from_bullet(pose.getOrigin()), {q.w(), q.x(), q.y(), q.z()}};
                           },
                           [hold](std::size_t finger) { return hold->felt[finger]; }};
                     }});
}

}  // namespace lumbrical::bench
