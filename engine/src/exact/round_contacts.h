// The narrowphase of round primitives under the field law, from triangle to contact, one source for every
// instruction set. A lane is a pair; lanes never meet.
#pragma once

#include "exact/flat_side.h"
#include "exact/point_rules.h"
#include "exact/round_depth.h"
#include "exact/round_section.h"
#include "section/stated_errors.h"

namespace lumbrical::LUMBRICAL_ISA {

// On the side of a capsule digits are lost where no point of the region has more than this share of R.
inline constexpr double kShallowSide = 1e-3;
// At exact precision points are for triangles up to this share of R. Larger ones take so many points, and
// share registers with so many that need the closed form besides, that a dense mesh's tick would get slower.
inline constexpr double kByPoints = 0.12;

// The largest phi of the whole section, or more.
template <class V>
inline V most_of(const RoundPart<V>& part, const RoundPlane<V>& plane) {
  const V first = part.radius1 - abs(plane.h1), second = part.radius2 - abs(plane.h2);
  if (part.sphere) return first;
  return select(plane.h1 * plane.h2 > number<V>(0), max(first, second), part.radius1);
}

// Where the closed form loses no digits.
template <class V>
inline auto keeps_digits(const RoundPart<V>& part, const RoundPlane<V>& plane, const SideView<V>& side,
                         V most, V size, bool flat) {
  const auto large = size >= number<V>(kSmall) * part.radius1;
  if (part.sphere) return large;
  const auto deep = large && most >= number<V>(kShallowSide) * part.radius1;
  if (flat) return deep && has_deepest_point(part, plane, flat);
  const double least = part.cone ? kFlatCosineCone : kFlatCosine;
  return deep && side.c >= number<V>(least);
}

// The integrals over the part of the polygon in the section, by zones; `lost` is 1 where they could not be
// had.
template <class V, class M>
Moments<V> section_moments(const RoundPair<V>& pair, const SideView<V>& side, V most, bool flat, M wanted,
                           Directions<V>& directions, InsideParts<V>& inside, V& lost) {
  Moments<V> sum = no_moments<V>();
  const auto end = [&](const Polygon<V>& here, V x0, V radius, V height) {
    add_disc(here, directions, x0, radius, height, wanted, sum, inside,
             [&](const Chord<V>& chord, V h, V rho2) { return disc_moments(chord, radius, h, rho2, most); });
  };
  const auto between = [&](const Polygon<V>& here) {
    const auto had = flat ? add_flat_side(pair.part, pair.plane, side, here, directions, wanted, sum, inside)
                          : add_side(pair.part, side, here, directions, wanted, pair.whole, sum, inside);
    lost = select(had, number<V>(0), number<V>(1));
  };
  over_zones(pair, side, wanted, directions, end, between);
  return sum;
}

// May the polygon reach the part of an end's zone where the cone's field is the other formula's? It lies
// between the conic's first abscissa, where q = tan(alpha) |e|, and the zone's border, at which it is widest
// where the conic is a hyperbola: see cone_slivers.h.
template <class V>
inline auto meets_sliver(const RoundPart<V>& part, const RoundPlane<V>& plane, V at, V h, V border,
                         const PolygonBounds<V>& all) {
  const V zero = number<V>(0), t = part.tangent;
  V lower = zero - beyond<V>(), hyperbola = number<V>(1);
  for (const V sign : {t, zero - t}) {
    const V a = plane.s - sign * plane.c, b = h * (plane.c + sign * plane.s);
    lower = select(a > zero, max(lower, at + b * one_over(a)), lower);
    hyperbola = select(a > zero, hyperbola, zero);
  }
  const V x = border - at, q = plane.s * x - plane.c * h, e = plane.c * x + plane.s * h;
  const V y = max(zero, max(all.low_y, zero - all.high_y));  // of the box's points, nearest to 0
  const auto wide = hyperbola == zero || q * q > t * t * (e * e + y * y);
  return lower < border && wide && all.low_x < border && all.high_x > lower;
}

template <class V>
inline auto meets_slivers(const RoundPart<V>& part, const RoundPlane<V>& plane, const SideView<V>& side,
                          const PolygonBounds<V>& all) {
  return meets_sliver(part, plane, number<V>(0), plane.h1, side.border1, all) ||
         meets_sliver(part, plane, plane.x2, plane.h2, side.border2, all);
}

// Integrals of the lanes whose polygon lies wholly inside and for which points will do; `error` is over the
// area and beyond `limit` elsewhere.
template <class V>
PointSum<V> whole_by_points(const RoundPair<V>& pair, V limit) {
  const auto& [part, plane, polygon, all, along_cut, met, whole] = pair;
  const V zero = number<V>(0), one = number<V>(1);
  if (!any(whole && limit > zero)) return {zero, zero, zero, beyond<V>()};
  V cut = zero;
  for (std::size_t k = 3; k < polygon.count; ++k) cut = select(has_length(polygon.edge[k]), one, cut);
  const V per_area = one_over(all.area);
  return by_points(part, plane, polygon, Wide2<V>{all.area_x * per_area, all.area_y * per_area},
                   whole && cut == zero, limit);
}

template <class V>
void round_contacts(RoundTerms& terms) {
  const V zero = number<V>(0);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const RoundPair<V> pair = pair_at<V>(terms, i);
    const auto& [part, plane, polygon, all, along_cut, met, whole] = pair;
    const V r = part.radius1;
    const V exactness = number<V>(terms.flat ? kFlatError : kDiscError) * (r * r * r);

    const auto small = all.size <= number<V>(kByPoints) * r;
    const V limit = select(small, number<V>(kPointwise) * r, zero);
    const PointSum<V> points = whole_by_points(pair, limit);
    const auto pointwise = whole && limit > zero && points.error <= limit;
    const auto open = met && (all.outside > zero || limit <= zero || points.error > limit);
    const SideView<V> side = part.sphere ? SideView<V>{} : side_of(part, plane);
    const V most = most_of(part, plane);
    const auto closed = open && keeps_digits(part, plane, side, most, all.size, terms.flat);

    Directions<V> directions = directions_of(polygon);
    InsideParts<V> inside;  // only depths are asked of them
    if (terms.depths) inside = inside_parts(polygon, directions, whole);
    Moments<V> sum = no_moments<V>();
    V lost = zero;
    if (any(closed)) sum = section_moments(pair, side, most, terms.flat, closed, directions, inside, lost);
    take_whole(all, whole, sum);
    sum.volume = select(pointwise, points.volume * all.area, sum.volume);
    sum.volume_x = select(pointwise, points.volume_x * all.area, sum.volume_x);
    sum.volume_y = select(pointwise, points.volume_y * all.area, sum.volume_y);

    const V least = least_area(all, whole, r);
    const V error = select(pointwise, points.error * all.area + rounded_off(r, all.size), exactness) +
                    plane.rounded * sum.area;
    const auto had = closed && lost == zero, contact = (pointwise || had) && sum.area > least;
    const V depth =
        terms.depths ? largest_depth(part, plane, side, polygon, directions, inside, contact).depth : zero;
    V found = number<V>(kContact);
    if (part.cone) found = select(had && meets_slivers(part, plane, side, all), number<V>(kSlivers), found);
    put(terms.status + i, status_of(open, had, contact, along_cut, found));
    const Wide2<V> centroid = middle_of(sum.area, sum.area_x, sum.area_y);
    const Wide2<V> pressed = middle_of(sum.volume, sum.volume_x, sum.volume_y);
    put_contact(plane, sum, depth, error, centroid, select(sum.volume > zero, pressed, centroid), i, terms);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
