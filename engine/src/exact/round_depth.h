// dl_max of round primitives in lanes: see depth.cpp for the derivation.
#pragma once

#include "exact/cone_integrals.h"

namespace lumbrical::LUMBRICAL_ISA {

// Where on 0 <= t <= 1 sqrt(a t^2 + 2 b t + c) - t dh is largest. Its stationary point solves (a t + b) =
// dh sqrt(..); the form is chosen so that nothing cancels whatever the sign of b. For capsules the function
// is concave; the radius of a cone may shrink so fast that it is not, and then one of the ends is best.
template <class V>
inline V best_parameter(bool cone, V a, V b, V c, V dh) {
  const V zero = number<V>(0), one = number<V>(1), two = number<V>(2);
  const V g = dh * dh - a, per_g = one_over(g);
  const V square = max(b * b - a * c, zero) * per_g, steep = dh * sqrt(square);
  const V with = b + steep, against = b - steep;
  const auto along = b * dh >= zero;
  const V numerator = select(along, (b * b - dh * dh * c) * per_g, zero - against);
  const V denominator = select(along, with, a), safe = select(denominator == zero, one, denominator);
  // Upright: every sphere reaches equally far, the lowest is best.
  const V upright = select(dh < zero, one, zero);
  const V t = select(denominator == zero, upright, divide(numerator, safe));
  const V best = select(g > zero, clamp(t, zero, one), zero);
  if (!cone) return best;
  const auto value = [&](V at) {
    const V q = c + at * (two * b + at * a);
    return select(q >= zero, sqrt(max(q, zero)) - at * dh, zero - beyond<V>());
  };
  const V first = value(zero), last = value(one), end = select(first >= last, zero, one);
  return select(value(best) >= max(first, last), best, end);
}

template <class V>
inline V depth_at(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> p) {
  const V zero = number<V>(0);
  const V c = part.radius1 * part.radius1 - dot(p, p);
  if (part.sphere) return sqrt(max(c, zero)) - plane.h1;
  const V dr = part.radius2 - part.radius1, dh = plane.h2 - plane.h1;
  const V a = (dr - plane.x2) * (dr + plane.x2), b = part.radius1 * dr + p.x * plane.x2;
  const V t = best_parameter(part.cone, a, b, c, dh);
  return sqrt(max(c + t * (b + b + t * a), zero)) - plane.h1 - t * dh;
}

// A largest depth, and where in the plane.
template <class V>
struct Deepest {
  V depth;
  Wide2<V> point;
};

// On the part of an edge inside the section.
template <class V>
inline Deepest<V> depth_along(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> end, Wide2<V> t,
                              V lower, V upper) {
  const V p = cross(end, t);
  V best = number<V>(0);
  if (!part.sphere) {
    const V slope = number<V>(0) - plane.x2 * t.y, dr = part.radius2 - part.radius1;
    const V at = best_parameter(part.cone, (dr - slope) * (dr + slope), part.radius1 * dr - p * slope,
                                (part.radius1 - p) * (part.radius1 + p), plane.h2 - plane.h1);
    best = at * plane.x2 * t.x;
  }
  const V z = clamp(best, lower, upper);
  const Wide2<V> point{p * t.y + z * t.x, z * t.y - p * t.x};
  return {depth_at(part, plane, point), point};
}

// Where, on y = 0, the whole section is deepest: under the end that reaches deepest or, where the
// section doesn't hold that point, on the rim towards it.
template <class V>
V deepest_abscissa(const RoundPart<V>& part, const RoundPlane<V>& plane, const SideView<V>& side) {
  const V zero = number<V>(0), one = number<V>(1);
  const auto first = part.radius1 - plane.h1 >= part.radius2 - plane.h2;
  const V under = select(first, zero, plane.x2);
  const auto pierced = select(first, plane.h1 + part.radius1, plane.h2 + part.radius2) <= zero;
  if (part.sphere || !any(pierced)) return under;
  const auto outside = field_at(part, plane, Wide2<V>{under, zero}).phi < zero;
  const V sign = select(first, zero - one, one);
  const V e = sign * side.level * one_over(part.cosine - sign * side.slope);
  const V on_side = (e - side.foot) * one_over(side.c);
  const V radius = select(first, part.radius2, part.radius1), h = select(first, plane.h2, plane.h1);
  const V other = select(first, plane.x2, zero);
  const V on_disc = other + sign * sqrt(max((radius - h) * (radius + h), zero));
  const auto in_zone = on_side >= side.border1 && on_side <= side.border2;
  return select(pierced && outside, select(in_zone, on_side, on_disc), under);
}

// Over the common part of polygon and section. What is deeper than a given depth is the slice of a convex
// body, so on the way to the deepest point depth never falls: where that point lies outside, the deepest one
// inside is on an edge that has it on the other side.
template <class V, class M>
Deepest<V> largest_depth(const RoundPart<V>& part, const RoundPlane<V>& plane, const SideView<V>& side,
                         const Polygon<V>& polygon, const Directions<V>& directions,
                         const InsideParts<V>& inside, M wanted) {
  const V zero = number<V>(0);
  Deepest<V> best{zero, {deepest_abscissa(part, plane, side), zero}};
  const Wide2<V> deepest = best.point;
  V least = number<V>(1), excess[Polygon<V>::kMost];  // negative: an edge leaves the deepest point outside
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    excess[i] = select(has_length(edge), cross(edge.q - edge.p, deepest - edge.p), zero);
    least = min(least, excess[i]);
  }
  if (any(wanted && least >= zero)) best.depth = select(least >= zero, depth_at(part, plane, deepest), zero);
  if (!any(wanted && least < zero)) return best;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const auto here = wanted && excess[i] < zero && inside.lower[i] < inside.upper[i];
    if (!any(here)) continue;
    const Edge<V>& edge = polygon.edge[i];
    const Wide2<V> near = select(dot(edge.p, edge.p) < dot(edge.q, edge.q), edge.p, edge.q);
    const Deepest<V> along =
        depth_along(part, plane, near, directions.t[i], inside.lower[i], inside.upper[i]);
    const auto deeper = here && along.depth > best.depth;
    best = {select(deeper, along.depth, best.depth), select(deeper, along.point, best.point)};
  }
  return best;
}

}  // namespace lumbrical::LUMBRICAL_ISA
