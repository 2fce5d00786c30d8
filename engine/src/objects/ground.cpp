#include "objects/ground.h"

#include <cmath>

namespace lumbrical {
namespace {

// [m] So far a body sinks in at a single point that carries it.
constexpr double kRestingDepth = 5e-5;

}  // namespace

Wrench rest_on(const Ground& ground, std::span<const Vec3> points, const MassProperties& body, double weight,
               double dt, ObjectState& state, Springs& springs) {
  Wrench wrench;
  const Vec3 centre = transform(state.pose, body.centre);
  // Damped as strongly as does without a bounce.
  const double stiffness = weight / kRestingDepth, damping = 2 * std::sqrt(stiffness * body.mass);
  for (std::size_t i = 0; i < points.size(); ++i) {
    SupportState& anchor = state.support[i];
    const Vec3 point = transform(state.pose, points[i]), arm = point - centre;
    const Vec3 speed = state.velocity + cross(state.angular_velocity, arm);
    const double depth = ground.offset - dot(ground.normal, point), rising = dot(ground.normal, speed);
    const double push = stiffness * depth - damping * rising;
    if (!(depth > 0) || !(push > 0)) {
      anchor = {};
      continue;
    }
    if (anchor.holds > 0) anchor.shear += dt * (speed - rising * ground.normal);
    anchor.holds = 1;
    const double most = ground.friction * push / stiffness, drawn = norm(anchor.shear);
    const bool slides = drawn > most;
    if (slides) anchor.shear = (most / drawn) * anchor.shear;
    const Vec3 force = stiffness * depth * ground.normal - stiffness * anchor.shear;
    wrench.force += force;
    wrench.torque += cross(arm, force);
    const double resistance = stiffness + damping / dt;
    springs.push_back({arm, ground.normal, resistance, slides ? 0 : resistance, 0});
  }
  return wrench;
}

}  // namespace lumbrical
