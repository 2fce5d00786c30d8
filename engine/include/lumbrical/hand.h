// The human hand as the engine knows it: 26 joints (the order of OpenXR's XR_EXT_hand_tracking), 15 phalanges
// and a palm, and the forward kinematics from joint angles to joint poses.
//
// Joint frames follow OpenXR for both hands: -z points along the bone to the fingertip, +y to the back of the
// hand, x = y cross z, so that +x is to the person's right when the palm faces down (away from the thumb on a
// right hand, towards the thumb on a left hand). A tip has the orientation of the joint before it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "lumbrical/math.h"
#include "lumbrical/status.h"

namespace lumbrical {

// clang-format off
enum Joint : std::uint8_t {
  kPalm, kWrist,
  kThumbMetacarpal, kThumbProximal, kThumbDistal, kThumbTip,
  kIndexMetacarpal, kIndexProximal, kIndexIntermediate, kIndexDistal, kIndexTip,
  kMiddleMetacarpal, kMiddleProximal, kMiddleIntermediate, kMiddleDistal, kMiddleTip,
  kRingMetacarpal, kRingProximal, kRingIntermediate, kRingDistal, kRingTip,
  kLittleMetacarpal, kLittleProximal, kLittleIntermediate, kLittleDistal, kLittleTip,
};
// clang-format on
inline constexpr int kJointCount = 26;
inline constexpr int kFingerCount = 5;  ///< thumb, index, middle, ring, little

/// Segments 3f, 3f+1, 3f+2 are finger f's phalanges from base to tip (for the thumb: metacarpal, proximal,
/// distal); segment 15 is the palm. Each segment is moved by one joint, the one at its base; the palm by the
/// wrist.
inline constexpr int kPhalanxCount = 15;
inline constexpr int kPalmSegment = 15;
inline constexpr int kSegmentCount = 16;

struct PhalanxJoints {
  Joint base, tip;
};
// clang-format off
inline constexpr std::array<PhalanxJoints, kPhalanxCount> kPhalanxJoints = {{
    {kThumbMetacarpal, kThumbProximal},   {kThumbProximal, kThumbDistal},             {kThumbDistal, kThumbTip},
    {kIndexProximal, kIndexIntermediate}, {kIndexIntermediate, kIndexDistal},         {kIndexDistal, kIndexTip},
    {kMiddleProximal, kMiddleIntermediate}, {kMiddleIntermediate, kMiddleDistal},     {kMiddleDistal, kMiddleTip},
    {kRingProximal, kRingIntermediate},   {kRingIntermediate, kRingDistal},           {kRingDistal, kRingTip},
    {kLittleProximal, kLittleIntermediate}, {kLittleIntermediate, kLittleDistal},     {kLittleDistal, kLittleTip},
}};
// clang-format on

/// "thumb metacarpal", "index tip", ...; the engine's only spelling.
std::string_view joint_name(int joint);
/// "thumb metacarpal", "index proximal", ..., "palm".
std::string_view segment_name(int segment);
/// "thumb", "index", "middle", "ring", "little".
std::string_view finger_name(int finger);
/// The number that has this name; nothing for any other text.
std::optional<int> parse_joint(std::string_view text);
std::optional<int> parse_segment(std::string_view text);
std::optional<int> parse_finger(std::string_view text);

/// Joint angles of the kinematic hand: per finger 4f+0 abduction and 4f+1..4f+3 flexion of its three joints
/// from base to tip, all [rad]. Flexion by a turns the bones beyond the joint about the joint's x axis by -a,
/// towards the palm. Abduction turns them about the y axis of the finger's first moving joint before that
/// joint flexes; positive is away from the middle finger, for the middle finger towards the ring finger, for
/// the thumb away from the index (towards the palmar side). Its sense about y is therefore opposite on the
/// two hands.
inline constexpr int kAngleCount = 20;

struct AngleLimit {
  double lower = 0, upper = 0;
};  ///< [rad]

struct Finger {
  Pose base;                            ///< X_HM: the metacarpal joint in the wrist frame, angles zero
  std::array<double, 4> bone_length{};  ///< [m] metacarpal (0 for the thumb), then the three phalanges
  std::array<AngleLimit, 4> limit{};    ///< of the finger's four angles
};

/// The palm: everything within r = thickness / 2 of a convex polygon, its core, so its rim is round and its
/// skin `height` below the palm joint (towards the palmar side, -y). The core is parallel to the xz-plane of
/// the palm joint's frame and height - r below the joint.
struct Palm {
  /// [m] The core: x and z of 3 to 16 corners (y = 0), convex, either sense of rotation; empty: no palm. The
  /// palm reaches r beyond it on every side.
  std::vector<Vec3> polygon;
  double height = 0.012;     ///< [m] of the palmar skin below the palm joint
  double thickness = 0.024;  ///< [m] from the palmar skin to the dorsal one
};

enum class Side : std::uint8_t { left, right };

/// "left", "right".
std::string_view side_name(Side side);
constexpr Side other_side(Side side) { return side == Side::right ? Side::left : Side::right; }

struct Hand {
  Side side = Side::right;
  std::array<double, kJointCount> radius{};   ///< [m] from the joint to the skin, > 0
  std::array<Finger, kFingerCount> finger{};  ///< needed for joint-angle input only
  Palm palm;
  Pose palm_joint;  ///< X_HP: the palm joint in the wrist frame (joint-angle input)
};

/// An adult hand whose wrist and middle fingertip are `length` [m] > 0 apart when all angles are zero. Radii
/// are Quest's defaults at 0.19 m and scale with the length. The left hand is the exact mirror image of the
/// right one.
Hand default_hand(Side side, double length = 0.19);

/// The same hand for the other side: reflected in the yz-plane of the wrist.
Hand mirrored_hand(const Hand& hand);

/// Refuses what the engine cannot feel with: radii or a palm's thickness not in 1e-6 .. 1000 m, bone lengths
/// not in 0 .. 1000 m, limits that are not finite or the wrong way round, a position or the palm's height
/// beyond 1000 m, a quaternion that is not of length 1, a palm polygon that is not flat, convex and of 3 to
/// 16 corners. Names the field.
Status check_hand(const Hand& hand);

/// Poses of all 26 joints in the wrist's parent frame B. Angles outside the limits are clamped; returns how
/// many were. Deterministic (own sine and cosine); allocates nothing. `angles` holds kAngleCount finite
/// values [rad].
int forward_kinematics(const Hand& hand, const Pose& X_BH, std::span<const double, kAngleCount> angles,
                       std::array<Pose, kJointCount>& X_BJ);

}  // namespace lumbrical
