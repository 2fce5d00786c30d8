// What the palm feels of sixteen patches (sample_kernels.h): phi = radius - distance from the polygon.
#pragma once

#include "samples/patch_rows.h"

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
    const V past = along - clamp(along, zero, V(palm.length[k]));
    out = max(out, beside);
    square = min(square, beside * beside + past * past);
  }
  return V(palm.radius) - sqrt(p.z * p.z + select(out > zero, square, zero));
}

/// Adds the shares of all patches to the palm's sums: `moments_of(patch)` from its frame.
template <class V, class Moments>
LUMBRICAL_INLINE inline std::uint32_t sum_patches(const PatchList& list, const PalmBody& palm, BodySums& sums,
                                                  const Moments& moments_of) {
  std::uint32_t touched = 0;
  for_rows<V>(list, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const PatchInFrame<V> patch = see_patch(rows, lane, palm.axis, Wide3<V>{V(0.0f), V(0.0f), V(0.0f)});
    const auto [force, moment] = share_of(patch, moments_of(patch));
    add_wrench(force, moment, lane, sums);
    touched += count_of(lanes_with(force));
  });
  return touched;
}

/// Patches beside one edge of the polygon, in the plane across it: how far beyond the edge, and how high.
template <class V>
struct EdgeRows {
  V radius;
  Wide2<V> corner, edge1, edge2;

  EdgeRows(const PalmBody& palm, const PatchInFrame<V>& patch) : radius(palm.radius) {
    const Wide3<V> centre = patch.corner + number<V>(1.0 / 3) * (patch.edge1 + patch.edge2);
    V most = number<V>(-1e30), out_x = most, out_y = most, offset = most;
    for (std::size_t k = 0; k < palm.corner_count; ++k) {
      const V x(palm.out_x[k]), y(palm.out_y[k]),
          of_edge(palm.out_x[k] * palm.x[k] + palm.out_y[k] * palm.y[k]);
      const V beside = x * centre.x + y * centre.y - of_edge;
      const auto is_farther = beside > most;
      most = select(is_farther, beside, most);
      out_x = select(is_farther, x, out_x);
      out_y = select(is_farther, y, out_y);
      offset = select(is_farther, of_edge, offset);
    }
    const auto across = [&](Wide3<V> p) { return Wide2<V>{out_x * p.x + out_y * p.y, p.z}; };
    corner = across(patch.corner);
    corner.x = corner.x - offset;
    edge1 = across(patch.edge1);
    edge2 = across(patch.edge2);
  }
  [[nodiscard]] Wide2<V> row(V u) const { return corner + u * edge1; }
  [[nodiscard]] V field(Wide2<V> row, V v) const {
    const Wide2<V> p = row + v * edge2;
    const V beyond = max(p.x, number<V>(0));
    return radius - sqrt(beyond * beyond + p.y * p.y);
  }
};

template <class V>
std::uint32_t palm_edge_lattice(const PatchList& list, const PalmBody& palm, std::size_t steps,
                                BodySums& sums) {
  return sum_patches<V>(list, palm, sums, [&](const PatchInFrame<V>& patch) LUMBRICAL_INLINE {
    const EdgeRows<V> edge(palm, patch);
    return lattice_moments<V>(
        steps, [&](float u) LUMBRICAL_INLINE { return edge.row(V(u)); },
        [&](Wide2<V> row, float v) LUMBRICAL_INLINE { return edge.field(row, V(v)); });
  });
}

template <class V>
std::uint32_t palm_lattice(const PatchList& list, const PalmBody& palm, std::size_t steps, BodySums& sums) {
  return sum_patches<V>(list, palm, sums, [&](const PatchInFrame<V>& patch) LUMBRICAL_INLINE {
    return lattice_moments<V>(
        steps, [&](float u) LUMBRICAL_INLINE { return patch.corner + V(u) * patch.edge1; },
        [&](Wide3<V> row, float v) LUMBRICAL_INLINE { return palm_field(palm, row + V(v) * patch.edge2); });
  });
}

/// Zeroth and first moments of the positive part of the linear function with these values at the corners
/// (0, 0), (1, 0), (0, 1): exact.
template <class V>
LUMBRICAL_INLINE inline LatticeMoments<V> linear_moments(V a, V b, V c) {
  const V zero = number<V>(0), one = number<V>(1), third = number<V>(1.0 / 3);
  const auto [b_alone, c_alone] = odd_corner(a, b, c);
  const V f = select(b_alone, b, select(c_alone, c, a)), g = select(b_alone, c, select(c_alone, a, b)),
          h = select(b_alone, a, select(c_alone, b, c));
  const Wide2<V> at_a{zero, zero}, at_b{one, zero}, at_c{zero, one};
  const Wide2<V> p = select(b_alone, at_b, select(c_alone, at_c, at_a)),
                 q = select(b_alone, at_c, select(c_alone, at_a, at_b)),
                 r = select(b_alone, at_a, select(c_alone, at_b, at_c));
  const auto inside = f > zero, mixed = (inside && g <= zero) || (f <= zero && g > zero);
  const V to_g = f - g, to_h = f - h;
  const V s = select(mixed, divide(f, select(mixed, to_g, one)), zero);
  const V t = select(mixed, divide(f, select(mixed, to_h, one)), zero);
  // What the odd corner cuts off, with its sign; and the whole where that is the larger part.
  const V part = s * t * f * third;
  const Wide2<V> part_at = p + number<V>(0.25) * (s * (q - p) + t * (r - p));
  const V sum = (a + b + c) * third, twelfth = number<V>(1.0 / 12);
  const V sum_u = (a + b + b + c) * twelfth, sum_v = (a + b + c + c) * twelfth;
  const auto odd_inside = mixed && inside, whole = f > zero && g > zero;
  const auto none = f <= zero && g <= zero;
  const V base = select(odd_inside || none, zero, sum), base_u = select(odd_inside || none, zero, sum_u),
          base_v = select(odd_inside || none, zero, sum_v);
  const V sign = select(odd_inside, one, select(whole, zero, zero - one));
  return {base + sign * part, base_u + sign * part * part_at.x, base_v + sign * part * part_at.y};
}

template <class V>
std::uint32_t palm_side(const PatchList& list, const PalmBody& palm, BodySums& sums) {
  return sum_patches<V>(list, palm, sums, [&](const PatchInFrame<V>& patch) LUMBRICAL_INLINE {
    const V a = V(palm.radius) - abs(patch.corner.z);
    const V b = V(palm.radius) - abs(patch.corner.z + patch.edge1.z);
    const V c = V(palm.radius) - abs(patch.corner.z + patch.edge2.z);
    return linear_moments(a, b, c);
  });
}

/// The positive part of radius - |z| is that of radius - z, less twice that of -z, and that of -z - radius.
template <class V>
std::uint32_t palm_through(const PatchList& list, const PalmBody& palm, BodySums& sums) {
  return sum_patches<V>(list, palm, sums, [&](const PatchInFrame<V>& patch) LUMBRICAL_INLINE {
    const V zero = number<V>(0), radius(palm.radius);
    const V a = zero - patch.corner.z, b = a - patch.edge1.z, c = a - patch.edge2.z;
    LatticeMoments<V> m = linear_moments(radius + a, radius + b, radius + c);
    const LatticeMoments<V> middle = linear_moments(a, b, c),
                            below = linear_moments(a - radius, b - radius, c - radius);
    add_to(m, below.sum - (middle.sum + middle.sum), below.u - (middle.u + middle.u),
           below.v - (middle.v + middle.v));
    return m;
  });
}

}  // namespace lumbrical::LUMBRICAL_ISA
