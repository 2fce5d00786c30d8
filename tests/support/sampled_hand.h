// What a hand feels by the rung of samples of a precision, and what an exact one would; hands and poses to
// try it with.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "frame_joints.h"
#include "random.h"
#include "session.h"

namespace lumbrical::test {

/// Forces are neither limited nor faded: what comes out is what the narrowphase felt, every part of the hand
/// by itself, as exact rungs feel where nothing else is asked for.
inline Scene sampled_scene(const Hand& hand, std::vector<SceneObject> objects) {
  Scene scene;
  scene.hand = hand;
  scene.objects = std::move(objects);
  scene.settings.max_force = 1e6;
  scene.settings.fade_time = 0;
  scene.settings.felt_once = FeltOnce::never;
  scene.settings.max_candidates = 1u << 16;
  return scene;
}

/// 0: exact.
inline Model model_at(Scene scene, double precision, const Execution& execution = {}) {
  scene.settings.precision.fill(precision);
  return model_of(scene, execution);
}

/// A model and what its ticks need; every tick is the first one.
class FeelingHand {
 public:
  FeelingHand(const Scene& scene, double precision, const Execution& execution = {})
      : model_(model_at(scene, precision, execution)) {
    forget();
  }
  /// Whatever other frames left behind.
  void forget() {
    scratch_ = make_scratch(model_);
    scratch_.hash_stages = false;
  }
  /// [m^2] of the last frame's exact contacts.
  [[nodiscard]] double contact_area() const {
    double area = 0;
    for (std::uint32_t i = 0; i < scratch_.contact_count; ++i) area += scratch_.contacts[i].area;
    return area;
  }
  [[nodiscard]] const Model& model() const { return model_; }
  /// As the last frame left it.
  [[nodiscard]] const Scratch& scratch() const { return scratch_; }
  [[nodiscard]] Scratch& scratch() { return scratch_; }
  ActuatorFrame operator()(const DeviceFrame& frame) {
    State state = make_state(model_);
    return tick(model_, state, scratch_, frame);
  }

 private:
  Model model_;
  Scratch scratch_;
};

inline Vec3 total_force(const HandForces& forces) {
  Vec3 sum;
  for (const Wrench& segment : forces.segment) sum += segment.force;
  return sum;
}
/// [N] Of all segments together, however they are directed.
inline double force_size(const HandForces& forces) {
  double sum = 0;
  for (const Wrench& segment : forces.segment) sum += norm(segment.force);
  return sum;
}

inline Quat turned(Vec3 axis, double angle) {
  const double half = 0.5 * angle;
  return {std::cos(half), std::sin(half) * axis.x, std::sin(half) * axis.y, std::sin(half) * axis.z};
}

/// Palm down with the fingers along +y, each flexed anyhow between `low` and `high` [rad], tilted by up to
/// `tilt` and turned about z at random; its lowest skin is `depth` [m] below z = 0 and the palm within
/// `spread` of the z-axis.
inline DeviceFrame dropped_hand(const Hand& hand, Random& random, double low, double high, double tilt,
                                double depth, double spread) {
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    frame.angle[4 * finger] = static_cast<float>(random.between(-0.1, 0.1));
    for (std::size_t k = 1; k < 4; ++k)
      frame.angle[4 * finger + k] = static_cast<float>(random.between(low, high));
  }
  const Quat down{std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  const double lean = random.between(-tilt, tilt), roll = random.between(-tilt, tilt),
               turn = random.between(-3.1, 3.1);
  frame.base.orientation =
      normalized(turned({0, 0, 1}, turn) * turned({1, 0, 0}, lean) * turned({0, 1, 0}, roll) * down);
  const std::array<Pose, kJointCount> pose = posed_joints(hand, frame);
  double lowest = 1;
  for (std::size_t j = kThumbMetacarpal; j < kJointCount; ++j)
    lowest = std::min(lowest, pose[j].position.z - hand.radius[j]);
  const Vec3 middle = pose[kMiddleProximal].position;
  const double x = random.between(-spread, spread), y = random.between(-spread, spread);
  frame.base.position = {x - middle.x, y - middle.y, -depth - lowest};
  return frame;
}

/// Calls look(patches, what samples found) for hands dropped onto planes of large to small triangles, each in
/// the pose drop(hand, random).
template <class Drop, class Look>
void for_hands_on_planes(std::uint64_t seed, const Drop& drop, const Look& look) {
  for (const std::uint32_t cells : {3u, 12u, 60u}) {
    const Scene scene = sampled_scene(default_hand(Side::right), {{"field", make_plane(0.3, cells, 1, 3)}});
    const Model model = model_at(scene, 1e-4);
    Scratch scratch = make_scratch(model);
    Random random(seed);
    for (int i = 0; i < 200; ++i) {
      State state;
      tick(model, state, scratch, drop(scene.hand, random));
      look(*model.patches, *scratch.samples);
    }
  }
}

/// The same hand told by the poses of its joints.
inline DeviceFrame as_joint_poses(const Hand& hand, const DeviceFrame& frame) {
  DeviceFrame at_origin = frame;
  at_origin.base = {};
  const std::array<Pose, kJointCount> poses = posed_joints(hand, at_origin);
  DeviceFrame result;
  result.base = frame.base;
  const auto narrow = [](double x) { return static_cast<float>(x); };
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto& [p, q] = poses[j];
    result.joint[j] = {{narrow(p.x), narrow(p.y), narrow(p.z)},
                       {narrow(q.x), narrow(q.y), narrow(q.z), narrow(q.w)}};
  }
  return result;
}

inline void move(Mesh& mesh, Vec3 by) {
  for (Vec3& vertex : mesh.vertices) vertex += by;
}
inline void move(DeviceFrame& frame, Vec3 by) { frame.base.position += by; }

}  // namespace lumbrical::test
