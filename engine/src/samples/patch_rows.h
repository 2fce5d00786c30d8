// From a list of patches to lanes and from lanes to sums. A row of lanes may hold patches of several tiles;
// each is seen from its own.
#pragma once

#include <algorithm>

#include "base/prefetch.h"
#include "base/set_bits.h"
#include "samples/columns.h"
#include "samples/lattice.h"
#include "samples/sample_kernels.h"

namespace lumbrical::LUMBRICAL_ISA {

/// Sixteen patches, a lane each, relative to the origins of their bodies; lanes without one have no edges.
struct PatchRows {
  static constexpr std::size_t kWidth = PatchBlock::kWidth;
  alignas(64) float corner[3][kWidth];   // [m]
  alignas(64) float edge[2][3][kWidth];  // [m]
  alignas(64) float seen_from[kWidth];   // ListedPatch::tile
  std::size_t first;                     // lane's number among all of a list
};

/// A body's origin in fours, kept as long as patches are of the same body.
struct OriginFours {
  Four high{}, low{};
  std::size_t body = ~std::size_t{0};
  void see(const SplitPoint* origins, std::size_t of) {
    if (of == body) return;
    body = of;
    const SplitPoint& origin = origins[of];
    high = Four{origin.high[0], origin.high[1], origin.high[2], 0};
    low = Four{origin.low[0], origin.low[1], origin.low[2], 0};
  }
  /// A SplitPoint's six numbers, seen from there; the last of four is nothing.
  [[nodiscard]] Four seen(const float* numbers) const {
    return (four_at(numbers) - high) + (four_at(numbers + 3) - low);
  }
};

/// Four patches as fours: the first corner of each, and its edges' first and last four numbers of six.
struct PatchFours {
  Four corner[4], edges[4], edges_end[4];

  /// The k-th, seen from its body.
  void see(std::size_t k, const float* numbers, const OriginFours& origin) {
    corner[k] = origin.seen(numbers);
    edges[k] = four_at(numbers + 6);
    edges_end[k] = four_at(numbers + 8);
  }
  /// The first one's quarters: at its corners and, upside down, in its middle.
  void quarter() {
    const Four half = {0.5f, 0.5f, 0.5f, 0.5f}, zero{};
    const Four edge1 = half * edges[0],  // and the second's first number
        edge2 = half * __builtin_shufflevector(edges_end[0], edges_end[0], 1, 2, 3, 3);
    const Four own = corner[0], all_end = half * edges_end[0];
    const Four from_own[4] = {zero, edge1, edge2, edge1 + edge2};
    for (std::size_t k = 0; k < 4; ++k) {
      corner[k] = own + from_own[k];
      edges[k] = k < 3 ? edge1 : zero - edge1;
      edges_end[k] = k < 3 ? all_end : zero - all_end;
    }
  }
  void put(std::size_t lane, PatchRows& rows) {
    transpose(corner);
    transpose(edges);
    transpose(edges_end);
    put_fours(corner, 3, rows.corner, lane);
    put_fours(edges, 4, rows.edge, 0, lane);
    put_fours(edges_end + 2, 2, rows.edge, 4, lane);
  }
};

/// Lanes that a patch of the list takes, and the steps of the lattice in each.
inline std::size_t lanes_of_patch(const PatchList& list) { return is_in_quarters(list.steps) ? 4 : 1; }
inline std::size_t steps_of_lane(const PatchList& list) {
  return is_in_quarters(list.steps) ? list.steps / 2 : list.steps;
}

/// Fills `count` lanes with the list's patches, or with quarters of them, from lane `first` of all on.
inline void gather(const PatchList& list, std::size_t first, std::size_t count, PatchRows& rows) {
  static_assert(sizeof(PatchShape) == 12 * sizeof(float));
  const bool in_quarters = is_in_quarters(list.steps);
  OriginFours origin;
  PatchFours fours;
  const auto see = [&](const ListedPatch& patch, std::size_t k) LUMBRICAL_INLINE {
    origin.see(list.origins, body_of(first_tile(patch.tile)));
    fours.see(k, list.shape_at(patch.place).corner.high, origin);
    return static_cast<float>(patch.tile);
  };
  for (std::size_t lane = 0; lane < count; lane += 4) {
    if (in_quarters) {
      std::fill_n(rows.seen_from + lane, 4, see(list.patches[(first + lane) / 4], 0));
      fours.quarter();
    } else {
      for (std::size_t k = 0; k < 4; ++k)
        rows.seen_from[lane + k] = see(list.patches[first + std::min(lane + k, count - 1)], k);
    }
    fours.put(lane, rows);
  }
  for (std::size_t lane = count; lane < PatchRows::kWidth; ++lane) {
    rows.seen_from[lane] = rows.seen_from[count - 1];
    for (std::size_t axis = 0; axis < 3; ++axis)
      rows.corner[axis][lane] = rows.edge[0][axis][lane] = rows.edge[1][axis][lane] = 0;
  }
}

/// Asks for the patches of a row while another one goes through a kernel: for where they begin, since their
/// ends' own lines cost more than they bring.
LUMBRICAL_INLINE inline void prefetch_row(const PatchList& list, std::size_t first) {
  const std::size_t begin = first / lanes_of_patch(list),
                    end = std::min(begin + PatchRows::kWidth, list.count);
  for (std::size_t i = begin; i < end; ++i) prefetch(&list.shape_at(list.patches[i].place), 1);
}

/// Calls take(rows, lane) for every register of the patches that holds any.
template <class V, class Take>
LUMBRICAL_INLINE inline void for_rows(const PatchList& list, const Take& take) {
  PatchRows rows;
  const std::size_t count = list.count * lanes_of_patch(list);
  for (std::size_t first = 0; first < count; first += PatchRows::kWidth) {
    const std::size_t lanes = std::min(count - first, PatchRows::kWidth);
    gather(list, first, lanes, rows);
    rows.first = first;
    prefetch_row(list, first + PatchRows::kWidth);
    for (std::size_t lane = 0; lane < lanes; lane += wide::Lanes<V>::kCount) take(rows, lane);
  }
}

/// A patch seen from a frame.
template <class V>
struct PatchInFrame {
  Wide3<V> corner, edge1, edge2;
  [[nodiscard]] Wide3<V> at(V u, V v) const { return corner + (u * edge1 + v * edge2); }
};

/// How far a patch's corners are from its centroid at most.
template <class V>
inline V size_of(const PatchInFrame<V>& patch) {
  const Wide3<V> to_centre = number<V>(1.0 / 3) * (patch.edge1 + patch.edge2), at_1 = patch.edge1 - to_centre,
                 at_2 = patch.edge2 - to_centre;
  return sqrt(max(dot(to_centre, to_centre), max(dot(at_1, at_1), dot(at_2, at_2))));
}

template <class V>
inline Wide3<V> turn_into(const float (&axis)[3][3], Wide3<V> p) {
  return {dot(in_all_lanes<V>(axis[0]), p), dot(in_all_lanes<V>(axis[1]), p),
          dot(in_all_lanes<V>(axis[2]), p)};
}

template <class V>
inline PatchInFrame<V> see_patch(const PatchRows& rows, std::size_t lane, const float (&axis)[3][3],
                                 Wide3<V> origin) {
  return {turn_into(axis, vector_at<V>(rows.corner, lane) - origin),
          turn_into(axis, vector_at<V>(rows.edge[0], lane)),
          turn_into(axis, vector_at<V>(rows.edge[1], lane))};
}

/// A tile's numbers in lanes (bodies.h).
template <class V>
struct TileNumbers {
  V length, radius, end_radius, sine, cosine, tangent2, cosine2;
};
template <class V>
inline TileNumbers<V> numbers_of(const TileFrame& tile) {
  return {V(tile.length), V(tile.radius),   V(tile.end_radius), V(tile.sine),
          V(tile.cosine), V(tile.tangent2), V(tile.cosine2)};
}

/// Calls take(code, all, its) for the patches that are listed for the same tile: are they the whole register,
/// and their lanes.
template <class V, class Take>
LUMBRICAL_INLINE inline void for_tiles(const PatchRows& rows, std::size_t lane, const Take& take) {
  constexpr unsigned kAll = (1u << wide::Lanes<V>::kCount) - 1;
  const V codes = get(rows.seen_from + lane, V{});
  for (unsigned left = kAll; left != 0;) {
    const float code = rows.seen_from[lane + static_cast<unsigned>(__builtin_ctz(left))];
    const auto its = codes == V(code);
    const unsigned lanes = wide::bits_of(its);
    take(static_cast<std::uint32_t>(code), lanes == kAll, its);
    left &= ~lanes;
  }
}

/// Patches, each seen from its tile's frame, and the tiles' numbers.
template <class V>
struct SeenPatch {
  PatchInFrame<V> patch;
  TileNumbers<V> tile;
  decltype(V{} > V{}) at_far_end;
};
/// From the frames `frame_of(code)`.
template <class V, class FrameOf>
LUMBRICAL_INLINE inline SeenPatch<V> see_patches_from(const PatchRows& rows, std::size_t lane,
                                                      const FrameOf& frame_of) {
  SeenPatch<V> seen;
  seen.at_far_end = get(rows.seen_from + lane, V{}) >= V(static_cast<float>(ListedPatch::kFarEnd));
  for_tiles<V>(rows, lane, [&](std::uint32_t code, bool all, auto its) LUMBRICAL_INLINE {
    const TileFrame& frame = frame_of(code);
    const auto see = [&]() LUMBRICAL_INLINE {
      return see_patch(rows, lane, frame.axis, in_all_lanes<V>(frame.origin));
    };
    if (all) {  // asked first: what is put in its place at once need not be copied
      seen.patch = see();
      seen.tile = numbers_of<V>(frame);
      return;
    }
    const PatchInFrame<V> patch = see();
    const TileNumbers<V> tile = numbers_of<V>(frame);
    seen.patch = {select(its, patch.corner, seen.patch.corner), select(its, patch.edge1, seen.patch.edge1),
                  select(its, patch.edge2, seen.patch.edge2)};
    seen.tile = {
        select(its, tile.length, seen.tile.length),         select(its, tile.radius, seen.tile.radius),
        select(its, tile.end_radius, seen.tile.end_radius), select(its, tile.sine, seen.tile.sine),
        select(its, tile.cosine, seen.tile.cosine),         select(its, tile.tangent2, seen.tile.tangent2),
        select(its, tile.cosine2, seen.tile.cosine2)};
  });
  return seen;
}

/// From the tiles they are listed for, or from those `outward` of them.
template <class V>
LUMBRICAL_INLINE inline SeenPatch<V> see_patches(const PatchRows& rows, std::size_t lane,
                                                 const FingerBody* fingers, std::uint32_t outward = 0) {
  return see_patches_from<V>(rows, lane, [&](std::uint32_t code) LUMBRICAL_INLINE -> const TileFrame& {
    return tile_at(fingers, first_tile(code) + outward);
  });
}

inline std::uint32_t count_of(unsigned lanes) {
  return static_cast<std::uint32_t>(__builtin_popcount(lanes));
}

/// Adds numbers to sums from `lane` on, each first rounded to a multiple of the quantum.
template <class V>
LUMBRICAL_INLINE inline void add_rounded(V values, std::size_t lane, double quantum,
                                         double (&sums)[PatchBlock::kWidth]) {
  constexpr double kRounder = 6755399441055744.0;  // 1.5 * 2^52: its last place is that of units
  constexpr std::size_t kLanes = wide::Lanes<V>::kCount;
  const double rounder = kRounder * quantum;
  alignas(64) float row[kLanes];
  put(row, values);
  if constexpr (kLanes == 4 || kLanes == 8) {
    for (std::size_t i = 0; i < kLanes; i += kLanes / 2)
      add_half_rounded<kLanes / 2>(row + i, rounder, sums + lane + i);
  } else {
    for (std::size_t i = 0; i < kLanes; ++i)
      sums[lane + i] += (static_cast<double>(row[i]) + rounder) - rounder;
  }
}

/// Adds force and moment of a register's patches to a body's sums.
template <class V>
LUMBRICAL_INLINE inline void add_wrench(Wide3<V> force, Wide3<V> moment, std::size_t lane, BodySums& sums) {
  const V rows[6] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
  for (std::size_t k = 0; k < 6; ++k)
    add_rounded(rows[k], lane, k < 3 ? sums.force_quantum : sums.moment_quantum, sums.lane[k]);
}

/// Lanes whose force is not 0, a bit each.
template <class V>
inline unsigned lanes_with(Wide3<V> force) {
  const V size = abs(force.x) + (abs(force.y) + abs(force.z));
  return wide::bits_of(size > number<V>(0));
}

/// A share whose moments are known, as force and moment about the frame's origin.
template <class V>
struct Share {
  Wide3<V> force, moment;
};
template <class V>
LUMBRICAL_INLINE inline Share<V> share_of(const PatchInFrame<V>& patch, const LatticeMoments<V>& m) {
  const Wide3<V> normal = cross(patch.edge1, patch.edge2);
  const Wide3<V> first = m.sum * patch.corner + (m.u * patch.edge1 + m.v * patch.edge2);
  return {m.sum * normal, cross(first, normal)};
}

/// Adds the patches' shares to the sums of the tiles they go to, `tile_of(code)`, as far as those are wanted;
/// returns a bit per lane that has any.
template <class V, class TileOf>
LUMBRICAL_INLINE inline unsigned add_shares(const PatchInFrame<V>& patch, const LatticeMoments<V>& m,
                                            const PatchRows& rows, std::size_t lane, const TileSums& sums,
                                            const TileOf& tile_of) {
  const Share<V> share = share_of(patch, m);
  unsigned any = 0;
  for_tiles<V>(rows, lane, [&](std::uint32_t code, bool all, auto its) LUMBRICAL_INLINE {
    const std::uint32_t tile = tile_of(code);
    if (!has_bit(sums.wanted, tile)) return;
    if (all) {
      any = lanes_with(share.force);
      return add_wrench(share.force, share.moment, lane, sums.of[tile]);
    }
    const Wide3<V> zero{number<V>(0), number<V>(0), number<V>(0)};
    const Wide3<V> own = select(its, share.force, zero);
    any |= lanes_with(own);
    add_wrench(own, select(its, share.moment, zero), lane, sums.of[tile]);
  });
  return any;
}

}  // namespace lumbrical::LUMBRICAL_ISA
