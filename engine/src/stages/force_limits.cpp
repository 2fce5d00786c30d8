#include "stages/force_limits.h"

#include <cmath>

#include "base/wrench.h"
#include "stages/joint_torques.h"

namespace lumbrical {
namespace {

// Is every segment's force certainly felt as it is? Without a root.
bool are_all_small(double max_force, const HandForces& forces) {
  double largest2 = 0;
  for (const Wrench& wrench : forces.segment) largest2 = max(largest2, dot(wrench.force, wrench.force));
  const double small = 0.999999 * kUnlimitedShare * max_force;
  return largest2 < small * small;
}

bool saturate_segments(double max_force, const Primitives& hand, HandForces& forces) {
  bool limited = false;
  for (Wrench& wrench : forces.segment) {
    const double force = norm(wrench.force);
    if (force <= kUnlimitedShare * max_force) continue;
    const double share = saturated(force, max_force) / force;
    wrench = share * wrench;
    limited = true;
  }
  if (limited) sum_joint_torques(hand, forces);
  return limited;
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

// Where it is wanted, for a hand's forces are long to copy.
void mix(double a, const HandForces& x, double b, const HandForces& y, HandForces& sum) {
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    sum.segment[i] = a * x.segment[i] + b * y.segment[i];
    sum.joint_torque[i] = a * x.joint_torque[i] + b * y.joint_torque[i];
    sum.flexion_torque[i] = a * x.flexion_torque[i] + b * y.flexion_torque[i];
  }
}

// What other settings have left may be above what these allow: as a whole no more than that.
void keep_within(double max_force, HandForces& forces) {
  double largest = 0;
  for (const Wrench& wrench : forces.segment) largest = max(largest, norm(wrench.force));
  if (largest > 1.000001 * max_force) mix(max_force / largest, forces, 0, {}, forces);
}

// Fresh forces are zero where they are not trusted.
ActuatorFrame mix_with_held(const Settings& settings, const HandForces& fresh, Trust trust,
                            std::uint32_t flags, HandState& state) {
  const double step = 1 / max(1, settings.fade_time * settings.rate);
  if (trust != Trust::kept && state.rise > 0) {
    state.held = state.last;
    state.rise = 0;
    state.fall = 1;
  }
  if (trust != Trust::none) state.rise = min(1, state.rise + step);
  const bool are_held = state.fall > 0;  // or have just become so
  state.fall = max(0, state.fall - step);
  if (state.rise != 1 || state.fall != 0) flags |= kFading;
  if (state.fall > 0) keep_within(settings.max_force, state.held);
  if (are_held && !(state.fall > 0)) state.held = {};

  mix(state.rise, fresh, state.fall, state.held, state.last);
  ActuatorFrame output{state.last, state.tick, flags, 0};
  ++state.tick;
  return output;
}

}  // namespace

double saturated(double force, double max_force) {
  const double free = kUnlimitedShare * max_force, room = max_force - free;
  if (force <= free) return force;
  const double over = force - free;
  // The smaller one over the larger one: no square can overflow, and a limit of 0 lets nothing through.
  const double x = over <= room ? over / room : room / over, root = std::sqrt(1 + x * x);
  return min(max_force, free + room * (over <= room ? x / root : 1 / root));
}

ActuatorFrame limit_forces(const Settings& settings, const Primitives& hand, const HandForces& fresh,
                           Trust trust, std::uint32_t flags, HandState& state) {
  if (trust == Trust::none || !all_finite(fresh)) return fade_forces(settings, flags, state);
  if (are_all_small(settings.max_force, fresh)) return mix_with_held(settings, fresh, trust, flags, state);
  HandForces limited = fresh;
  if (saturate_segments(settings.max_force, hand, limited)) flags |= kForceLimited;
  return mix_with_held(settings, limited, trust, flags, state);
}

ActuatorFrame fade_forces(const Settings& settings, std::uint32_t flags, HandState& state) {
  return mix_with_held(settings, {}, Trust::none, flags, state);
}

}  // namespace lumbrical
