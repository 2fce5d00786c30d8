// Where the joints of a hand are that a frame of angles tells of.
#pragma once

#include <algorithm>
#include <array>

#include "lumbrical/hand.h"
#include "lumbrical/tick.h"

namespace lumbrical::test {

inline std::array<Pose, kJointCount> posed_joints(const Hand& hand, const DeviceFrame& frame) {
  std::array<double, kAngleCount> angles;
  std::copy(frame.angle.begin(), frame.angle.end(), angles.begin());
  std::array<Pose, kJointCount> joints;
  forward_kinematics(hand, frame.base, angles, joints);
  return joints;
}

}  // namespace lumbrical::test
