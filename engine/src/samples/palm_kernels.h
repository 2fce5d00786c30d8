// What the palm feels of sixteen patches (sample_kernels.h): phi = radius - distance from the polygon.
#pragma once

#include "samples/patch_rows.h"

namespace lumbrical::LUMBRICAL_ISA {

/// How far a point of the polygon's plane is beyond the line of an edge, and past the edge along it; and the
/// square of how far from the edge.
template <class V>
struct FromEdge {
  V beside, past, square;
};
template <class V>
LUMBRICAL_INLINE inline FromEdge<V> from_edge(const PalmEdge& edge, Wide3<V> p) {
  const V x = p.x - V(edge.x), y = p.y - V(edge.y);
  const V beside = V(edge.out_x) * x + V(edge.out_y) * y, along = V(edge.out_x) * y - V(edge.out_y) * x;
  const V past = along - clamp(along, number<V>(0), V(edge.length));
  return {beside, past, beside * beside + past * past};
}

/// phi where the farthest of the edges is `out` away and the nearest sqrt(square).
template <class V>
inline V palm_field(float radius, V out, V square, V height) {
  const V zero = number<V>(0);
  return V(radius) - sqrt(height * height + select(out > zero, square, zero));
}
template <class V>
inline V palm_field(const PalmBody& palm, Wide3<V> p) {
  V out = number<V>(-1e30), square = number<V>(1e30);
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    const FromEdge<V> from = from_edge(palm.edge[k], p);
    out = max(out, from.beside);
    square = min(square, from.square);
  }
  return palm_field(palm.radius, out, square, p.z);
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

/// The palm for patches of a register: edges that no point of any of them is nearest to are left out.
template <class V>
struct PalmNearby {
  const PalmBody& palm;
  std::size_t count = 0;
  const PalmEdge* edge[PalmBody::kMostCorners];
  V most[PalmBody::kMostCorners];  // a bound of what it is asked about being outside: low where it is not
                                   // near

  PalmNearby(const PalmBody& whole, const PatchInFrame<V>& patch) : palm(whole) {
    constexpr double kSlack = 1e-4;  // of the radius
    const Wide3<V> centre = patch.corner + number<V>(1.0 / 3) * (patch.edge1 + patch.edge2);
    V square[PalmBody::kMostCorners], least = number<V>(1e30);
    for (std::size_t k = 0; k < palm.corner_count; ++k) {
      square[k] = from_edge(palm.edge[k], centre).square;
      least = min(least, square[k]);
    }
    const V reach = sqrt(least) + (number<V>(2.001) * size_of(patch) + number<V>(kSlack) * V(palm.radius));
    for (std::size_t k = 0; k < palm.corner_count; ++k) {
      const auto is_near = square[k] <= reach * reach;
      if (!any(is_near)) continue;
      most[count] = select(is_near, number<V>(1e30), number<V>(-1e30));
      edge[count++] = &palm.edge[k];
    }
  }
  [[nodiscard]] LUMBRICAL_INLINE V field(Wide3<V> p) const {
    V out = number<V>(-1e30), square = number<V>(1e30);
    for (std::size_t k = 0; k < count; ++k) {
      const FromEdge<V> from = from_edge(*edge[k], p);
      out = max(out, min(from.beside, most[k]));
      square = min(square, from.square);
    }
    return palm_field(palm.radius, out, square, p.z);
  }
};

template <class V>
std::uint32_t palm_lattice(const PatchList& list, const PalmBody& palm, BodySums& sums) {
  const std::size_t steps = steps_of_lane(list);
  return sum_patches<V>(list, palm, sums, [&](const PatchInFrame<V>& patch) LUMBRICAL_INLINE {
    const PalmNearby<V> nearby(palm, patch);
    return lattice_moments<V>(
        steps, [&](float u) LUMBRICAL_INLINE { return patch.corner + V(u) * patch.edge1; },
        [&](Wide3<V> row, float v) LUMBRICAL_INLINE { return nearby.field(row + V(v) * patch.edge2); });
  });
}

/// Zeroth and first moments of the positive part of the linear function with these values at the corners
/// (0, 0), (1, 0), (0, 1): exact.
template <class V>
LUMBRICAL_INLINE inline LatticeMoments<V> linear_moments(V a, V b, V c) {
  const V zero = number<V>(0), one = number<V>(1), third = number<V>(1.0 / 3);
  const auto [b_alone, c_alone, mixed] = odd_corner(a, b, c);
  const V f = select(b_alone, b, select(c_alone, c, a)), g = select(b_alone, c, select(c_alone, a, b)),
          h = select(b_alone, a, select(c_alone, b, c));
  const Wide2<V> at_a{zero, zero}, at_b{one, zero}, at_c{zero, one};
  const Wide2<V> p = select(b_alone, at_b, select(c_alone, at_c, at_a)),
                 q = select(b_alone, at_c, select(c_alone, at_a, at_b)),
                 r = select(b_alone, at_a, select(c_alone, at_b, at_c));
  const auto inside = f > zero;
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
