// Integrals of a field's positive part over a triangle, from its values on a fixed lattice: the triangle is
// cut into steps^2 congruent cells; in a cell the field is linear between its corners, whose positive part is
// integrated exactly, plus a bubble that the value at the centroid tells, as far as the cell is inside.
//
// Exact for quadratic fields that are positive throughout; where the field's zero crosses, the error falls
// with the fourth power of the step, and everywhere it is a continuous function of the values.
#pragma once

#include <type_traits>

#include "index/patches.h"
#include "simd/wide_geometry.h"

// Kernels are one piece of code: registers would be spilled round every call.
#define LUMBRICAL_INLINE __attribute__((always_inline))

namespace lumbrical::LUMBRICAL_ISA {

/// The mean of the positive part of a linear function over a triangle, from its values at the corners, and
/// the share of the area in which it is positive.
template <class V>
struct Positive {
  V mean, share;
};
template <class V>
inline Positive<V> positive_part(V a, V b, V c, V third_of_sum) {
  const V zero = number<V>(0), one = number<V>(1);
  const V ab_low = min(a, b), ab_high = max(a, b);
  const V low = min(ab_low, c), high = max(ab_high, c);
  const V middle = max(ab_low, min(ab_high, c));
  // The corner whose sign is its own: the highest, or the lowest. It cuts off a triangle.
  const auto one_inside = middle <= zero;
  const V odd = select(one_inside, max(high, zero), min(low, zero));
  const V product = (high - low) * select(one_inside, high - middle, middle - low);
  const V cut = divide(odd * odd, max(product, number<V>(1e-36)));  // at least odd^2, or odd is 0
  const V part = cut * odd * number<V>(1.0 / 3);
  return {select(one_inside, part, third_of_sum - part), select(one_inside, cut, one - cut)};
}

/// Which corner's sign is its own: the second, or the third, else the first.
template <class M>
struct OddCorner {
  M second, third;
};
template <class V>
inline auto odd_corner(V a, V b, V c) {
  const V zero = number<V>(0);
  const auto second = ((b > zero && c <= zero) || (b <= zero && c > zero)) &&
                      ((a > zero && c > zero) || (a <= zero && c <= zero));
  const auto third = ((c > zero && b <= zero) || (c <= zero && b > zero)) &&
                     ((a > zero && b > zero) || (a <= zero && b <= zero));
  return OddCorner<std::remove_const_t<decltype(second)>>{second, third};
}

/// The share of a function, from its values f at the corners, that is where another is positive, from its
/// values a, b, c: both as if they were linear, and what is below 0 of f left out.
template <class V>
LUMBRICAL_INLINE inline V share_where_positive(V a, V b, V c, V fa, V fb, V fc) {
  const V zero = number<V>(0), one = number<V>(1);
  const auto [second, third] = odd_corner(a, b, c);
  const V odd = select(second, b, select(third, c, a)), next = select(second, c, select(third, a, b)),
          last = select(second, a, select(third, b, c));
  fa = max(fa, zero);
  fb = max(fb, zero);
  fc = max(fc, zero);
  const V f = select(second, fb, select(third, fc, fa)), f_next = select(second, fc, select(third, fa, fb)),
          f_last = select(second, fa, select(third, fb, fc)), whole = fa + fb + fc;
  const auto inside = odd > zero, mixed = (inside && next <= zero) || (odd <= zero && next > zero);
  const V s = divide(odd, select(mixed, odd - next, one)), t = divide(odd, select(mixed, odd - last, one));
  const V part = s * (f_next - f) + t * (f_last - f) + number<V>(3) * f;
  const V cut_off = s * t * select(whole > zero, divide(part, select(whole > zero, whole, one)), one);
  return select(mixed, select(inside, cut_off, one - cut_off), select(inside, one, zero));
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

/// One cell's mean, and how it leans towards its second and third corner.
template <class V>
struct Cell {
  V mean, to_b, to_c;
};
/// From the corners' values, their mean and by how much the field's mean is above that.
template <class V>
inline Cell<V> raised_cell(V a, V b, V c, V level, V bubble) {
  const auto [mean, share] = positive_part(a + bubble, b + bubble, c + bubble, level + bubble);
  return {mean, share * (b - level), share * (c - level)};
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
    excess = excess + ((max(lead_a, zero) + max(lead_b, zero) + max(lead_c, zero)) * third - mean);
    bubble = (one - share) * bubble + share * bubble_of(k);
    most_a = max(most_a, a[k]);
    most_b = max(most_b, b[k]);
    most_c = max(most_c, c[k]);
  }
  return raised_cell(most_a, most_b, most_c, (most_a + most_b + most_c) * third, bubble - excess);
}

/// Sums over the cells of a lattice.
template <class V>
struct CellSums {
  V sum = number<V>(0), u = number<V>(0), v = number<V>(0), lean_u = number<V>(0), lean_v = number<V>(0);

  /// A share of the cell with its centroid at (u, v); `upright`: its sides run along u and v and not against.
  void add(V at_u, V at_v, bool upright, const Cell<V>& cell) {
    sum = sum + cell.mean;
    u = u + at_u * cell.mean;
    v = v + at_v * cell.mean;
    lean_u = upright ? lean_u + cell.to_b : lean_u - cell.to_b;
    lean_v = upright ? lean_v + cell.to_c : lean_v - cell.to_c;
  }
  [[nodiscard]] LatticeMoments<V> means(std::size_t steps) const {
    const V share(1.0f / static_cast<float>(steps * steps)), lean(1.0f / static_cast<float>(12 * steps));
    return {share * sum, share * (u + lean * lean_u), share * (v + lean * lean_v)};
  }
};
template <class V>
inline Cell<V> operator*(V share, const Cell<V>& cell) {
  return {share * cell.mean, share * cell.to_b, share * cell.to_c};
}

/// Goes through the cells row by row. `row(u)` is what a row's points have in common, `corner(row, v)` the
/// field at one of them, or the fields; `take(row, u, v, upright, a, b, c)` gets the row of a cell's centroid
/// (u, v) and the values at its corners.
template <class Value, class Row, class Corner, class Take>
LUMBRICAL_INLINE inline void for_cells(std::size_t steps, const Row& row, const Corner& corner,
                                       const Take& take) {
  constexpr float kThird = 1.0f / 3, kTwoThirds = 2.0f / 3;
  Value values[2][kMostSteps + 1];
  Value *above = values[0], *below = values[1];
  const float side = 1.0f / static_cast<float>(steps);
  const auto first = row(0.0f);
  for (std::size_t j = 0; j <= steps; ++j) above[j] = corner(first, side * static_cast<float>(j));
  for (std::size_t i = 0; i < steps; ++i) {
    const auto at = static_cast<float>(i);
    const float up = side * (at + kThird), down = side * (at + kTwoThirds);
    const auto up_row = row(up), down_row = row(down), next_row = row(side * (at + 1));
    below[0] = corner(next_row, 0.0f);
    const std::size_t last = steps - i - 1;
    for (std::size_t j = 0; j < last; ++j) {
      const auto v = static_cast<float>(j);
      below[j + 1] = corner(next_row, side * (v + 1));
      take(up_row, up, side * (v + kThird), true, above[j], below[j], above[j + 1]);
      take(down_row, down, side * (v + kTwoThirds), false, below[j + 1], above[j + 1], below[j]);
    }
    take(up_row, up, side * (static_cast<float>(last) + kThird), true, above[last], below[last],
         above[last + 1]);
    Value* const kept = above;
    above = below;
    below = kept;
  }
}

/// Moments of the positive part of a field: `row(u)` and `field(row, v)` as above.
template <class V, class Row, class Field>
LUMBRICAL_INLINE inline LatticeMoments<V> lattice_moments(std::size_t steps, const Row& row,
                                                          const Field& field) {
  CellSums<V> sums;
  for_cells<V>(steps, row, field,
               [&](const auto& at, float u, float v, bool upright, V a, V b, V c)
                   LUMBRICAL_INLINE { sums.add(V(u), V(v), upright, cell_of(a, b, c, field(at, v))); });
  return sums.means(steps);
}

}  // namespace lumbrical::LUMBRICAL_ISA
