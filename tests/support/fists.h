// Hands bent as far as they go, and beyond what an adult's do.
#pragma once

#include "frame_joints.h"
#include "random.h"

namespace lumbrical::test {

inline constexpr double kBeyond = 0.5;  // [rad]

/// A hand whose joints bend by so much more.
inline Hand loosened(Hand hand) {
  for (Finger& finger : hand.finger) {
    for (AngleLimit& limit : finger.limit) limit = {limit.lower - kBeyond, limit.upper + kBeyond};
  }
  return hand;
}

/// Fingers bent to the last third of what a hand allows, turned anyhow, one of their joints about `away` [m]
/// from the origin.
inline DeviceFrame fist_frame(const Hand& hand, Random& random, double away) {
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  for (std::size_t k = 0; k < kAngleCount; ++k) {
    const AngleLimit& limit = hand.finger[k / 4].limit[k % 4];
    const double folded = k % 4 != 0 ? 2.0 / 3 : 0;
    frame.angle[k] =
        static_cast<float>(random.between(limit.lower + folded * (limit.upper - limit.lower), limit.upper));
  }
  frame.base.orientation = random.rotation();
  const std::size_t joint = kThumbMetacarpal + random.below(kJointCount - kThumbMetacarpal);
  // One draw a statement: in which order a sum draws is up to the compiler.
  const Vec3 from_origin = away * random.direction();
  frame.base.position = from_origin + random.in_box(0.01) - posed_joints(hand, frame)[joint].position;
  return frame;
}

}  // namespace lumbrical::test
