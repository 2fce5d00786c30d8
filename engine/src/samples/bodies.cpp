#include "samples/bodies.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/set_bits.h"
#include "model/primitive.h"

namespace lumbrical {
namespace {

// Two unit vectors across a third and each other, without a root: T. Duff et al., "Building an orthonormal
// basis, revisited", 2017.
std::array<Vec3, 2> across(Vec3 axis) {
  const double sign = axis.z < 0 ? -1 : 1, a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
  return {Vec3{1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x},
          Vec3{b, sign + axis.y * axis.y * a, -axis.y}};
}

// The phalanx from its larger sphere; true where that is the outer one. One that lies inside the other's
// sphere, or has no length, is that sphere. `direction` is its axis, a unit vector or 0.
bool set_tile(const Primitive& phalanx, Vec3 direction, Vec3 origin, TileFrame& tile) {
  Vec3 from = phalanx.end1, to = phalanx.end2,
       axis = dot(direction, direction) > 0 ? direction : Vec3{1, 0, 0};
  double radius = phalanx.radius1, end_radius = phalanx.radius2;
  const bool turned = end_radius > radius;
  if (turned) {
    std::swap(from, to);
    std::swap(radius, end_radius);
    axis = -axis;
  }
  double length = dot(to - from, axis);
  if (!(length > radius - end_radius)) {
    length = 0;
    end_radius = radius;
  }
  const auto [side, other_side] = across(axis);
  const double sine = length > 0 ? (radius - end_radius) / length : 0, cosine2 = (1 - sine) * (1 + sine);
  put(from - origin, tile.origin);
  put(axis, tile.axis[0]);
  put(side, tile.axis[1]);
  put(other_side, tile.axis[2]);
  tile.length = static_cast<float>(length);
  tile.radius = static_cast<float>(radius);
  tile.end_radius = static_cast<float>(end_radius);
  tile.sine = static_cast<float>(sine);
  tile.cosine = static_cast<float>(std::sqrt(cosine2));
  tile.tangent2 = static_cast<float>(sine * sine / cosine2);
  tile.cosine2 = static_cast<float>(cosine2);
  return turned;
}

// [m] How deep a point is in a phalanx, or a little less.
double depth_in(const Primitive& phalanx, Vec3 point) {
  const Vec3 axis = phalanx.end2 - phalanx.end1, from = point - phalanx.end1;
  const double square = dot(axis, axis),
               along = square > 0 ? std::clamp(dot(from, axis) / square, 0.0, 1.0) : 0.0;
  return phalanx.radius1 + along * (phalanx.radius2 - phalanx.radius1) - norm(from - along * axis);
}

// From 0 to 1: do places mislead at the joint between phalanges k - 1 and k? Of a cone without ends a point's
// place and field make a right triangle with its distance from the joint, place^2 + (joint radius - field)^2:
// of two cones the larger place has the larger field, unless that is above the joint's radius, or the point
// lies behind a phalanx's end.
double places_mislead(const Primitives& hand, std::size_t k) {
  const Primitive &inner = hand.capsule[k - 1], &outer = hand.capsule[k];
  const double joint_radius = inner.radius2;
  const Vec3 apart = outer.end2 - inner.end1;
  const double into = std::max(depth_in(inner, outer.end2) + outer.radius2,
                               depth_in(outer, inner.end1) + inner.radius1),
               behind = std::max(outer.radius2 - dot(apart, hand.direction[k - 1]),
                                 inner.radius1 - dot(apart, hand.direction[k])),
               misled = std::max(std::min(into, behind), into - 2 * joint_radius);
  constexpr double kMargin = 0.25;  // of the joint's radius
  return std::clamp(1 + misled / (kMargin * joint_radius), 0.0, 1.0);
}

bool is_short(const TileFrame& tile) { return tile.cosine * tile.length < tile.radius; }

// Places tell as fields do, but where they mislead, which is near the joint where a tile is short.
float places_share(const TileFrame& inner, const TileFrame& outer, double misled) {
  constexpr float kLeast = 1.0f / 16;  // fields are the same round the joint's sphere
  if (inner.length == 0 || outer.length == 0) return 0;
  if (is_short(inner) || is_short(outer)) return kLeast;
  return 1 - static_cast<float>(misled) * (1 - kLeast);
}

JointSides sides_of(const TileFrame& inner, bool inner_turned, const TileFrame& outer, bool outer_turned,
                    float by_place) {
  return {inner_turned ? by_place : -by_place, inner_turned ? 0.0f : inner.length,
          outer_turned ? -by_place : by_place, outer_turned ? outer.length : 0.0f, 1 - by_place};
}

// Phalanges `first` .. `last`, each beside the next.
void set_finger(const Primitives& hand, std::size_t first, std::size_t last, const PatchRules& rules,
                FingerBody& finger) {
  finger.tile_count = last - first + 1;
  finger.origin = hand.capsule[first + (last - first) / 2].end1;
  bool turned[FingerBody::kMostTiles];
  for (std::size_t k = 0; k < finger.tile_count; ++k) {
    finger.segment[k] = static_cast<std::uint8_t>(first + k);
    finger.block_size[k] = static_cast<float>(rules.block_size[first + k]);
    finger.steps[k] = rules.steps[first + k].data();
    turned[k] = set_tile(hand.capsule[first + k], hand.direction[first + k], finger.origin, finger.tile[k]);
    if (k == 0) continue;
    const TileFrame &inner = finger.tile[k - 1], &outer = finger.tile[k];
    const float by_place = places_share(inner, outer, places_mislead(hand, first + k));
    finger.joint[k - 1] = sides_of(inner, turned[k - 1], outer, turned[k], by_place);
  }
}

void set_palm(const SweptPolygon& polygon, const PatchRules& rules, PalmBody& palm) {
  palm.corner_count = polygon.corner_count;
  if (palm.corner_count == 0) return;
  Vec3 middle;
  for (std::size_t k = 0; k < palm.corner_count; ++k)
    middle += polygon.corner[k] / static_cast<double>(palm.corner_count);
  palm.origin = middle;
  const Vec3 z = polygon.normal, y = polygon.outward[0], x = cross(y, z);
  put(x, palm.axis[0]);
  put(y, palm.axis[1]);
  put(z, palm.axis[2]);
  palm.steps = rules.steps[kPalmSegment].data();
  palm.radius = static_cast<float>(polygon.radius);
  palm.block_size[0] = static_cast<float>(rules.block_above_palm);
  palm.block_size[1] = static_cast<float>(rules.block_size[kPalmSegment]);
  static_assert(PalmBody::kMostCorners >= SweptPolygon::kMostCorners);
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    const Vec3 from = polygon.corner[k] - middle,
               edge = polygon.corner[(k + 1) % palm.corner_count] - polygon.corner[k];
    palm.edge[k] = {static_cast<float>(dot(x, from)), static_cast<float>(dot(y, from)),
                    static_cast<float>(dot(x, polygon.outward[k])),
                    static_cast<float>(dot(y, polygon.outward[k])), static_cast<float>(norm(edge))};
  }
}

}  // namespace

std::uint64_t parts_of(const Bodies& bodies) {
  std::uint64_t parts = std::uint64_t{bodies.palm.corner_count > 0} << palm_number(bodies);
  for (std::size_t i = 0; i < bodies.finger_count; ++i)
    parts |= std::uint64_t{bodies.finger[i].tiles()} << i * Bodies::kTilesApart;
  return parts;
}

BodyOffsets offsets_from(Vec3 point, const Bodies& bodies) {
  BodyOffsets offsets;
  offsets.largest = bodies.palm.corner_count > 0 ? bodies.palm.radius : 0;
  for (std::size_t i = 0; i < bodies.finger_count; ++i) {
    const FingerBody& finger = bodies.finger[i];
    put(finger.origin - point, offsets.of[i]);
    offsets.largest = std::max(offsets.largest, largest_radius(finger));
  }
  put(bodies.palm.origin - point, offsets.of[bodies.finger_count]);
  return offsets;
}

void take_blocks_on_skin(double radius, Bodies& bodies) {
  const auto size = static_cast<float>(radius);
  for (std::size_t i = 0; i < bodies.finger_count; ++i) bodies.finger[i].block_on_skin = size;
  bodies.palm.block_on_skin = size;
}

void set_bodies(const Primitives& hand, std::uint32_t segments, std::uint32_t felt, const PatchRules& rules,
                Bodies& bodies) {
  bodies.finger_count = 0;
  bodies.felt = 0;
  const auto takes_part = [&](std::size_t i) { return hand.present[i] && has_bit(segments, i); };
  for (std::size_t first = 0; first < kPhalanxCount;) {
    std::size_t last = first;
    while (last % 3 < 2 && takes_part(last) && takes_part(last + 1)) ++last;
    if (takes_part(first)) {
      FingerBody& finger = bodies.finger[bodies.finger_count];
      set_finger(hand, first, last, rules, finger);
      bodies.felt |= (felt >> first & 1u) << bodies.finger_count;
      bodies.origin[bodies.finger_count++] = split_point(finger.origin);
    }
    first = last + 1;
  }
  bodies.palm.corner_count = 0;
  if (has_bit(segments, kPalmSegment) && hand.joints.has(kPalm)) set_palm(hand.palm, rules, bodies.palm);
  bodies.felt |= (felt >> kPalmSegment & 1u) << bodies.finger_count;
  bodies.origin[bodies.finger_count] = split_point(bodies.palm.origin);
}

}  // namespace lumbrical
