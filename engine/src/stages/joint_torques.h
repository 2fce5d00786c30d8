// What segments' wrenches come to at the joints (Eq. 5 of the paper).
#pragma once

#include "lumbrical/device.h"
#include "model/primitive.h"

namespace lumbrical {

/// Sets the torques of all joints from the wrenches of the segments: a joint carries those from its own to
/// the fingertip, the wrist carries all. Of a joint that is not tracked nobody knows where it is: 0.
inline void sum_joint_torques(const Primitives& hand, HandForces& forces) {
  for (std::size_t joint = 0; joint < kSegmentCount; ++joint) {
    const bool wrist = joint == kPalmSegment;
    const std::size_t first = wrist ? 0 : joint, last = wrist ? kPalmSegment : joint - joint % 3 + 2;
    Vec3 torque;
    const bool is_tracked = hand.joints.has(static_cast<int>(base_joint_of(joint)));
    for (std::size_t i = first; is_tracked && i <= last; ++i) {
      const Wrench& wrench = forces.segment[i];
      torque += wrench.torque + cross(hand.base_joint[i] - hand.base_joint[joint], wrench.force);
    }
    forces.joint_torque[joint] = torque;
    forces.flexion_torque[joint] = dot(torque, hand.flexion_axis[joint]);
  }
}

}  // namespace lumbrical
