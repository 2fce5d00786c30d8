#include "stages/pad_damping.h"

#include "base/small_turn.h"
#include "stages/joint_torques.h"

namespace lumbrical {

Twist speed_between(const Pose& from, const Pose& to, double rate) {
  return {rate * (to.position - from.position), rate * small_turn(from.orientation, to.orientation)};
}

PadSpeeds speeds_of_pads(const Settings& settings, bool trusted, const Primitives& hand,
                         std::optional<PadState>& pad) {
  PadSpeeds speeds{};
  if (!(settings.pad.damping > 0)) {
    pad.reset();
    return speeds;
  }
  if (!pad || !trusted) pad = PadState{};
  if (!trusted) return speeds;
  const std::uint32_t known = hand.joints.valid & static_cast<std::uint32_t>(pad->valid);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Pose& X_WS = base_pose(hand, i);
    Pose& was = pad->segment[i];
    if ((known >> base_joint_of(i) & 1u) != 0) speeds[i] = speed_between(was, X_WS, settings.rate);
    was = X_WS;
  }
  pad->valid = hand.joints.valid;
  return speeds;
}

double damping_share(double damping, const Wrench& wrench, const Twist& speed) {
  const double force = norm(wrench.force);
  if (!(force > 0)) return 0;
  const double power = dot(wrench.force, speed.velocity) + dot(wrench.torque, speed.angular_velocity);
  return max(-1, min(1, -damping * (power / force)));
}

void damp_pads(const Pad& pad, const PadSpeeds& speeds, const Primitives& hand, HandForces& forces) {
  if (!(pad.damping > 0)) return;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    Wrench& wrench = forces.segment[i];
    const double kept = 1 + damping_share(pad.damping, wrench, speeds[i]);
    wrench = {kept * wrench.force, kept * wrench.torque};
  }
  sum_joint_torques(hand, forces);
}

}  // namespace lumbrical
