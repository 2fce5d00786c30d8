// The section of a cone's side where its rim is nearly a pair of lines: the axis lies nearly along the plane,
// and a circle to stretch it to would be huge, or is none. Area as in section_area.cpp, in lanes.
//
// On the side eta^2 = alpha + 2 beta x - gamma x^2. Where an edge runs outside, the rim takes its place over
// the same range of x; over its chord it bulges by series in u = gamma delta^2 / (4 Q^2), which is small
// here.
#pragma once

#include "exact/disc_integrals.h"
#include "section/bulge_series.h"

namespace lumbrical::LUMBRICAL_ISA {

// More of u than this the series is not for.
inline constexpr double kMostBulge = 0.05;

inline constexpr BulgeSeries<13> kBulge = bulge_series<13>();

template <class V>
struct Span {
  V lower, upper;
};

// Where a z^2 + 2 b z + c is positive on [lower, upper], known to be one interval; upper < lower: nowhere.
template <class V>
inline Span<V> positive_span(V a, V b, V c, V lower, V upper) {
  const V zero = number<V>(0), one = number<V>(1);
  a = select(a == zero, number<V>(-1e-280), a);
  const V square = b * b - a * c, rise = sqrt(max(square, zero));
  const V q = select(b >= zero, zero - (b + rise), rise - b);
  const V root1 = divide(q, a), root2 = divide(c, select(q == zero, one, q));
  const V first = min(root1, root2), second = max(root1, root2);
  const V left = min(upper, first), right = max(lower, second);
  const auto leftmost = left - lower > upper - right;
  const auto convex = a > zero, real = square > zero;
  Span<V> span{select(convex, select(leftmost, lower, right), max(lower, first)),
               select(convex, select(leftmost, left, upper), min(upper, second))};
  return {select(real, span.lower, select(convex, lower, upper)),
          select(real, span.upper, select(convex, upper, lower))};
}

template <class V>
struct StripRim {
  V alpha, beta, gamma, lower, upper;  // of eta^2; the zone
  V real_lower, real_upper;            // where eta is real in the zone
  V too_round;                         // 1 where an arc was no strip's
};

template <class V>
inline V eta_of(const StripRim<V>& rim, V x) {
  const V zero = number<V>(0);
  const V eta = sqrt(max(rim.alpha + x * (rim.beta + rim.beta - rim.gamma * x), zero));
  // At the curve's own ends rounding would leave the root of a small number.
  const V inner = select(x == rim.real_lower && x > rim.lower, zero, eta);
  return select(x == rim.real_upper && x < rim.upper, zero, inner);
}

// Adds the area under the line from p to q, and its moments; the area of a region is minus the sum.
template <class V>
inline void add_chord(Wide2<V> p, Wide2<V> q, Moments<V>& sum) {
  const V delta = q.x - p.x, area = number<V>(0.5) * (delta * (p.y + q.y));
  sum.area = sum.area - area;
  sum.area_x = sum.area_x -
               (number<V>(0.5) * ((p.x + q.x) * area) + number<V>(1.0 / 12) * (delta * delta * (q.y - p.y)));
  sum.area_y = sum.area_y - number<V>(1.0 / 6) * (delta * (p.y * p.y + p.y * q.y + q.y * q.y));
}

// The rim over the range of x of the line from p to q, on the line's side of y = 0.
template <class V>
struct RimArc {
  V x1, x2, side;
};
template <class V>
inline RimArc<V> arc_of(const StripRim<V>& rim, Wide2<V> p, Wide2<V> q) {
  const V zero = number<V>(0), one = number<V>(1), across = q.x - p.x;
  const V x1 = clamp(p.x, rim.real_lower, rim.real_upper), x2 = clamp(q.x, rim.real_lower, rim.real_upper);
  const V slope = (q.y - p.y) * divide(one, select(across == zero, one, across));
  const V middle = number<V>(0.5) * (x1 + x2);
  return {x1, x2, select(p.y + (middle - p.x) * slope < zero, zero - one, one)};
}

// The rim in place of the line from p to q.
template <class V, class M>
inline void add_arc(M here, Wide2<V> p, Wide2<V> q, StripRim<V>& rim, Moments<V>& sum) {
  const V zero = number<V>(0), one = number<V>(1);
  const auto [x1, x2, side] = arc_of(rim, p, q);
  const V delta = x2 - x1, middle = number<V>(0.5) * (x1 + x2);
  const auto drawn = here && rim.real_lower < rim.real_upper && x1 != x2;
  if (!any(drawn)) return;
  const V a = eta_of(rim, x1), b = eta_of(rim, x2), rise = b - a, mean = number<V>(0.5) * (a + b);
  const V squares = rim.gamma * (delta * delta), q2 = mean * mean + number<V>(0.25) * squares;
  const V k = squares + rise * rise, u = number<V>(0.25) * squares * one_over(q2);
  rim.too_round = select(drawn && abs(u) > number<V>(kMostBulge), one, rim.too_round);
  rim.too_round = select(drawn && q2 <= zero, one, rim.too_round);
  const V area =
      side * (delta * k * horner(kBulge.s, u)) * number<V>(1.0 / 12) * one_over(sqrt(max(q2, zero)));
  const V moment =
      side * (k * rise * (delta * delta) * horner(kBulge.w, u)) * number<V>(1.0 / 48) * one_over(q2);
  Moments<V> arc = no_moments<V>();
  add_chord(Wide2<V>{x1, side * a}, Wide2<V>{x2, side * b}, arc);
  arc.area = arc.area - area;
  arc.area_x = arc.area_x - (middle * area - moment);
  arc.area_y = arc.area_y - number<V>(1.0 / 12) * (k * delta);
  add_areas(drawn, arc, sum);
}

// The part of an edge inside, as coordinates along it from the foot of (0, 0) and as points.
template <class V>
struct StripEdge {
  Span<V> inside;
  Wide2<V> enters, leaves;
};

// One edge of a polygon in the side's zone: adds its share of the area and tells which part of it is inside.
template <class V, class M>
inline StripEdge<V> add_strip_edge(const Edge<V>& edge, Wide2<V> t, M here, StripRim<V>& rim,
                                   Moments<V>& sum) {
  const V start = dot(edge.p, t), end = dot(edge.q, t);
  const V p = cross(select(dot(edge.p, edge.p) < dot(edge.q, edge.q), edge.p, edge.q), t);
  const Wide2<V> foot{p * t.y, number<V>(0) - p * t.x};
  const V a = number<V>(0) - (rim.gamma * (t.x * t.x) + t.y * t.y);
  const V b = (rim.beta - rim.gamma * foot.x) * t.x - foot.y * t.y;
  const V c = rim.alpha + foot.x * (rim.beta + rim.beta - rim.gamma * foot.x) - foot.y * foot.y;
  Span<V> inside = positive_span(a, b, c, start, end);
  // What rounding has left of an edge may run against it.
  const auto none = inside.upper <= inside.lower || end <= start;
  inside = {select(none, end, inside.lower), select(none, end, inside.upper)};
  const Wide2<V> enters =
      select(inside.lower == start, edge.p, select(inside.lower == end, edge.q, foot + inside.lower * t));
  const Wide2<V> leaves = select(inside.upper == end, edge.q, foot + inside.upper * t);
  Moments<V> chord = no_moments<V>();
  add_chord(enters, leaves, chord);
  add_areas(here, chord, sum);
  add_arc(here, edge.p, enters, rim, sum);
  add_arc(here, leaves, edge.q, rim, sum);
  return {inside, enters, leaves};
}

}  // namespace lumbrical::LUMBRICAL_ISA
