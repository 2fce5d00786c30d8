#include "borders/joint_border.h"

#include <cmath>

#include "index/triangle_bound.h"
#include "section/section.h"

namespace lumbrical {
namespace {

// Sine of half the difference of two slopes below which the border is the plane to rounding.
constexpr double kSameSlope = 1e-14;

// Sine of an angle so small that the bounds below, which divide by it, say nothing any more.
constexpr double kFlatAngle = 0.05;

// The same for slopes that differ almost as much as the axes: the cone is too narrow to follow as such.
constexpr double kSteepest = 0.85;

// A phalanx seen from the joint it shares.
struct Side {
  Vec3 axis;          // unit, away from the joint
  double length;      // [m]
  double far_radius;  // [m]
  double sine = 0, cosine = 1;
  bool is_hull = false;  // of both its spheres, so that sine and cosine of its slope are known
  Side(Vec3 away, const Primitive& phalanx, double radius, double other_radius)
      : axis(away), length(norm(phalanx.end2 - phalanx.end1)), far_radius(other_radius) {
    const double drop = radius - other_radius;
    is_hull = length > std::fabs(drop);
    if (!is_hull) return;
    sine = drop / length;
    cosine = std::sqrt((1 - sine) * (1 + sine));
  }
};

// The quadric cone of two near tiles. Two angles whose sum is constant mark a convex cone of directions.
void set_cone(const Side& before, const Side& after, JointBorder& border) {
  const Vec3 apart = after.axis - before.axis, middle = before.axis + after.axis, z = border.normal;
  const Vec3 some = std::fabs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  Vec3 x = unit_or(middle - dot(middle, z) * z, {});
  if (!(dot(middle, middle) > 1e-20)) x = unit_or(cross(z, some), {});  // a straight joint: round about z
  const double sine = after.sine * before.cosine - after.cosine * before.sine,
               cosine = after.cosine * before.cosine + after.sine * before.sine;
  const double tangent = sine / (1 + cosine), square = tangent * tangent / (1 + tangent * tangent);
  const double gap = max(1e-300, 0.25 * dot(apart, apart) - square);
  border.x = tangent * x;
  border.y = std::sqrt(square / gap) * cross(z, x);
  border.side = tangent < 0 ? -1 : 1;
}

// Of the joint beyond `phalanx`. Lengths follow from the spherical hyperbola theta_i - theta_j = delta: with
// beta the angle between the two axes and Z the height over the bisecting plane,
//   |Z| <= D sin(delta / 2) / sin(beta / 2),  theta_i + sigma_i >= (beta + sigma_i + sigma_j) / 2.
JointBorder border_of(const Primitives& hand, std::size_t phalanx) {
  const Primitive &inner = hand.capsule[phalanx], &outer = hand.capsule[phalanx + 1];
  const double r = inner.radius2;
  const Side before(-hand.direction[phalanx], inner, r, inner.radius1),
      after(hand.direction[phalanx + 1], outer, r, outer.radius2);
  const auto& [axis1, length1, far1, sine1, cosine1, is_hull1] = before;
  const auto& [axis2, length2, far2, sine2, cosine2, is_hull2] = after;
  JointBorder border;
  border.centre = inner.end2;
  border.normal = half_way(-axis1, axis2);
  border.shared = true;
  // Whatever the border may be, it lies inside both tiles.
  border.reach = kReachMargin * max(r, max(length1 + far1, length2 + far2));
  border.slab = kReachMargin * max(r, max(far1, far2));
  if (!is_hull1 || !is_hull2) return border;
  const double half_sine = 0.5 * norm(axis1 - axis2), half_cosine = 0.5 * norm(axis1 + axis2);
  const double slope_sine =
      0.5 * std::sqrt((sine1 - sine2) * (sine1 - sine2) + (cosine1 - cosine2) * (cosine1 - cosine2));
  // Half the angle between the axes plus the mean slope: the border comes no nearer to the axes.
  const double size =
      std::sqrt((sine1 + sine2) * (sine1 + sine2) + (cosine1 + cosine2) * (cosine1 + cosine2));
  const double mean_sine = (sine1 + sine2) / size, mean_cosine = (cosine1 + cosine2) / size;
  const double nearest_sine = half_sine * mean_cosine + half_cosine * mean_sine;
  const double nearest_cosine = half_cosine * mean_cosine - half_sine * mean_sine;
  if (!(nearest_sine > kFlatAngle) || !(slope_sine < kSteepest * half_sine)) return border;
  border.near = kReachMargin * r * nearest_cosine < nearest_sine * min(cosine1 * length1, cosine2 * length2);
  if (!border.near) return border;
  if (slope_sine < kSameSlope) return {};
  set_cone(before, after, border);
  // Between plane and border the owner is no nearer to its axis than half the angle plus the smaller slope.
  const bool first = sine1 < sine2;
  const double least_sine = half_sine * (first ? cosine1 : cosine2) + half_cosine * (first ? sine1 : sine2);
  const double least_cosine = half_cosine * (first ? cosine1 : cosine2) - half_sine * (first ? sine1 : sine2);
  if (least_sine > kFlatAngle) {
    border.reach = min(border.reach, kReachMargin * (least_cosine > 0 ? r / least_sine : r));
    border.slab = min(border.slab, kReachMargin * border.reach * slope_sine / half_sine);
  }
  return border;
}

}  // namespace

Vec3 half_way(Vec3 here, Vec3 next) {
  constexpr double kFolded = 3.99;  // at 174 degrees; below, nothing cancels
  const Vec3 sum = here + next, apart = here - next;
  const double square = dot(apart, apart);
  if (!(square > kFolded)) return unit_or(sum, unit_or(here, {1, 0, 0}));
  const Vec3 across = sum - (dot(sum, apart) / square) * apart;
  const Vec3 some = std::fabs(here.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return unit_or(norm(across) > 1e-14 ? across : cross(here, some), {1, 0, 0});
}

namespace {

bool reaches(const Primitive& capsule, const Corners& at) {
  const Sphere bound = sphere_round(at, {});
  return segment_distance(Segment{capsule.end1, capsule.end2}, Segment{bound.centre, bound.centre}) <=
         kReachMargin * (max(capsule.radius1, capsule.radius2) + bound.radius);
}

// Of what a finger's tiles share out.
bool takes_part(const Primitives& hand, std::size_t phalanx) {
  return hand.present[phalanx] && hand.capsule[phalanx].law == Law::field;
}

}  // namespace

void set_joint_borders(Primitives& hand) {
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    hand.border[i] = {};
    if (i % 3 < 2 && takes_part(hand, i) && takes_part(hand, i + 1)) hand.border[i] = border_of(hand, i);
  }
}

void set_folded_fingers(Primitives& hand) {
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    const Primitive &first = hand.capsule[3 * finger], &last = hand.capsule[3 * finger + 2];
    hand.folded[finger] = takes_part(hand, 3 * finger) && takes_part(hand, 3 * finger + 2) &&
                          segment_distance(first, last) < kReachMargin * (max(first.radius1, first.radius2) +
                                                                          max(last.radius1, last.radius2));
  }
}

bool is_in_reach(const JointBorder& border, const Corners& at) {
  const auto& [a, b, c] = at;
  const Vec3 n = cross(b - a, c - a);
  const double height = dot(n, a - border.centre);
  if (height * height > border.reach * border.reach * dot(n, n)) return false;
  const Sphere bound = sphere_round(at, {});
  return norm(bound.centre - border.centre) <= border.reach + bound.radius;
}

bool meets_folded(const Primitives& hand, const Primitive& tile, const Corners& at) {
  const std::size_t i = tile.segment;
  return reaches(hand.capsule[i % 3 == 0 ? i + 2 : i - 2], at);
}

namespace {

// Has the tile anything in the triangle's plane between the two planes that hold the border?
bool reaches_between(const JointBorder& border, const Primitive& tile, const Corners& at) {
  Primitive between = tile;
  between.cut_count = 2;
  between.cut = {{{border.normal, border.centre + border.slab * border.normal},
                  {-border.normal, border.centre - border.slab * border.normal}}};
  Section section;
  return look_from_plane(between, at, section) && classify(section) != Overlap::none;
}

}  // namespace

TileBorders borders_on(const Primitives& hand, const Primitive& tile, const Corners& at) {
  if (tile.law != Law::field || tile.shape != Shape::round) return {};
  const std::size_t i = tile.segment;
  TileBorders borders = borders_in_reach(hand, tile, at);
  borders.inner = borders.inner && reaches_between(hand.border[i - 1], tile, at);
  borders.outer = borders.outer && reaches_between(hand.border[i], tile, at);
  return borders;
}

}  // namespace lumbrical
