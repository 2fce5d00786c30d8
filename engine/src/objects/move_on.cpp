#include "objects/move_on.h"

namespace lumbrical {
namespace {

// What holds it in this tick.
Mechanism held_by_latch(const ApartObject& object, const ObjectState& state, const ObjectState& handle) {
  Mechanism mechanism = object.mechanism;
  if (&state != &handle && state.coordinate <= 0 && handle.coordinate < mechanism.latch.opens)
    mechanism.upper = 0;
  return mechanism;
}

}  // namespace

Twist move_on(const Model& model, const ApartObject& object, Wrench wrench, const ObjectState& handle,
              Springs& springs, ObjectState& state) {
  const MassProperties& body = object.mechanism.body;
  const double dt = 1 / model.settings.rate;
  wrench.force += body.mass * model.gravity;
  if (model.ground && object.mechanism.mobility == Mobility::free) {
    const double weight = body.mass * max(1, norm(model.gravity));
    const double load = -dot(model.ground->normal, wrench.force);
    const Wrench borne = rest_on(*model.ground, object.supports, body, weight, load, dt, state, springs);
    wrench.force += borne.force;
    wrench.torque += borne.torque;
  }
  return advance_body(held_by_latch(object, state, handle), object.start, {springs.begin(), springs.size()},
                      wrench, dt, state);
}

}  // namespace lumbrical
