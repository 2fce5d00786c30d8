#include "borders/border_pairs.h"

#include "exact/through_lanes.h"
#include "section/stated_errors.h"

namespace lumbrical {
namespace {

// On the border f = D cos(theta + sigma) and D sin(theta + sigma) are the same for both phalanges, seen from
// the joint (joint_border.h). So axial_i = cos(sigma_i) f + sin(sigma_i) D for both where f = 0, and axial_i
// sin(sigma_j) = axial_j sin(sigma_i).
Vec3 ring_of(const Primitives& hand, std::size_t phalanx) {
  const Primitive &inner = hand.capsule[phalanx], &outer = hand.capsule[phalanx + 1];
  const double drop1 = inner.radius2 - inner.radius1, drop2 = outer.radius1 - outer.radius2;
  const double length1 = norm(inner.end2 - inner.end1), length2 = norm(outer.end2 - outer.end1);
  return (drop1 / length1) * hand.direction[phalanx + 1] + (drop2 / length2) * hand.direction[phalanx];
}

void put_border(const Primitives& hand, std::size_t phalanx, const BorderWay& way, Vec3 origin, std::size_t k,
                BorderTerms& terms) {
  const JointBorder& border = hand.border[phalanx];
  put_vector(border.centre - origin, k, terms.joint);
  put_vector(border.x, k, terms.x);
  put_vector(border.y, k, terms.y);
  put_vector(border.side * border.normal, k, terms.z);
  terms.side[k] = way.outer ? -border.side : border.side;
  put_vector(ring_of(hand, phalanx), k, terms.ring);
  put_vector(way.from, k, terms.from);
  put_vector(way.to, k, terms.to);
}

// What was found in lane k, for a tile whose joint there is at `joint`.
void read_border(const BorderTerms& terms, std::size_t k, const Primitive& tile, Vec3 joint, BorderWay& way,
                 OwnCuts& own) {
  own.clear = own.clear && terms.status[k] != kBorderUnclear;
  const Vec3 across = vector_at(terms.across, k);
  way.from = vector_at(terms.start, k);
  way.to = vector_at(terms.end, k);
  own.cut[own_cut(tile, way.outer)] = {across, joint, dot(across, way.from)};
  if (terms.status[k] != kBorderInside) return;
  own.height[way.outer] = terms.height[k];
  own.bulge.area += terms.area[k];
  own.bulge.volume += terms.volume[k];
  own.bulge.area_first += vector_at(terms.area_first, k);
  own.bulge.first += vector_at(terms.first, k);
  const Vec3 chord = way.to - way.from;
  own.bulge.error += kBulgeInLanesError * dot(chord, chord) * max(tile.radius1, tile.radius2);
}

}  // namespace

void follow_borders(const PairSlots& pairs, std::span<const RoundHull> hulls, std::span<BorderWay> ways,
                    std::span<OwnCuts> own) {
  const Primitives& hand = pairs.hand;
  BorderTerms terms;
  const auto gather = [&](const BorderWay& way, std::size_t k, BorderTerms& to) {
    const std::uint32_t slot = own[way.own].slot;
    const RoundHull& hull = hulls[pairs.contact[slot].primitive];
    put_hull(hull, seen_from(hull.origin, pairs.corners(slot)), k, to);
    put_border(hand, joint_of(pairs.primitive(slot), way.outer), way, hull.origin, k, to);
  };
  const auto give = [&](BorderWay& way, std::size_t k, const BorderTerms& from) {
    const Primitive& tile = pairs.primitive(own[way.own].slot);
    read_border(from, k, tile, hand.border[joint_of(tile, way.outer)].centre, way, own[way.own]);
  };
  through_lanes(ways, terms, pairs.kernels.border_bulges, gather, give);

  // A bulge keeps to the tile's side of the other cut.
  for (const BorderWay& way : ways) {
    OwnCuts& cuts = own[way.own];
    const Primitive& tile = pairs.primitive(cuts.slot);
    if (tile.cut_count < 2 || !(cuts.height[way.outer] > 0)) continue;
    const Vec3 joint = hand.border[joint_of(tile, way.outer)].centre;
    cuts.clear = cuts.clear && keeps_to(cuts.cut[own_cut(tile, !way.outer)], joint, way.from, way.to,
                                        cuts.height[0] + cuts.height[1]);
  }
}

}  // namespace lumbrical
