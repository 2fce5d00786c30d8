#include "samples/rivals.h"

#include "borders/joint_border.h"
#include "model/primitive.h"

namespace lumbrical {
namespace {

// Share of their radii by which parts may be apart.
constexpr double kApart = 0.1;

double reach_of(const Primitive& phalanx) {
  return (1 + 0.5 * kApart) * max(phalanx.radius1, phalanx.radius2);
}

bool meet(const Primitive& one, const Primitive& other) {
  const double reach = reach_of(one) + reach_of(other);
  const Vec3 apart = 0.5 * ((other.end1 - one.end1) + (other.end2 - one.end2));
  const double far = reach + 0.5 * (norm(one.end2 - one.end1) + norm(other.end2 - other.end1));
  return dot(apart, apart) <= far * far && segment_distance(one, other) <= reach;
}

// No plane along the palm's skin has all of the phalanx beyond it.
bool meet(const SweptPolygon& palm, const Primitive& phalanx) {
  const double reach = (1 + 0.5 * kApart) * palm.radius + reach_of(phalanx);
  const auto is_beyond = [&](Vec3 normal, Vec3 point) {
    return min(dot(normal, phalanx.end1 - point), dot(normal, phalanx.end2 - point)) > reach;
  };
  if (is_beyond(palm.normal, palm.corner[0]) || is_beyond(-palm.normal, palm.corner[0])) return false;
  for (int k = 0; k < palm.corner_count; ++k) {
    if (is_beyond(palm.outward[static_cast<std::size_t>(k)], palm.corner[static_cast<std::size_t>(k)]))
      return false;
  }
  return true;
}

// At least one of two has to be felt.
bool matter(const Bodies& bodies, std::size_t one, std::size_t other) {
  return is_felt(bodies, body_of(one)) || is_felt(bodies, body_of(other));
}

void add_pair(std::size_t one, std::size_t other, Rivals& rivals) {
  const std::uint64_t its = std::uint64_t{1} << one, others = std::uint64_t{1} << other;
  rivals.of[one] |= others;
  rivals.of[other] |= its;
  rivals.any |= its | others;
}

}  // namespace

Rivals all_rivals(const Bodies& bodies) {
  Rivals rivals;
  rivals.any = parts_of(bodies);
  for_numbers(rivals.any, [&](std::size_t part) {
    const std::size_t body = body_of(part);
    rivals.of[part] = rivals.any & ~(parts_of_body(rivals.any, body) << body * Bodies::kTilesApart);
  });
  return rivals;
}

Rivals find_rivals(const Primitives& hand, const Bodies& bodies) {
  Rivals rivals;
  const std::uint64_t palm = std::uint64_t{1} << palm_number(bodies), parts = parts_of(bodies),
                      tiles = parts & ~palm;
  const auto phalanx = [&](std::size_t number) -> const Primitive& {
    const FingerBody& finger = bodies.finger[body_of(number)];
    return hand.capsule[finger.segment[number % Bodies::kTilesApart]];
  };
  for_numbers(tiles, [&](std::size_t own) {
    const std::size_t of_palm = palm_number(bodies);
    if ((parts & palm) != 0 && matter(bodies, own, of_palm) && meet(hand.palm, phalanx(own)))
      add_pair(own, of_palm, rivals);
    const std::uint64_t inward = (std::uint64_t{1} << body_of(own) * Bodies::kTilesApart) - 1;
    for_numbers(tiles & inward, [&](std::size_t other) {
      if (matter(bodies, own, other) && meet(phalanx(own), phalanx(other))) add_pair(own, other, rivals);
    });
  });
  return rivals;
}

}  // namespace lumbrical
