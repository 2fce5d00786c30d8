// Device frames of a single finger with chosen joints, for tests of tiles, depth and torque.
#pragma once

#include <array>

#include "session.h"

namespace lumbrical::test {

/// A hand whose joints all have the same radius [m] and which has no palm.
inline Hand plain_hand(double radius) {
  Hand hand = default_hand(Side::right);
  hand.radius.fill(radius);
  hand.palm.polygon.clear();
  return hand;
}

/// The index finger's four joints from base to tip [m, W]; all other joints are missing, but for the wrist.
inline DeviceFrame finger_frame(const std::array<Vec3, 4>& joints) {
  DeviceFrame frame;
  frame.base.position = joints[0];  // exact far from the origin
  frame.valid = 1u << kWrist;
  frame.joint[kWrist].position = {-0.08f, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 p = joints[i] - joints[0];
    frame.joint[kIndexProximal + i].position = {static_cast<float>(p.x), static_cast<float>(p.y),
                                                static_cast<float>(p.z)};
    frame.valid |= 1u << (kIndexProximal + i);
  }
  return frame;
}

/// One finger against a mesh: a settled tick, its contacts and its output.
struct Touch {
  ActuatorFrame output;
  std::vector<Contact> contacts;
};

inline Touch touch(const Hand& hand, Law law, const Mesh& mesh, const DeviceFrame& frame) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = hand;
  scene.settings.law.fill(law);
  scene.settings.fade_time = 0;
  scene.settings.max_force = 1e6;
  scene.objects.push_back({"mesh", mesh});
  const Model model = model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  Touch result;
  result.output = tick(model, state, scratch, frame);
  result.contacts.assign(scratch.contacts.begin(), scratch.contacts.begin() + scratch.contact_count);
  return result;
}

}  // namespace lumbrical::test
