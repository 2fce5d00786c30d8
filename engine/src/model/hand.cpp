// Names, the default hand and the check of a hand.
#include "lumbrical/hand.h"
#include "base/floating_point.h"

#include <string>

#include "model/convex_hull.h"
#include "model/hand_from_positions.h"

namespace lumbrical {
namespace {

constexpr std::array<std::string_view, kJointCount> kJointNames = {"palm",
                                                                   "wrist",
                                                                   "thumb metacarpal",
                                                                   "thumb proximal",
                                                                   "thumb distal",
                                                                   "thumb tip",
                                                                   "index metacarpal",
                                                                   "index proximal",
                                                                   "index intermediate",
                                                                   "index distal",
                                                                   "index tip",
                                                                   "middle metacarpal",
                                                                   "middle proximal",
                                                                   "middle intermediate",
                                                                   "middle distal",
                                                                   "middle tip",
                                                                   "ring metacarpal",
                                                                   "ring proximal",
                                                                   "ring intermediate",
                                                                   "ring distal",
                                                                   "ring tip",
                                                                   "little metacarpal",
                                                                   "little proximal",
                                                                   "little intermediate",
                                                                   "little distal",
                                                                   "little tip"};
constexpr std::array<std::string_view, kFingerCount> kFingerNames = {"thumb", "index", "middle", "ring",
                                                                     "little"};

constexpr double kDefaultLength = 0.19;  // [m] at which the radii below hold

// Quest's default radii, in the order of Joint [m]. The palm has none there; half its thickness is taken.
constexpr std::array<double, kJointCount> kDefaultRadius = {
    0.0120, 0.0215,                          // palm, wrist
    0.0194, 0.0123, 0.0098, 0.0088,          // thumb
    0.0212, 0.0103, 0.0085, 0.0076, 0.0066,  // index
    0.0212, 0.0112, 0.0080, 0.0076, 0.0066,  // middle
    0.0191, 0.0099, 0.0076, 0.0072, 0.0062,  // ring
    0.0181, 0.0085, 0.0068, 0.0064, 0.0054,  // little
};

// A right hand, palm down in the wrist frame: x to the little finger, y up, -z to the fingers.
struct FingerShape {
  Vec3 metacarpal;               // [m] the base joint
  Vec3 direction;                // from there at angles zero, any length
  Vec3 flexion_axis;             // roughly: made exact against the direction
  std::array<double, 4> length;  // [m] metacarpal, then the phalanges
};
// The thumb's ball stands in front of the palm and its nail looks sideways, so that flexing it sweeps across
// the palm and abducting it lifts it off, opposite the fingers. The other axes fan out and roll with the
// palm's arch, so that the fingers converge when they close.
constexpr std::array<FingerShape, kFingerCount> kRightHand = {{
    {{-0.028, -0.016, -0.035}, {-0.70, -0.32, -0.64}, {0.10, 0.88, -0.46}, {0, 0.033, 0.034, 0.025}},
    {{-0.0190, -0.0080, -0.036}, {-0.005, 0.002, -0.060}, {1, 0.05, 0}, {0.060, 0.038, 0.0245, 0.0225}},
    {{-0.0035, -0.0065, -0.034}, {0.0015, 0.0040, -0.062}, {1, 0, 0}, {0.062, 0.043, 0.0275, 0.0250}},
    {{0.0140, -0.0060, -0.034}, {0.0040, 0.0005, -0.055}, {1, -0.08, 0}, {0.055, 0.039, 0.0265, 0.0245}},
    {{0.0230, -0.0075, -0.034}, {0.0115, 0.0000, -0.044}, {1, -0.18, 0}, {0.046, 0.031, 0.0205, 0.0220}},
}};

constexpr double kDegree = 0.017453292519943295;  // [rad]

constexpr AngleLimit degrees(double lower, double upper) { return {lower * kDegree, upper * kDegree}; }

// Active ranges of a healthy adult hand as anatomy books give them, rounded outwards.
constexpr std::array<AngleLimit, 4> kThumbLimits = {degrees(-10, 60), degrees(-30, 45), degrees(-10, 60),
                                                    degrees(-15, 80)};
constexpr std::array<AngleLimit, 4> kFingerLimits = {degrees(-20, 25), degrees(-20, 90), degrees(0, 110),
                                                     degrees(-5, 80)};

Finger make_finger(const FingerShape& shape, bool is_thumb) {
  const Vec3 z = -unit_or(shape.direction, {0, 0, -1});
  const Vec3 x = unit_or(shape.flexion_axis - dot(shape.flexion_axis, z) * z, {1, 0, 0});
  Finger finger;
  finger.base = {shape.metacarpal, quat_from_axes(x, cross(z, x), z)};
  finger.bone_length = shape.length;
  finger.limit = is_thumb ? kThumbLimits : kFingerLimits;
  return finger;
}

std::array<Pose, kJointCount> rest_pose(const Hand& hand) {
  std::array<Pose, kJointCount> X_HJ;
  const std::array<double, kAngleCount> zero{};
  forward_kinematics(hand, Pose{}, zero, X_HJ);
  return X_HJ;
}

void scale_lengths(double scale, Hand& hand) {
  for (Finger& finger : hand.finger) {
    finger.base.position = scale * finger.base.position;
    for (double& length : finger.bone_length) length *= scale;
  }
}

// The frame of the wrist on the other side: -x, y, z of the reflected frame, which is right-handed again.
Pose mirrored(const Pose& pose) {
  const Vec3 p = pose.position;
  const Quat q = pose.orientation;
  return {{-p.x, p.y, p.z}, {q.w, q.x, -q.y, -q.z}};
}

// [m] Cubes and quotients of such lengths are numbers yet.
constexpr double kLargest = 1e3;
bool is_size(double length) { return length >= 1e-6 && length <= kLargest; }
bool is_near(double coordinate) { return std::fabs(coordinate) <= kLargest; }
bool is_near(Vec3 place) { return is_near(place.x) && is_near(place.y) && is_near(place.z); }

bool is_rigid(const Pose& pose) {
  const double square = dot(pose.orientation, pose.orientation);
  return is_near(pose.position) && is_finite(square) && std::fabs(square - 1) < 1e-6;
}

Status refuse(const std::string& what) { return Status::error("hand: " + what); }

Status check_finger(const Finger& finger, std::string_view name) {
  const std::string field = std::string(name) + " finger: ";
  if (!is_rigid(finger.base)) {
    return refuse(field + "base is not a position within 1000 m with a unit quaternion");
  }
  for (const double length : finger.bone_length) {
    if (!(length >= 0 && length <= kLargest))
      return refuse(field + "bone_length must lie between 0 and 1000 m");
  }
  for (const AngleLimit& limit : finger.limit) {
    if (!is_finite(limit.lower) || !is_finite(limit.upper) || limit.lower > limit.upper) {
      return refuse(field + "limit must be finite with lower <= upper");
    }
  }
  return {};
}

// Every corner lies on the same side of every edge, and not all on one line: that also refuses stars.
bool is_convex(const std::vector<Vec3>& polygon) {
  bool left = false, right = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    if (a == b) return false;
    for (const Vec3 c : polygon) {
      left = left || turn(a, b, c) > 0;
      right = right || turn(a, b, c) < 0;
    }
  }
  return left != right;
}

Status check_palm(const Palm& palm) {
  if (!is_near(palm.height)) return refuse("palm.height must lie between -1000 and 1000 m");
  if (!is_size(palm.thickness)) return refuse("palm.thickness must lie between 1e-6 and 1000 m");
  if (palm.polygon.empty()) return {};
  if (palm.polygon.size() < 3 || palm.polygon.size() > 16) {
    return refuse("palm.polygon has " + std::to_string(palm.polygon.size()) +
                  " corners; it needs 3 to 16, or none");
  }
  for (const Vec3 corner : palm.polygon) {
    if (!is_near(corner)) return refuse("palm.polygon has a corner that is not within 1000 m");
    if (corner.y != 0) return refuse("palm.polygon is not flat: every corner needs y = 0");
  }
  if (!is_convex(palm.polygon))
    return refuse("palm.polygon is not convex, or its corners coincide or lie on one line");
  return {};
}

}  // namespace

std::string_view joint_name(int joint) {
  return joint >= 0 && joint < kJointCount ? kJointNames[joint] : std::string_view("no joint");
}

std::string_view segment_name(int segment) {
  if (segment == kPalmSegment) return "palm";
  return segment >= 0 && segment < kPhalanxCount ? kJointNames[kPhalanxJoints[segment].base]
                                                 : std::string_view("no segment");
}

std::string_view side_name(Side side) { return side == Side::right ? "right" : "left"; }

std::string_view finger_name(int finger) {
  return finger >= 0 && finger < kFingerCount ? kFingerNames[finger] : std::string_view("no finger");
}

Hand default_hand(Side side, double length) {
  const FloatingPointGuard guard;
  Hand hand;
  hand.side = Side::right;
  for (int f = 0; f < kFingerCount; ++f) hand.finger[f] = make_finger(kRightHand[f], f == 0);
  scale_lengths(length / norm(rest_pose(hand)[kMiddleTip].position), hand);

  const double scale = length / kDefaultLength;
  for (int j = 0; j < kJointCount; ++j) hand.radius[j] = scale * kDefaultRadius[j];
  hand.palm.height *= scale;
  hand.palm.thickness *= scale;
  const std::array<Pose, kJointCount> X_HJ = rest_pose(hand);
  hand.palm_joint = palm_between(X_HJ[kMiddleMetacarpal], X_HJ[kMiddleProximal]);
  hand.palm.polygon = fit_palm_polygon(rest_pose(hand), hand.radius, hand.palm.thickness);
  return side == Side::right ? hand : mirrored_hand(hand);
}

Hand mirrored_hand(const Hand& hand) {
  const FloatingPointGuard guard;
  Hand other = hand;
  other.side = other_side(hand.side);
  for (Finger& finger : other.finger) finger.base = mirrored(finger.base);
  other.palm_joint = mirrored(hand.palm_joint);
  for (Vec3& corner : other.palm.polygon) corner.x = -corner.x;
  return other;
}

Status check_hand(const Hand& hand) {
  for (int j = 0; j < kJointCount; ++j) {
    if (!is_size(hand.radius[j]))
      return refuse("radius of " + std::string(joint_name(j)) + " must lie between 1e-6 and 1000 m");
  }
  for (int f = 0; f < kFingerCount; ++f) {
    Status status = check_finger(hand.finger[f], finger_name(f));
    if (!status.ok()) return status;
  }
  if (!is_rigid(hand.palm_joint))
    return refuse("palm_joint is not a position within 1000 m with a unit quaternion");
  return check_palm(hand.palm);
}

}  // namespace lumbrical
