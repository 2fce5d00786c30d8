// Joint angles to joint poses: a chain of bones along -z, turned by abduction about y and flexion about x.
#include "base/elementary.h"
#include "lumbrical/hand.h"

namespace lumbrical {
namespace {

// Sense of positive abduction about y for the right hand; the left hand's is opposite.
constexpr std::array<double, kFingerCount> kAbductionSign = {1, 1, -1, -1, -1};

// The first joint that a finger's angles move: its three moving joints and the tip follow each other in
// Joint.
constexpr std::array<int, kFingerCount> kFirstMovingJoint = {kThumbMetacarpal, kIndexProximal,
                                                             kMiddleProximal, kRingProximal, kLittleProximal};

Quat turn_about_y(SinCos half) { return {half.cos, 0, half.sin, 0}; }
Quat flex(SinCos half) { return {half.cos, -half.sin, 0, 0}; }

}  // namespace

int forward_kinematics(const Hand& hand, const Pose& X_BH, std::span<const double, kAngleCount> angles,
                       std::array<Pose, kJointCount>& X_BJ) {
  int clamped_count = 0;
  const double side_sign = hand.side == Side::right ? 1.0 : -1.0;
  std::array<double, kAngleCount> half_angle;
  for (std::size_t i = 0; i < kAngleCount; ++i) {
    const std::size_t finger = i / 4, joint = i % 4;
    const auto& limit = hand.finger[finger].limit[joint];
    const double angle = clamp(angles[i], limit.lower, limit.upper);
    if (angle != angles[i]) ++clamped_count;
    half_angle[i] = 0.5 * (joint == 0 ? side_sign * kAbductionSign[finger] * angle : angle);
  }
  std::array<SinCos, kAngleCount> half;
  sin_cos(half_angle, half);
  X_BJ[kWrist] = X_BH;
  X_BJ[kPalm] = X_BH * hand.palm_joint;
  for (int f = 0; f < kFingerCount; ++f) {
    const Finger& finger = hand.finger[f];
    const SinCos* const turn = &half[static_cast<std::size_t>(4 * f)];
    int joint = kFirstMovingJoint[f];
    Pose pose = X_BH * finger.base;
    if (f > 0) X_BJ[joint - 1] = pose;  // the metacarpal, fixed in the palm
    pose.position = transform(pose, {0, 0, -finger.bone_length[0]});
    pose.orientation = pose.orientation * (turn_about_y(turn[0]) * flex(turn[1]));
    X_BJ[joint] = pose;
    for (int i = 1; i < 4; ++i) {
      pose.position = transform(pose, {0, 0, -finger.bone_length[i]});
      if (i < 3) pose.orientation = pose.orientation * flex(turn[i + 1]);
      X_BJ[++joint] = pose;
    }
  }
  return clamped_count;
}

}  // namespace lumbrical
