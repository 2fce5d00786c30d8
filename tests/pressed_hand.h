// A flat hand pressed into a bumpy height field: scenes A and B, which tests and benchmarks share.
//
// A is 300 mm wide whatever the number of triangles; B has triangles of 5 mm and grows with their number.
#pragma once

#include <algorithm>
#include <cmath>

#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"

namespace lumbrical::test {

inline constexpr double kWidthA = 0.3, kCellB = 0.005;  // [m]

/// 2 cells^2 triangles, `extent` [m] wide: bumps of 2 mm, 40 mm apart.
inline Scene pressed_scene(double extent, std::uint32_t cells) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"field", make_height_field(extent, cells, 0.002, 0.04)});
  return scene;
}

/// Palm down, fingers straight, the lowest joint's skin `depth` [m] below z = 0. `time` 0 .. 1 moves the hand
/// once round a small circle, so that ticks differ.
inline DeviceFrame pressed_frame(const Hand& hand, double depth, double time) {
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  frame.base.orientation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  const std::array<double, kAngleCount> straight{};
  std::array<Pose, kJointCount> joint;
  forward_kinematics(hand, frame.base, straight, joint);
  double lowest = 1e300;
  Vec3 middle;
  for (std::size_t i = kThumbMetacarpal; i < kJointCount; ++i) {
    lowest = std::min(lowest, joint[i].position.z - hand.radius[i]);
    middle += (1.0 / (kJointCount - kThumbMetacarpal)) * joint[i].position;
  }
  const double angle = 2 * 3.14159265358979323846 * time;
  frame.base.position = {0.01 * std::cos(angle) - middle.x, 0.01 * std::sin(angle) - middle.y,
                         -depth - lowest};
  return frame;
}

}  // namespace lumbrical::test
