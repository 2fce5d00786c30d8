// Integrals of a field's positive part over a triangle, from its values on a fixed lattice: the triangle is
// cut into steps^2 congruent cells (lattice_cell.h).
//
// Exact for quadratic fields that are positive throughout; where the field's zero crosses, the error falls
// with the fourth power of the step, and everywhere it is a continuous function of the values.
#pragma once

#include <array>
#include <type_traits>
#include <utility>

#include "index/patches.h"
#include "samples/lattice_cell.h"

namespace lumbrical::LUMBRICAL_ISA {

/// Zeroth and first moments of a share in barycentric coordinates u and v: means over the triangle.
template <class V>
struct LatticeMoments {
  V sum = number<V>(0), u = number<V>(0), v = number<V>(0);
};

template <class V>
inline void add_to(LatticeMoments<V>& m, V sum, V u, V v) {
  m.sum = m.sum + sum;
  m.u = m.u + u;
  m.v = m.v + v;
}

/// Sums over the cells of a lattice.
template <class V>
struct CellSums {
  V sum = number<V>(0), u = number<V>(0), v = number<V>(0), lean_u = number<V>(0), lean_v = number<V>(0);

  /// A share of the cell with its centroid at (u, v); `upright` or not as in for_cells.
  void add(V at_u, V at_v, bool upright, const Cell<V>& cell) {
    sum = sum + cell.mean;
    u = u + at_u * cell.mean;
    v = v + at_v * cell.mean;
    lean_u = upright ? lean_u + cell.to_b : lean_u - cell.to_c;
    lean_v = upright ? lean_v + cell.to_c : lean_v - cell.to_b;
  }
  [[nodiscard]] LatticeMoments<V> means(std::size_t steps) const {
    const V share(1.0f / static_cast<float>(steps * steps)), lean(1.0f / static_cast<float>(12 * steps));
    return {share * sum, share * (u + lean * lean_u), share * (v + lean * lean_v)};
  }
};

/// Where points and cells' centroids of a lattice are, along a side of 1.
struct LatticePlaces {
  float point[kMostStepsAtOnce + 1], upright[kMostStepsAtOnce], inverted[kMostStepsAtOnce];
};
inline constexpr std::array<LatticePlaces, kMostStepsAtOnce + 1> kLatticePlaces = [] {
  std::array<LatticePlaces, kMostStepsAtOnce + 1> all{};
  for (std::size_t steps = 1; steps <= kMostStepsAtOnce; ++steps) {
    const float side = 1.0f / static_cast<float>(steps);
    for (std::size_t i = 0; i <= steps; ++i) {
      const auto at = static_cast<float>(i);
      all[steps].point[i] = side * at;
      if (i == steps) break;
      all[steps].upright[i] = side * (at + 1.0f / 3);
      all[steps].inverted[i] = side * (at + 2.0f / 3);
    }
  }
  return all;
}();

/// Goes through the cells row by row. `row(u)` is what a row's points have in common, `field(row, v)` the
/// field at one of them, or the fields (`field(row, v, to)` writes large ones in place), at corners and at
/// cells' centroids (u, v), and
/// `take(u, v, upright, a, b, c, centre)` gets a cell. Two cells that make a square have b and c in common,
/// of which b has the greater u and c the greater v; a is at the corner with less of both where the cell is
/// upright. Fields come first and cells after: each by itself has less to wait for.
template <class Value, class Row, class Field, class Take>
LUMBRICAL_INLINE inline void for_cells(std::size_t steps, const Row& row, const Field& field,
                                       const Take& take) {
  const LatticePlaces& at = kLatticePlaces[steps];
  Value values[2][kMostStepsAtOnce + 1];
  Value upright[kMostStepsAtOnce], inverted[kMostStepsAtOnce];
  Value *above = values[0], *below = values[1];
  const auto fill = [&](const auto& of_row, std::size_t count, const float* places, Value* to)
                        LUMBRICAL_INLINE {
                          for (std::size_t j = 0; j < count; ++j) {
                            if constexpr (std::is_invocable_v<Field, decltype(of_row), float, Value&>) {
                              field(of_row, places[j], to[j]);
                            } else {
                              to[j] = field(of_row, places[j]);
                            }
                          }
                        };
  fill(row(0.0f), steps + 1, at.point, above);
  for (std::size_t i = 0; i < steps; ++i) {
    const float up = at.upright[i], down = at.inverted[i];
    const auto up_row = row(up), down_row = row(down);
    const std::size_t last = steps - i - 1;
    fill(row(at.point[i + 1]), last + 1, at.point, below);
    fill(up_row, last + 1, at.upright, upright);
    fill(down_row, last, at.inverted, inverted);
    for (std::size_t j = 0; j < last; ++j) {
      take(up, at.upright[j], true, above[j], below[j], above[j + 1], upright[j]);
      take(down, at.inverted[j], false, below[j + 1], below[j], above[j + 1], inverted[j]);
    }
    take(up, at.upright[last], true, above[last], below[last], above[last + 1], upright[last]);
    std::swap(above, below);
  }
}

/// Moments of the positive part of a field: `row(u)` and `field(row, v)` as above.
template <class V, class Row, class Field>
LUMBRICAL_INLINE inline LatticeMoments<V> lattice_moments(std::size_t steps, const Row& row,
                                                          const Field& field) {
  CellSums<V> sums;
  for_cells<V>(steps, row, field,
               [&](float u, float v, bool upright, V a, V b, V c, V centre)
                   LUMBRICAL_INLINE { sums.add(V(u), V(v), upright, cell_of(a, b, c, centre)); });
  return sums.means(steps);
}

}  // namespace lumbrical::LUMBRICAL_ISA
