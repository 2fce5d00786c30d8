// The narrowphase of round primitives under the field law, from triangle to contact, one source for every
// instruction set. A lane is a pair; lanes never meet.
#pragma once

#include "exact/flat_side.h"
#include "exact/point_rules.h"
#include "exact/round_depth.h"
#include "section/stated_errors.h"

namespace lumbrical::LUMBRICAL_ISA {

// On the side of a capsule digits are lost where no point of the region has more than this share of R.
inline constexpr double kShallowSide = 1e-3;
// Polygons of less than this share of R drown in the section's scale.
inline constexpr double kSmall = 0.006;
// At exact precision points are for triangles up to this share of R. Larger ones take so many points, and
// share registers with so many that need the closed form besides, that a dense mesh's tick would get slower.
inline constexpr double kByPoints = 0.12;
// Of the section's scale times the polygon's: rounding leaves less of nothing.
inline constexpr double kLeastArea = 1e-13;

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
  // Of a flat pair an end that is through the plane would leave no digits to the deepest point.
  const V zero = number<V>(0);
  if (flat) return deep && plane.h1 + part.radius1 > zero && plane.h2 + part.radius2 > zero;
  const double least = part.cone ? kFlatCosineCone : kFlatCosine;
  return deep && side.c >= number<V>(least);
}

// Corners of a polygon: box round them, area and first moments, and whether all are inside the section.
template <class V>
struct Corners {
  V low_x, low_y, high_x, high_y, size, outside;  // outside: 1 if any corner is
  V area, area_x, area_y;
};

template <class V>
Corners<V> corners_of(const RoundPart<V>& part, const RoundPlane<V>& plane, const Polygon<V>& polygon) {
  const V zero = number<V>(0), one = number<V>(1), far = beyond<V>();
  Corners<V> all{far, far, zero - far, zero - far, zero, zero, zero, zero, zero};
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

// The integrals over the part of the polygon in the section, by zones; `lost` is 1 where they could not be
// had.
template <class V, class M>
Moments<V> section_moments(const RoundPart<V>& part, const RoundPlane<V>& plane, const SideView<V>& side,
                           const Polygon<V>& polygon, const Corners<V>& all, V most, bool flat, M wanted,
                           M whole, Directions<V>& directions, InsideParts<V>& inside, V& lost) {
  const V zero = number<V>(0);
  Moments<V> sum = no_moments<V>();
  if (part.sphere) {
    add_disc(polygon, directions, zero, part.radius1, plane.h1, most, wanted, sum, inside);
    return sum;
  }
  // Nothing is parted off where no lane has any of it.
  Polygon<V> end, beside, between_ends;
  const Polygon<V>* rest = &polygon;
  const std::size_t count = polygon.count;
  if (any(wanted && all.low_x <= above_border(side.border1, part.radius1))) {
    part_at(side.border1, part.radius1, *rest, end, beside);
    rest = &beside;
    set_upright(end, count, directions);
    add_disc(end, directions, zero, part.radius1, plane.h1, most, wanted, sum, inside);
    set_upright(beside, count, directions);
  }
  if (any(wanted && all.high_x > above_border(side.border2, part.radius1))) {
    part_at(side.border2, part.radius1, *rest, between_ends, end);
    rest = &between_ends;
    set_upright(end, count, directions);
    add_disc(end, directions, plane.x2, part.radius2, plane.h2, most, wanted, sum, inside);
    set_upright(between_ends, count, directions);
  }
  const auto had = flat ? add_flat_side(part, plane, side, *rest, directions, wanted, sum, inside)
                        : add_side(part, side, *rest, directions, wanted, whole, sum, inside);
  lost = select(had, zero, number<V>(1));
  return sum;
}

template <class V>
inline Wide3<V> in_space(const RoundPlane<V>& plane, V x, V y) {
  return x * plane.u + y * plane.v - plane.h1 * plane.n;
}

// May the polygon reach the part of an end's zone where the cone's field is the other formula's? It lies
// between the conic's first abscissa, where q = tan(alpha) |e|, and the zone's border, at which it is widest
// where the conic is a hyperbola: see cone_slivers.h.
template <class V>
inline auto meets_sliver(const RoundPart<V>& part, const RoundPlane<V>& plane, V at, V h, V border,
                         const Corners<V>& all) {
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
                          const Corners<V>& all) {
  return meets_sliver(part, plane, number<V>(0), plane.h1, side.border1, all) ||
         meets_sliver(part, plane, plane.x2, plane.h2, side.border2, all);
}

// Integrals of the lanes whose polygon lies wholly inside and for which points will do; `error` is over the
// area and beyond `limit` elsewhere.
template <class V, class M>
PointSum<V> whole_by_points(const RoundPart<V>& part, const RoundPlane<V>& plane, const Polygon<V>& polygon,
                            const Corners<V>& all, M whole, V limit) {
  const V zero = number<V>(0), one = number<V>(1);
  if (!any(whole && limit > zero)) return {zero, zero, zero, beyond<V>()};
  V cut = zero;
  for (std::size_t k = 3; k < polygon.count; ++k) cut = select(has_length(polygon.edge[k]), one, cut);
  const V per_area = one_over(all.area);
  return by_points(part, plane, polygon, Wide2<V>{all.area_x * per_area, all.area_y * per_area},
                   whole && cut == zero, limit);
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

template <class V>
void put_contact(const RoundPlane<V>& plane, const Moments<V>& sum, V depth, V error, std::size_t i,
                 RoundTerms& terms) {
  const V zero = number<V>(0);
  put(terms.area + i, sum.area);
  put(terms.volume + i, max(sum.volume, zero));
  put(terms.depth + i, max(depth, zero));
  put(terms.error + i, error);
  put_vector(plane.n, i, terms.normal);
  const V per_area = one_over(sum.area), per_volume = one_over(sum.volume);
  const Wide2<V> centroid{sum.area_x * per_area, sum.area_y * per_area};
  const Wide2<V> pressed{sum.volume_x * per_volume, sum.volume_y * per_volume};
  const Wide2<V> centre = select(sum.volume > zero, pressed, centroid);
  put_vector(in_space(plane, centroid.x, centroid.y), i, terms.centroid);
  put_vector(in_space(plane, centre.x, centre.y), i, terms.centre);
}

template <class V>
void round_contacts(RoundTerms& terms) {
  const V zero = number<V>(0), one = number<V>(1), unsure = number<V>(kUnsure);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const RoundPart<V> part = part_of<V>(terms, i);
    const V r = part.radius1;
    const V exactness = number<V>(terms.flat ? kFlatError : kDiscError) * (r * r * r);
    const Wide3<V> corner[3] = {vector_at<V>(terms.a, i), vector_at<V>(terms.b, i), vector_at<V>(terms.c, i)};
    RoundPlane<V> plane;
    const auto fine = look(part, vector_at<V>(terms.axis, i), corner[0], corner[1], corner[2], plane);
    Polygon<V> polygon;
    const V along_cut = set_polygon(terms, part, plane, corner, i, polygon);
    const Corners<V> all = corners_of(part, plane, polygon);
    const auto met = fine && all.low_y < r && all.high_y > zero - r;
    const auto whole = met && all.outside == zero;

    const auto small = all.size <= number<V>(kByPoints) * r;
    const V limit = select(small, number<V>(kPointwise) * r, zero);
    const PointSum<V> points = whole_by_points(part, plane, polygon, all, whole, limit);
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
    if (any(closed))
      sum = section_moments(part, plane, side, polygon, all, most, terms.flat, closed, whole, directions,
                            inside, lost);
    sum.area = select(whole, all.area, sum.area);
    sum.area_x = select(whole, all.area_x, sum.area_x);
    sum.area_y = select(whole, all.area_y, sum.area_y);
    sum.volume = select(pointwise, points.volume * all.area, sum.volume);
    sum.volume_x = select(pointwise, points.volume_x * all.area, sum.volume_x);
    sum.volume_y = select(pointwise, points.volume_y * all.area, sum.volume_y);

    const V least = select(whole, zero, number<V>(kLeastArea) * (r * min(r, all.size)));
    const V error = select(pointwise, points.error * all.area + rounded_off(r, all.size), exactness) +
                    plane.rounded * sum.area;
    const auto had = closed && lost == zero, contact = (pointwise || had) && sum.area > least;
    const V depth =
        terms.depths ? largest_depth(part, plane, side, polygon, directions, inside, contact) : zero;
    V status = select(open, unsure, zero);
    status = select(had, zero, status);
    status = select(contact, one, status);
    if (part.cone)
      status = select(contact && had && meets_slivers(part, plane, side, all), number<V>(kSlivers), status);
    status = select(fine && along_cut > zero, unsure, status);
    put(terms.status + i, status);
    put_contact(plane, sum, depth, error, i, terms);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
