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

void pair_up(std::size_t one, std::size_t other, Rivals& rivals) {
  rivals.of[one] |= std::uint64_t{1} << other;
  rivals.of[other] |= std::uint64_t{1} << one;
  rivals.any |= std::uint64_t{1} << one | std::uint64_t{1} << other;
}

}  // namespace

Rivals find_rivals(const Primitives& hand, const Bodies& bodies) {
  Rivals rivals;
  const bool has_palm = bodies.palm.corner_count > 0;
  for (std::size_t i = 0; i < bodies.finger_count; ++i) {
    const FingerBody& finger = bodies.finger[i];
    for (std::size_t k = 0; k < finger.tile_count; ++k) {
      const std::size_t number = i * Bodies::kTilesApart + k;
      const Primitive& own = hand.capsule[finger.segment[k]];
      if (has_palm && meet(hand.palm, own)) pair_up(number, palm_number(bodies), rivals);
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t of_other = 0; of_other < bodies.finger[j].tile_count; ++of_other) {
          if (meet(own, hand.capsule[bodies.finger[j].segment[of_other]]))
            pair_up(number, j * Bodies::kTilesApart + of_other, rivals);
        }
      }
    }
  }
  return rivals;
}

}  // namespace lumbrical
