#include "stages/pad_damping.h"

#include "base/wrench.h"
#include "stages/joint_torques.h"

namespace lumbrical {
namespace {

// [m] No skin of a segment lies farther from its base joint; 0: of a palm without a shape.
double skin_reach(const Primitives& hand, std::size_t segment) {
  if (segment != kPalmSegment) {
    const Primitive& whole = hand.capsule[segment];
    return norm(whole.end2 - whole.end1) + max(whole.radius1, whole.radius2);
  }
  double reach = 0;
  for (std::size_t i = 0; i < hand.palm.corner_count; ++i) {
    const Vec3 corner = hand.palm.corner[i];
    reach = max(reach, norm(corner - hand.base_joint[segment]) + hand.palm.radius);
  }
  return reach;
}

}  // namespace

// Faces that push opposite ways leave a small force and a torque. Power over that force would be the speed of
// a point far beyond the skin, and step as the force goes through 0: so a torque counts as the least force
// on the skin that has it.
double damping_wanted(double damping, const Primitives& hand, std::size_t segment, const Wrench& wrench,
                      const Twist& speed) {
  const double torque = norm(wrench.torque), reach = torque > 0 ? skin_reach(hand, segment) : 0;
  const double force = max(norm(wrench.force), reach > 0 ? torque / reach : 0);
  if (!(force > 0)) return 0;
  const double power = dot(wrench.force, speed.velocity) + dot(wrench.torque, speed.angular_velocity);
  return -damping * (power / force);
}

void damp_pads(const Pad& pad, const std::array<Twist, kSegmentCount>& speed, const Primitives& hand,
               HandForces& forces) {
  if (!(pad.damping > 0)) return;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    Wrench& wrench = forces.segment[i];
    const double kept = 1 + damping_share(damping_wanted(pad.damping, hand, i, wrench, speed[i]));
    wrench = kept * wrench;
  }
  sum_joint_torques(hand, forces);
}

}  // namespace lumbrical
