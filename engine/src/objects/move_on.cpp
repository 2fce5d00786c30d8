#include "objects/move_on.h"

namespace lumbrical {
Twist move_on(const Model& model, const ApartObject& object, Wrench wrench, Springs& springs,
              ObjectState& state) {
  const MassProperties& body = object.mechanism.body;
  const double dt = 1 / model.settings.rate;
  wrench.force += body.mass * model.gravity;
  if (model.ground && object.mechanism.mobility == Mobility::free) {
    const double weight = body.mass * max(1, norm(model.gravity));
    const Wrench borne = rest_on(*model.ground, object.supports, body, weight, dt, state, springs);
    wrench.force += borne.force;
    wrench.torque += borne.torque;
  }
  return advance_body(object.mechanism, object.start, {springs.begin(), springs.size()}, wrench, dt, state);
}

}  // namespace lumbrical
