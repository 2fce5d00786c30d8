// The narrowphase of round primitives under `max-depth` and `point`, from triangle to contact, one source for
// every instruction set: area, its centroid, and the largest depth in the primitive itself. A lane is a pair;
// lanes never meet.
#pragma once

#include "exact/round_depth.h"
#include "exact/round_section.h"

namespace lumbrical::LUMBRICAL_ISA {

// Area and first moments of the part of the polygon in the section; `lost` is 1 where they could not be had.
template <class V, class M>
Moments<V> section_area(const RoundPair<V>& pair, const SideView<V>& side, M wanted,
                        Directions<V>& directions, InsideParts<V>& inside, V& lost) {
  Moments<V> sum = no_moments<V>();
  const auto end = [&](const Polygon<V>& here, V x0, V radius, V height) {
    add_disc(here, directions, x0, radius, height, wanted, sum, inside, [](const Chord<V>& chord, V, V rho2) {
      Moments<V> moments = no_moments<V>();
      area_of(chord, rho2, moments);
      return moments;
    });
  };
  const auto between = [&](const Polygon<V>& here) {
    const auto had = add_side_area(side, here, directions, wanted, sum, inside);
    lost = select(had, number<V>(0), number<V>(1));
  };
  over_zones(pair, side, wanted, directions, end, between);
  return sum;
}

template <class V>
void paper_contacts(RoundTerms& terms) {
  const V zero = number<V>(0);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const RoundPair<V> pair = pair_at<V>(terms, i);
    const auto& [part, plane, polygon, all, along_cut, met, whole] = pair;
    const V r = part.radius1;
    const auto large = whole || all.size >= number<V>(kSmall) * r;
    const auto closed = met && large && has_deepest_point(part, plane, terms.flat);
    const auto rimmed = closed && is_not(whole);

    const SideView<V> side = part.sphere ? SideView<V>{} : side_of(part, plane);
    Directions<V> directions = directions_of(polygon);
    InsideParts<V> inside = inside_parts(polygon, directions, whole);
    Moments<V> sum = no_moments<V>();
    V lost = zero;
    if (any(rimmed)) sum = section_area(pair, side, rimmed, directions, inside, lost);
    take_whole(all, whole, sum);

    const V least = least_area(all, whole, r);
    const auto had = closed && (whole || lost == zero), contact = had && sum.area > least;
    const Deepest<V> deepest = largest_depth(part, plane, side, polygon, directions, inside, contact);
    put(terms.status + i, status_of(met, had, contact, along_cut, number<V>(kContact)));
    put_contact(plane, sum, deepest.depth, zero, middle_of(sum.area, sum.area_x, sum.area_y), deepest.point,
                i, terms);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
