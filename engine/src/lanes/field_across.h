// The field's mean along short ways across a triangle's plane, one source for every instruction set; a way is
// a lane.
#pragma once

#include "lanes/crossing_terms.h"
#include "lanes/round_plane.h"

namespace lumbrical::LUMBRICAL_ISA {

// In shares of the distance d from the axis: up to the first, two nodes leave less than a hundredth of the
// fourth power of height over d; up to the last, four do.
inline constexpr double kThinWay = 4e-3, kShortWay = 0.1;

// Where on its way the field passes over to the formula of a sphere.
template <class V>
struct Break {
  V at;        // share of the way, 1 where that is nowhere
  V doubtful;  // 1 where it may do so twice
};

// The sphere of the end that is `from` along the axis. f = cos(alpha) q - sin(alpha) rho is concave along the
// way, so it changes its sign once if it differs at the ends; its slope is 1 at most. Of the quadratic that
// has its roots, the other one lies on the cone's mirror image, where q < 0.
template <class V>
Break<V> break_at(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> foot, Wide2<V> way, V far,
                  V from) {
  const V zero = number<V>(0), one = number<V>(1);
  const V e = plane.c * foot.x + plane.s * plane.h1, q = plane.s * foot.x - plane.c * plane.h1 - from;
  const V de = plane.c * way.x, dq = plane.s * way.x, e1 = e + de, y1 = foot.y + way.y;
  const V axial = part.cosine * q, radial = part.sine * root(e * e + foot.y * foot.y);
  const V first = axial - radial, last = part.cosine * (q + dq) - part.sine * root(e1 * e1 + y1 * y1);
  const V steep = part.cosine * dq, spread2 = part.sine * part.sine;
  const V a = steep * steep - spread2 * (de * de + way.y * way.y);
  const V b = axial * steep - spread2 * (e * de + foot.y * way.y), c = first * (axial + radial);
  const V rise = part.cone ? root(greater(b * b - a * c, zero)) : zero;
  const V sum = choose(b < zero, rise - b, zero - (b + rise));
  const V one_root = quotient(sum, choose(a == zero, one, a));
  const V other_root = quotient(c, choose(sum == zero, one, sum));
  const auto proper =
      both(both(one_root >= zero, one_root <= one), both(a != zero, q + one_root * dq >= zero));
  const auto enters = both(first < zero, last >= zero), leaves = both(first >= zero, last < zero);
  const auto dips = both(both(first < zero, last < zero), zero - (first + last) < far);
  return {choose(either(enters, leaves), between(choose(proper, one_root, other_root), zero, one), one),
          choose(dips, one, zero)};
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
template <class V>
void add_stretch(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> foot, Wide2<V> way, V from,
                 V to, V& mean, V& lean) {
  const V zero = number<V>(0), length = to - from;
  if (!some(length > zero)) return;
  V own_mean = zero, own_lean = zero;
  add_ways(part, plane, foot + from * way, length * way, kGauss4, own_mean, own_lean);
  mean = mean + length * own_mean;
  lean = lean + length * (from * own_mean + length * own_lean);
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
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide2<V> foot{get(terms.x + i, V{}), get(terms.y + i, V{})};
    const V height = get(terms.height + i, V{}), far = magnitude(height);
    const Wide2<V> way{height * number<V>(terms.across_x), height * number<V>(terms.across_y)};
    const FieldValue<V> start = field_at(part, plane, foot);
    const V distance = number<V>(terms.radius2) - start.phi;
    const auto even = far < start.margin, kinked = far >= start.margin;
    const auto thin = both(even, far < number<V>(kThinWay) * distance);
    const auto thick = both(even, far >= number<V>(kThinWay) * distance);
    V mean = zero, lean = zero, doubtful = zero;
    const auto add = [&](const auto& which, const auto& rule) {
      if (!some(which)) return;
      V own_mean = zero, own_lean = zero;
      add_ways(part, plane, foot, way, rule, own_mean, own_lean);
      mean = choose(which, own_mean, mean);
      lean = choose(which, own_lean, lean);
    };
    add(thin, kGauss2);
    add(thick, kGauss4);
    if (some(kinked)) {
      const Break<V> one_end = break_at(part, plane, foot, way, far, zero);
      const Break<V> other_end = break_at(part, plane, foot, way, far, part.length);
      const V near = lesser(one_end.at, other_end.at), next = greater(one_end.at, other_end.at);
      V own_mean = zero, own_lean = zero;
      add_stretch(part, plane, foot, way, zero, near, own_mean, own_lean);
      add_stretch(part, plane, foot, way, near, next, own_mean, own_lean);
      add_stretch(part, plane, foot, way, next, one, own_mean, own_lean);
      mean = choose(kinked, own_mean, mean);
      lean = choose(kinked, own_lean, lean);
      doubtful = choose(kinked, one_end.doubtful + other_end.doubtful, zero);
    }
    put(terms.mean + i, mean);
    put(terms.lean + i, lean);
    put(terms.smooth + i, choose(both(doubtful == zero, far < number<V>(kShortWay) * distance), one, zero));
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
