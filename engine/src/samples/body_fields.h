// The fields of all bodies of a hand at the same points: which is the deepest there.
#pragma once

#include "samples/classify.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class V>
inline V field_at(const TileFrame& tile, Wide3<V> p) {
  return tile_field(numbers_of<V>(tile), tile_point(turn_into(tile.axis, p - in_all_lanes<V>(tile.origin))));
}
template <class V>
inline V field_at(const PalmBody& palm, Wide3<V> p) {
  return palm_field(palm, turn_into(palm.axis, p));
}

/// What ask(part's body or tile, points seen from its body's origin) tells of a part of the hand at points
/// `at`. `offset`: of the bodies' origins from where points are seen.
template <class V, class Ask>
LUMBRICAL_INLINE inline auto ask_part(const Bodies& bodies, std::size_t part, const BodyOffsets& offset,
                                      Wide3<V> at, const Ask& ask) {
  const Wide3<V> p = at - in_all_lanes<V>(offset[body_of(part)]);
  return part == palm_number(bodies) ? ask(bodies.palm, p) : ask(tile_at(bodies.finger.data(), part), p);
}
template <class V>
inline V field_at(const Bodies& bodies, std::size_t part, const BodyOffsets& offset, Wide3<V> at) {
  return ask_part(bodies, part, offset, at,
                  [](const auto& its, Wide3<V> p) LUMBRICAL_INLINE { return field_at(its, p); });
}

/// The fields of bodies at points `at`, of each by its parts in `parts`, and the two largest. `offset`: of
/// the bodies' origins from where points are seen.
template <class V>
struct BodyFields {
  V of[Bodies::kMostFingers + 1];
  V first = number<V>(kNowhere), second = number<V>(kNowhere);

  BodyFields(const Bodies& bodies, std::uint64_t parts, const BodyOffsets& offset, Wide3<V> at) {
    for (std::size_t i = 0; i <= bodies.finger_count; ++i) {
      of[i] = number<V>(kNowhere);
      const std::uint64_t own = parts_of_body(parts, i);
      if (own == 0) continue;
      const Wide3<V> p = at - in_all_lanes<V>(offset[i]);
      if (i == bodies.finger_count) {
        of[i] = field_at(bodies.palm, p);
      } else {
        for_numbers(own, [&](std::size_t k)
                             LUMBRICAL_INLINE { of[i] = max(of[i], field_at(bodies.finger[i].tile[k], p)); });
      }
      second = max(second, min(first, of[i]));
      first = max(first, of[i]);
    }
  }
  [[nodiscard]] V largest_of_others(std::size_t body) const {
    return select(of[body] < first, first, second);
  }
};

/// How far [m] points are from the nearest of the spheres' centres that sweep a part of the hand, and the way
/// from there, a unit vector, 0 at a centre: along it the part's field falls.
template <class V>
struct PartSlope {
  V distance;
  Wide3<V> away;
};
template <class V>
inline PartSlope<V> slope_at(const TileFrame& tile, Wide3<V> at) {
  const Wide3<V> from = at - in_all_lanes<V>(tile.origin), p = turn_into(tile.axis, from);
  const TileDepth<V> depth = tile_depth(numbers_of<V>(tile), tile_point(p));
  const V share = divide(number<V>(1), max(depth.distance, number<V>(1e-30)));
  return {select(depth.is_end, depth.distance, depth.distance * V(1 / tile.cosine2)),
          share * away_from(tile, depth, from, p)};
}
template <class V>
inline PartSlope<V> slope_at(const PalmBody& palm, Wide3<V> at) {
  const Wide3<V> p = turn_into(palm.axis, at);
  const V zero = number<V>(0);
  V out = number<V>(-1e30), square = number<V>(1e30), x = zero, y = zero;
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    const PalmEdge& edge = palm.edge[k];
    const FromEdge<V> from = from_edge(edge, p);
    const auto is_nearer = from.square < square;
    x = select(is_nearer, from.beside * V(edge.out_x) - from.past * V(edge.out_y), x);
    y = select(is_nearer, from.beside * V(edge.out_y) + from.past * V(edge.out_x), y);
    square = min(square, from.square);
    out = max(out, from.beside);
  }
  x = select(out > zero, x, zero);
  y = select(out > zero, y, zero);
  const V distance = sqrt(p.z * p.z + (x * x + y * y)),
          share = divide(number<V>(1), max(distance, number<V>(1e-30)));
  return {distance, share * (x * in_all_lanes<V>(palm.axis[0]) +
                             (y * in_all_lanes<V>(palm.axis[1]) + p.z * in_all_lanes<V>(palm.axis[2])))};
}
template <class V>
inline PartSlope<V> slope_at(const Bodies& bodies, std::size_t part, const BodyOffsets& offset, Wide3<V> at) {
  return ask_part(bodies, part, offset, at, [](const auto& its, Wide3<V> p) { return slope_at(its, p); });
}

/// Of a block's patches those of which each body is felt nothing, since another is deeper throughout: a bit
/// per lane.
template <class V>
void outdone_lanes(const PatchBlock& block, const Bodies& bodies, std::uint64_t parts,
                   const BodyOffsets& offset, const SplitPoint& origin, std::uint16_t* outdone) {
  for (std::size_t i = 0; i <= bodies.finger_count; ++i) outdone[i] = 0;
  for (unsigned lane = 0; lane < PatchBlock::kWidth; lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
    const Discs<V> discs = discs_of<V>(block, origin, offset.largest, lane);
    const BodyFields<V> fields(bodies, parts, offset, discs.centre);
    const V twice = discs.reach + discs.reach;
    for (std::size_t i = 0; i <= bodies.finger_count; ++i) {
      const unsigned lanes = wide::bits_of(fields.of[i] + twice < fields.largest_of_others(i));
      outdone[i] = static_cast<std::uint16_t>(outdone[i] | lanes << lane);
    }
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
