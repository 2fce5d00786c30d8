// Which patches a body may meet, and in what way: decided by patch and body alone, whatever found them and
// whatever else their block holds. In doubt a patch is of the more general kind.
#pragma once

#include "samples/tile_field.h"

namespace lumbrical::LUMBRICAL_ISA {

/// Share of a radius by which single precision may move a distance here, generously.
inline constexpr double kDistanceSlack = 1e-5;

/// Centroids of a block's patches, relative to a body's origin [m].
template <class V>
inline Wide3<V> centroids_of(const PatchBlock& block, const SplitOrigin& origin, std::size_t lane) {
  V at[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const V corner = (get(block.corner[0][axis] + lane, V{}) - V(origin.high[axis])) +
                     (get(block.corner[1][axis] + lane, V{}) - V(origin.low[axis]));
    at[axis] = corner + (get(block.edge[0][axis] + lane, V{}) + get(block.edge[1][axis] + lane, V{})) *
                            number<V>(1.0 / 3);
  }
  return {at[0], at[1], at[2]};
}

inline void prefetch_block(const PatchBlock& block) {
  const char* const bytes = reinterpret_cast<const char*>(&block);
  for (std::size_t line = 0; line < sizeof(PatchBlock); line += 64) __builtin_prefetch(bytes + line);
}

/// Lists the patches of a block whose kind is not negative.
inline void put_kinds(const float* kinds, unsigned found, const PatchBlock& block, std::uint32_t first,
                      FoundPatch* patches, std::size_t& count) {
  for (; found != 0; found &= found - 1) {
    const auto lane = static_cast<std::uint32_t>(__builtin_ctz(found));
    patches[count++] = {block.size[lane] * kind::kCount + static_cast<std::uint32_t>(kinds[lane]),
                        first + lane};
  }
}

/// What a tile has to do with patches.
template <class V>
struct TileView {
  V field, place, kind;
};
template <class V>
inline TileView<V> view_tile(const TileFrame& tile, std::uint32_t k, Wide3<V> centre, V reach) {
  const auto [field, place] =
      tile_field_and_place(tile, turn_into(tile.axis, centre - in_all_lanes<V>(tile.origin)));
  const V end = V(tile.cosine * tile.length), zero = number<V>(0);
  const auto id = [k](std::uint32_t part) { return number<V>(part + k); };
  V kind = id(kind::kTile);
  kind = choose(both(place > reach, place + reach < end), id(kind::kSide), kind);
  kind = choose(place + reach < zero, id(kind::kNearEnd), kind);
  kind = choose(place - reach > end, id(kind::kFarEnd), kind);
  return {field, place, choose(field > reach, id(kind::kInside), kind)};
}

/// What the lanes from `lane` on have to do with a finger, -1: nothing; `tiles` are those the block's sphere
/// may reach.
template <class V>
inline V finger_kinds(const FingerBody& finger, Wide3<V> centre, V radius, V reach, V ramp, unsigned tiles) {
  const V zero = number<V>(0), far = number<V>(-1e30);
  TileView<V> view[FingerBody::kMostTiles];
  for (std::size_t k = 0; k < FingerBody::kMostTiles; ++k) {
    view[k] = {far, zero, zero};
    if ((tiles >> k & 1u) != 0)
      view[k] = view_tile(finger.tile[k], static_cast<std::uint32_t>(k), centre, reach);
    view[k].field = choose(radius >= zero, view[k].field, far);
  }
  // Neighbours part where their places along their axes are the same, with a ramp as wide as a cell.
  const V limit = reach + reach + ramp, below = zero - limit;
  V inner = zero, outer = zero;  // how much farther out than a joint the patch is, where both tiles meet it
  const auto meets = [&](std::size_t k) { return view[k].field + reach > zero; };
  if ((tiles & 3u) == 3u) {
    const V side =
        side_of_joint(finger.joint[0], finger.tile[0], view[0].place, finger.tile[1], view[1].place);
    inner = choose(both(meets(0), meets(1)), side, zero);
  }
  if ((tiles & 6u) == 6u) {
    const V side =
        side_of_joint(finger.joint[1], finger.tile[1], view[1].place, finger.tile[2], view[2].place);
    outer = choose(both(meets(1), meets(2)), side, zero);
  }
  if (finger.folded && (tiles & 5u) == 5u) {  // its ends have a part wherever they meet the patch
    const auto ends = both(meets(0), meets(2));
    inner = choose(ends, zero, inner);
    outer = choose(ends, zero, outer);
  }
  const auto first = both(meets(0), inner <= limit);
  const auto middle = both(meets(1), both(inner >= below, outer <= limit));
  const auto last = both(meets(2), both(inner >= below, outer >= below));
  V kind = choose(first, view[0].kind, number<V>(-1));
  kind = choose(middle, view[1].kind, kind);
  kind = choose(last, view[2].kind, kind);
  kind = choose(both(first, middle), number<V>(kind::kInnerJoint), kind);
  kind = choose(both(middle, last), number<V>(kind::kOuterJoint), kind);
  return choose(both(first, last), number<V>(kind::kFinger), kind);
}

inline float largest_radius(const FingerBody& finger) {
  float largest = 0;
  for (std::size_t k = 0; k < finger.tile_count; ++k)
    if (finger.tile[k].radius > largest) largest = finger.tile[k].radius;
  return largest;
}

template <class V>
std::size_t classify_finger(const PatchBlock* blocks, const FingerBody& finger, const std::uint32_t* found,
                            std::size_t block_count, FoundPatch* patches) {
  constexpr std::size_t kAhead = 3;
  const SplitOrigin origin(finger.origin);
  const V zero = number<V>(0);
  const float largest = largest_radius(finger);
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    if (i + kAhead < block_count) prefetch_block(blocks[found[i + kAhead] >> 3]);
    const std::uint32_t place = found[i] >> 3;
    const PatchBlock& block = blocks[place];
    alignas(64) float kinds[PatchBlock::kWidth];
    unsigned some = 0;
    for (unsigned lane = 0; lane < PatchBlock::kWidth;
         lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
      const V radius = get(block.radius + lane, V{});
      const V reach = radius + number<V>(kDistanceSlack) * (V(largest) + radius);
      // The side of a square as large as two triangles is less than 1.62 of its triangle's radius.
      const V ramp = lesser(V(finger.widest_cell), number<V>(1.62) * reach);
      const V kind =
          finger_kinds(finger, centroids_of<V>(block, origin, lane), radius, reach, ramp, found[i] & 7u);
      put(kinds + lane, kind);
      some |= wide::bits_of(kind >= zero, zero) << lane;
    }
    put_kinds(kinds, some, block, place * PatchBlock::kWidth, patches, count);
  }
  return count;
}

/// What spheres have to do with the palm: -1 nothing, kPalm, kPalmSide on one side of the polygon, above it,
/// or kPalmBlock there and inside the skin.
template <class V>
inline V palm_kinds(const PalmBody& palm, Wide3<V> centre, V radius) {
  const V zero = number<V>(0);
  const Wide3<V> p = turn_into(palm.axis, centre);
  const V reach = radius + number<V>(kDistanceSlack) * (V(palm.radius) + radius);
  V out = number<V>(-1e30);
  for (std::size_t k = 0; k < palm.corner_count; ++k)
    out = greater(out, V(palm.out_x[k]) * (p.x - V(palm.x[k])) + V(palm.out_y[k]) * (p.y - V(palm.y[k])));
  const V height = magnitude(p.z), aside = greater(out, zero), limit = V(palm.radius) + reach;
  const V kind = choose(both(radius >= zero, aside * aside + height * height <= limit * limit),
                        number<V>(kind::kPalm), number<V>(-1));
  const auto above = both(kind >= zero, both(out + reach<zero, height> reach));
  return choose(
      above, choose(height + reach < V(palm.radius), number<V>(kind::kPalmBlock), number<V>(kind::kPalmSide)),
      kind);
}

template <class V>
std::size_t classify_palm(const PatchBlock* blocks, const PalmBody& palm, const std::uint32_t* found,
                          std::size_t block_count, FoundPatch* patches) {
  constexpr std::size_t kAhead = 3;
  const SplitOrigin origin(palm.origin);
  const V zero = number<V>(0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    if (i + kAhead < block_count) prefetch_block(blocks[found[i + kAhead]]);
    const PatchBlock& block = blocks[found[i]];
    alignas(64) float kinds[PatchBlock::kWidth];
    unsigned some = 0;
    for (unsigned lane = 0; lane < PatchBlock::kWidth;
         lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
      const V radius = get(block.radius + lane, V{});
      const V whole = palm_kinds(palm, centroids_of<V>(block, origin, lane), radius);
      const V kind = choose(whole == number<V>(kind::kPalmBlock), number<V>(kind::kPalmSide), whole);
      put(kinds + lane, kind);
      some |= wide::bits_of(kind >= zero, zero) << lane;
    }
    put_kinds(kinds, some, block, found[i] * PatchBlock::kWidth, patches, count);
  }
  return count;
}

}  // namespace lumbrical::LUMBRICAL_ISA
