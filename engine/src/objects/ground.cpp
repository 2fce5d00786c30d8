#include "objects/ground.h"

#include <cmath>

namespace lumbrical {
namespace {

// [m] So far a body sinks in at a single point that carries it and what presses it, while that is
// no more than kHeld [N]: a light thing is as hard to press in, and without a hand doesn't rattle as on
// anvils.
constexpr double kRestingDepth = 5e-5, kHeld = 2.5;

// [m/s] What is deeper in, since it began there or fell fast, comes out no faster; what comes down faster
// than that is not held so hard, or what spins would rattle at low rates.
constexpr double kMostRising = 0.2, kFalling = 1;

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
               double load, const Twist& expected, double dt, SupportShares& sticks, ObjectState& state,
               Springs& springs) {
  Wrench wrench;
  const Vec3 centre = transform(state.pose, body.centre);
  // Damped as strongly as does without a bounce.
  const double stiffness = max(weight, min(load, kHeld)) / kRestingDepth,
               critical = 2 * std::sqrt(stiffness * body.mass);
  const auto damping_of = [&](const Support& support) {
    return support.rising < -kFalling ? critical : max(critical, stiffness * support.depth / kMostRising);
  };
  FixedList<Support, kMostSupports> supports;
  double touching = 0, most_damping = critical;
  for (const Vec3 point : points) {
    supports.push_back(support_at(ground, transform(state.pose, point), centre, state));
    if (!(supports.back().depth > 0)) continue;
    ++touching;
    most_damping = max(most_damping, damping_of(supports.back()));
  }
  const double given_way = 1 + dt * (dt * stiffness + most_damping) * touching / body.mass;
  for (std::size_t i = 0; i < points.size(); ++i) {
    SupportState& anchor = state.support[i];
    const auto& [arm, speed, depth, rising] = supports.begin()[i];
    const double damping = damping_of(supports.begin()[i]), resistance = stiffness + damping / dt;
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
    if (drawn > most) anchor.shear = (most / drawn) * anchor.shear;
    const Vec3 force = stiffness * depth * ground.normal - stiffness * anchor.shear;
    wrench.force += force;
    wrench.torque += cross(arm, force);
    springs.push_back({arm, ground.normal, resistance, 0, 0});
    if (!(most > 0)) continue;
    // What slides is not held unless it would slide the other way in the end: a hand presses light things so
    // hard that friction turns them round within a step.
    const Vec3 end = expected.velocity + cross(expected.angular_velocity, arm),
               drawing = end - dot(ground.normal, end) * ground.normal;
    const Vec3 now = (1 / most) * anchor.shear, more = (dt * resistance / (stiffness * most)) * drawing;
    sticks[i] = next_share(sticks[i], share_within(dot(now, now), dot(now, more), dot(more, more)));
    springs.back().across = resistance * sticks[i].now;
  }
  return wrench;
}

}  // namespace lumbrical
