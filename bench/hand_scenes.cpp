#include "hand_scenes.h"

#include <algorithm>

#include "random.h"

namespace lumbrical::bench {

Hand plain_hand() {
  Hand hand = default_hand(Side::right);
  hand.palm.polygon.clear();
  for (const auto& phalanx : kPhalanxJoints) {
    const auto first = static_cast<std::size_t>(&phalanx - &kPhalanxJoints[0]) / 3 * 3;
    const double radius = hand.radius[static_cast<std::size_t>(kPhalanxJoints[first + 1].base)];
    hand.radius[static_cast<std::size_t>(phalanx.base)] = radius;
    hand.radius[static_cast<std::size_t>(phalanx.tip)] = radius;
  }
  return hand;
}

DeviceFrame tips_frame(const Hand& hand, double depth, double time, std::size_t first, std::size_t last) {
  DeviceFrame frame = test::pressed_frame(hand, depth, time);
  frame.angle.fill(0);
  frame.base.position.z = 0.06;
  for (std::size_t finger = first; finger <= last; ++finger) {
    frame.angle[4 * finger + 2] = frame.angle[4 * finger + 3] = 0.35f;
    float low = -0.3f, high = 1.4f;
    for (int step = 0; step < 24; ++step) {
      frame.angle[4 * finger + 1] = 0.5f * (low + high);
      (test::skin_height(hand, frame, kIndexProximal + 5 * (finger - 1) + 3) > -depth ? low : high) =
          frame.angle[4 * finger + 1];
    }
  }
  return frame;
}

Scene field_scene(const Hand& hand, bool fine, std::uint32_t cells) {
  Scene scene = test::pressed_scene(fine ? test::kWidthA : test::kCellB * cells, cells);
  scene.hand = hand;
  scene.settings.max_force = 1e6;
  scene.settings.fade_time = 0;
  scene.settings.max_candidates =
      std::clamp<std::uint32_t>(2 * cells * cells / 4, scene.settings.max_candidates, 1u << 24);
  return scene;
}

std::vector<DeviceFrame> touching_frames(const Hand& hand, Touch touch, double extent, int count,
                                         double depth) {
  test::Random random(5);
  std::vector<DeviceFrame> frames;
  for (int i = 0; i < count; ++i) {
    const double time = i / static_cast<double>(count),
                 deep = depth + 0.002 * (touch == Touch::jump ? 0.5 : time);
    // Bending the fingers to their depth is slow: a hand that jumps does it once.
    if (touch == Touch::jump && i > 0) {
      frames.push_back(frames[0]);
    } else if (touch == Touch::tips || touch == Touch::finger) {
      frames.push_back(tips_frame(hand, deep, time, 1, touch == Touch::finger ? 1 : 4));
    } else {
      frames.push_back(test::pressed_frame(hand, deep, time));
    }
    Vec3& place = frames.back().base.position;
    if (touch == Touch::none) place.z += 0.5;
    if (touch != Touch::jump) continue;
    const double reach = 0.5 * extent - 0.15;
    place = {random.between(-reach, reach), random.between(-reach, reach), place.z};
  }
  return frames;
}

namespace {

// Triangles contacted in a tick, each counted once: the mean over the poses.
double touched_triangles(const Model& model, const std::vector<DeviceFrame>& frames) {
  State state;
  Scratch scratch = make_scratch(model);
  double sum = 0;
  for (const DeviceFrame& frame : frames) {
    tick(model, state, scratch, frame);
    std::vector<std::uint32_t> touched;
    for (const Contact& contact : find_contacts(model, scratch)) touched.push_back(contact.triangle);
    std::sort(touched.begin(), touched.end());
    sum += static_cast<double>(std::unique(touched.begin(), touched.end()) - touched.begin());
  }
  return sum / static_cast<double>(frames.size());
}

}  // namespace

double depth_touching(const Model& model, Touch touch, double extent, int count, double wanted) {
  double low = -0.008, high = 0.008;
  for (int step = 0; step < 12; ++step) {
    const double middle = 0.5 * (low + high);
    const auto frames = touching_frames(model.hand, touch, extent, count, middle);
    (touched_triangles(model, frames) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace lumbrical::bench
