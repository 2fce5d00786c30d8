#include "objects/move_on.h"

namespace lumbrical {
namespace {

// How often a step is taken anew: the second time two of them tell which share of skin sticks (touches.cpp).
constexpr int kAnew = 2;

// What holds it in this tick.
Mechanism held_by_latch(const ApartObject& object, const ObjectState& state, const ObjectState& handle) {
  Mechanism mechanism = object.mechanism;
  if (&state != &handle && state.coordinate <= 0 && handle.coordinate < mechanism.latch.opens)
    mechanism.upper = 0;
  return mechanism;
}

bool lies_on_ground(const Model& model, const ApartObject& object) {
  return model.ground.has_value() && object.mechanism.mobility == Mobility::free;
}

// Under `wrench` [about its centre of mass, W] of what gives way like `springs`, to which the ground's are
// added, to a speed like the one expected. Returns the speed it then has.
Twist step(const Model& model, const ApartObject& object, Wrench wrench, const ObjectState& handle,
           const Twist& expected, double dt, SupportShares& sticks, Springs& springs, ObjectState& state) {
  const MassProperties& body = object.mechanism.body;
  wrench.force += body.mass * model.gravity;
  if (lies_on_ground(model, object)) {
    const double weight = body.mass * max(1, norm(model.gravity));
    const double load = -dot(model.ground->normal, wrench.force);
    const Wrench borne =
        rest_on(*model.ground, object.supports, body, weight, load, expected, dt, sticks, state, springs);
    wrench.force += borne.force;
    wrench.torque += borne.torque;
  }
  return advance_body(held_by_latch(object, state, handle), object.start, springs, wrench, dt, state);
}

}  // namespace

void move_on(const Model& model, const ApartObject& object, const ObjectState& handle, double dt,
             std::span<Touch> touches, ObjectState& state) {
  const Quat orientation = state.pose.orientation;
  const Wrench wrench = wrench_on_object(touches, transform(state.pose, object.mechanism.body.centre));
  SupportShares sticks;
  const auto moved = [&](const Twist& expected) {
    Springs springs;
    for (const Touch& touch : touches) springs.push_back(touch.spring);
    return step(model, object, wrench, handle, expected, dt, sticks, springs, state);
  };
  const Twist now{state.velocity, state.angular_velocity};
  if (touches.empty()) {
    moved(now);
    return;
  }
  soften(now, dt, orientation, touches);
  const ObjectState before = state;
  const bool on_ground = lies_on_ground(model, object);
  Twist reached = moved(now);
  for (int anew = 0; anew < kAnew && (soften(reached, dt, orientation, touches) || on_ground); ++anew) {
    state = before;
    reached = moved(reached);
  }
  give_way(reached, dt, touches);
}

}  // namespace lumbrical
