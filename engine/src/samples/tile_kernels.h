// What the tiles of a finger feel of sixteen patches (sample_kernels.h).
#pragma once

#include "lanes/triangle_rules.h"
#include "samples/lattice.h"
#include "samples/tile_field.h"

namespace lumbrical::LUMBRICAL_ISA {

template <TilePart kPart, class V>
inline std::uint32_t part_lattice(const PatchList& patches, const TileFrame& tile, std::size_t steps,
                                  BodySums& sums) {
  std::uint32_t touched = 0;
  for_rows<V>(patches, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const PatchInFrame<V> patch = see_patch(rows, lane, tile.axis, in_all_lanes<V>(tile.origin));
    const LatticeMoments<V> m = lattice_moments<V>(
        patch, steps, [&](Wide3<V> p) LUMBRICAL_INLINE { return part_field<kPart>(tile, p); });
    touched += count_of(add_share(patch, m, lane, sums));
  });
  return touched;
}

template <class V>
std::uint32_t tile_lattice(const PatchList& patches, const TileFrame& tile, TilePart part, std::size_t steps,
                           BodySums& sums) {
  switch (part) {
    case TilePart::side:
      return part_lattice<TilePart::side, V>(patches, tile, steps, sums);
    case TilePart::near_end:
      return part_lattice<TilePart::near_end, V>(patches, tile, steps, sums);
    case TilePart::far_end:
      return part_lattice<TilePart::far_end, V>(patches, tile, steps, sums);
    case TilePart::whole:
      break;
  }
  return part_lattice<TilePart::whole, V>(patches, tile, steps, sums);
}

/// Shares of two or three tiles at a point: where neighbours part, each has a ramp as wide as a cell, so that
/// shares are continuous; tiles that are no neighbours (of a folded finger) part where their fields are
/// equal.
template <class V, std::size_t N>
inline void tile_shares(const TileFrame* tiles, const JointSides* joints, bool folded,
                        const FieldAndPlace<V> (&at)[N], V per_width, V (&share)[N]) {
  const V zero = number<V>(0), one = number<V>(1), half = number<V>(0.5);
  const auto ramp = [&](V lead) { return between(half + lead * per_width, zero, one); };
  const V outer = ramp(side_of_joint(joints[0], tiles[0], at[0].place, tiles[1], at[1].place));
  if constexpr (N == 2) {
    share[0] = one - outer;
    share[1] = outer;
  } else {
    const V outermost = ramp(side_of_joint(joints[1], tiles[1], at[1].place, tiles[2], at[2].place));
    const V last = folded ? ramp(at[2].field - at[0].field) : outermost;
    share[0] = (one - outer) * (folded ? one - last : one);
    share[2] = last * (folded ? outermost : outer);
    share[1] = one - share[0] - share[2];
  }
}

template <class V, std::size_t N>
inline std::uint32_t shared_lattice(const PatchList& patches, const TileFrame* tiles,
                                    const JointSides* joints, bool folded, std::size_t steps, unsigned wanted,
                                    BodySums* sums) {
  std::uint32_t touched = 0;
  for_rows<V>(patches, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    PatchInFrame<V> patch[N];
    for (std::size_t k = 0; k < N; ++k)
      patch[k] = see_patch(rows, lane, tiles[k].axis, in_all_lanes<V>(tiles[k].origin));
    const Wide3<V> normal = cross(patch[0].edge1, patch[0].edge2);
    const V width = root(root(dot(normal, normal)));  // of the whole patch
    const V per_width =
        quotient(V(0.5f * static_cast<float>(steps)), choose(width > number<V>(0), width, number<V>(1)));
    LatticeMoments<V> m[N];
    struct Fields {
      V of[N];
    };
    for_cells<Fields>(
        steps,
        [&](float u, float v) LUMBRICAL_INLINE {
          Fields fields;
          for (std::size_t k = 0; k < N; ++k) fields.of[k] = tile_field(tiles[k], patch[k].at(V(u), V(v)));
          return fields;
        },
        [&](float u, float v, const Fields& a, const Fields& b, const Fields& c, float side)
            LUMBRICAL_INLINE {
              FieldAndPlace<V> at[N];
              V centre[N];
              for (std::size_t k = 0; k < N; ++k) {
                at[k] = tile_field_and_place(tiles[k], patch[k].at(V(u), V(v)));
                centre[k] = at[k].field;
              }
              const LatticeMoments<V> cell =
                  cell_moments(V(u), V(v), V(side), cell_of_largest(a.of, b.of, c.of, centre));
              V share[N];
              tile_shares<V, N>(tiles, joints, folded, at, per_width, share);
              for (std::size_t k = 0; k < N; ++k)
                add_to(m[k], share[k] * cell.sum, share[k] * cell.u, share[k] * cell.v);
            });
    unsigned any = 0;
    for (std::size_t k = 0; k < N; ++k) {
      if ((wanted >> k & 1u) != 0) any |= add_share(patch[k], mean_of(m[k], steps), lane, sums[k]);
    }
    touched += count_of(any);
  });
  return touched;
}

template <class V>
std::uint32_t joint_lattice(const PatchList& patches, const TileFrame* tiles, const JointSides* joints,
                            std::size_t steps, unsigned wanted, BodySums* sums) {
  return shared_lattice<V, 2>(patches, tiles, joints, false, steps, wanted, sums);
}
template <class V>
std::uint32_t finger_lattice(const PatchList& patches, const TileFrame* tiles, const JointSides* joints,
                             bool folded, std::size_t steps, unsigned wanted, BodySums* sums) {
  return shared_lattice<V, 3>(patches, tiles, joints, folded, steps, wanted, sums);
}

/// Calls take(u, v, weight) for every node of a rule, u and v barycentric.
template <class Take>
LUMBRICAL_INLINE inline void for_nodes(const TriangleRule& rule, const Take& take) {
  // centroid + a (one corner - centroid) + b (another - centroid)
  const auto take_towards = [&](double a, std::size_t one, double b, std::size_t other, double weight)
                                LUMBRICAL_INLINE {
                                  const double rest = (1 - a - b) * (1.0 / 3);
                                  take(rest + (one == 1 ? a : 0) + (other == 1 ? b : 0),
                                       rest + (one == 2 ? a : 0) + (other == 2 ? b : 0), weight);
                                };
  if (rule.centre > 0) take_towards(0, 0, 0, 0, rule.centre);
  for (std::size_t k = 0; k < rule.corner_count; ++k) {
    for (std::size_t one = 0; one < 3; ++one)
      take_towards(rule.corner[k].at, one, 0, 0, rule.corner[k].weight);
  }
  for (std::size_t k = 0; k < rule.pair_count; ++k) {
    for (std::size_t one = 0; one < 3; ++one) {
      for (std::size_t step = 1; step < 3; ++step)
        take_towards(rule.pair[k].first, one, rule.pair[k].second, (one + step) % 3, rule.pair[k].weight);
    }
  }
}

template <class V>
std::uint32_t tile_rule(const PatchList& patches, const TileFrame& tile, std::size_t rule, BodySums& sums) {
  std::uint32_t touched = 0;
  for_rows<V>(patches, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const PatchInFrame<V> patch = see_patch(rows, lane, tile.axis, in_all_lanes<V>(tile.origin));
    LatticeMoments<V> m;
    for_nodes(kTriangleRules[rule], [&](double u, double v, double weight) {
      const V at_u = number<V>(u), at_v = number<V>(v);
      const V mean = number<V>(weight) * tile_field(tile, patch.at(at_u, at_v));
      add_to(m, mean, at_u * mean, at_v * mean);
    });
    touched += count_of(add_share(patch, m, lane, sums));
  });
  return touched;
}

}  // namespace lumbrical::LUMBRICAL_ISA
