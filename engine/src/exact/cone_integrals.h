// The field's integrals over the part of a polygon on the side of a capsule or rounded cone, and its area
// alone.
//
// About the point F where the axis pierces the plane, in coordinates e = c x + s h1 along the projected axis
// and y, the distance from the axis is w = sqrt(e^2 + y^2), and the field phi = A + B e - cos(alpha) w is a
// constant and a part that is homogeneous of degree one. So div(phi r) = 3 phi - A, div(phi r r_i) = 4 phi
// r_i - A r_i, and as phi vanishes on the section's rim,
//   3 volume = A area + sum over edges of  p * integral of phi along the part inside,
// p the distance of F from the edge; the first moments likewise with a quarter. The rim enters by its area
// only, and that of an ellipse is a disc's after stretching.
#pragma once

#include "exact/round_strip.h"

namespace lumbrical::LUMBRICAL_ISA {

// The side of the primitive as a plane sees it; e is counted so that it grows with x.
template <class V>
struct SideView {
  V c, foot;       // e = c x + foot, c >= 0
  V level, slope;  // A and B
  V scale, shift;  // the rim is a circle in (scale x + shift, y)
  V rho2;          // its radius squared
  V strip;         // 1 where it is better taken for a pair of lines
  StripRim<V> rim;
  V border1, border2;  // where in x the first end's zone ends and the second's begins, as in section.cpp
};

template <class V>
inline void set_borders(const RoundPart<V>& part, const RoundPlane<V>& plane, SideView<V>& side) {
  const V zero = number<V>(0), far = beyond<V>();
  const V dr = part.radius2 - part.radius1, dh = plane.h2 - plane.h1;
  const V turn = (part.length - dr) * (part.length + dr), start = part.radius1 * dr - plane.h1 * dh;
  const auto slanted = plane.x2 > zero;
  const V per = one_over(plane.x2);
  side.border1 = select(slanted, zero - start * per, select(start >= zero, zero - far, far));
  side.border2 = select(slanted, (turn - start) * per, select(start >= turn, zero - far, far));
}

// The rim as a circle is used up to this size in units of R and of its stretch: an area's digits go with
// both.
inline constexpr double kMostStretch = 30, kLeastGamma = 1e-3;

template <class V>
inline void set_rim(const RoundPart<V>& part, const RoundPlane<V>& plane, V gamma, SideView<V>& side) {
  const V zero = number<V>(0);
  const V sum = part.radius1 * part.sine + plane.h1 * plane.c, per2 = part.per_cosine * part.per_cosine;
  StripRim<V>& rim = side.rim;
  rim.alpha = (part.radius1 - plane.h1) * (part.radius1 + plane.h1) + sum * sum * per2;
  rim.beta = zero - sum * plane.s * per2;
  rim.gamma = gamma;
  rim.lower = side.border1;
  rim.upper = side.border2;
  rim.too_round = zero;
  const Span<V> real = positive_span(zero - gamma, rim.beta, rim.alpha, rim.lower, rim.upper);
  rim.real_lower = real.lower;
  rim.real_upper = real.upper;
}

template <class V>
SideView<V> side_of(const RoundPart<V>& part, const RoundPlane<V>& plane) {
  const V zero = number<V>(0), one = number<V>(1);
  const auto down = plane.c < zero;
  const V c = abs(plane.c), h = select(down, zero - plane.h1, plane.h1);
  SideView<V> side{};
  side.c = c;
  side.foot = plane.s * h;
  side.level = part.radius1;
  side.slope = zero;
  side.scale = c;
  side.shift = side.foot;
  side.rho2 = part.radius1 * part.radius1;
  V gamma = c * c;
  if (part.cone) {
    const V per_c = one_over(c), squares = (c - part.sine) * (c + part.sine), per = one_over(squares);
    side.level = part.radius1 + part.sine * h * per_c;
    side.slope = zero - part.sine * plane.s * per_c;
    gamma = squares * part.per_cosine * part.per_cosine;
    side.scale = sqrt(max(gamma, zero));
    side.shift = (part.radius1 * part.sine + plane.h1 * plane.c) * plane.s * side.scale * per;
    const V reach = side.level * c;
    side.rho2 = select(side.level > zero, reach * reach * per, zero);
  }
  const V most = number<V>(kMostStretch * kMostStretch) * part.radius1 * part.radius1;
  side.strip = select(gamma > number<V>(kLeastGamma) && side.rho2 <= most * gamma, zero, one);
  set_borders(part, plane, side);
  if (any(side.strip > zero)) set_rim(part, plane, gamma, side);
  return side;
}

// phi integrated along an edge from a to b, coordinates from the foot of F, p = distance of F; times p / c:
// what the edge adds to 3 volume, and to 4 moments in (e, y).
template <class V>
inline void add_along(const RoundPart<V>& part, const SideView<V>& side, Wide2<V> t, V p, V a, V b, V per_c,
                      Moments<V>& moments) {
  const V half = number<V>(0.5), third = number<V>(1.0 / 3), k2 = p * p;
  const V a2 = a * a, b2 = b * b, wa2 = a2 + k2, wb2 = b2 + k2, wa = sqrt(wa2), wb = sqrt(wb2);
  const V delta = b - a, log = twice_atanh(delta, wa + wb);
  const V w1 = half * (b * wb - a * wa + k2 * log), w2 = third * (wb * wb2 - wa * wa2);
  const V mean = side.level + side.slope * (p * t.y), rise = side.slope * t.x,
          squares = half * (delta * (a + b));
  const V zeroth = mean * delta + rise * squares - part.cosine * w1;
  const V first = mean * squares + rise * (third * (delta * (b2 + a * b + a2))) - part.cosine * w2;
  const V weight = p * per_c;
  moments.volume = third * (weight * zeroth);
  moments.volume_x = number<V>(0.25) * (weight * (p * t.y * zeroth + t.x * first));
  moments.volume_y = number<V>(0.25) * (weight * (t.y * first - p * t.x * zeroth));
}

// A unit direction of the plane after stretching by `scale` along x.
template <class V>
struct Stretched {
  Wide2<V> t;
  V length, per_length;  // of what was unit length
};
template <class V>
inline Stretched<V> stretch(Wide2<V> t, V scale) {
  const Wide2<V> d{scale * t.x, t.y};
  const V length = sqrt(dot(d, d)), per = one_over(length);
  return {per * d, length, per};
}

// The part of an edge inside the rim of the lanes whose rim is a circle in (scale x + shift, y), as
// coordinates along it from the foot of (0, 0).
template <class V, class M>
inline Span<V> add_circle_edge(const SideView<V>& side, const Edge<V>& edge, Wide2<V> along,
                               const Stretched<V>& about_centre, M here, Moments<V>& sum) {
  const Wide2<V> from{side.scale * edge.p.x + side.shift, edge.p.y};
  const Wide2<V> to{side.scale * edge.q.x + side.shift, edge.q.y};
  const Chord<V> chord = chord_of(from, to, about_centre.t, side.rho2);
  Moments<V> moments = no_moments<V>();
  area_of(chord, side.rho2, moments);
  add_areas(here, moments, sum);
  // Counted from the end nearer to the origin: a far one would bring its own rounding along.
  const auto nearer = dot(edge.p, edge.p) < dot(edge.q, edge.q);
  const V start = select(nearer, chord.x1, chord.x2), offset = dot(select(nearer, edge.p, edge.q), along);
  const V ratio = about_centre.per_length;
  return {offset + ratio * (chord.xa - start), offset + ratio * (chord.xb - start)};
}

// Which lanes see the side's rim, and as what; `all` need none.
template <class M>
struct RimWays {
  M all, round, strip, real;
};
template <class V, class M>
inline RimWays<M> rim_ways(const SideView<V>& side, M wanted, M whole) {
  const V zero = number<V>(0);
  const M all = wanted && whole, rimmed = wanted && is_not(whole);
  const M round = rimmed && side.strip == zero && side.rho2 > zero, strip = rimmed && side.strip > zero;
  return {all, round, strip, all || round || strip};
}

// Areas of what lies in the rim.
template <class V>
struct RimAreas {
  StripRim<V> rim;
  Moments<V> by_circle, by_strip;
};
template <class V>
inline RimAreas<V> no_areas(const SideView<V>& side) {
  return {side.rim, no_moments<V>(), no_moments<V>()};
}

// Adds an edge, and tells the part of it inside: coordinates along it from the foot of (0, 0).
template <class V, class M>
inline Span<V> add_rim_edge(const SideView<V>& side, const Edge<V>& edge, Wide2<V> t,
                            const Stretched<V>& about_centre, const RimWays<M>& ways, M here,
                            RimAreas<V>& areas) {
  Span<V> part_in{dot(edge.p, t), dot(edge.q, t)};
  if (any(ways.round && here)) {
    const Span<V> other = add_circle_edge(side, edge, t, about_centre, ways.round && here, areas.by_circle);
    part_in = {select(ways.round, other.lower, part_in.lower),
               select(ways.round, other.upper, part_in.upper)};
  }
  if (any(ways.strip && here)) {
    const Span<V> other = add_strip_edge(edge, t, ways.strip && here, areas.rim, areas.by_strip).inside;
    part_in = {select(ways.strip, other.lower, part_in.lower),
               select(ways.strip, other.upper, part_in.upper)};
  }
  return part_in;
}

// The areas of all edges; of the lanes that need no rim the polygon's.
template <class V, class M>
inline Moments<V> rim_moments(const SideView<V>& side, const Polygon<V>& polygon, const RimWays<M>& ways,
                              const RimAreas<V>& areas) {
  const V per_scale = one_over(side.scale);
  const Moments<V>&by_circle = areas.by_circle, &by_strip = areas.by_strip;
  Moments<V> own = no_moments<V>();
  own.area = select(ways.strip, by_strip.area, by_circle.area * per_scale);
  own.area_x = select(ways.strip, by_strip.area_x,
                      (by_circle.area_x - side.shift * by_circle.area) * per_scale * per_scale);
  own.area_y = select(ways.strip, by_strip.area_y, by_circle.area_y * per_scale);
  if (any(ways.all)) {
    const Moments<V> area = area_of(polygon, corner_of(polygon));
    own.area = select(ways.all, area.area, own.area);
    own.area_x = select(ways.all, area.area_x, own.area_x);
    own.area_y = select(ways.all, area.area_y, own.area_y);
  }
  return own;
}

// What of the polygon lies in the side's section: all of it in the lanes `whole`, which need no rim. False
// where an arc of the rim was neither circle nor strip.
template <class V, class M>
auto add_side(const RoundPart<V>& part, const SideView<V>& side, const Polygon<V>& polygon,
              const Directions<V>& directions, M wanted, M whole, Moments<V>& sum, InsideParts<V>& inside) {
  const V zero = number<V>(0), quarter = number<V>(0.25), third = number<V>(1.0 / 3);
  const RimWays<M> ways = rim_ways(side, wanted, whole);
  RimAreas<V> areas = no_areas(side);
  Moments<V> along = no_moments<V>();
  if (any(ways.real)) {
    const V per_c = one_over(side.c);
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const Edge<V>& edge = polygon.edge[i];
      const M here = ways.real && has_length(edge);
      if (!any(here)) continue;
      const Wide2<V> t = directions.t[i];
      const Stretched<V> about_foot = stretch(t, side.c);
      const Stretched<V> about_centre = part.cone ? stretch(t, side.scale) : about_foot;
      const Span<V> part_in = add_rim_edge(side, edge, t, about_centre, ways, here, areas);
      const Wide2<V> near = select(dot(edge.p, edge.p) < dot(edge.q, edge.q), edge.p, edge.q);
      const Wide2<V> about{side.c * near.x + side.foot, near.y}, direction = about_foot.t;
      const V start = dot(near, t), offset = dot(about, direction), p = cross(about, direction);
      const V length = about_foot.length;
      Moments<V> moments = no_moments<V>();
      add_along(part, side, direction, p, offset + length * (part_in.lower - start),
                offset + length * (part_in.upper - start), per_c, moments);
      add_volumes(here && part_in.lower < part_in.upper, moments, along);
      inside.add(i, here && part_in.lower < part_in.upper, part_in.lower, part_in.upper);
    }
    Moments<V> own = rim_moments(side, polygon, ways, areas);
    own.volume = along.volume + third * (side.level * own.area);
    own.volume_x = along.volume_x + quarter * (side.level * (side.c * own.area_x + side.foot * own.area));
    own.volume_x = (own.volume_x - side.foot * own.volume) * per_c;
    own.volume_y = along.volume_y + quarter * (side.level * own.area_y);
    add_where(ways.real, own, sum);
  }
  return areas.rim.too_round == zero;
}

// The same area alone, of lanes that need the rim.
template <class V, class M>
auto add_side_area(const SideView<V>& side, const Polygon<V>& polygon, const Directions<V>& directions,
                   M wanted, Moments<V>& sum, InsideParts<V>& inside) {
  const RimWays<M> ways = rim_ways(side, wanted, is_not(wanted));  // none is whole
  RimAreas<V> areas = no_areas(side);
  if (any(ways.real)) {
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const Edge<V>& edge = polygon.edge[i];
      const M here = ways.real && has_length(edge);
      if (!any(here)) continue;
      const Wide2<V> t = directions.t[i];
      const Span<V> part_in = add_rim_edge(side, edge, t, stretch(t, side.scale), ways, here, areas);
      inside.add(i, here && part_in.lower < part_in.upper, part_in.lower, part_in.upper);
    }
    add_areas(ways.real, rim_moments(side, polygon, ways, areas), sum);
  }
  return areas.rim.too_round == number<V>(0);
}

}  // namespace lumbrical::LUMBRICAL_ISA
