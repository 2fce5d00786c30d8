// Brings a motion to any time: Steffen's monotone cubic (Astronomy and Astrophysics 239, 1990) for what is a
// number, the normalised linear blend for what is a rotation. Also the placing of a motion and the hand that
// fits it.
#include <algorithm>
#include <cassert>

#include "base/floating_point.h"
#include "lumbrical/motion.h"
#include "lumbrical/object_path.h"
#include "model/hand_from_positions.h"

namespace lumbrical {
namespace {

// The samples round one time: `left` <= time < `right`, and the fraction of the way between them.
template <class Sample>
struct Interval {
  const Sample* before;  // of `left`; the same as `left` where there is none
  const Sample* left;
  const Sample* right;
  const Sample* after;  // of `right`; the same as `right` where there is none
  double fraction;      // 0..1
  // The neighbouring intervals' lengths in units of this one's; 0 where there is none.
  double length_before, length_after;
};

// `time` lies between the first and the last sample.
template <class Sample>
Interval<Sample> find_interval(const std::vector<Sample>& samples, double time) {
  const Sample* first = samples.data();
  const Sample* last = first + samples.size() - 1;
  Interval<Sample> found;
  found.right = std::upper_bound(first + 1, last, time, [](double t, const Sample& s) { return t < s.time; });
  found.left = found.right - 1;
  found.before = found.left == first ? first : found.left - 1;
  found.after = found.right == last ? last : found.right + 1;
  const double length = found.right->time - found.left->time;
  const bool increasing = length > 0;
  found.fraction = increasing ? clamp((time - found.left->time) / length, 0, 1) : 0;
  found.length_before = increasing ? (found.left->time - found.before->time) / length : 0;
  found.length_after = increasing ? (found.after->time - found.right->time) / length : 0;
  return found;
}

// Slope at a sample from the differences to its neighbours, which lie `a_length` and `b_length` away: that of
// the parabola through the three, limited so that no cubic built on it overshoots; zero at a peak.
double limited_slope(double a, double a_length, double b, double b_length) {
  if (!(a_length > 0 && b_length > 0)) return 0;  // the motion starts and ends at rest
  const double a_slope = a / a_length, b_slope = b / b_length;
  const double parabola = (a_slope * b_length + b_slope * a_length) / (a_length + b_length);
  const bool rising = a_slope > 0 && b_slope > 0, falling = a_slope < 0 && b_slope < 0;
  if (!rising && !falling) return 0;
  const double size = min(0.5 * std::fabs(parabola), min(std::fabs(a_slope), std::fabs(b_slope)));
  return rising ? 2 * size : -2 * size;
}

// The cubic of one coordinate. The final clamp keeps rounding, and overflow of absurd input, between the
// neighbours.
template <class Sample>
double blend(double before, double left, double right, double after, const Interval<Sample>& at) {
  const double rise = right - left;
  const double left_slope = limited_slope(left - before, at.length_before, rise, 1);
  const double right_slope = limited_slope(rise, 1, after - right, at.length_after);
  const double u = at.fraction;
  const double value = left + u * (left_slope + u * ((3 * rise - 2 * left_slope - right_slope) +
                                                     u * (left_slope + right_slope - 2 * rise)));
  return clamp(value, min(left, right), max(left, right));
}

float blend(float before, float left, float right, float after, const Interval<MotionSample>& at) {
  return static_cast<float>(blend(double{before}, double{left}, double{right}, double{after}, at));
}

Quat blend(Quat left, Quat right, double fraction) {
  const double sign = dot(left, right) < 0 ? -1.0 : 1.0;
  const double a = 1 - fraction, b = sign * fraction;
  return normalized({a * left.w + b * right.w, a * left.x + b * right.x, a * left.y + b * right.y,
                     a * left.z + b * right.z});
}

Quat to_quat(const std::array<float, 4>& xyzw) { return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]}; }

std::array<float, 4> to_floats(Quat q) {
  return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
}

const Pose& pose_of(const MotionSample& sample) { return sample.frame.base; }
const Pose& pose_of(const PathPoint& point) { return point.pose; }

template <class Sample>
Pose blend_pose(const Interval<Sample>& at) {
  const Pose& before = pose_of(*at.before);
  const Pose& left = pose_of(*at.left);
  const Pose& right = pose_of(*at.right);
  const Pose& after = pose_of(*at.after);
  Pose pose;
  pose.position.x = blend(before.position.x, left.position.x, right.position.x, after.position.x, at);
  pose.position.y = blend(before.position.y, left.position.y, right.position.y, after.position.y, at);
  pose.position.z = blend(before.position.z, left.position.z, right.position.z, after.position.z, at);
  pose.orientation = blend(left.orientation, right.orientation, at.fraction);
  return pose;
}

void blend_joints(const Interval<MotionSample>& at, DeviceFrame& frame) {
  for (int j = 0; j < kJointCount; ++j) {
    const JointPose& before = at.before->frame.joint[j];
    const JointPose& left = at.left->frame.joint[j];
    const JointPose& right = at.right->frame.joint[j];
    const JointPose& after = at.after->frame.joint[j];
    for (int i = 0; i < 3; ++i) {
      frame.joint[j].position[i] =
          blend(before.position[i], left.position[i], right.position[i], after.position[i], at);
    }
    frame.joint[j].orientation =
        to_floats(blend(to_quat(left.orientation), to_quat(right.orientation), at.fraction));
  }
}

void blend_angles(const Interval<MotionSample>& at, DeviceFrame& frame) {
  for (int i = 0; i < kAngleCount; ++i) {
    frame.angle[i] = blend(at.before->frame.angle[i], at.left->frame.angle[i], at.right->frame.angle[i],
                           at.after->frame.angle[i], at);
  }
}

DeviceFrame held(const MotionSample& sample, double time, double max_gap) {
  DeviceFrame frame = sample.frame;
  const double distance = std::fabs(time - sample.time);
  if (distance == 0) return frame;
  frame.flags |= kExtrapolated;
  if (!(distance <= max_gap)) frame.flags |= kTrackingLost;
  return frame;
}

bool is_rigid(const Pose& pose) {
  const double square = dot(pose.orientation, pose.orientation);
  return is_finite(pose.position) && is_finite(square) && std::fabs(square - 1) < 1e-6;
}

constexpr std::uint32_t bit(int joint) { return 1u << joint; }
constexpr std::uint32_t kPalmJoints = bit(kPalm) | bit(kIndexMetacarpal) | bit(kIndexProximal) |
                                      bit(kMiddleMetacarpal) | bit(kMiddleProximal) | bit(kRingMetacarpal) |
                                      bit(kRingProximal) | bit(kLittleMetacarpal) | bit(kLittleProximal);

bool shows_the_palm(const DeviceFrame& frame) {
  return frame.kind == InputKind::joint_poses && (frame.flags & kTrackingLost) == 0 &&
         (frame.valid & kPalmJoints) == kPalmJoints;
}

bool is_rigid_joint(const JointPose& joint) {
  const Quat q = to_quat(joint.orientation);
  const double square = dot(q, q);
  return is_finite(to_pose(joint).position) && square > 0.25 && square < 4;
}

void take_radii(const std::array<double, kJointCount>& radius, Hand& hand) {
  for (int j = 0; j < kJointCount; ++j) {
    if (radius[j] > 0) hand.radius[j] = radius[j];
  }
}

// False, and the hand's own stays, where the joints span no area.
bool take_palm(const DeviceFrame& frame, Hand& hand) {
  std::array<Pose, kJointCount> X_BJ;
  for (int j = 0; j < kJointCount; ++j) X_BJ[j] = to_pose(frame.joint[j]);
  std::vector<Vec3> polygon = fit_palm_polygon(X_BJ, hand.radius, hand.palm.thickness);
  if (polygon.empty()) return false;
  hand.palm.polygon = std::move(polygon);
  return true;
}

}  // namespace

DeviceFrame resample(const Motion& motion, double time, const ResamplerOptions& options) {
  assert(!motion.samples.empty());
  const FloatingPointGuard guard;
  const MotionSample& first = motion.samples.front();
  const MotionSample& last = motion.samples.back();
  if (motion.samples.size() == 1) return first.frame;  // a still pose holds for ever
  if (!(time > first.time)) return held(first, time, options.max_gap);
  if (time >= last.time) return held(last, time, options.max_gap);
  const Interval at = find_interval(motion.samples, time);
  if (at.fraction == 0) return at.left->frame;
  DeviceFrame frame;
  frame.kind = at.left->frame.kind;
  frame.flags = at.left->frame.flags | at.right->frame.flags;
  if (!(at.right->time - at.left->time <= options.max_gap)) frame.flags |= kTrackingLost;
  frame.valid = at.left->frame.valid & at.right->frame.valid;
  frame.base = blend_pose(at);
  if (frame.kind == InputKind::joint_poses) {
    blend_joints(at, frame);
  } else {
    blend_angles(at, frame);
  }
  return frame;
}

Pose resample(const ObjectPath& path, double time) {
  const FloatingPointGuard guard;
  if (!(time > path.front().time)) return path.front().pose;
  if (time >= path.back().time) return path.back().pose;
  const Interval at = find_interval(path, time);
  return at.fraction == 0 ? at.left->pose : blend_pose(at);
}

std::uint64_t tick_count(double seconds, double rate) {
  return static_cast<std::uint64_t>(max(1, std::ceil(seconds * rate - 1e-6)));
}

double duration(const Motion& motion) {
  return motion.samples.empty() ? 0 : motion.samples.back().time - motion.samples.front().time;
}

Status place_motion(const MotionPlacement& placement, Motion& motion) {
  const FloatingPointGuard guard;
  if (!is_rigid(placement.pose)) {
    return Status::error("placement: the pose is not a finite position with a unit quaternion; correct it");
  }
  const double scale = placement.scale;
  if (!is_finite(scale) || !(scale > 0)) {
    return Status::error("placement: the scale must be finite and > 0");
  }
  Motion placed = motion;
  for (MotionSample& sample : placed.samples) {
    DeviceFrame& frame = sample.frame;
    if (frame.kind == InputKind::joint_angles && scale != 1) {
      return Status::error(
          "placement: a motion in joint angles has no size; leave the scale at 1 and scale the hand instead");
    }
    frame.base = placement.pose * frame.base;
    if (!is_finite(frame.base.position))
      return Status::error("placement: a position overflows; move it nearer");
    if (frame.kind == InputKind::joint_angles) continue;
    for (JointPose& joint : frame.joint) {
      for (float& coordinate : joint.position) {
        const double scaled = scale * double{coordinate};
        if (!fits_float(scaled)) return Status::error("placement: a position overflows; use a smaller scale");
        coordinate = static_cast<float>(scaled);
      }
    }
  }
  for (double& radius : placed.radius) radius *= scale;
  motion = std::move(placed);
  return {};
}

Hand fit_hand(const Hand& hand, const Motion& motion) {
  const FloatingPointGuard guard;
  Hand fitted = hand.side == motion.side ? hand : mirrored_hand(hand);
  take_radii(motion.radius, fitted);
  for (const MotionSample& sample : motion.samples) {
    if (!shows_the_palm(sample.frame)) continue;
    take_palm(sample.frame, fitted);
    break;
  }
  return fitted;
}

Status fit_hand_to(const DeviceFrame& frame, const std::array<double, kJointCount>& radius, Hand& hand) {
  const FloatingPointGuard guard;
  constexpr std::uint32_t kAll = (1u << kJointCount) - 1;
  if (!shows_the_palm(frame) || (frame.valid & kAll) != kAll)
    return Status::error(
        "not all joints are tracked; fit the hand to a frame of joint poses in which they are");
  for (int j = 0; j < kJointCount; ++j) {
    if (!is_rigid_joint(frame.joint[j]) || !is_finite(radius[j]))
      return Status::error(
          "the pose or radius of " + std::string(joint_name(j)) +
          " is not finite, or its orientation no unit quaternion; fit the hand to another frame");
  }
  Hand fitted = hand;
  take_radii(radius, fitted);
  if (!take_palm(frame, fitted))
    return Status::error(
        "the joints of the palm span no area; fit the hand to a frame that shows an open hand");
  if (Status status = check_hand(fitted); !status.ok()) return status;
  hand = std::move(fitted);
  return {};
}

}  // namespace lumbrical
