#include "borders/border_batch.h"

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

void add_lane(const Primitives& hand, std::size_t phalanx, bool outer, const BorderCrossing& crossing,
              const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c, BorderTerms& terms) {
  const JointBorder& border = hand.border[phalanx];
  const std::size_t k = terms.count++;
  put_pair(hull, a, b, c, k, terms);
  put_vector(border.centre - hull.origin, k, terms.joint);
  put_vector(border.x, k, terms.x);
  put_vector(border.y, k, terms.y);
  put_vector(border.side * border.normal, k, terms.z);
  terms.side[k] = outer ? -border.side : border.side;
  put_vector(ring_of(hand, phalanx), k, terms.ring);
  put_vector(crossing.from, k, terms.from);
  put_vector(crossing.to, k, terms.to);
}

void pad(BorderTerms& terms) {
  for (auto* vector : {&terms.axis, &terms.a, &terms.b, &terms.c, &terms.joint, &terms.x, &terms.y, &terms.z,
                       &terms.ring, &terms.from, &terms.to}) {
    fill_up_vector(*vector, terms.count);
  }
  for (double* row : {terms.length, terms.radius1, terms.radius2, terms.sine, terms.cosine, terms.side})
    fill_up(row, terms.count);
}

// Puts the chords in the place of the pair's cuts and adds up what lies beyond them. False where a border is
// not for the lanes or a bulge meets the other cut.
bool set_cuts(const Primitives& hand, const Primitive& tile, const BorderTerms& terms, BorderPair& pair) {
  std::array<double, 2> height{};
  for (const bool outer : {false, true}) {
    if (pair.lane[outer] < 0) continue;
    const auto k = static_cast<std::size_t>(pair.lane[outer]);
    if (terms.status[k] == kBorderUnclear) return false;
    const Vec3 across = vector_at(terms.across, k), joint = hand.border[joint_of(tile, outer)].centre;
    pair.cut[own_cut(tile, outer)] = {across, joint, dot(across, vector_at(terms.start, k))};
    if (terms.status[k] == kBorderOutside) continue;
    height[outer] = terms.height[k];
    pair.bulge.area += terms.area[k];
    pair.bulge.volume += terms.volume[k];
    pair.bulge.area_first += vector_at(terms.area_first, k);
    pair.bulge.first += vector_at(terms.first, k);
  }
  if (tile.cut_count < 2) return true;
  for (const bool outer : {false, true}) {
    if (!(height[outer] > 0)) continue;
    const auto k = static_cast<std::size_t>(pair.lane[outer]);
    if (!keeps_to(pair.cut[own_cut(tile, !outer)], hand.border[joint_of(tile, outer)].centre,
                  vector_at(terms.start, k), vector_at(terms.end, k), height[0] + height[1]))
      return false;
  }
  return true;
}

}  // namespace

void add_to_batch(const Primitives& hand, const Primitive& tile, const RoundHull& hull,
                  const TriangleCuts& cuts, Vec3 a, Vec3 b, Vec3 c, Contact& contact, BorderBatch& batch) {
  BorderPair& pair = batch.pairs.push_back({&contact, cuts.cut, {-1, -1}, false, {}});
  pair.bulge.base = hull.origin;
  for (const bool outer : {false, true}) {
    if (!cuts.crossing[outer].exists) continue;
    pair.lane[outer] = static_cast<int>(batch.terms.count);
    add_lane(hand, joint_of(tile, outer), outer, cuts.crossing[outer], hull, a, b, c, batch.terms);
  }
}

std::span<const BorderPair> finish_batch(const Primitives& hand, BorderBatch& batch) {
  if (batch.pairs.empty()) return {};
  pad(batch.terms);
  batch.kernels.border_bulges(batch.terms);
  for (BorderPair& pair : batch.pairs)
    pair.clear = set_cuts(hand, hand.primitive[pair.contact->primitive], batch.terms, pair);
  const std::span<const BorderPair> done(batch.pairs.begin(), batch.pairs.end());
  batch.pairs.clear();
  batch.terms.count = 0;
  return done;
}

}  // namespace lumbrical
