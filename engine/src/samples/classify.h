// Which patches a body may meet, and in what way: decided by patch and body alone, whatever found them and
// whatever else their block holds. In doubt a patch is of the more general kind.
#pragma once

#include "samples/tile_field.h"

namespace lumbrical::LUMBRICAL_ISA {

/// A skeleton is near to patches within this many times their radius, and fields are smooth beyond that.
inline constexpr double kSkeletonReach = 1.25, kSmoothReach = 2.5;

/// Share of a radius by which single precision may move a distance here, generously.
inline constexpr double kDistanceSlack = 1e-5;

/// Centroids of a block's patches, relative to a body's origin [m].
template <class V>
inline Wide3<V> centroids_of(const PatchBlock& block, const SplitPoint& origin, std::size_t lane) {
  V at[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = (get(block.centroid[0][axis] + lane, V{}) - V(origin.high[axis])) +
               (get(block.centroid[1][axis] + lane, V{}) - V(origin.low[axis]));
  }
  return {at[0], at[1], at[2]};
}

inline void prefetch_block(const PatchBlock& block) {
  const char* const bytes = reinterpret_cast<const char*>(&block);
  for (std::size_t line = 0; line < sizeof(PatchBlock); line += 64) __builtin_prefetch(bytes + line);
}

/// Lists a block's patches by their keys, those of a key as one; keys below 0 are of nothing.
template <class V>
inline void list_patches(const float (&keys)[PatchBlock::kWidth], std::uint32_t block, FoundPatches* found,
                         std::size_t& count) {
  constexpr auto kCount = static_cast<unsigned>(wide::Lanes<V>::kCount);
  const auto bits_of = [&](const auto& is) {
    unsigned bits = 0;
    for (unsigned lane = 0; lane < PatchBlock::kWidth; lane += kCount)
      bits |= wide::bits_of(is(get(keys + lane, V{}))) << lane;
    return bits;
  };
  unsigned open = bits_of([](V key) { return key >= number<V>(0); });
  while (open != 0) {
    const float key = keys[__builtin_ctz(open)];
    const unsigned its = bits_of([&](V other) { return other == V(key); });
    found[count++] = {static_cast<std::uint16_t>(key), static_cast<std::uint16_t>(its), block};
    open &= ~its;
  }
}
/// What patches are to a body: their kind, negative if they are nothing to it, and whether its skeleton comes
/// near (1).
template <class V>
struct Kinds {
  V kind, is_near;
};
template <class V>
inline V key_of(const Kinds<V>& kinds, V size) {
  const V patch_class = size + number<V>(kPatchSizes) * kinds.is_near;
  return select(kinds.kind >= number<V>(0), patch_class * number<V>(kind::kCount) + kinds.kind,
                number<V>(-1));
}

/// What a tile has to do with patches: its field and place there, whether its skeleton comes near (1), and
/// the kind they are if they meet no other.
template <class V>
struct TileView {
  V field, place, is_near, kind;
};
template <class V>
inline TileView<V> view_tile(const TileFrame& frame, std::uint32_t k, Wide3<V> centre, V reach) {
  const TileNumbers<V> tile = numbers_of<V>(frame);
  const Wide3<V> p = turn_into(frame.axis, centre - in_all_lanes<V>(frame.origin));
  const TilePoint<V> point{p.x, p.y * p.y + p.z * p.z};
  const TileDepth<V> depth = tile_depth(tile, point);
  const V distance = depth.distance, field = depth.level - distance, place = place_on(tile, point);
  const V end = tile.cosine * tile.length, zero = number<V>(0);
  const auto is_near = distance < number<V>(kSkeletonReach) * reach;
  const auto id = [k](std::uint32_t part) { return number<V>(part + k); };
  V kind = id(kind::kTile);
  kind = select(place > reach && place + reach < end, id(kind::kSide), kind);
  kind = select(place + reach < zero, id(kind::kNearEnd), kind);
  kind = select(place - reach > end, id(kind::kFarEnd), kind);
  const auto inside = field > reach && distance >= number<V>(kSmoothReach) * reach;
  return {field, place, select(is_near, number<V>(1), zero), select(inside, id(kind::kInside), kind)};
}

template <class V>
inline V side_of_joint(const FingerBody& finger, std::size_t k, V inner_place, V outer_place) {
  return side_of_joint(numbers_of<V>(finger.joint[k]), numbers_of<V>(finger.tile[k]), inner_place,
                       numbers_of<V>(finger.tile[k + 1]), outer_place);
}

/// What the lanes from `lane` on have to do with a finger, -1: nothing; `tiles` are those the block's sphere
/// may reach.
template <class V>
inline Kinds<V> finger_kinds(const FingerBody& finger, Wide3<V> centre, V radius, V reach, unsigned tiles) {
  const V zero = number<V>(0), far = number<V>(-1e30);
  TileView<V> view[FingerBody::kMostTiles];
  for (std::size_t k = 0; k < FingerBody::kMostTiles; ++k) {
    view[k] = {far, zero, zero, zero};
    if ((tiles >> k & 1u) != 0)
      view[k] = view_tile(finger.tile[k], static_cast<std::uint32_t>(k), centre, reach);
    view[k].field = select(radius >= zero, view[k].field, far);
  }
  if ((tiles & (tiles - 1)) == 0) {  // one tile at most: the usual case
    const TileView<V>& alone = view[tiles >> 1];
    const auto meets = alone.field + reach > zero;
    return {select(meets, alone.kind, number<V>(-1)), select(meets, alone.is_near, zero)};
  }
  // Neighbours part where their places along their axes are the same.
  const V limit = reach + reach, below = zero - limit;
  V inner = zero, outer = zero;  // how much farther out than a joint the patch is, where both tiles meet it
  const auto meets = [&](std::size_t k) { return view[k].field + reach > zero; };
  if ((tiles & 3u) == 3u) {
    const V side = side_of_joint(finger, 0, view[0].place, view[1].place);
    inner = select(meets(0) && meets(1), side, zero);
  }
  if ((tiles & 6u) == 6u) {
    const V side = side_of_joint(finger, 1, view[1].place, view[2].place);
    outer = select(meets(1) && meets(2), side, zero);
  }
  if (finger.folded && (tiles & 5u) == 5u) {  // its ends have a part wherever they meet the patch
    const auto ends = meets(0) && meets(2);
    inner = select(ends, zero, inner);
    outer = select(ends, zero, outer);
  }
  const auto first = meets(0) && inner <= limit;
  const auto middle = meets(1) && inner >= below && outer <= limit;
  const auto last = meets(2) && inner >= below && outer >= below;
  V kind = select(first, view[0].kind, number<V>(-1));
  kind = select(middle, view[1].kind, kind);
  kind = select(last, view[2].kind, kind);
  kind = select(first && middle, number<V>(kind::kInnerJoint), kind);
  kind = select(middle && last, number<V>(kind::kOuterJoint), kind);
  kind = select(first && last, number<V>(kind::kFinger), kind);
  const V is_near = max(select(first, view[0].is_near, zero),
                        max(select(middle, view[1].is_near, zero), select(last, view[2].is_near, zero)));
  return {kind, is_near};
}

inline float largest_radius(const FingerBody& finger) {
  float largest = 0;
  for (std::size_t k = 0; k < finger.tile_count; ++k)
    if (finger.tile[k].radius > largest) largest = finger.tile[k].radius;
  return largest;
}

template <class V>
std::size_t classify_finger(const PatchBlock* blocks, const FingerBody& finger, const std::uint32_t* found,
                            std::size_t block_count, FoundPatches* patches) {
  constexpr std::size_t kAhead = 3;
  const SplitPoint origin = split_point(finger.origin);
  const float largest = largest_radius(finger);
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    if (i + kAhead < block_count) prefetch_block(blocks[found[i + kAhead] >> 3]);
    const std::uint32_t place = found[i] >> 3;
    const PatchBlock& block = blocks[place];
    alignas(64) float keys[PatchBlock::kWidth];
    for (unsigned lane = 0; lane < PatchBlock::kWidth;
         lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
      const V radius = get(block.radius + lane, V{});
      const V reach = radius + number<V>(kDistanceSlack) * (V(largest) + radius);
      const Kinds<V> kinds =
          finger_kinds(finger, centroids_of<V>(block, origin, lane), radius, reach, found[i] & 7u);
      put(keys + lane, key_of(kinds, get(block.size + lane, V{})));
    }
    list_patches<V>(keys, place, patches, count);
  }
  return count;
}

/// Is one edge of the palm's polygon nearer to all of spheres than the others are? `out`: how far beyond the
/// farthest edge their centres are.
template <class V>
inline auto is_at_one_edge(const PalmBody& palm, Wide3<V> centre, V reach, V out) {
  const V zero = number<V>(0);
  V next = number<V>(-1e30), within = number<V>(1e30);  // beyond the others; from the ends of the farthest
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    const V x = centre.x - V(palm.x[k]), y = centre.y - V(palm.y[k]);
    const V beside = V(palm.out_x[k]) * x + V(palm.out_y[k]) * y;
    const V along = V(palm.out_x[k]) * y - V(palm.out_y[k]) * x;
    const auto is_farthest = beside == out;
    next = select(is_farthest, next, max(next, beside));
    within = select(is_farthest, min(within, min(along, V(palm.length[k]) - along)), within);
  }
  return within > reach && (out > reach || next + reach < zero);
}

/// What spheres have to do with the palm: nothing; above the polygon kPalmSide or kPalmThrough, or kPalmBlock
/// inside the skin; by one edge and no other kPalmEdge; else kPalm.
template <class V>
inline Kinds<V> palm_kinds(const PalmBody& palm, Wide3<V> centre, V radius) {
  const V zero = number<V>(0), one = number<V>(1);
  const Wide3<V> p = turn_into(palm.axis, centre);
  const V reach = radius + number<V>(kDistanceSlack) * (V(palm.radius) + radius);
  V out = number<V>(-1e30);
  for (std::size_t k = 0; k < palm.corner_count; ++k)
    out = max(out, V(palm.out_x[k]) * (p.x - V(palm.x[k])) + V(palm.out_y[k]) * (p.y - V(palm.y[k])));
  const V height = abs(p.z), aside = max(out, zero), limit = V(palm.radius) + reach,
          near = number<V>(kSkeletonReach) * reach, square = aside * aside + height * height;
  V above = select(height + reach < V(palm.radius), number<V>(kind::kPalmBlock), number<V>(kind::kPalmSide));
  above = select(height > reach, above, number<V>(kind::kPalmThrough));
  const auto is_above = out + reach < zero, is_palm = radius >= zero && square <= limit * limit;
  V kind = select(is_above, above, number<V>(kind::kPalm));
  if (any(is_palm && !is_above))
    kind = select(!is_above && is_at_one_edge(palm, p, reach, out), number<V>(kind::kPalmEdge), kind);
  return {select(is_palm, kind, zero - one), select(square < near * near && out + reach >= zero, one, zero)};
}

template <class V>
std::size_t classify_palm(const PatchBlock* blocks, const PalmBody& palm, const std::uint32_t* found,
                          std::size_t block_count, FoundPatches* patches) {
  constexpr std::size_t kAhead = 3;
  const SplitPoint origin = split_point(palm.origin);
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    if (i + kAhead < block_count) prefetch_block(blocks[found[i + kAhead]]);
    const PatchBlock& block = blocks[found[i]];
    alignas(64) float keys[PatchBlock::kWidth];
    for (unsigned lane = 0; lane < PatchBlock::kWidth;
         lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
      const V radius = get(block.radius + lane, V{});
      Kinds<V> kinds = palm_kinds(palm, centroids_of<V>(block, origin, lane), radius);
      kinds.kind = select(kinds.kind == number<V>(kind::kPalmBlock), number<V>(kind::kPalmSide), kinds.kind);
      put(keys + lane, key_of(kinds, get(block.size + lane, V{})));
    }
    list_patches<V>(keys, found[i], patches, count);
  }
  return count;
}

}  // namespace lumbrical::LUMBRICAL_ISA
