#include "samples/limbs.h"

#include <cmath>

#include "base/set_bits.h"
#include "index/patches.h"

namespace lumbrical {
namespace {

// By this share of their size, and by that of where they are, things are nearer than they seem.
constexpr double kSlack = kDistanceSlack + 1e-6, kRounding = 1e-15;

constexpr double kFarAway = 1e300;  // [m]

}  // namespace

HandPlace place_of(const Primitives& hand) {
  HandPlace place;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (!hand.present[i]) continue;
    const Primitive& capsule = hand.capsule[i];
    place.phalanx[place.phalanx_count++] = {capsule.end1, capsule.end2,
                                            max(capsule.radius1, capsule.radius2)};
  }
  place.palm = hand.palm;
  return place;
}

bool is_within(double reach, const HandPlace& was, const HandPlace& hand) {
  if (hand.phalanx_count != was.phalanx_count || hand.palm.corner_count != was.palm.corner_count)
    return false;
  const auto is_near = [reach](Vec3 a, Vec3 b) { return dot(a - b, a - b) <= reach * reach; };
  bool within = true;
  for (std::size_t i = 0; i < hand.phalanx_count; ++i) {
    const auto &a = hand.phalanx[i], &b = was.phalanx[i];
    within = within && a.radius == b.radius && is_near(a.end1, b.end1) && is_near(a.end2, b.end2);
  }
  for (std::size_t k = 0; k < hand.palm.corner_count; ++k)
    within = within && is_near(hand.palm.corner[k], was.palm.corner[k]);
  return within;
}

Limbs::Limbs(const HandPlace& hand, double spare) : count_(hand.phalanx_count), palm_(hand.palm) {
  double largest = palm_.radius;
  for (std::size_t i = 0; i < count_; ++i) largest = max(largest, hand.phalanx[i].radius);
  const double more = spare + kSlack * (largest + spare);
  for (std::size_t i = 0; i < count_; ++i) {
    const auto& [end1, end2, radius] = hand.phalanx[i];
    const Vec3 axis = end2 - end1;
    const double square = dot(axis, axis), reach = radius + more;
    segment_[i] = {end1, axis, square > 0 ? 1 / square : 0, reach};
    box_.add(end1, reach);
    box_.add(end2, reach);
  }
  palm_reach_ = palm_.radius + more;
  for (std::size_t k = 0; k < palm_.corner_count; ++k) box_.add(palm_.corner[k], palm_reach_);
  ball_.centre = box_.middle();
  ball_.radius = norm(box_.upper - ball_.centre);
}

std::uint32_t Limbs::near_plane(const Corners& at) const {
  const Vec3 across = cross(at.b - at.a, at.c - at.a), normal = across / norm(across);
  const double slack = kRounding * (largest_of(at.a) + largest_of(ball_.centre));
  const auto height = [&](Vec3 p) { return dot(normal, p - at.a); };
  std::uint32_t near = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const double at_end = height(segment_[i].end), beyond = at_end + dot(normal, segment_[i].axis),
                 reach = segment_[i].reach + slack;
    near |= std::uint32_t{min(at_end, beyond) <= reach && max(at_end, beyond) >= -reach} << i;
  }
  double lowest = kFarAway, highest = -kFarAway;
  for (std::size_t k = 0; k < palm_.corner_count; ++k) {
    const double at_corner = height(palm_.corner[k]);
    lowest = min(lowest, at_corner);
    highest = max(highest, at_corner);
  }
  const double reach = palm_reach_ + slack;
  return near | std::uint32_t{lowest <= reach && highest >= -reach} << count_;
}

std::uint32_t Limbs::near(const Sphere& sphere, std::uint32_t limbs) const {
  const double within = (1 + kSlack) * sphere.radius + kRounding * largest_of(sphere.centre);
  const Vec3 gap = sphere.centre - ball_.centre;
  const double reach = ball_.radius + within;
  if (dot(gap, gap) > reach * reach) return 0;
  if (sphere.radius > ball_.radius) return limbs;
  const auto meets_segment = [&](const Segment& segment) {
    const Vec3 from = sphere.centre - segment.end;
    const Vec3 apart = from - clamp(dot(from, segment.axis) * segment.inverse, 0, 1) * segment.axis;
    return dot(apart, apart) <= (segment.reach + within) * (segment.reach + within);
  };
  std::uint32_t near = 0;
  for_numbers(limbs, [&](std::size_t i) {
    const bool meets = i < count_ ? meets_segment(segment_[i]) : meets_palm(sphere.centre, within);
    near |= std::uint32_t{meets} << i;
  });
  return near;
}

bool Limbs::meets_palm(Vec3 centre, double within) const {
  const double reach = palm_reach_ + within;
  bool meets = palm_.corner_count > 0 && std::fabs(dot(palm_.normal, centre - palm_.corner[0])) <= reach;
  for (std::size_t k = 0; meets && k < palm_.corner_count; ++k)
    meets = dot(palm_.outward[k], centre - palm_.corner[k]) <= reach;
  return meets;
}

}  // namespace lumbrical
