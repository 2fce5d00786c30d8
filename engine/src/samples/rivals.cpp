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

/// Rivals of the parts that are felt.
struct Pairs {
  const Bodies& bodies;
  Rivals rivals;

  void add(std::size_t one, std::size_t other) {
    const std::uint64_t its = std::uint64_t{1} << one, others = std::uint64_t{1} << other;
    if (is_felt(bodies, one)) rivals.of[one] |= others;
    if (is_felt(bodies, other)) rivals.of[other] |= its;
    if (is_felt(bodies, one) || is_felt(bodies, other)) rivals.any |= its | others;
  }
};

}  // namespace

Rivals find_rivals(const Primitives& hand, const Bodies& bodies, std::uint64_t parts) {
  Pairs pairs{bodies, {}};
  const std::size_t palm = palm_number(bodies);
  std::uint64_t tiles = 0;
  for (std::size_t i = 0; i < bodies.finger_count; ++i)
    tiles |= std::uint64_t{bodies.finger[i].tiles()} << i * Bodies::kTilesApart;
  tiles &= parts;
  const auto phalanx = [&](std::size_t number) -> const Primitive& {
    const FingerBody& finger = bodies.finger[number / Bodies::kTilesApart];
    return hand.capsule[finger.segment[number % Bodies::kTilesApart]];
  };
  const bool has_palm = bodies.palm.corner_count > 0 && (parts >> palm & 1u) != 0;
  for_numbers(tiles, [&](std::size_t own) {
    if (has_palm && meet(hand.palm, phalanx(own))) pairs.add(own, palm);
    const std::uint64_t inward = (std::uint64_t{1} << own / Bodies::kTilesApart * Bodies::kTilesApart) - 1;
    for_numbers(tiles & inward, [&](std::size_t other) {
      if (meet(phalanx(own), phalanx(other))) pairs.add(own, other);
    });
  });
  return pairs.rivals;
}

}  // namespace lumbrical
