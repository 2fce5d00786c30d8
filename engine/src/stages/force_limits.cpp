#include "stages/force_limits.h"

#include <cmath>

namespace lumbrical {
namespace {

// One factor for the whole hand keeps joint torques and segment forces consistent.
bool clamp_segments(double max_force, HandForces& forces) {
  double least = 1;
  for (const Wrench& wrench : forces.segment) {
    const double force = norm(wrench.force);
    if (!(force <= max_force)) least = min(least, is_finite(force) ? max_force / force : 0);
  }
  if (least == 1) return false;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    forces.segment[i].force = least * forces.segment[i].force;
    forces.segment[i].torque = least * forces.segment[i].torque;
    forces.joint_torque[i] = least * forces.joint_torque[i];
    forces.flexion_torque[i] = least * forces.flexion_torque[i];
  }
  return true;
}

bool all_finite(const HandForces& forces) {
  double force = 0, torque = 0, joint = 0;  // NaN and infinity survive any sum of squares
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    force += dot(forces.segment[i].force, forces.segment[i].force);
    torque += dot(forces.segment[i].torque, forces.segment[i].torque);
    joint += dot(forces.joint_torque[i], forces.joint_torque[i]);
  }
  return is_finite(force) && is_finite(torque) && is_finite(joint);
}

HandForces mix(double a, const HandForces& x, double b, const HandForces& y) {
  HandForces sum;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    sum.segment[i].force = a * x.segment[i].force + b * y.segment[i].force;
    sum.segment[i].torque = a * x.segment[i].torque + b * y.segment[i].torque;
    sum.joint_torque[i] = a * x.joint_torque[i] + b * y.joint_torque[i];
    sum.flexion_torque[i] = a * x.flexion_torque[i] + b * y.flexion_torque[i];
  }
  return sum;
}

}  // namespace

ActuatorFrame limit_forces(const Settings& settings, HandForces fresh, bool trusted, std::uint32_t flags,
                           State& state) {
  trusted = trusted && all_finite(fresh);
  if (!trusted) fresh = {};
  if (trusted && clamp_segments(settings.max_force, fresh)) flags |= kForceLimited;
  const double step = 1 / max(1, settings.fade_time * settings.rate);
  if (!trusted && state.rise > 0) {
    state.held = state.last;
    state.rise = 0;
    state.fall = 1;
  }
  if (trusted) state.rise = min(1, state.rise + step);
  state.fall = max(0, state.fall - step);
  if (state.rise != 1 || state.fall != 0) flags |= kFading;
  if (state.fall == 0) state.held = {};

  state.last = mix(state.rise, fresh, state.fall, state.held);
  ActuatorFrame output{state.last, state.tick, flags, 0};
  ++state.tick;
  return output;
}

}  // namespace lumbrical
