// Fingertips by themselves, placed as a test likes: capsules of 8 mm, one per finger, for objects to rest on
// or to be held between.
#pragma once

#include <vector>

#include "session.h"

namespace lumbrical::test {

inline constexpr double kPadRadius = 0.008;  // [m]

/// One fingertip: the centre of its end sphere, and where its finger comes from.
struct Pad {
  Vec3 tip;
  Vec3 away{0, 0, -1};   ///< unit, along the finger, away from the tip
  double length = 0.02;  ///< [m]
};

/// A hand of nothing but the last phalanges of as many fingers as there are pads.
inline DeviceFrame frame_of(const std::vector<Pad>& pads) {
  DeviceFrame frame;
  frame.valid = 0;
  const auto put = [&frame](std::size_t joint, Vec3 p) {
    frame.joint[joint].position = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    frame.valid |= 1u << joint;
  };
  for (std::size_t i = 0; i < pads.size(); ++i) {
    const auto [base, tip] = kPhalanxJoints[3 * i + 2];
    put(base, pads[i].tip + pads[i].length * pads[i].away);
    put(tip, pads[i].tip);
  }
  return frame;
}

/// A hand for frame_of, and nothing to touch yet; forces are neither limited nor faded.
inline Scene pad_scene() {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.hand.palm.polygon.clear();
  scene.hand.radius.fill(kPadRadius);
  scene.settings.precision.fill(0);
  scene.settings.fade_time = 0;
  scene.settings.max_force = 1e6;
  return scene;
}

inline SceneObject object_of(const char* name, Mesh mesh, const Pose& pose, const Material& material) {
  SceneObject object;
  object.name = name;
  object.mesh = std::move(mesh);
  object.pose = pose;
  object.material = material;
  return object;
}

/// A free body of this mass.
inline SceneObject body_of(const char* name, Mesh mesh, double mass, const Pose& pose,
                           const Material& material) {
  SceneObject object = object_of(name, std::move(mesh), pose, material);
  MassProperties& body = object.mechanism.body;
  object.mechanism.mobility = Mobility::free;
  if (Status status = mass_properties(object.mesh, 1000, body); !status.ok())
    throw std::runtime_error(status.message());
  scale_to_mass(mass, body);
  return object;
}

/// The palm and wrist of an open hand, alone, with its wrist at `base`.
inline DeviceFrame palm_alone_at(const Hand& hand, const Pose& base) {
  DeviceFrame frame;
  std::array<Pose, kJointCount> joint;
  forward_kinematics(hand, {}, std::array<double, kAngleCount>{}, joint);
  for (const int known : {kPalm, kWrist}) {
    const auto& [p, q] = joint[static_cast<std::size_t>(known)];
    frame.joint[static_cast<std::size_t>(known)] = {
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
        {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)}};
  }
  frame.valid = 1u << kPalm | 1u << kWrist;
  frame.base = {base.position, base.orientation};
  return frame;
}

/// A model with its memory, run tick by tick.
struct Session {
  Model model;
  State state;
  Scratch scratch;
  ActuatorFrame output;

  explicit Session(const Scene& scene, const Execution& execution = {})
      : model(model_of(scene, execution)), state(make_state(model)), scratch(make_scratch(model)) {}
  const ActuatorFrame& feel(const DeviceFrame& frame, std::span<const ObjectFrame> given = {}) {
    return output = tick(model, state, scratch, frame, given);
  }
  /// Of the first object apart: there has to be one.
  const ObjectOutput& step(const DeviceFrame& frame, std::span<const ObjectFrame> given = {}) {
    feel(frame, given);
    return scratch.object_output[0];
  }
};

inline Vec3 hand_force(const ActuatorFrame& output) {
  Vec3 sum;
  for (const Wrench& wrench : output.segment) sum += wrench.force;
  return sum;
}

/// [rad] of a rotation.
inline double angle_of(Quat q) { return 2 * std::atan2(norm(Vec3{q.x, q.y, q.z}), std::fabs(q.w)); }

}  // namespace lumbrical::test
