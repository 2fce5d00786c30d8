#include "stages/pad_damping.h"

#include "stages/joint_torques.h"

namespace lumbrical {

double damping_wanted(double damping, const Wrench& wrench, const Twist& speed) {
  const double force = norm(wrench.force);
  if (!(force > 0)) return 0;
  const double power = dot(wrench.force, speed.velocity) + dot(wrench.torque, speed.angular_velocity);
  return -damping * (power / force);
}

void damp_pads(const Pad& pad, const std::array<Twist, kSegmentCount>& speed, const Primitives& hand,
               HandForces& forces) {
  if (!(pad.damping > 0)) return;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    Wrench& wrench = forces.segment[i];
    const double kept = 1 + damping_share(damping_wanted(pad.damping, wrench, speed[i]));
    wrench = {kept * wrench.force, kept * wrench.torque};
  }
  sum_joint_torques(hand, forces);
}

}  // namespace lumbrical
