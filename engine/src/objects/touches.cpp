#include "objects/touches.h"

#include "base/wrench.h"

namespace lumbrical {
namespace {

// A patch's stiffness is that of a plane, and even a plane's grows with depth, so of a touch that has hardly
// begun it may be far from right: within a tick, as skin and object go on, no touch grows by more than
// what it was.
constexpr double kMostGrowth = 1;

// Nor does what presses move to beyond what is touched.
bool soften_tilt(const Twist& speed, double dt, double pushed, double reach, Spring& spring) {
  Spring tilting = spring;
  tilting.along = tilting.across = tilting.about = 0;
  const double torque = norm(change_of(tilting, speed, dt).torque), most = pushed * reach;
  if (!(torque > most)) return false;
  spring.tilt *= most / torque;
  return true;
}

bool soften(const Twist& speed, double dt, Quat orientation, Touch& touch) {
  Spring& spring = touch.spring;
  const double along = spring.along;
  spring.across = touch.across;
  spring.about = touch.about;
  const double pushed = max(0, dot(touch.wrench.force, spring.normal)),
               pulled = dot(change_of(spring, speed, dt).force, spring.normal);
  if (pulled > pushed) spring.along *= pushed / pulled;
  if (-pulled > kMostGrowth * pushed) spring.along *= kMostGrowth * pushed / -pulled;
  bool softer = spring.along < along;
  if (spring.tilt > 0) softer = soften_tilt(speed, dt, pushed, touch.reach, spring) || softer;
  if (!(spring.across > 0)) return softer;
  Spring skin = spring;
  skin.along = skin.tilt = 0;
  const Wrench drawn = rotated(conjugate(orientation), -change_of(skin, speed, dt));
  const double share = share_that_sticks(touch.friction, drawn.force, drawn.torque);
  const double taken = touch.sticks.now;
  touch.sticks = next_share(touch.sticks, share);
  spring.across *= touch.sticks.now;
  spring.about *= touch.sticks.now;
  return softer || touch.sticks.now != taken;
}

}  // namespace

Wrench wrench_on_object(std::span<const Touch> touches, Vec3 centre) {
  Wrench sum;
  for (const Touch& touch : touches) sum += -about(touch.joint - centre, touch.wrench);
  return sum;
}

void slacken_damper(double dt, const ObjectState& state, Touch& touch) {
  Spring& spring = touch.spring;
  const double speed = dot(spring.normal, velocity_at(state, spring.arm) - spring.anchor.velocity);
  touch.wrench += about(touch.arm, {(-touch.damper * speed) * spring.normal, {}});
  spring.along += touch.damper / dt;
}

void add_palm(const PalmStiffness& palm, Touch& touch) {
  touch.spring.along += palm.along - touch.guess;
  touch.spring.tilt = palm.tilt;
  touch.reach = palm.reach;
  touch.guess = 0;
}

bool soften(const Twist& speed, double dt, Quat orientation, std::span<Touch> touches) {
  bool softer = false;
  for (Touch& touch : touches) softer = soften(speed, dt, orientation, touch) || softer;
  return softer;
}

void give_way(const Twist& speed, double dt, std::span<Touch> touches) {
  for (Touch& touch : touches) touch.wrench += about(touch.arm, -change_of(touch.spring, speed, dt));
}

}  // namespace lumbrical
