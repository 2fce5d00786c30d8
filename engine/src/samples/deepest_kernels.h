// What one or two fingers and the palm feel of sixteen patches that they meet (sample_kernels.h): each where
// it is the deepest.
#pragma once

#include "samples/palm_kernels.h"
#include "samples/tile_kernels.h"

namespace lumbrical::LUMBRICAL_ISA {

/// Of each of N fields, from their values at a cell's corners and centroid, the cell where it leads. Of what
/// fields have in common the first one has all.
template <class V, std::size_t N>
LUMBRICAL_INLINE inline std::array<Cell<V>, N> cells_where_leading(const std::array<V, N>& a,
                                                                   const std::array<V, N>& b,
                                                                   const std::array<V, N>& c,
                                                                   const std::array<V, N>& centre, V tie) {
  const auto own_cell = [&](std::size_t k)
                            LUMBRICAL_INLINE { return PartCell<V>(a[k], b[k], c[k], centre[k]); };
  const auto lead = [&](std::size_t k, std::size_t i) LUMBRICAL_INLINE {
    const auto at = [&](const std::array<V, N>& field)
                        LUMBRICAL_INLINE { return (field[k] - field[i]) + tie; };
    return in_cell(at(a), at(b), at(c), at(centre));
  };
  if constexpr (N == 2) {  // one leads where the other does not
    const CutCorner<V> cut(lead(0, 1));
    const PartCell<V> first = own_cell(0), second = own_cell(1);
    return {first.where(cut), second.elsewhere(cut)};
  } else {
    static_assert(N == 3);
    const AtCorners<V> first = lead(0, 1), second = lead(1, 2), last = lead(0, 2);
    return {cell_within<V, 2>(own_cell(0), {first, last}), cell_within<V, 2>(own_cell(1), {-first, second}),
            cell_within<V, 2>(own_cell(2), {-last, -second})};
  }
}

/// A body's origin, from that of the finger that patches are listed for [m].
inline void put_offset(Vec3 origin, const Bodies& bodies, std::uint32_t code, float (&offset)[3]) {
  put(origin - bodies.finger[body_of(first_tile(code))].origin, offset);
}

/// Patches seen from the second tile that they are listed for.
template <class V>
LUMBRICAL_INLINE inline SeenPatch<V> see_from_second(const PatchRows& rows, std::size_t lane,
                                                     const Bodies& bodies) {
  return see_patches_from<V>(rows, lane, [&](std::uint32_t code) LUMBRICAL_INLINE {
    const std::uint32_t number = second_tile(code);
    TileFrame frame = tile_at(bodies.finger.data(), number);
    float offset[3];
    put_offset(bodies.finger[body_of(number)].origin, bodies, code, offset);
    for (std::size_t axis = 0; axis < 3; ++axis) frame.origin[axis] += offset[axis];
    return frame;
  });
}

/// Patches seen from the palm, and a bound of what it is asked about: low where it is not near.
template <class V>
struct SeenFromPalm {
  PatchInFrame<V> patch;
  V most = number<V>(1e30);
};
template <class V>
LUMBRICAL_INLINE inline SeenFromPalm<V> see_from_palm(const PatchRows& rows, std::size_t lane,
                                                      const Bodies& bodies) {
  Wide3<V> origin;
  V most = number<V>(1e30);
  for_tiles<V>(rows, lane, [&](std::uint32_t code, bool all, auto its) LUMBRICAL_INLINE {
    float offset[3];
    put_offset(bodies.palm.origin, bodies, code, offset);
    const V its_most(is_without_palm(code) ? static_cast<float>(kNowhere) : 1e30f);
    origin = all ? in_all_lanes<V>(offset) : select(its, in_all_lanes<V>(offset), origin);
    most = all ? its_most : select(its, its_most, most);
  });
  return {see_patch(rows, lane, bodies.palm.axis, origin), most};
}

/// One or two tiles of different fingers, and the palm.
template <std::size_t kTiles, class V>
inline std::uint32_t deepest_of(const PatchList& list, const Bodies& bodies, const TileSums& sums) {
  const std::size_t steps = steps_of_lane(list);
  constexpr std::size_t kAll = kTiles + 1;
  using Fields = std::array<V, kAll>;
  struct Row {
    typename TileRows<V>::Row of_tile[kTiles];
    Wide3<V> of_palm;
  };
  const std::size_t palm_place = palm_number(bodies);
  std::uint32_t touched = 0;
  for_rows<V>(list, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    std::array<SeenPatch<V>, kTiles> seen;
    seen[0] = see_patches<V>(rows, lane, bodies.finger.data());
    if constexpr (kTiles == 2) seen[1] = see_from_second<V>(rows, lane, bodies);
    std::array<TileRows<V>, kTiles> tile;
    for (std::size_t k = 0; k < kTiles; ++k) tile[k] = tile_rows(seen[k].patch);
    const SeenFromPalm<V> seen_from_palm = see_from_palm<V>(rows, lane, bodies);
    const PatchInFrame<V>& from_palm = seen_from_palm.patch;
    const PalmNearby<V> palm(bodies.palm, from_palm);
    const auto fields = [&](const Row& row, float v) LUMBRICAL_INLINE {
      Fields field;
      for (std::size_t k = 0; k < kTiles; ++k)
        field[k] = tile_field(seen[k].tile, tile[k].at(row.of_tile[k], V(v)));
      field[kTiles] = min(palm.field(row.of_palm + V(v) * from_palm.edge2), seen_from_palm.most);
      return field;
    };
    const V tie = number<V>(kTie) * seen[0].tile.radius;
    CellSums<V> cells[kAll];
    for_cells<Fields>(
        steps,
        [&](float u) LUMBRICAL_INLINE {
          Row row;
          for (std::size_t k = 0; k < kTiles; ++k) row.of_tile[k] = tile[k].row(V(u));
          row.of_palm = from_palm.corner + V(u) * from_palm.edge1;
          return row;
        },
        fields,
        [&](float u, float v, bool upright, const Fields& a, const Fields& b, const Fields& c,
            const Fields& centre) LUMBRICAL_INLINE {
          const std::array<Cell<V>, kAll> its = cells_where_leading(a, b, c, centre, tie);
          for (std::size_t k = 0; k < kAll; ++k) cells[k].add(V(u), V(v), upright, its[k]);
        });
    touched += count_of(add_shares(seen[0].patch, cells[0].means(steps), rows, lane, sums, first_tile));
    if constexpr (kTiles == 2)
      touched += count_of(add_shares(seen[1].patch, cells[1].means(steps), rows, lane, sums, second_tile));
    if (!has_bit(sums.wanted, palm_place)) return;
    const auto [force, moment] = share_of(from_palm, cells[kTiles].means(steps));
    add_wrench(force, moment, lane, sums.of[palm_place]);
    touched += count_of(lanes_with(force));
  });
  return touched;
}

template <class V>
std::uint32_t deepest_lattice(const PatchList& list, const Bodies& bodies, std::size_t tiles,
                              const TileSums& sums) {
  return tiles == 1 ? deepest_of<1, V>(list, bodies, sums) : deepest_of<2, V>(list, bodies, sums);
}

}  // namespace lumbrical::LUMBRICAL_ISA
