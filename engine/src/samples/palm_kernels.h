// What the palm feels of sixteen patches (sample_kernels.h): phi = radius - distance from the polygon.
#pragma once

#include "samples/lattice.h"
#include "samples/tile_field.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class V>
inline V palm_field(const PalmBody& palm, Wide3<V> p) {
  const V zero = number<V>(0);
  V out = number<V>(-1e30), square = number<V>(1e30);
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    const V x = p.x - V(palm.x[k]), y = p.y - V(palm.y[k]);
    const V beside = V(palm.out_x[k]) * x + V(palm.out_y[k]) * y;
    // Counterclockwise: the edge runs a quarter turn to the left of `out`.
    const V along = V(palm.out_x[k]) * y - V(palm.out_y[k]) * x;
    const V past = along - between(along, zero, V(palm.length[k]));
    out = greater(out, beside);
    square = lesser(square, beside * beside + past * past);
  }
  return V(palm.radius) - root(p.z * p.z + choose(out > zero, square, zero));
}

template <class V>
std::uint32_t palm_lattice(const PatchList& patches, const PalmBody& palm, std::size_t steps,
                           BodySums& sums) {
  std::uint32_t touched = 0;
  for_rows<V>(patches, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const PatchInFrame<V> patch = see_patch(rows, lane, palm.axis, Wide3<V>{V(0.0f), V(0.0f), V(0.0f)});
    const LatticeMoments<V> m =
        lattice_moments<V>(patch, steps, [&](Wide3<V> p) LUMBRICAL_INLINE { return palm_field(palm, p); });
    touched += count_of(add_share(patch, m, lane, sums));
  });
  return touched;
}

/// Zeroth and first moments of the positive part of the linear function with these values at the corners
/// (0, 0), (1, 0), (0, 1): exact.
template <class V>
inline LatticeMoments<V> linear_moments(V a, V b, V c) {
  const V zero = number<V>(0), one = number<V>(1), third = number<V>(1.0 / 3);
  // The corner whose sign is its own first; the others in turn.
  const auto b_alone = both(either(both(b > zero, c <= zero), both(b <= zero, c > zero)),
                            either(both(a > zero, c > zero), both(a <= zero, c <= zero)));
  const auto c_alone = both(either(both(c > zero, b <= zero), both(c <= zero, b > zero)),
                            either(both(a > zero, b > zero), both(a <= zero, b <= zero)));
  const V f = choose(b_alone, b, choose(c_alone, c, a)), g = choose(b_alone, c, choose(c_alone, a, b)),
          h = choose(b_alone, a, choose(c_alone, b, c));
  const Wide2<V> at_a{zero, zero}, at_b{one, zero}, at_c{zero, one};
  const Wide2<V> p = choose(b_alone, at_b, choose(c_alone, at_c, at_a)),
                 q = choose(b_alone, at_c, choose(c_alone, at_a, at_b)),
                 r = choose(b_alone, at_a, choose(c_alone, at_b, at_c));
  const auto inside = f > zero, mixed = either(both(inside, g <= zero), both(f <= zero, g > zero));
  const V to_g = f - g, to_h = f - h;
  const V s = choose(mixed, quotient(f, choose(mixed, to_g, one)), zero);
  const V t = choose(mixed, quotient(f, choose(mixed, to_h, one)), zero);
  // What the odd corner cuts off, with its sign; and the whole where that is the larger part.
  const V part = s * t * f * third;
  const Wide2<V> part_at = p + number<V>(0.25) * (s * (q - p) + t * (r - p));
  const V sum = (a + b + c) * third, twelfth = number<V>(1.0 / 12);
  const V sum_u = (a + b + b + c) * twelfth, sum_v = (a + b + c + c) * twelfth;
  const auto odd_inside = both(mixed, inside), whole = both(f > zero, g > zero);
  const auto none = both(f <= zero, g <= zero);
  const V base = choose(either(odd_inside, none), zero, sum),
          base_u = choose(either(odd_inside, none), zero, sum_u),
          base_v = choose(either(odd_inside, none), zero, sum_v);
  const V sign = choose(odd_inside, one, choose(whole, zero, zero - one));
  return {base + sign * part, base_u + sign * part * part_at.x, base_v + sign * part * part_at.y};
}

template <class V>
std::uint32_t palm_side(const PatchList& patches, const PalmBody& palm, BodySums& sums) {
  std::uint32_t touched = 0;
  for_rows<V>(patches, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const PatchInFrame<V> patch = see_patch(rows, lane, palm.axis, Wide3<V>{V(0.0f), V(0.0f), V(0.0f)});
    const V a = V(palm.radius) - magnitude(patch.corner.z);
    const V b = V(palm.radius) - magnitude(patch.corner.z + patch.edge1.z);
    const V c = V(palm.radius) - magnitude(patch.corner.z + patch.edge2.z);
    touched += count_of(add_share(patch, linear_moments(a, b, c), lane, sums));
  });
  return touched;
}

}  // namespace lumbrical::LUMBRICAL_ISA
