// Integrals of a field's positive part over a triangle, from its values on a fixed lattice: the triangle is
// cut into steps^2 congruent cells; in a cell the field is linear between its corners, whose positive part is
// integrated exactly, plus a bubble that the value at the centroid tells, as far as the cell is inside.
//
// Exact for quadratic fields that are positive throughout; where the field's zero crosses, the error falls
// with the fourth power of the step, and everywhere it is a continuous function of the values.
#pragma once

#include "index/patches.h"
#include "lanes/wide_geometry.h"

namespace lumbrical::LUMBRICAL_ISA {

inline constexpr std::size_t kMostSteps = kLatticeSteps.back();

/// The mean of the positive part of a linear function over a triangle, from its values at the corners, and
/// the share of the area in which it is positive.
template <class V>
struct Positive {
  V mean, share;
};
template <class V>
inline Positive<V> positive_part(V a, V b, V c, V third_of_sum) {
  const V zero = number<V>(0), one = number<V>(1);
  const V ab_low = lesser(a, b), ab_high = greater(a, b);
  const V low = lesser(ab_low, c), high = greater(ab_high, c);
  const V middle = greater(ab_low, lesser(ab_high, c));
  // The corner whose sign is its own: the highest, or the lowest. It cuts off a triangle.
  const auto one_inside = middle <= zero;
  const V odd = choose(one_inside, greater(high, zero), lesser(low, zero));
  const V product = (high - low) * choose(one_inside, high - middle, middle - low);
  const V cut = quotient(odd * odd, choose(product > zero, product, one));
  const V part = cut * odd * number<V>(1.0 / 3);
  return {choose(one_inside, part, third_of_sum - part), choose(one_inside, cut, one - cut)};
}

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
/// From sums over cells to means over the triangle.
template <class V>
inline LatticeMoments<V> mean_of(const LatticeMoments<V>& m, std::size_t steps) {
  const V share(1.0f / static_cast<float>(steps * steps));
  return {share * m.sum, share * m.u, share * m.v};
}

/// One cell's mean and how it leans: what the moments need.
template <class V>
struct Cell {
  V mean, lean_u, lean_v;
};
/// From the corners' values, their mean and by how much the field's mean is above that.
template <class V>
inline Cell<V> raised_cell(V a, V b, V c, V level, V bubble) {
  const auto [mean, share] = positive_part(a + bubble, b + bubble, c + bubble, level + bubble);
  const V lean = share * number<V>(1.0 / 12);
  return {mean, (b - level) * lean, (c - level) * lean};
}
/// `a` at the corner the cell's sides are counted from, `b` along u, `c` along v, `centre` at the centroid.
template <class V>
inline Cell<V> cell_of(V a, V b, V c, V centre) {
  const V level = (a + b + c) * number<V>(1.0 / 3);
  return raised_cell(a, b, c, level, number<V>(0.75) * (centre - level));
}

/// The largest of N fields: their corners' values, a kind of cell each. Where two are equal the largest one
/// has a kink, which its corners alone would tell too large; each by itself is smooth.
template <class V, std::size_t N>
inline Cell<V> cell_of_largest(const V (&a)[N], const V (&b)[N], const V (&c)[N], const V (&centre)[N]) {
  const V third = number<V>(1.0 / 3), zero = number<V>(0), one = number<V>(1);
  const auto bubble_of = [&](std::size_t k) {
    return number<V>(0.75) * (centre[k] - (a[k] + b[k] + c[k]) * third);
  };
  V most_a = a[0], most_b = b[0], most_c = c[0], bubble = bubble_of(0), excess = zero;
  for (std::size_t k = 1; k < N; ++k) {
    const V lead_a = a[k] - most_a, lead_b = b[k] - most_b, lead_c = c[k] - most_c;
    const auto [mean, share] = positive_part(lead_a, lead_b, lead_c, (lead_a + lead_b + lead_c) * third);
    excess =
        excess + ((greater(lead_a, zero) + greater(lead_b, zero) + greater(lead_c, zero)) * third - mean);
    bubble = (one - share) * bubble + share * bubble_of(k);
    most_a = greater(most_a, a[k]);
    most_b = greater(most_b, b[k]);
    most_c = greater(most_c, c[k]);
  }
  return raised_cell(most_a, most_b, most_c, (most_a + most_b + most_c) * third, bubble - excess);
}

/// `side` is the length of the cell's sides, negative for cells the other way up.
template <class V>
inline LatticeMoments<V> cell_moments(V u, V v, V side, const Cell<V>& cell) {
  return {cell.mean, u * cell.mean + side * cell.lean_u, v * cell.mean + side * cell.lean_v};
}

// Kernels are one piece of code: registers would be spilled round every call.
#define LUMBRICAL_INLINE __attribute__((always_inline))

/// Goes through the cells row by row. `corner(u, v)` is the field there, or the fields; `take(u, v, a, b, c,
/// side)` gets a cell's values at its corners and its centroid (u, v).
template <class Value, class Corner, class Take>
LUMBRICAL_INLINE inline void for_cells(std::size_t steps, const Corner& corner, const Take& take) {
  Value row[2][kMostSteps + 1];
  Value *above = row[0], *below = row[1];
  const float side = 1.0f / static_cast<float>(steps);
  for (std::size_t j = 0; j <= steps; ++j) above[j] = corner(0.0f, side * static_cast<float>(j));
  for (std::size_t i = 0; i < steps; ++i) {
    constexpr float kThird = 1.0f / 3, kTwoThirds = 2.0f / 3;
    const auto u = static_cast<float>(i);
    const float up = side * (u + kThird), down = side * (u + kTwoThirds), next = side * (u + 1);
    below[0] = corner(next, 0.0f);
    for (std::size_t j = 0; j + 1 < steps - i; ++j) {
      const auto v = static_cast<float>(j);
      below[j + 1] = corner(next, side * (v + 1));
      take(up, side * (v + kThird), above[j], below[j], above[j + 1], side);
      take(down, side * (v + kTwoThirds), below[j + 1], above[j + 1], below[j], -side);
    }
    const std::size_t last = steps - i - 1;
    take(up, side * (static_cast<float>(last) + kThird), above[last], below[last], above[last + 1], side);
    Value* const kept = above;
    above = below;
    below = kept;
  }
}

/// Moments of the positive part of field(patch.at(u, v)).
template <class V, class Patch, class Field>
LUMBRICAL_INLINE inline LatticeMoments<V> lattice_moments(const Patch& patch, std::size_t steps,
                                                          const Field& field) {
  LatticeMoments<V> m;
  for_cells<V>(
      steps, [&](float u, float v) LUMBRICAL_INLINE { return field(patch.at(V(u), V(v))); },
      [&](float u, float v, V a, V b, V c, float side) LUMBRICAL_INLINE {
        const Cell<V> cell = cell_of(a, b, c, field(patch.at(V(u), V(v))));
        const LatticeMoments<V> more = cell_moments(V(u), V(v), V(side), cell);
        add_to(m, more.sum, more.u, more.v);
      });
  return mean_of(m, steps);
}

}  // namespace lumbrical::LUMBRICAL_ISA
