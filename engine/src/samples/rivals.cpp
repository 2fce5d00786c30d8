#include "samples/rivals.h"

#include "base/fixed_list.h"
#include "borders/joint_border.h"
#include "model/primitive.h"

namespace lumbrical {
namespace {

// Share of their radii by which parts may be apart.
constexpr double kApart = 0.1;

/// A phalanx, and a sphere about its axis.
struct Rival {
  std::size_t number;
  const Primitive* phalanx;
  Vec3 middle;
  double half, reach;  // [m] of its axis; and from that to where others are near

  Rival(std::size_t its_number, const Primitive& its)
      : number(its_number),
        phalanx(&its),
        middle(0.5 * (its.end1 + its.end2)),
        half(0.5 * norm(its.end2 - its.end1)),
        reach((1 + 0.5 * kApart) * max(its.radius1, its.radius2)) {}
};

bool meet(const Rival& one, const Rival& other) {
  const double reach = one.reach + other.reach, far = reach + one.half + other.half;
  const Vec3 apart = other.middle - one.middle;
  return dot(apart, apart) <= far * far && segment_distance(*one.phalanx, *other.phalanx) <= reach;
}

// No plane along the palm's skin has all of the phalanx beyond it.
bool meet(const SweptPolygon& palm, const Rival& rival) {
  const double reach = (1 + 0.5 * kApart) * palm.radius + rival.reach;
  const auto is_beyond = [&](Vec3 normal, Vec3 point) {
    return min(dot(normal, rival.phalanx->end1 - point), dot(normal, rival.phalanx->end2 - point)) > reach;
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
  const std::size_t palm = palm_number(bodies);
  const bool has_palm = bodies.palm.corner_count > 0;
  FixedList<Rival, Bodies::kMostParts> before;
  for_numbers(parts_of(bodies) & ((std::uint64_t{1} << palm) - 1), [&](std::size_t number) {
    const FingerBody& finger = bodies.finger[body_of(number)];
    const Rival own(number, hand.capsule[finger.segment[number % Bodies::kTilesApart]]);
    if (has_palm && matter(bodies, number, palm) && meet(hand.palm, own)) add_pair(number, palm, rivals);
    for (const Rival& other : before) {
      if (body_of(other.number) != body_of(number) && matter(bodies, number, other.number) &&
          meet(own, other))
        add_pair(number, other.number, rivals);
    }
    before.push_back(own);
  });
  return rivals;
}

}  // namespace lumbrical
