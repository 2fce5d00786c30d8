// The field's mean along short ways across a triangle's plane, one source for every instruction set; a way is
// a lane.
#pragma once

#include "base/gauss.h"
#include "exact/crossing_terms.h"
#include "exact/round_plane.h"

namespace lumbrical::LUMBRICAL_ISA {

// In shares of the distance d from the axis: up to the first, two nodes leave less than a hundredth of the
// fourth power of height over d; up to the second, four leave 1e-12; up to the last, eight do.
inline constexpr double kThinWay = 4e-3, kShortWay = 0.1, kLongWay = 0.5;

// Where on its way the field passes over to the formula of a sphere.
template <class V>
struct Break {
  V at;     // share of the way, 1 where that is nowhere
  V twice;  // 1 where it does so and comes back
};

// The sphere of the end that is `from` along the axis. f = cos(alpha) q - sin(alpha) rho is concave along the
// way, so it changes its sign once if it differs at the ends; its slope is 1 at most. Of the quadratic that
// has its roots, the other one lies on the cone's mirror image, where q < 0.
template <class V>
Break<V> break_at(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> foot, Wide2<V> way, V from) {
  const V zero = number<V>(0), one = number<V>(1);
  const V e = plane.c * foot.x + plane.s * plane.h1, q = plane.s * foot.x - plane.c * plane.h1 - from;
  const V de = plane.c * way.x, dq = plane.s * way.x, e1 = e + de, y1 = foot.y + way.y;
  const V axial = part.cosine * q, radial = part.sine * sqrt(e * e + foot.y * foot.y);
  const V first = axial - radial, last = part.cosine * (q + dq) - part.sine * sqrt(e1 * e1 + y1 * y1);
  const V steep = part.cosine * dq, spread2 = part.sine * part.sine;
  const V a = steep * steep - spread2 * (de * de + way.y * way.y);
  const V b = axial * steep - spread2 * (e * de + foot.y * way.y), c = first * (axial + radial);
  const V rise = part.cone ? sqrt(max(b * b - a * c, zero)) : zero;
  const V sum = select(b < zero, rise - b, zero - (b + rise));
  const V one_root = divide(sum, select(a == zero, one, a));
  const V other_root = divide(c, select(sum == zero, one, sum));
  const auto on_way = [&](V share) { return share >= zero && share <= one && q + share * dq >= zero; };
  const auto proper = a != zero && on_way(one_root);
  const auto enters = first < zero && last >= zero, leaves = first >= zero && last < zero;
  const auto dips = first < zero && last < zero && (proper || on_way(other_root));
  return {select(enters || leaves, clamp(select(proper, one_root, other_root), zero, one), one),
          select(dips && rise > zero, one, zero)};
}

template <class V, std::size_t N>
void add_ways(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> foot, Wide2<V> way,
              const GaussNode (&rule)[N], V& mean, V& lean) {
  for (const GaussNode& node : rule) {
    const V at = number<V>(node.at);
    const V share = number<V>(node.weight) * field_at(part, plane, foot + at * way).phi;
    mean = mean + share;
    lean = lean + at * share;
  }
}

// The part of the way from share `from` to share `to`.
template <class V, std::size_t N>
void add_stretch(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> foot, Wide2<V> way, V from,
                 V to, const GaussNode (&rule)[N], V& mean, V& lean) {
  const V zero = number<V>(0), length = to - from;
  if (!any(length > zero)) return;
  V own_mean = zero, own_lean = zero;
  add_ways(part, plane, foot + from * way, length * way, rule, own_mean, own_lean);
  mean = mean + length * own_mean;
  lean = lean + length * (from * own_mean + length * own_lean);
}

// The field's mean along the way, and that of the field times the share of the way; `smooth` is 0 where
// these few nodes will not do.
template <class V>
struct WayMeans {
  V mean, lean, smooth;
};

// From `foot` on by `height` along `across`, in the lanes that are asked for. `ends`: those whose spheres may
// come in on the way, one or two, as abscissas of the axis.
template <class V, class M, std::size_t N>
WayMeans<V> means_across(const RoundPart<V>& part, const RoundPlane<V>& plane, const V (&ends)[N],
                         Wide2<V> foot, Wide2<V> across, V height, M wanted) {
  const V zero = number<V>(0), one = number<V>(1), far = abs(height);
  const Wide2<V> way = height * across;
  // Of the two nodes' values the first one tells besides what the way is like: margins change no faster than
  // one goes.
  const FieldValue<V> first = field_at(part, plane, foot + number<V>(kGauss2[0].at) * way);
  const V distance = part.radius2 - first.phi;
  const auto even = wanted && far < first.margin, kinked = wanted && far >= first.margin;
  const auto bulky = even && far >= number<V>(kThinWay) * distance;
  const auto thick = bulky && far < number<V>(kShortWay) * distance;
  const auto long_way = bulky && far >= number<V>(kShortWay) * distance;
  const V own = number<V>(kGauss2[0].weight) * first.phi;
  const V other =
      number<V>(kGauss2[1].weight) * field_at(part, plane, foot + number<V>(kGauss2[1].at) * way).phi;
  WayMeans<V> means{own + other, number<V>(kGauss2[0].at) * own + number<V>(kGauss2[1].at) * other, zero};
  const auto add = [&](const auto& which, const auto& rule) {
    if (!any(which)) return;
    V own_mean = zero, own_lean = zero;
    add_ways(part, plane, foot, way, rule, own_mean, own_lean);
    means.mean = select(which, own_mean, means.mean);
    means.lean = select(which, own_lean, means.lean);
  };
  add(thick, kGauss4);
  add(long_way, kGauss8);
  means.smooth = select(even && far < number<V>(kLongWay) * distance, one, zero);
  if (!any(kinked)) return means;
  V near = one, next = one, twice = zero;
  for (const V end : ends) {
    const Break<V> here = break_at(part, plane, foot, way, end);
    next = max(near, here.at);
    near = min(near, here.at);
    twice = twice + here.twice;
  }
  const auto add_parts = [&](const auto& which, const auto& rule) {
    if (!any(which)) return;
    V own_mean = zero, own_lean = zero;
    add_stretch(part, plane, foot, way, zero, near, rule, own_mean, own_lean);
    add_stretch(part, plane, foot, way, near, next, rule, own_mean, own_lean);
    add_stretch(part, plane, foot, way, next, one, rule, own_mean, own_lean);
    means.mean = select(which, own_mean, means.mean);
    means.lean = select(which, own_lean, means.lean);
  };
  add_parts(kinked && far < number<V>(kThinWay) * distance, kGauss2);
  add_parts(kinked && far >= number<V>(kThinWay) * distance, kGauss4);
  const auto short_way = far < number<V>(kShortWay) * distance;
  means.smooth = select(kinked && twice == zero && short_way, one, means.smooth);
  return means;
}

template <class V>
void field_across(CrossingTerms& terms) {
  const V zero = number<V>(0), one = number<V>(1);
  const RoundPart<V> part =
      round_part(number<V>(terms.length), number<V>(terms.radius1), number<V>(terms.radius2),
                 number<V>(terms.sine), number<V>(terms.cosine), terms.length == 0, terms.sine != 0);
  RoundPlane<V> plane{};
  plane.s = number<V>(terms.s);
  plane.c = number<V>(terms.c);
  plane.h1 = number<V>(terms.h1);
  const V ends[2] = {zero, part.length};
  const Wide2<V> across{number<V>(terms.across_x), number<V>(terms.across_y)};
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide2<V> foot{get(terms.x + i, V{}), get(terms.y + i, V{})};
    const WayMeans<V> means =
        means_across(part, plane, ends, foot, across, get(terms.height + i, V{}), one > zero);
    put(terms.mean + i, means.mean);
    put(terms.lean + i, means.lean);
    put(terms.smooth + i, means.smooth);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
