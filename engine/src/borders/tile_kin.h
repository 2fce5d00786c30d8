// Two tiles of one finger compared at a point of a triangle's plane: whose field is larger, whose the point
// is.
//
// Tiles that have a joint sphere in common have equal fields on the whole part of space to which that sphere
// is nearest, and nearly equal ones beside it. So they are compared not by phi but by the signed root of D
// (phi - phi_S), phi_S the field of the joint sphere and D the distance from its centre: sqrt(2) D sin((pi/2
// - theta - sigma) / 2) up to the far end (joint_border.h), which is smooth, changes its sign steadily and
// goes on where the fields are equal.
#pragma once

#include <cmath>

#include "section/section.h"

namespace lumbrical {

/// A phalanx from one of its joints, in plane coordinates and the height over the plane.
struct Cone {
  enum Kind : std::uint8_t {
    hull,        ///< of both spheres
    joint_only,  ///< the far sphere lies inside that of the joint
    far_only     ///< the other way round
  } kind = hull;
  Vec3 joint;  ///< [m]
  Vec3 axis;   ///< unit, away from the joint
  double length = 0, radius = 0;
  double drop = 0;              ///< [m] radius at the joint less that at the far end
  double sine = 0, cosine = 1;  ///< of the slope
};

/// A point seen from a cone's joint.
struct Sight {
  Vec3 from;        ///< [m] joint to point
  double distance;  ///< [m] D
  double axial, radial;
  double along;  ///< [m] D cos(theta + sigma): negative where the joint's sphere is the nearest one
};

inline Sight sight_of(const Cone& cone, Point2 p) {
  const Vec3 from = Vec3{p.x, p.y, 0} - cone.joint;
  const double axial = dot(from, cone.axis), radial = norm(cross(from, cone.axis));
  return {from, norm(from), axial, radial, cone.cosine * axial - cone.sine * radial};
}

/// Which sphere is the nearest: of the joint (the first end), one between (on the side), or the far one.
inline Zone::Part part_of(const Cone& cone, const Sight& sight) {
  if (cone.kind != Cone::hull) return cone.kind == Cone::joint_only ? Zone::first_end : Zone::second_end;
  if (sight.along < 0) return Zone::first_end;
  return sight.along < cone.cosine * cone.length ? Zone::side : Zone::second_end;
}

inline double cone_field(const Cone& cone, const Sight& sight) {
  switch (part_of(cone, sight)) {
    case Zone::first_end:
      return cone.radius - sight.distance;
    case Zone::side:
      return cone.radius - cone.sine * sight.axial - cone.cosine * sight.radial;
    default:
      return cone.radius - cone.drop - norm(sight.from - cone.length * cone.axis);
  }
}

/// The field's gradient within the plane; 0 where it has none.
inline Point2 cone_slope(const Cone& cone, const Sight& sight) {
  const Zone::Part part = part_of(cone, sight);
  Vec3 down;  // away from the nearest sphere's centre, unit
  if (part == Zone::side) {
    const Vec3 out = unit_or(sight.from - sight.axial * cone.axis, {});
    down = cone.sine * cone.axis + cone.cosine * out;
  } else {
    down = unit_or(part == Zone::first_end ? sight.from : sight.from - cone.length * cone.axis, {});
  }
  return {-down.x, -down.y};
}

/// Signed root of D (phi - phi_S).
inline double lead_of(const Cone& cone, const Sight& sight) {
  const double distance = sight.distance;
  if (cone.kind == Cone::joint_only) return -2 * distance;
  if (part_of(cone, sight) == Zone::second_end) {
    const double far = norm(sight.from - cone.length * cone.axis), sum = distance + far;
    const double rise = sum > 0 ? cone.length * (2 * sight.axial - cone.length) / sum - cone.drop : 0;
    return std::sqrt(distance * max(0, rise));
  }
  const double sum = distance + cone.sine * sight.axial + cone.cosine * sight.radial;
  return sum > 0 ? sight.along * std::sqrt(distance / sum) : 0;
}

/// The cone of a near border, height = side root(x^2 + y^2) with x and y scaled (JointBorder).
struct BorderCone {
  double side = 1;      ///< on the side of the first (-1) or the second (+1) of the two
  Linear x, y, height;  ///< [m] coordinates in space as functions of the plane's
};

/// A tile and one of its kin.
struct Kin {
  Cone first, second;    ///< the inner and the outer phalanx; compared in this order by both
  bool joined = true;    ///< they have a joint in common; otherwise their fields are compared
  bool near = false;     ///< JointBorder::near
  bool is_first = true;  ///< the tile in question is the first one
  BorderCone border{};   ///< of a near one
  [[nodiscard]] const Cone& own() const { return is_first ? first : second; }
  [[nodiscard]] const Cone& other() const { return is_first ? second : first; }
};

/// A point of W in plane coordinates and its height.
inline Vec3 to_plane(const Section& section, Vec3 p) {
  const Vec3 d = p - section.origin;
  return {dot(d, section.u), dot(d, section.v), dot(d, section.n) + section.h1};
}

/// A phalanx seen from one of its joints; the ends in W.
inline Cone cone_from(const Section& section, Vec3 joint, Vec3 end, double radius, double end_radius) {
  Cone cone;
  cone.joint = to_plane(section, joint);
  const Vec3 axis = end - joint;
  cone.length = norm(axis);
  cone.axis = unit_or({dot(axis, section.u), dot(axis, section.v), dot(axis, section.n)}, {1, 0, 0});
  cone.radius = radius;
  cone.drop = radius - end_radius;
  if (has_two_ends(cone.length, radius, end_radius)) {
    cone.sine = cone.drop / cone.length;
    cone.cosine = std::sqrt((1 - cone.sine) * (1 + cone.sine));
  } else {
    cone.kind = cone.drop >= 0 ? Cone::joint_only : Cone::far_only;
  }
  return cone;
}

/// `phalanx` and the next one out, of which the tile in question is the first or the second.
inline Kin joint_kin(const Section& section, const Primitives& hand, std::size_t phalanx, bool is_first) {
  const Primitive &inner = hand.capsule[phalanx], &outer = hand.capsule[phalanx + 1];
  const JointBorder& border = hand.border[phalanx];
  Kin kin;
  kin.first = cone_from(section, inner.end2, inner.end1, inner.radius2, inner.radius1);
  kin.second = cone_from(section, outer.end1, outer.end2, outer.radius1, outer.radius2);
  kin.near = border.near;
  kin.is_first = is_first;
  const Vec3 centre = to_plane(section, border.centre);
  const auto linear = [&](Vec3 w) {
    const Vec3 d{dot(w, section.u), dot(w, section.v), dot(w, section.n)};
    return Linear{-dot(d, centre), {d.x, d.y}};
  };
  kin.border = {border.side, linear(border.x), linear(border.y), linear(border.normal)};
  return kin;
}

/// Changes by no more than this per metre.
inline constexpr double kPrecedenceSlope = 3;

/// Positive where p belongs to the tile in question, negative where to its kin. [m]
inline double precedence(const Kin& kin, Point2 p) {
  if (kin.near) {
    const BorderCone& cone = kin.border;
    const double x = cone.x.at(p), y = cone.y.at(p);
    const double lead = cone.side * std::sqrt(x * x + y * y) - cone.height.at(p);
    return kin.is_first ? lead : -lead;
  }
  const Sight first = sight_of(kin.first, p), second = sight_of(kin.second, p);
  double lead = kin.joined ? lead_of(kin.first, first) - lead_of(kin.second, second)
                           : cone_field(kin.first, first) - cone_field(kin.second, second);
  // Two tiles in one place: not rounding decides, the first one has it.
  if (std::fabs(lead) < 1e-14 * kin.first.radius) lead = 1e-300;
  return kin.is_first ? lead : -lead;
}

}  // namespace lumbrical
