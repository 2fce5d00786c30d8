#include "samples/rivals.h"

#include "borders/joint_border.h"
#include "model/primitive.h"

namespace lumbrical {
namespace {

// Share of their radii by which parts may be apart.
constexpr double kRivalGap = 0.1;

/// A phalanx, and how far from its axis others are near [m].
struct Rival {
  const Primitive& phalanx;
  double length, reach;

  Rival(const Primitives& hand, const Bodies& bodies, std::size_t part)
      : phalanx(hand.capsule[segment_of(bodies, part)]),
        length(tile_at(bodies.finger.data(), part).length),
        reach((1 + 0.5 * kRivalGap) * max(phalanx.radius1, phalanx.radius2)) {}
};

bool meet(const Rival& one, const Rival& other) {
  const double reach = one.reach + other.reach, far = reach + 0.50001 * (one.length + other.length);
  const Vec3 apart =
      0.5 * ((other.phalanx.end1 - one.phalanx.end1) + (other.phalanx.end2 - one.phalanx.end2));
  return dot(apart, apart) <= far * far && segment_distance(one.phalanx, other.phalanx) <= reach;
}

// No plane along the palm's skin has all of the phalanx beyond it.
bool meet(const SweptPolygon& palm, const Rival& rival) {
  const double reach = (1 + 0.5 * kRivalGap) * palm.radius + rival.reach;
  const auto is_beyond = [&](Vec3 normal, Vec3 point) {
    return min(dot(normal, rival.phalanx.end1 - point), dot(normal, rival.phalanx.end2 - point)) > reach;
  };
  if (is_beyond(palm.normal, palm.corner[0]) || is_beyond(-palm.normal, palm.corner[0])) return false;
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    if (is_beyond(palm.outward[k], palm.corner[k])) return false;
  }
  return true;
}

}  // namespace

std::uint64_t Rivals::find(std::size_t part) const {
  const std::size_t palm = palm_number(bodies_);
  std::uint64_t rivals = 0;
  const auto add_those = [&](std::uint64_t others, const auto& meets) {
    for_numbers(others, [&](std::size_t other) { rivals |= std::uint64_t{meets(other)} << other; });
  };
  const auto rival = [&](std::size_t number) { return Rival(hand_, bodies_, number); };
  const std::uint64_t parts = parts_of(bodies_), tiles = parts & ~(std::uint64_t{1} << palm);
  if (part == palm) {
    add_those(tiles, [&](std::size_t tile) { return meet(hand_.palm, rival(tile)); });
  } else {
    const Rival own = rival(part);
    const std::uint64_t kin = parts_of_body(parts, body_of(part)) << body_of(part) * Bodies::kTilesApart;
    add_those(tiles & ~kin, [&](std::size_t tile) { return meet(own, rival(tile)); });
    add_those(parts & ~tiles, [&](std::size_t) { return meet(hand_.palm, own); });
  }
  return rivals;
}

}  // namespace lumbrical
