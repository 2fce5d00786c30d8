// Which patches a body may meet, and in what way: decided by patch and body alone, whatever found them and
// whatever else their block holds. In doubt a patch is of the more general kind.
#pragma once

#include "base/prefetch.h"
#include "base/set_bits.h"
#include "samples/palm_kernels.h"
#include "samples/tile_field.h"

namespace lumbrical::LUMBRICAL_ISA {

/// A skeleton is near to patches within this many times their radius, and fields are smooth beyond that.
inline constexpr double kSkeletonReach = 1.25, kSmoothReach = 2.5;

/// Patches as discs about their centroids, relative to a body's origin.
template <class V>
struct Discs {
  Wide3<V> centre;  // [m]
  V radius, reach;  // [m], and by what rounding may take away more; radius negative: nothing
  Wide3<V> normal;  // twice n dA over radius^2
};
template <class V>
inline V reach_of(V radius, float largest) {
  return radius + number<V>(kDistanceSlack) * (V(largest) + radius);
}
/// `largest`: the body's radius.
template <class V>
inline Discs<V> discs_of(const PatchBlock& block, const SplitPoint& origin, float largest, std::size_t lane) {
  V at[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = (get(block.centroid[0][axis] + lane, V{}) - V(origin.high[axis])) +
               (get(block.centroid[1][axis] + lane, V{}) - V(origin.low[axis]));
  }
  const V radius = get(block.radius + lane, V{});
  return {{at[0], at[1], at[2]}, radius, reach_of(radius, largest), vector_at<V>(block.normal, lane)};
}

/// Are discs nowhere inside a concave field? It is nowhere above its tangent at their centres, where it is
/// `field` and falls by 1 a metre along `away`, a vector of that length.
template <class V>
LUMBRICAL_INLINE inline auto is_outside(const Discs<V>& discs, V field, V length, Wide3<V> away) {
  constexpr double kRoundedSine2 = 1e-6;  // what rounding may take away of the square of an angle's sine
  const V f = field + (discs.reach - discs.radius), along = dot(away, discs.normal),
          square = length * length * dot(discs.normal, discs.normal);
  const V across = square * number<V>(1 + kRoundedSine2) - along * along;
  return f < number<V>(0) && f * f * square > discs.reach * discs.reach * across;
}

/// Blocks of patches: boxes along their arms, and the spheres about them.
template <class V>
struct Boxes {
  Wide3<V> centre;  // [m]
  V radius, reach;  // as those of discs
  Wide3<V> arm[3];  // [m] times the extent
};
template <class V>
LUMBRICAL_INLINE inline auto is_outside(const Boxes<V>& boxes, V field, V length, Wide3<V> away) {
  V along = abs(dot(away, boxes.arm[0]));
  for (std::size_t k = 1; k < 3; ++k) along = along + abs(dot(away, boxes.arm[k]));
  return (field + (boxes.reach - boxes.radius)) * length + along < number<V>(0);
}

/// The keys of the patches of blocks; below 0 are those of nothing.
struct BlockKeys {
  alignas(64) float of[kBlocksAtATime][PatchBlock::kWidth];
};

/// Lists a block's patches by their keys, those of a key as one.
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
/// What patches are to a body: their kind, negative if they are nothing to it, whether its skeleton comes
/// near (1), and the field at their centroids.
template <class V>
struct Kinds {
  V kind, is_near, field;
};
/// Adds what the centroids of patches tell of the force.
template <class V>
inline void add_centroids(const Discs<V>& discs, const Kinds<V>& kinds, std::size_t lane,
                          CentroidForce& force) {
  const V zero = number<V>(0);
  const V depth = select(kinds.kind >= zero, max(kinds.field, zero), zero) * (discs.radius * discs.radius);
  put_vector(vector_at<V>(force.lane, lane) + depth * discs.normal, lane, force.lane);
}
template <class V>
inline V key_of(const Kinds<V>& kinds, V size) {
  const V patch_class = size + number<V>(kPatchSizes) * kinds.is_near;
  return select(kinds.kind >= number<V>(0), patch_class * number<V>(kind::kCount) + kinds.kind,
                number<V>(-1));
}

/// The way a tile's field falls at points, as long as their `distance`; `from` its frame's origin, and `p` in
/// that frame.
template <class V>
LUMBRICAL_INLINE inline Wide3<V> away_from(const TileFrame& frame, const TileDepth<V>& depth, Wide3<V> from,
                                           Wide3<V> p) {
  const V across = select(depth.is_end, number<V>(1), V(frame.cosine2)),
          along = select(depth.is_end, depth.axial, V(frame.sine) * depth.distance) - across * p.x;
  return across * from + along * in_all_lanes<V>(frame.axis[0]);
}

/// What a tile has to do with patches: its field at their centroids, kNowhere where it does not meet them,
/// and their place along it, whether its skeleton comes near (1), and the kind they are if they meet no
/// other.
template <class V>
struct TileView {
  V field, place, is_near, kind;
};
template <class V>
inline TileView<V> not_met() {
  return {number<V>(kNowhere), number<V>(0), number<V>(0), number<V>(0)};
}
template <class V, template <class> class Shape>
LUMBRICAL_INLINE inline TileView<V> view_tile(const TileFrame& frame, std::uint32_t k,
                                              const Shape<V>& discs) {
  const TileNumbers<V> tile = numbers_of<V>(frame);
  const Wide3<V> from = discs.centre - in_all_lanes<V>(frame.origin), p = turn_into(frame.axis, from);
  const TilePoint<V> point = tile_point(p);
  const TileDepth<V> depth = tile_depth(tile, point);
  const V distance = depth.distance, field = depth.level - distance, reach = discs.reach;
  const V zero = number<V>(0);
  if (!any(field + reach > zero)) return not_met<V>();
  const V place = place_on(tile, point), end = tile.cosine * tile.length;
  const auto meets =
      field + reach > zero && is_not(is_outside(discs, field, distance, away_from(frame, depth, from, p)));
  const auto is_near = distance < number<V>(kSkeletonReach) * reach;
  const auto id = [k](std::uint32_t part) { return number<V>(part + k); };
  V kind = id(kind::kTile);
  kind = select(place > reach && place + reach < end, id(kind::kSide), kind);
  kind = select(place + reach < zero, id(kind::kNearEnd), kind);
  kind = select(place - reach > end, id(kind::kFarEnd), kind);
  const auto inside = field > reach && distance >= number<V>(kSmoothReach) * reach;
  return {select(meets && discs.radius >= zero, field, number<V>(kNowhere)), place,
          select(is_near, number<V>(1), zero), select(inside, id(kind::kInside), kind)};
}

template <class V>
inline V side_of_joint(const FingerBody& finger, std::size_t k, const TileView<V>& inner,
                       const TileView<V>& outer) {
  return side_of_joint(numbers_of<V>(finger.joint[k]), numbers_of<V>(finger.tile[k]),
                       TileClaim<V>{inner.field, inner.place}, numbers_of<V>(finger.tile[k + 1]),
                       TileClaim<V>{outer.field, outer.place});
}

/// What discs have to do with one tile of a finger, and no other.
template <class V>
LUMBRICAL_INLINE inline Kinds<V> tile_kinds(const FingerBody& finger, const Discs<V>& discs,
                                            std::uint32_t k) {
  const TileView<V> view = view_tile(finger.tile[k], k, discs);
  const auto is_met = view.field > number<V>(kNowhere);
  return {select(is_met, view.kind, number<V>(-1)), view.is_near, view.field};
}

/// What the tiles of a finger have to do with discs, of those whose bit is set.
template <class V>
struct FingerView {
  TileView<V> tile[FingerBody::kMostTiles];
  [[nodiscard]] auto meets(std::size_t k) const { return tile[k].field > number<V>(kNowhere); }
};
template <class V, template <class> class Shape>
LUMBRICAL_INLINE inline FingerView<V> view_finger(const FingerBody& finger, const Shape<V>& discs,
                                                  unsigned tiles) {
  FingerView<V> view;
  for (std::size_t k = 0; k < FingerBody::kMostTiles; ++k) {
    view.tile[k] = not_met<V>();
    if (has_bit(tiles, k)) view.tile[k] = view_tile(finger.tile[k], static_cast<std::uint32_t>(k), discs);
  }
  return view;
}

/// What discs are to a finger that is seen so.
template <class V>
inline Kinds<V> shared_kinds(const FingerBody& finger, const FingerView<V>& seen, V reach, unsigned tiles) {
  const V zero = number<V>(0);
  const TileView<V>(&view)[FingerBody::kMostTiles] = seen.tile;
  const auto meets = [&](std::size_t k) { return seen.meets(k); };
  // Neighbours part where their places along their axes are the same, or their fields (JointSides).
  const V limit = reach + reach, below = zero - limit;
  V inner = zero, outer = zero;  // how much farther out than a joint the patch is, where both tiles meet it
  if ((tiles & 3u) == 3u) {
    const V side = side_of_joint(finger, 0, view[0], view[1]);
    inner = select(meets(0) && meets(1), side, zero);
  }
  if ((tiles & 6u) == 6u) {
    const V side = side_of_joint(finger, 1, view[1], view[2]);
    outer = select(meets(1) && meets(2), side, zero);
  }
  if ((tiles & 5u) == 5u) {  // the ends of a bent finger have a part wherever they meet the patch
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
  return {kind, is_near, max(view[0].field, max(view[1].field, view[2].field))};
}

/// What discs have to do with a finger; `tiles` are those that their block's sphere may reach.
template <class V>
LUMBRICAL_INLINE inline Kinds<V> finger_kinds(const FingerBody& finger, const Discs<V>& discs,
                                              unsigned tiles) {
  if ((tiles & (tiles - 1)) == 0) return tile_kinds(finger, discs, tiles >> 1);  // the usual case
  return shared_kinds(finger, view_finger(finger, discs, tiles), discs.reach, tiles);
}

/// Puts the patches of blocks that a body meets into `sink` and adds what their centroids feel to its force:
/// `kinds_of(discs, found)`, of blocks at `place(found)`. Keys come first and lists after, so that no branch
/// waits for a key to be computed.
template <class V, class Place, class KindsOf>
inline std::size_t classify(const PatchBlock* blocks, const SplitPoint& origin, float largest,
                            const std::uint32_t* found, std::size_t block_count, const Place& place,
                            const KindsOf& kinds_of, const FoundSink& sink) {
  constexpr std::size_t kAhead = 3;
  BlockKeys keys;
  for (std::size_t i = 0; i < block_count; ++i) {
    if (i + kAhead < block_count) prefetch(&blocks[place(found[i + kAhead])], sizeof(PatchBlock));
    const PatchBlock& block = blocks[place(found[i])];
    for (unsigned lane = 0; lane < PatchBlock::kWidth;
         lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
      const Discs<V> discs = discs_of<V>(block, origin, largest, lane);
      const Kinds<V> kinds = kinds_of(discs, found[i]);
      add_centroids(discs, kinds, lane, sink.force);
      put(keys.of[i] + lane, key_of(kinds, get(block.size + lane, V{})));
    }
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i)
    list_patches<V>(keys.of[i], place(found[i]), sink.patches, count);
  return count;
}

template <class V>
std::size_t classify_finger(const PatchBlock* blocks, const FingerBody& finger, const SplitPoint& origin,
                            const std::uint32_t* found, std::size_t block_count, const FoundSink& sink) {
  return classify<V>(
      blocks, origin, largest_radius(finger), found, block_count,
      [](std::uint32_t block) { return place_of(block); },
      [&](const Discs<V>& discs, std::uint32_t block)
          LUMBRICAL_INLINE { return finger_kinds(finger, discs, tiles_of(block)); },
      sink);
}

/// What discs have to do with the palm: nothing; above the polygon kPalmSide or kPalmThrough, or kPalmBlock
/// inside the skin; else kPalm. The field is that of the farthest edge.
template <class V, template <class> class Shape>
inline Kinds<V> palm_kinds(const PalmBody& palm, const Shape<V>& discs) {
  const V zero = number<V>(0), one = number<V>(1), reach = discs.reach;
  const Wide3<V> p = turn_into(palm.axis, discs.centre);
  V out = number<V>(-1e30), out_x = zero, out_y = zero;  // beyond the farthest edge, and which way
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    const PalmEdge& edge = palm.edge[k];
    const V beside = from_edge(edge, p).beside;
    out_x = select(beside > out, V(edge.out_x), out_x);
    out_y = select(beside > out, V(edge.out_y), out_y);
    out = max(out, beside);
  }
  const V height = abs(p.z), aside = max(out, zero), near = number<V>(kSkeletonReach) * reach,
          square = aside * aside + height * height, distance = sqrt(square),
          field = V(palm.radius) - distance;
  const Wide3<V> away = (aside * out_x) * in_all_lanes<V>(palm.axis[0]) +
                        (aside * out_y) * in_all_lanes<V>(palm.axis[1]) + p.z * in_all_lanes<V>(palm.axis[2]);
  V above = select(height + reach < V(palm.radius), number<V>(kind::kPalmBlock), number<V>(kind::kPalmSide));
  above = select(height > reach, above, number<V>(kind::kPalmThrough));
  const auto is_palm =
      discs.radius >= zero && field + reach >= zero && is_not(is_outside(discs, field, distance, away));
  const auto is_above = out + reach < zero;
  const V kind = select(is_above, above, number<V>(kind::kPalm));
  return {select(is_palm, kind, zero - one), select(square < near * near && out + reach >= zero, one, zero),
          field};
}

template <class V>
std::size_t classify_palm(const PatchBlock* blocks, const PalmBody& palm, const SplitPoint& origin,
                          const std::uint32_t* found, std::size_t block_count, const FoundSink& sink) {
  return classify<V>(
      blocks, origin, palm.radius, found, block_count, [](std::uint32_t block) { return block; },
      [&](const Discs<V>& discs, std::uint32_t) LUMBRICAL_INLINE {
        Kinds<V> kinds = palm_kinds(palm, discs);
        kinds.kind =
            select(kinds.kind == number<V>(kind::kPalmBlock), number<V>(kind::kPalmSide), kinds.kind);
        return kinds;
      },
      sink);
}

}  // namespace lumbrical::LUMBRICAL_ISA
