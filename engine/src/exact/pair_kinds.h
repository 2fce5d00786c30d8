// Which kind a pair of a round primitive with a triangle is, one source for every instruction set. A lane is
// a pair; lanes never meet.
#pragma once

#include "exact/kind_terms.h"
#include "simd/wide_geometry.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class V>
inline V zone_number(RoundZone zone) {
  return number<V>(static_cast<double>(zone));
}

// The heights of the corners over a plane through the origin.
template <class V>
struct Heights {
  V of[3];
  V low, high;
};
template <class V>
inline Heights<V> heights_over(Wide3<V> normal, const Wide3<V> (&corner)[3]) {
  const V a = dot(normal, corner[0]), b = dot(normal, corner[1]), c = dot(normal, corner[2]);
  return {{a, b, c}, min(a, min(b, c)), max(a, max(b, c))};
}

// Are all corners inside the cone, which is the side?
template <class V>
inline auto is_whole(const KindTerms& terms, const Wide3<V> (&corner)[3], const Heights<V>& along) {
  const V square(terms.cosine * terms.cosine), radius1(terms.radius1), sine(terms.sine);
  const auto inside = [&](std::size_t i) {
    const V reach = radius1 - sine * along.of[i];
    return square * (dot(corner[i], corner[i]) - along.of[i] * along.of[i]) <= reach * reach;
  };
  return inside(0) && inside(1) && inside(2);
}

// The borders of the zones, lines in the triangle's plane, lie in two planes across the axis.
template <class V>
V zone_of(const KindTerms& terms, const Wide3<V> (&corner)[3]) {
  const Wide3<V> axis = in_all_lanes<V>(terms.axis);
  const Wide3<V> normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const V slope = dot(axis, normal), square = slope * slope, size = dot(normal, normal);
  const V flat(terms.flat), slanted(terms.slanted), first(terms.first), second(terms.second);
  const Heights<V> along = heights_over(axis, corner);
  V zone = select(square < slanted * slanted * size, zone_number<V>(RoundZone::slanted_side),
                  zone_number<V>(RoundZone::side));
  zone = select(is_whole(terms, corner, along), zone_number<V>(RoundZone::whole_side), zone);
  zone = select(along.high >= second, zone_number<V>(RoundZone::outer), zone);
  zone = select(along.low <= first, zone_number<V>(RoundZone::inner), zone);
  zone = select(along.high < first, zone_number<V>(RoundZone::first_end), zone);
  zone = select(along.low > second, zone_number<V>(RoundZone::second_end), zone);
  return select(square < flat * flat * size, zone_number<V>(RoundZone::flat), zone);
}

template <class V>
void pair_kinds(KindTerms& terms) {
  const V zero = number<V>(0), one = number<V>(1);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide3<V> corner[3] = {vector_at<V>(terms.a, i), vector_at<V>(terms.b, i), vector_at<V>(terms.c, i)};
    put(terms.zone + i, zone_of(terms, corner));
    for (std::size_t k = 0; k < 2; ++k) {
      const KindTerms::Border& border = terms.border[k];
      const V height(border.height), slab(border.slab);
      const Heights<V> reach = heights_over(in_all_lanes<V>(border.normal), corner);
      const auto near = reach.low - height <= slab && reach.high - height >= zero - slab;
      put(terms.near[k] + i, select(near, one, zero));
    }
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
