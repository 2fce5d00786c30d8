// What a polygon and a round primitive's section have in common, as far as all laws want it: corners, zones,
// the parts of edges inside, and where the finds go.
#pragma once

#include "base/always_inline.h"
#include "exact/cone_integrals.h"

namespace lumbrical::LUMBRICAL_ISA {

// Polygons of less than this share of R drown in the section's scale.
inline constexpr double kSmall = 0.006;
// Of the section's scale times the polygon's: rounding leaves less of nothing.
inline constexpr double kLeastArea = 1e-13;

// Corners of a polygon: box round them, area and first moments, and whether all are inside the section.
template <class V>
struct PolygonBounds {
  V low_x, low_y, high_x, high_y, size, outside;  // outside: 1 if any corner is
  V area, area_x, area_y;
};

template <class V>
PolygonBounds<V> bounds_of(const RoundPart<V>& part, const RoundPlane<V>& plane, const Polygon<V>& polygon) {
  const V zero = number<V>(0), one = number<V>(1), far = beyond<V>();
  PolygonBounds<V> all{far, far, zero - far, zero - far, zero, zero, zero, zero, zero};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const auto here = has_length(polygon.edge[i]);
    if (!any(here)) continue;
    const Wide2<V> p = polygon.edge[i].p;
    all.low_x = select(here, min(all.low_x, p.x), all.low_x);
    all.low_y = select(here, min(all.low_y, p.y), all.low_y);
    all.high_x = select(here, max(all.high_x, p.x), all.high_x);
    all.high_y = select(here, max(all.high_y, p.y), all.high_y);
    all.outside = select(here && is_outside(part, plane, p), one, all.outside);
  }
  const V dx = all.high_x - all.low_x, dy = all.high_y - all.low_y;
  all.size = sqrt(max(dx * dx + dy * dy, zero));
  const Moments<V> whole = area_of(polygon, Wide2<V>{all.low_x, all.low_y});
  all.area = whole.area;
  all.area_x = whole.area_x;
  all.area_y = whole.area_y;
  return all;
}

// A pair per lane, seen from the triangles' planes.
template <class V>
struct RoundPair {
  using Mask = decltype(V() < V());
  RoundPart<V> part;
  RoundPlane<V> plane;
  Polygon<V> polygon;
  PolygonBounds<V> all;
  Mask along_cut;   // it all but lies in one of the cuts, so that another way has to be taken
  Mask met, whole;  // polygon and section may meet; all of the polygon lies inside
};
template <class V>
RoundPair<V> pair_at(const RoundTerms& terms, std::size_t i) {
  RoundPair<V> pair;
  const V zero = number<V>(0);
  pair.part = part_of<V>(terms, i);
  const Wide3<V> corner[3] = {vector_at<V>(terms.a, i), vector_at<V>(terms.b, i), vector_at<V>(terms.c, i)};
  const auto fine = look(pair.part, vector_at<V>(terms.axis, i), corner[0], corner[1], corner[2], pair.plane);
  const V along_cut = set_polygon(terms, pair.part, pair.plane, corner, i, pair.polygon);
  pair.along_cut = fine && along_cut > zero;
  pair.all = bounds_of(pair.part, pair.plane, pair.polygon);
  const V r = pair.part.radius1;
  pair.met = fine && pair.all.low_y < r && pair.all.high_y > zero - r;
  pair.whole = pair.met && pair.all.outside == zero;
  return pair;
}

// Of an axis nearly along the plane an end that is through it would leave no digits to the deepest point.
template <class V>
inline auto has_deepest_point(const RoundPart<V>& part, const RoundPlane<V>& plane, bool flat) {
  const V zero = number<V>(0), through = flat ? zero : zero - beyond<V>();
  return plane.h1 + part.radius1 > through && plane.h2 + part.radius2 > through;
}

// The area of polygons wholly inside is known.
template <class V, class M>
LUMBRICAL_INLINE inline void take_whole(const PolygonBounds<V>& all, M whole, Moments<V>& sum) {
  sum.area = select(whole, all.area, sum.area);
  sum.area_x = select(whole, all.area_x, sum.area_x);
  sum.area_y = select(whole, all.area_y, sum.area_y);
}

// What an area has to exceed.
template <class V, class M>
LUMBRICAL_INLINE inline V least_area(const PolygonBounds<V>& all, M whole, V radius) {
  return select(whole, number<V>(0), number<V>(kLeastArea) * (radius * min(radius, all.size)));
}

// What became of a pair that was `open`, whose integrals were `had`: `found` if it is a contact.
template <class V, class M>
LUMBRICAL_INLINE inline V status_of(M open, M had, M contact, M along_cut, V found) {
  const V zero = number<V>(0), unclear = number<V>(kUnclear);
  const V left = select(had, zero, select(open, unclear, zero));
  return select(along_cut, unclear, select(contact, found, left));
}

// Of edges wholly inside everything counts.
template <class V, class M>
InsideParts<V> inside_parts(const Polygon<V>& polygon, const Directions<V>& directions, M whole) {
  InsideParts<V> inside;
  inside.count = polygon.count;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const Wide2<V> t = directions.t[k];
    inside.lower[k] = select(whole, dot(polygon.edge[k].p, t), beyond<V>());
    inside.upper[k] = select(whole, dot(polygon.edge[k].q, t), number<V>(0) - beyond<V>());
  }
  return inside;
}

// The polygon by zones: end(polygon, x, radius, height) of what lies where a sphere's field is the hull's,
// the first end's or the second's, and between(polygon) of the rest. Nothing is parted off where no lane has
// any of it. Of what is handed over `directions` are the edges'.
template <class V, class M, class End, class Between>
void over_zones(const RoundPair<V>& pair, const SideView<V>& side, M wanted, Directions<V>& directions,
                const End& end, const Between& between) {
  const auto& [part, plane, polygon, all, along_cut, met, whole] = pair;
  const V zero = number<V>(0);
  if (part.sphere) return end(polygon, zero, part.radius1, plane.h1);
  Polygon<V> beyond_border, beside, between_ends;
  const Polygon<V>* rest = &polygon;
  const std::size_t count = polygon.count;
  if (any(wanted && all.low_x <= above_border(side.border1, part.radius1))) {
    part_at(side.border1, part.radius1, *rest, beyond_border, beside);
    rest = &beside;
    set_upright(beyond_border, count, directions);
    end(beyond_border, zero, part.radius1, plane.h1);
    set_upright(beside, count, directions);
  }
  if (any(wanted && all.high_x > above_border(side.border2, part.radius1))) {
    part_at(side.border2, part.radius1, *rest, between_ends, beyond_border);
    rest = &between_ends;
    set_upright(beyond_border, count, directions);
    end(beyond_border, plane.x2, part.radius2, plane.h2);
    set_upright(between_ends, count, directions);
  }
  between(*rest);
}

template <class V>
inline Wide3<V> in_space(const RoundPlane<V>& plane, V x, V y) {
  return x * plane.u + y * plane.v - plane.h1 * plane.n;
}

// Divided by their integral first moments are a point.
template <class V>
inline Wide2<V> middle_of(V integral, V x, V y) {
  const V per = one_over(integral);
  return {x * per, y * per};
}

// What was found of a pair but its status, as points of the plane.
template <class V>
void put_contact(const RoundPlane<V>& plane, const Moments<V>& sum, V depth, V error, Wide2<V> centroid,
                 Wide2<V> centre, std::size_t i, RoundTerms& terms) {
  const V zero = number<V>(0);
  put(terms.area + i, sum.area);
  put(terms.volume + i, max(sum.volume, zero));
  put(terms.depth + i, max(depth, zero));
  put(terms.error + i, error);
  put_vector(plane.n, i, terms.normal);
  put_vector(in_space(plane, centroid.x, centroid.y), i, terms.centroid);
  put_vector(in_space(plane, centre.x, centre.y), i, terms.centre);
}

}  // namespace lumbrical::LUMBRICAL_ISA
