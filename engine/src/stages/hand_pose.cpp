// The paper's Figure 1 and 2 and their repair. Under the paper's laws a phalanx is a cylinder, and of the
// spheres at joints and tips only the part counts that the cylinders don't cover. Under the exact laws a
// phalanx is one tile, the hull of its end spheres, and neighbouring tiles share out space along the
// bisecting plane of their joint; where that is not exact, joint_border.h says so. The palm: swept_polygon.h.
#include "stages/hand_pose.h"

#include <cmath>

#include "base/set_bits.h"
#include "borders/joint_border.h"
#include "model/swept_polygon.h"

namespace lumbrical {
namespace {

// Farther from the wrist than this [m] no joint of a hand is.
constexpr double kHandReach = 1.0;

std::uint32_t find_joints(const Hand& hand, const DeviceFrame& frame, Joints& joints) {
  const Pose X_WB{frame.base.position, normalized(frame.base.orientation)};
  if (frame.kind == InputKind::joint_angles) {
    std::array<double, kAngleCount> angle;
    for (std::size_t i = 0; i < kAngleCount; ++i) angle[i] = frame.angle[i];
    joints.valid = (1u << kJointCount) - 1;
    return forward_kinematics(hand, X_WB, angle, joints.pose) > 0 ? kAngleClamped : 0u;
  }
  joints.valid = frame.valid & ((1u << kJointCount) - 1);
  if (!joints.has(kWrist)) joints.valid &= ~(1u << kPalm);  // the palm's wrench is about the wrist
  for (std::size_t i = 0; i < kJointCount; ++i) {
    joints.pose[i] = X_WB * to_pose(frame.joint[i]);
    // Of a joint that is not tracked a frame may hold anything, and what is not finite would be in all sums.
    if (!joints.has(static_cast<int>(i)) && !is_finite(joints.pose[i].position)) joints.pose[i] = X_WB;
  }
  return 0;
}

bool is_exact(Law law) { return law == Law::field || law == Law::column; }

void add(const Primitive& primitive, Primitives& hand) {
  if (hand.count < Primitives::kMaxCount) hand.primitive[hand.count++] = primitive;
}

void add_cut(Vec3 normal, Vec3 point, Primitive& primitive, double overhang = 0) {
  primitive.overhang[primitive.cut_count] = overhang;
  primitive.cut[primitive.cut_count++] = {normal, point};
}

// The whole phalanges, uncut.
std::uint32_t set_capsules(const Hand& hand, const Settings& settings, Primitives& primitives) {
  const Joints& joints = primitives.joints;
  std::uint32_t flags = 0;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    const auto [base, tip] = kPhalanxJoints[i];
    primitives.present[i] = joints.has(base) && joints.has(tip);
    if (!primitives.present[i]) {
      flags |= kSegmentMissing;
      continue;
    }
    Primitive& capsule = primitives.capsule[i];
    capsule.segment = static_cast<std::uint8_t>(i);
    capsule.law = settings.law[i];
    capsule.end1 = joints.position(base);
    capsule.end2 = joints.position(tip);
    capsule.radius1 = hand.radius[base];
    capsule.radius2 = hand.radius[tip];
    const Vec3 axis = capsule.end2 - capsule.end1;
    if (!(dot(axis, axis) > 1e-18)) flags |= kSegmentDegenerate;
  }
  return flags;
}

bool is_paper(const Primitives& hand, std::size_t phalanx) { return !is_exact(hand.capsule[phalanx].law); }

// A joint between two phalanges is the paper's, with a sphere of its own, where both follow the paper.
bool paper_joint(const Primitives& hand, std::size_t phalanx) {
  return is_paper(hand, phalanx) && is_paper(hand, phalanx + 1);
}

// The plane through the joint beyond `phalanx` that shares out space between it and the next.
Vec3 bisector(const Primitives& hand, std::size_t phalanx) {
  const Vec3 here = hand.direction[phalanx], next = hand.direction[phalanx + 1];
  return half_way(here, next);
}

// What the paper's cuts stand on: along the phalanx, or, where it has no length, its nearest neighbour.
Vec3 paper_axis(const Primitives& hand, std::size_t i) {
  Vec3 axis = hand.direction[i];
  const auto is_none = [&axis] { return !(dot(axis, axis) > 0); };
  for (std::size_t j = i; is_none() && j % 3 > 0 && hand.present[j - 1]; --j) axis = hand.direction[j - 1];
  for (std::size_t j = i; is_none() && j % 3 < 2 && hand.present[j + 1]; ++j) axis = hand.direction[j + 1];
  return is_none() ? Vec3{1, 0, 0} : axis;
}

bool has_before(const Primitives& hand, std::size_t i) { return i % 3 > 0 && hand.present[i - 1]; }
bool has_after(const Primitives& hand, std::size_t i) { return i % 3 < 2 && hand.present[i + 1]; }

// The body of a phalanx: tile or cylinder, cut at its neighbours.
void add_body(std::size_t i, Primitives& hand) {
  Primitive body = hand.capsule[i];
  const Vec3 axis = paper_axis(hand, i);
  if (has_before(hand, i) && !paper_joint(hand, i - 1)) {
    add_cut(-bisector(hand, i - 1), body.end1, body, hand.border[i - 1].slab);
  } else if (is_paper(hand, i)) {
    add_cut(-axis, body.end1, body);
  }
  if (has_after(hand, i) && !paper_joint(hand, i)) {
    add_cut(bisector(hand, i), body.end2, body, hand.border[i].slab);
  } else if (is_paper(hand, i)) {
    add_cut(axis, body.end2, body);
  }
  if (is_paper(hand, i)) body.phalanx = {static_cast<std::int8_t>(i), -1};
  add(body, hand);
}

// The part of a joint's or tip's sphere that no cylinder covers.
void add_sphere(std::size_t i, bool at_tip, Primitives& hand) {
  Primitive sphere = hand.capsule[i];
  const Vec3 axis = paper_axis(hand, i);
  const bool joined = !at_tip && has_before(hand, i);
  sphere.end1 = sphere.end2 = at_tip ? sphere.end2 : sphere.end1;
  sphere.radius1 = sphere.radius2 = at_tip ? sphere.radius2 : sphere.radius1;
  add_cut(at_tip ? -axis : axis, sphere.end1, sphere);
  if (joined) add_cut(-paper_axis(hand, i - 1), sphere.end1, sphere);
  sphere.phalanx = {static_cast<std::int8_t>(i), static_cast<std::int8_t>(joined ? i - 1 : -1)};
  add(sphere, hand);
}

void add_phalanx(std::size_t i, Primitives& hand) {
  if (is_paper(hand, i) && (!has_before(hand, i) || paper_joint(hand, i - 1))) add_sphere(i, false, hand);
  add_body(i, hand);
  if (is_paper(hand, i) && !has_after(hand, i)) add_sphere(i, true, hand);
}

std::uint32_t place_parts(const Hand& hand, const Settings& settings, Primitives& primitives) {
  primitives.count = 0;
  primitives.palm.corner_count = 0;
  std::uint32_t flags = set_capsules(hand, settings, primitives);
  if (!primitives.joints.has(kPalm) && !hand.palm.polygon.empty()) flags |= kSegmentMissing;
  return flags;
}

}  // namespace

void place_axes(Primitives& primitives) {
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Pose& X_WJ = base_pose(primitives, i);
    primitives.base_joint[i] = X_WJ.position;
    primitives.flexion_axis[i] = rotate(X_WJ.orientation, {1, 0, 0});
  }
}

std::uint32_t check_input(const DeviceFrame& frame) {
  std::uint32_t flags = 0;
  const auto rotation_usable = [](Quat q) {
    const double square = dot(q, q);
    return square > 0.25 && square < 4;
  };
  const Quat base = frame.base.orientation;
  if (!is_finite(frame.base.position) || !is_finite(dot(base, base))) return kInputNotFinite;
  if (!rotation_usable(base)) flags |= kInputImplausible;
  if (frame.kind == InputKind::joint_angles) {
    for (const float angle : frame.angle) {
      if (!std::isfinite(angle)) return kInputNotFinite;
    }
    return flags;
  }
  const Pose wrist = to_pose(frame.joint[kWrist]);
  for (std::size_t i = 0; i < kJointCount; ++i) {
    if (!has_bit(frame.valid, i)) continue;
    const JointPose& joint = frame.joint[i];
    const auto& p = joint.position;
    const auto& q = joint.orientation;
    const Quat orientation{q[3], q[0], q[1], q[2]};
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]) ||
        !is_finite(dot(orientation, orientation))) {
      return kInputNotFinite;
    }
    if (!rotation_usable(orientation)) flags |= kInputImplausible;
    const Vec3 from_wrist = Vec3{p[0], p[1], p[2]} - wrist.position;
    if (has_bit(frame.valid, kWrist) && !(norm(from_wrist) < kHandReach)) flags |= kInputImplausible;
  }
  return flags;
}

std::uint32_t place_hand(const Hand& hand, const Settings& settings, const DeviceFrame& frame,
                         Primitives& primitives) {
  const std::uint32_t flags = find_joints(hand, frame, primitives.joints);
  return flags | place_parts(hand, settings, primitives);
}

void place_hand(const Hand& hand, const Settings& settings, const Joints& joints, const Pose& X_OW,
                Primitives& primitives) {
  primitives.joints.valid = joints.valid;
  for (std::size_t i = 0; i < kJointCount; ++i) primitives.joints.pose[i] = X_OW * joints.pose[i];
  static_cast<void>(place_parts(hand, settings, primitives));
}

bool may_meet(const Hand& hand, const Primitives& primitives, const Box& world) {
  Box box;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (!primitives.present[i]) continue;
    const Primitive& capsule = primitives.capsule[i];
    box.add(capsule.end1, kReachMargin * capsule.radius1);
    box.add(capsule.end2, kReachMargin * capsule.radius2);
  }
  if (primitives.joints.has(kPalm)) {
    double square = 0;
    for (const Vec3 corner : hand.palm.polygon) square = max(square, dot(corner, corner));
    const double reach = std::sqrt(square) + std::fabs(hand.palm.height) + hand.palm.thickness;
    box.add(primitives.joints.position(kPalm), kReachMargin * reach);
  }
  return box.meets(world);
}

void shape_hand(const Hand& hand, Primitives& primitives) {
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    const Primitive& capsule = primitives.capsule[i];
    if (primitives.present[i]) primitives.direction[i] = unit_or(capsule.end2 - capsule.end1, {});
  }
  primitives.palm = {};
  if (primitives.joints.has(kPalm)) primitives.palm = place_palm(hand.palm, primitives.joints.pose[kPalm]);
  place_axes(primitives);
}

void tile_hand(const Settings& settings, Primitives& primitives) {
  if (primitives.count > 0) return;
  set_joint_borders(primitives);
  set_folded_fingers(primitives);
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (primitives.present[i]) add_phalanx(i, primitives);
  }
  if (primitives.joints.has(kPalm)) add_palm_parts(primitives.palm, settings.law[kPalmSegment], primitives);
}

bool tile_hand_in(const Model& model, const Joints& joints, const Pose& X_OW, Primitives& primitives) {
  place_hand(model.hand, model.settings, joints, X_OW, primitives);
  if (!may_meet(model.hand, primitives, model.extent)) return false;
  shape_hand(model.hand, primitives);
  tile_hand(model.settings, primitives);
  return true;
}

}  // namespace lumbrical
