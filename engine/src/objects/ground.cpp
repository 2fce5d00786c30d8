#include "objects/ground.h"

#include <cmath>

#include "objects/friction.h"

namespace lumbrical {
namespace {

// [m] So far a body sinks in at a single point that carries it.
constexpr double kRestingDepth = 5e-5;

struct Support {
  Vec3 arm, speed;  // W, from the centre of mass
  double depth = 0, rising = 0;
};

Support support_at(const Ground& ground, Vec3 point, Vec3 centre, const ObjectState& state) {
  const Vec3 arm = point - centre, speed = velocity_at(state, arm);
  return {arm, speed, ground.offset - dot(ground.normal, point), dot(ground.normal, speed)};
}

}  // namespace

Wrench rest_on(const Ground& ground, std::span<const Vec3> points, const MassProperties& body, double weight,
               double load, double dt, ObjectState& state, Springs& springs) {
  Wrench wrench;
  const Vec3 centre = transform(state.pose, body.centre);
  // Damped as strongly as does without a bounce.
  const double stiffness = weight / kRestingDepth, damping = 2 * std::sqrt(stiffness * body.mass);
  const double resistance = stiffness + damping / dt;
  FixedList<Support, kMostSupports> supports;
  double touching = 0;
  for (const Vec3 point : points) {
    supports.push_back(support_at(ground, transform(state.pose, point), centre, state));
    touching += supports.back().depth > 0 ? 1 : 0;
  }
  const double given_way = 1 + dt * dt * resistance * touching / body.mass;
  for (std::size_t i = 0; i < points.size(); ++i) {
    SupportState& anchor = state.support[i];
    const auto& [arm, speed, depth, rising] = supports.begin()[i];
    if (!(depth > 0) || !(stiffness * depth - damping * rising > 0)) {
      anchor = {};
      continue;
    }
    const Vec3 along = speed - rising * ground.normal;
    if (anchor.holds > 0) anchor.shear += dt * along;
    anchor.holds = 1;
    // What presses here in the end of a step in which all that touch give way alike: friction goes by it.
    const double later = (rising + dt * (stiffness * depth * touching - load) / body.mass) / given_way;
    const double pressed = max(0, stiffness * depth - dt * resistance * later);
    const double most = ground.friction * pressed / stiffness;
    const double drawn = norm(anchor.shear);
    const bool slides = drawn > most || !(most > 0);
    if (drawn > most) anchor.shear = (most / drawn) * anchor.shear;
    const Vec3 force = stiffness * depth * ground.normal - stiffness * anchor.shear;
    wrench.force += force;
    wrench.torque += cross(arm, force);
    springs.push_back({arm, ground.normal, resistance, 0, 0});
    if (slides) continue;
    const Vec3 now = (1 / most) * anchor.shear, more = (dt * resistance / (stiffness * most)) * along;
    springs.back().across = resistance * share_within(dot(now, now), dot(now, more), dot(more, more));
  }
  return wrench;
}

}  // namespace lumbrical
