// Hands in poses, for tests of the hand model.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lumbrical/hand.h"
#include "random.h"

namespace lumbrical::test {

using Angles = std::array<double, kAngleCount>;
using Poses = std::array<Pose, kJointCount>;

inline Angles random_angles(Random& random, const Hand& hand) {
  Angles angles;
  for (int i = 0; i < kAngleCount; ++i) {
    const AngleLimit limit = hand.finger[i / 4].limit[i % 4];
    angles[i] = random.between(limit.lower, limit.upper);
  }
  return angles;
}

inline Poses pose_hand(const Hand& hand, const Pose& wrist, const Angles& angles) {
  Poses poses;
  forward_kinematics(hand, wrist, angles, poses);
  return poses;
}

/// The angle between two rotations [rad].
inline double turn_between(Quat a, Quat b) {
  return 2 * std::acos(std::min(1.0, std::fabs(dot(normalized(a), normalized(b)))));
}

inline void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

}  // namespace lumbrical::test
