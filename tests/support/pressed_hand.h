// A flat hand pressed into a bumpy height field: scenes A and B, which tests and benchmarks share.
//
// A is 300 mm wide whatever the number of triangles; B has triangles of 5 mm and grows with their number.
#pragma once

#include <algorithm>
#include <cmath>

#include "frame_joints.h"
#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"

namespace lumbrical::test {

inline constexpr double kWidthA = 0.3, kCellB = 0.005;  // [m]

/// 2 cells^2 triangles, `extent` [m] wide: bumps of 2 mm, 40 mm apart.
inline Scene pressed_scene(double extent, std::uint32_t cells) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.precision.fill(0);
  scene.objects.push_back({"field", make_height_field(extent, cells, 0.002, 0.04)});
  return scene;
}

inline double skin_height(const Hand& hand, const DeviceFrame& frame, std::size_t joint) {
  return posed_joints(hand, frame)[joint].position.z - hand.radius[joint];
}

/// Palm down, the middle knuckle's skin `depth` [m] below z = 0 and the fingers bent so that the skin of
/// their joints is as deep, as far as the joints' limits allow. `time` 0 .. 1 moves the hand once round a
/// small circle, so that ticks differ.
inline DeviceFrame pressed_frame(const Hand& hand, double depth, double time) {
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  frame.base.orientation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  frame.base.position.z = -depth - skin_height(hand, frame, kMiddleProximal);
  for (std::size_t finger = 1; finger < kFingerCount; ++finger) {
    for (std::size_t k = 1; k <= 3; ++k) {
      const std::size_t joint = kIndexProximal + 5 * (finger - 1) + k;
      float& flexion = frame.angle[4 * finger + k];
      float low = -0.7f, high = 0.7f;  // bending lowers the next joint
      for (int step = 0; step < 20; ++step) {
        flexion = 0.5f * (low + high);
        (skin_height(hand, frame, joint) > -depth ? low : high) = flexion;
      }
    }
  }
  const double angle = 2 * 3.14159265358979323846 * time;
  frame.base.position.x = 0.01 * std::cos(angle);
  frame.base.position.y = 0.01 * std::sin(angle) - 0.08;  // the fingers point along +y
  return frame;
}

}  // namespace lumbrical::test
