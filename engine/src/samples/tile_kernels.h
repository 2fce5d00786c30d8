// What the tiles of a finger feel of sixteen patches (sample_kernels.h).
#pragma once

#include "exact/triangle_rules.h"
#include "samples/lattice.h"
#include "samples/tile_field.h"

namespace lumbrical::LUMBRICAL_ISA {

template <TilePart kPart, class V>
inline std::uint32_t part_lattice(const PatchList& list, const FingerBody* fingers, const TileSums& sums) {
  const std::size_t steps = steps_of_lane(list);
  std::uint32_t touched = 0;
  for_rows<V>(list, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const SeenPatch<V> seen = see_patches<V>(rows, lane, fingers);
    const PartRows<kPart, V> part(seen);
    const LatticeMoments<V> m = lattice_moments<V>(
        steps, [&](float u) LUMBRICAL_INLINE { return part.row(V(u)); },
        [&](const auto& row, float v) LUMBRICAL_INLINE { return part.field(row, V(v)); });
    touched += count_of(add_shares(seen.patch, m, rows, lane, sums, first_tile));
  });
  return touched;
}

template <class V>
std::uint32_t tile_lattice(const PatchList& list, const FingerBody* fingers, TilePart part,
                           const TileSums& sums) {
  switch (part) {
    case TilePart::side:
      return part_lattice<TilePart::side, V>(list, fingers, sums);
    case TilePart::end:
      return part_lattice<TilePart::end, V>(list, fingers, sums);
    case TilePart::whole:
      break;
  }
  return part_lattice<TilePart::whole, V>(list, fingers, sums);
}

/// A lead that is more than rounding, as a share of a radius. Where tiles or bodies have a field in common,
/// the first one has it: all of it, whichever lattice asks.
inline constexpr double kTie = 4e-6;

/// The N tiles that share patches, and how they part.
template <class V, std::size_t N>
struct Neighbours {
  SeenPatch<V> seen[N];
  JointNumbers<V> joint[N - 1];
};
template <class V, std::size_t N>
LUMBRICAL_INLINE inline Neighbours<V, N> see_neighbours(const PatchRows& rows, std::size_t lane,
                                                        const FingerBody* fingers) {
  Neighbours<V, N> near;
  for (std::size_t k = 0; k < N; ++k)
    near.seen[k] = see_patches<V>(rows, lane, fingers, static_cast<std::uint32_t>(k));
  for_tiles<V>(rows, lane, [&](std::uint32_t code, bool all, auto its) LUMBRICAL_INLINE {
    const FingerBody& finger = fingers[body_of(first_tile(code))];
    for (std::size_t k = 0; k + 1 < N; ++k) {
      const auto joint = numbers_of<V>(finger.joint[code % Bodies::kTilesApart + k]);
      JointNumbers<V>& to = near.joint[k];
      to = all ? joint
               : JointNumbers<V>{select(its, joint.inner_sign, to.inner_sign),
                                 select(its, joint.inner_place, to.inner_place),
                                 select(its, joint.outer_sign, to.outer_sign),
                                 select(its, joint.outer_place, to.outer_place),
                                 select(its, joint.by_field, to.by_field)};
    }
  });
  return near;
}

/// What a point of a lattice that N tiles share is told by: their fields, and by how much each joint's outer
/// tile is nearer than the inner one.
template <class V, std::size_t N>
struct SharedPoint {
  V field[N], lead[N - 1];
};
template <class V, std::size_t N>
LUMBRICAL_INLINE inline SharedPoint<V, N> shared_point(const Neighbours<V, N>& near,
                                                       const TilePoint<V> (&at)[N]) {
  SharedPoint<V, N> point;
  for (std::size_t k = 0; k < N; ++k) point.field[k] = tile_field(near.seen[k].tile, at[k]);
  const auto claim = [&](std::size_t k) LUMBRICAL_INLINE {
    return TileClaim<V>{point.field[k], place_on(near.seen[k].tile, at[k])};
  };
  for (std::size_t k = 0; k + 1 < N; ++k) {
    const TileNumbers<V>&inner = near.seen[k].tile, &outer = near.seen[k + 1].tile;
    point.lead[k] =
        side_of_joint(near.joint[k], inner, claim(k), outer, claim(k + 1)) - number<V>(kTie) * inner.radius;
  }
  return point;
}

/// Each tile's part of a cell, by its own field. Neighbours part along their joint's border, the first tile
/// and the last, which a bent finger brings together, where their fields are equal.
template <class V, std::size_t N>
LUMBRICAL_INLINE inline std::array<Cell<V>, N> shared_cells(const SharedPoint<V, N>& a,
                                                            const SharedPoint<V, N>& b,
                                                            const SharedPoint<V, N>& c,
                                                            const SharedPoint<V, N>& centre, V tie) {
  const auto own_cell = [&](std::size_t k) LUMBRICAL_INLINE {
    return PartCell<V>(a.field[k], b.field[k], c.field[k], centre.field[k]);
  };
  const auto border = [&](std::size_t k) LUMBRICAL_INLINE {
    return in_cell(a.lead[k], b.lead[k], c.lead[k], centre.lead[k]);
  };
  const AtCorners<V> inner = border(0);
  const PartCell<V> second = own_cell(1);
  if constexpr (N == 2) {
    const CutCorner<V> cut(inner);
    return {own_cell(0).elsewhere(cut), second.where(cut)};
  } else {
    const auto ahead = [tie](const SharedPoint<V, N>& at)
                           LUMBRICAL_INLINE { return at.field[2] - at.field[0] - tie; };
    const AtCorners<V> outer = border(1), ends = in_cell(ahead(a), ahead(b), ahead(c), ahead(centre));
    const Cell<V> from_first = cell_within<V, 2>(second, {inner, -ends}),
                  from_last = cell_within<V, 2>(second, {-outer, ends});
    return {cell_within<V, 2>(own_cell(0), {-inner, -ends}), from_first + from_last,
            cell_within<V, 2>(own_cell(2), {outer, ends})};
  }
}

template <std::size_t N, class V>
inline std::uint32_t lattice_of(const PatchList& list, const FingerBody* fingers, const TileSums& sums) {
  const std::size_t steps = steps_of_lane(list);
  using Point = SharedPoint<V, N>;
  struct RowOfAll {
    typename TileRows<V>::Row of[N];
  };
  std::uint32_t touched = 0;
  for_rows<V>(list, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const Neighbours<V, N> near = see_neighbours<V, N>(rows, lane, fingers);
    const V tie = number<V>(kTie) * near.seen[0].tile.radius;
    TileRows<V> tile[N];
    for (std::size_t k = 0; k < N; ++k) tile[k] = tile_rows(near.seen[k].patch);
    const auto point = [&](const RowOfAll& row, float v) LUMBRICAL_INLINE {
      TilePoint<V> at[N];
      for (std::size_t k = 0; k < N; ++k) at[k] = tile[k].at(row.of[k], V(v));
      return shared_point<V, N>(near, at);
    };
    CellSums<V> cells[N];
    for_cells<Point>(
        steps,
        [&](float u) LUMBRICAL_INLINE {
          RowOfAll row;
          for (std::size_t k = 0; k < N; ++k) row.of[k] = tile[k].row(V(u));
          return row;
        },
        point,
        [&](float u, float v, bool upright, const Point& a, const Point& b, const Point& c,
            const Point& centre) LUMBRICAL_INLINE {
          const std::array<Cell<V>, N> its = shared_cells<V, N>(a, b, c, centre, tie);
          for (std::size_t k = 0; k < N; ++k) cells[k].add(V(u), V(v), upright, its[k]);
        });
    for (std::size_t k = 0; k < N; ++k) {
      touched += count_of(add_shares(near.seen[k].patch, cells[k].means(steps), rows, lane, sums,
                                     [k](std::uint32_t code) LUMBRICAL_INLINE {
                                       return first_tile(code) + static_cast<std::uint32_t>(k);
                                     }));
    }
  });
  return touched;
}

template <class V>
std::uint32_t shared_lattice(const PatchList& list, const FingerBody* fingers, std::size_t tiles,
                             const TileSums& sums) {
  return tiles == 2 ? lattice_of<2, V>(list, fingers, sums) : lattice_of<3, V>(list, fingers, sums);
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
std::uint32_t tile_rule(const PatchList& list, const FingerBody* fingers, std::size_t rule,
                        const TileSums& sums) {
  std::uint32_t touched = 0;
  for_rows<V>(list, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const SeenPatch<V> seen = see_patches<V>(rows, lane, fingers);
    LatticeMoments<V> m;
    for_nodes(kTriangleRules[rule], [&](double u, double v, double weight) LUMBRICAL_INLINE {
      const V at_u = number<V>(u), at_v = number<V>(v);
      const V mean = number<V>(weight) * tile_field(seen.tile, tile_point(seen.patch.at(at_u, at_v)));
      add_to(m, mean, at_u * mean, at_v * mean);
    });
    touched += count_of(add_shares(seen.patch, m, rows, lane, sums, first_tile));
  });
  return touched;
}

}  // namespace lumbrical::LUMBRICAL_ISA
