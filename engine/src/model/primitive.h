// The shapes a posed hand is made of, and the one they are all cases of.
//
// A round shape is the convex hull of two spheres: a sphere when both coincide, a capsule when the radii
// agree, a rounded cone otherwise. Half-spaces cut away what a neighbour feels. The paper's cylinder inside a
// finger is a capsule cut flat at both ends, its joint and fingertip spheres are spheres cut by the ends of
// the cylinders. The palm, everything within a radius of a convex polygon, falls into two slabs, one on each
// side of the polygon, and a capsule along every edge of it (swept_polygon.h).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "base/set_bits.h"
#include "lumbrical/math.h"
#include "lumbrical/model.h"

namespace lumbrical {

enum class Shape : std::uint8_t {
  round,  ///< convex hull of two spheres
  flat,   ///< cylinder with flat ends that stands alone (probe)
  slab,   ///< the palm between its core polygon and the skin on one side of that
};

/// The part of space where dot(normal, p - point) <= offset.
struct HalfSpace {
  Vec3 normal;        ///< unit, W
  Vec3 point;         ///< [m] W
  double offset = 0;  ///< [m] 0 but for what is cut in one triangle (border_cut.h)
};
/// [share of the radius] A triangle whose corners are all as near to a cut all but lies in it: where it
/// crosses is rounding's, which in lanes is not the same for the tiles on both sides (`cut_along`,
/// section.h).
inline constexpr double kAlongCut = 1e-5;

/// Reaches are taken for so much larger where things must not be lost by rounding.
inline constexpr double kReachMargin = 1.000001;

/// Is the hull of two spheres whose centres are so far apart [m] more than one of them?
inline bool has_two_ends(double length, double radius, double other_radius) {
  return length > std::fabs(radius - other_radius) && length > 1e-12 * radius;
}

struct Primitive {
  static constexpr std::size_t kMostCuts = 3;
  Shape shape = Shape::round;
  std::uint8_t segment = 0;  ///< the hand segment whose force it adds to
  Law law = Law::field;
  std::uint8_t cut_count = 0;
  Vec3 end1, end2;                  ///< [m] W; of a slab both are the centre of its bounding sphere
  double radius1 = 0, radius2 = 0;  ///< [m]; of a slab both are the radius of its bounding sphere
  /// Of a tile or a paper's shape up to two; of an edge of the palm three, towards the polygon and towards
  /// the next edges; of a slab one, the polygon's plane.
  std::array<HalfSpace, kMostCuts> cut{};
  std::array<double, kMostCuts> overhang{};  ///< [m] how far a tile may have space beyond (joint_border.h)
  /// The phalanges this primitive is a part of: the paper measures depth through them. Empty (-1): through
  /// itself.
  std::array<std::int8_t, 2> phalanx{-1, -1};
};

/// The palm's core: a convex polygon; the palm is everything within `radius` of it.
struct SweptPolygon {
  static constexpr std::size_t kMostCorners = 16;
  std::uint32_t corner_count = 0;  ///< 0: no palm
  std::array<Vec3, kMostCorners>
      corner{};  ///< [m] W, in order, counterclockwise seen from the tip of `normal`
  std::array<Vec3, kMostCorners> outward{};  ///< W, unit, in the polygon's plane: away from it across the
                                             ///< edge from corner i to i + 1
  Vec3 normal;                               ///< W, unit, towards the palmar side
  double radius = 0;                         ///< [m]
};

/// The joint between a phalanx and the next one out, where the two tiles share out space (joint_border.h).
struct JointBorder {
  bool shared = false;  ///< the border is not the bisecting plane everywhere
  bool near = false;    ///< neither tile's far end has a part in it
  Vec3 centre;          ///< [m] W, the joint
  Vec3 normal;          ///< W, unit, of the bisecting plane, away from the wrist
  double reach = 0;     ///< [m] farther from the joint plane and border agree
  double slab = 0;      ///< [m] farther from the plane plane and border agree
  /// A near border is a cone with its apex at the joint: side z = sqrt(x^2 + y^2), z along `normal`, x and y
  /// along these times their lengths. What lies inside it is the outer tile's (side 1) or the inner one's
  /// (-1).
  Vec3 x, y;
  double side = 1;
};

/// Where the joints are, as far as a frame tells.
struct Joints {
  std::array<Pose, kJointCount> pose;  ///< X_WJ
  std::uint32_t valid = 0;             ///< a bit for each joint
  [[nodiscard]] bool has(int joint) const { return has_bit(valid, joint); }
  [[nodiscard]] Vec3 position(int joint) const { return pose[static_cast<std::size_t>(joint)].position; }
};

/// All primitives of one posed hand.
struct Primitives {
  /// 15 phalanges, 15 joints and 5 tips; the palm's slabs and edges.
  static constexpr std::size_t kMaxCount = 15 + 15 + 5 + 2 + SweptPolygon::kMostCorners;
  std::uint32_t count = 0;  ///< 0 until the exact rung asks for them (`tile_hand`)
  std::array<Primitive, kMaxCount> primitive{};
  std::uint32_t flags = 0;    ///< TickFlag bits so far: of the input and of placing the hand
  bool in_reach = false;      ///< the hand was placed near what it may touch, and given its shape
  bool out_of_reach = false;  ///< it was placed but, far from everything, given none
  std::array<Primitive, kPhalanxCount> capsule{};  ///< whole phalanges, uncut, for the paper's depth
  std::array<bool, kPhalanxCount> present{};       ///< which of them this pose has
  std::array<Vec3, kPhalanxCount> direction{};  ///< W, unit, of their axes, away from the wrist; 0: no length
  Joints joints;                                ///< what they were made of
  std::array<JointBorder, kPhalanxCount> border{};  ///< of the joint beyond each phalanx
  std::array<bool, kFingerCount> folded{};          ///< first and last phalanx of the finger may overlap
  SweptPolygon palm;
  std::array<Vec3, kSegmentCount> base_joint{};    ///< [m] W, the joint that moves each segment
  std::array<Vec3, kSegmentCount> flexion_axis{};  ///< W, unit; turning about it opens the hand
};

/// A segment's base joint, and its pose.
inline std::size_t base_joint_of(std::size_t segment) {
  return static_cast<std::size_t>(segment == kPalmSegment ? int{kWrist} : int{kPhalanxJoints[segment].base});
}
inline const Pose& base_pose(const Primitives& primitives, std::size_t segment) {
  return primitives.joints.pose[base_joint_of(segment)];
}

}  // namespace lumbrical
