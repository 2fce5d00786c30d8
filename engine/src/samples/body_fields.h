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
