// What crosses the line to the haptic device, both ways, once per tick.
#pragma once

#include <array>
#include <cstdint>

#include "lumbrical/hand.h"
#include "lumbrical/math.h"

namespace lumbrical {

enum class InputKind : std::uint8_t { joint_poses, joint_angles };

/// As in OpenXR: float is what trackers deliver; far from the origin the frame's base carries the distance.
struct JointPose {
  std::array<float, 3> position{};               ///< [m] in B
  std::array<float, 4> orientation{0, 0, 0, 1};  ///< x y z w, of the joint in B
  friend bool operator==(const JointPose&, const JointPose&) = default;
};
/// As a frame has it.
inline JointPose to_joint_pose(const Pose& pose) {
  const Vec3 p = pose.position;
  const Quat q = pose.orientation;
  return {
      {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
      {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)}};
}
/// Back, of a unit quaternion to double precision.
inline Pose to_pose(const JointPose& joint) {
  const std::array<float, 3>& p = joint.position;
  const std::array<float, 4>& q = joint.orientation;
  const auto exactly = [](float value) { return static_cast<double>(value); };
  return {{exactly(p[0]), exactly(p[1]), exactly(p[2])},
          normalized({exactly(q[3]), exactly(q[0]), exactly(q[1]), exactly(q[2])})};
}

enum DeviceFlag : std::uint32_t {
  kTrackingLost = 1u << 0,  ///< the source does not trust this frame: forces fade to zero
  kExtrapolated = 1u << 1,  ///< held or continued beyond the last sample; used all the same
  // Why a device's angles were not believed; kTrackingLost stands beside them.
  kAngleOutOfRange = 1u << 2,  ///< outside its sensor's lower .. upper
  kAngleJumped = 1u << 3,      ///< farther than a finger can move in the time
  kAngleStuck = 1u << 4,       ///< not moved by torques that must have moved it; at its stop, bend it once
};

/// What the device says. Recorded as received; replay needs nothing else.
struct DeviceFrame {
  Pose base;  ///< X_WB. Joint poses are given in B; for joint angles B is the wrist
  InputKind kind = InputKind::joint_poses;
  std::uint32_t flags = 0;                        ///< DeviceFlag bits
  std::uint32_t valid = (1u << kJointCount) - 1;  ///< bit j: joint j is tracked (joint_poses only)
  std::array<JointPose, kJointCount> joint{};     ///< for joint_poses
  std::array<float, kAngleCount> angle{};         ///< [rad] for joint_angles, in the order of hand.h
  friend bool operator==(const DeviceFrame&, const DeviceFrame&) = default;
};

/// What happened inside a tick. Each bit names its remedy.
enum TickFlag : std::uint32_t {
  kInputNotFinite = 1u << 0,  ///< NaN or infinity in the device frame. Check the driver; forces fade to zero
  kInputImplausible =
      1u << 1,           ///< a joint farther than 1 m from its wrist, or a zero quaternion. Check units
  kInputLost = 1u << 2,  ///< kTrackingLost was set. Forces fade to zero
  kInputExtrapolated = 1u << 3,  ///< kExtrapolated was set. Raise the tracking rate
  kSegmentMissing = 1u << 4,     ///< a joint is not valid: its segments feel nothing; what they felt fades
  kSegmentDegenerate = 1u << 5,  ///< a phalanx of zero length was felt as a sphere
  kAngleClamped = 1u << 6,       ///< a joint angle exceeded the hand's limits. Calibrate or widen the limits
  kCandidateOverflow =
      1u << 7,  ///< more candidate pairs than Settings::max_candidates: forces fade to zero. Raise it
  kForceLimited = 1u << 8,  ///< a segment's force was above 4/5 of Settings::max_force and saturates
  kFading = 1u << 9,        ///< output is a fading or rising mixture, see limits
  kCoarsened = 1u << 10,  ///< lattices were coarser than the precision asks, to stay within Settings::effort
  kObjectMissing = 1u << 11,  ///< a given object was not told where it is, and stays. Pass a pose for each
  kObjectImplausible =
      1u << 12,  ///< a given object's pose is not finite, or jumped: forces fade to zero. Check who moves it
  kMemoryForeign = 1u << 13,  ///< Scratch is another model's or empty, or State has another number of objects
                              ///< apart: nothing was computed, forces fade to zero. make_scratch and
                              ///< make_state of this model; with assertions a tick ends there
  kHandJumped = 1u << 14,  ///< the wrist or a fingertip went farther in a tick than a hand can: forces pass
                           ///< over to those of the new place within Settings::fade_time
};

/// Forces and torques of the whole hand, in the world frame W.
struct HandForces {
  std::array<Wrench, kSegmentCount>
      segment{};  ///< felt by each segment: [N], [N m] about the joint at its base
  std::array<Vec3, kSegmentCount>
      joint_torque{};  ///< [N m] Eq. 5 about each segment's base joint, of all it carries
  std::array<double, kSegmentCount>
      flexion_torque{};  ///< [N m] of it along the flexion axis; > 0 opens the hand
};

/// What the device is told.
struct ActuatorFrame : HandForces {
  std::uint64_t tick = 0;
  std::uint32_t flags = 0;  ///< TickFlag bits
  /// Contacts behind this frame, before limits; of samples patches, by quarters where they are felt finely,
  /// and by sixteens where blocks are felt as one.
  std::uint32_t contact_count = 0;
  std::uint64_t evaluations = 0;  ///< of a field, by samples: what Settings::effort bounds
  /// [N] About what samples may be off, all sampled segments together, before limits: measured, no bound. 98
  /// % of ticks stay below it, 90 % where a bound on effort takes some of their levels, by up to twice; the
  /// worst seen were ten times as far off (docs/mechanics.md).
  double error_estimate = 0;
  /// [N] Bound of what the integrals behind all forces together may be off, before limits. Positions are
  /// rounded besides, which is more from a kilometre off the origin on.
  double force_error = 0;
};

}  // namespace lumbrical
