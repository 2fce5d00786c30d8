// A near border over its chord in a triangle's plane, a border per lane: its height in closed form, the field
// along it, and the part of it inside the section.
#pragma once

#include "exact/border_terms.h"
#include "exact/round_plane.h"

namespace lumbrical::LUMBRICAL_ISA {

// In shares of R: a Newton step so short is the last one; a chord so short is none; rounding of a field.
inline constexpr double kLastStep = 1e-7, kNoChord = 1e-12, kFieldRounding = 1e-12;
// Steps towards an end of the section; nearly all need less than half of them.
inline constexpr int kMostSteps = 10;

// The cone's coordinates as linear functions over the plane: along its axes, and from the joint at a point.
template <class V>
struct PlaneCone {
  Wide2<V> x, y, z;
  V side;  // 1: the tile is inside, -1: outside
};

// The cone's coordinates x, y, z at the start of a chord.
template <class V>
using ConePoint = Wide3<V>;

template <class V>
struct BorderChord {
  Wide2<V> from, along,
      across;  // plane coordinates; the chord points `along`, `across` into its kin's part
  V length;
  ConePoint<V> start;
  // x^2 + y^2 = z^2 is a h^2 + 2 (b + s tilt) h = bend s (length - s) - off - s drift in the height h over
  // abscissa s; the last two are what rounding leaves at the ends, a large triangle that of its plane.
  V a, b, tilt, bend, off, drift;
  V steepest, height;  // of the border over the chord at most: it is convex and stays below its end tangents
  V good;              // 0 where it is no flat curve over the chord
};

template <class V>
inline V in_cone(ConePoint<V> p, ConePoint<V> q) {
  return p.x * q.x + p.y * q.y - p.z * q.z;
}

template <class V>
BorderChord<V> chord_over(const PlaneCone<V>& cone, Wide2<V> from, Wide2<V> to, ConePoint<V> start) {
  const V zero = number<V>(0), one = number<V>(1), two = number<V>(2);
  BorderChord<V> chord;
  const Wide2<V> d = to - from;
  chord.from = from;
  chord.length = sqrt(dot(d, d));
  chord.along = one_over(chord.length) * d;
  chord.across = {chord.along.y, zero - chord.along.x};
  chord.start = start;
  const ConePoint<V> along{dot(cone.x, chord.along), dot(cone.y, chord.along), dot(cone.z, chord.along)};
  const ConePoint<V> across{dot(cone.x, chord.across), dot(cone.y, chord.across), dot(cone.z, chord.across)};
  chord.a = in_cone(across, across);
  chord.b = in_cone(start, across);
  chord.tilt = in_cone(along, across);
  chord.bend = in_cone(along, along);
  // At both ends the way across has to leave the tile, and the border not to be steep.
  const V first = cone.side * chord.b, last = first + cone.side * chord.tilt * chord.length;
  const V rise = abs(chord.bend) * chord.length;
  const auto leaves = first > zero && last > zero;
  const V k1 = rise * one_over(two * first), k2 = rise * one_over(two * last), sum = k1 + k2;
  chord.steepest = max(k1, k2);
  chord.height = number<V>(1.000001) * chord.length * k1 * k2 * one_over(sum);
  const ConePoint<V> end = start + chord.length * along;
  chord.off = in_cone(start, start);
  chord.drift = (in_cone(end, end) - chord.off) * one_over(chord.length);
  const auto flat = leaves && k1 < number<V>(kSteepestChord) && k2 < number<V>(kSteepestChord);
  chord.good = select(flat && start.z >= zero && end.z >= zero, one, zero);
  return chord;
}

// The border at abscissa s, and how fast it rises; `good` becomes 0 where there is none.
template <class V>
struct BorderHeight {
  V at, slope;
};

template <class V>
inline BorderHeight<V> height_at(const PlaneCone<V>& cone, const BorderChord<V>& chord, V s, V& good) {
  const V zero = number<V>(0), one = number<V>(1), two = number<V>(2);
  const V b = chord.b + s * chord.tilt;
  const V rest = chord.bend * (s * (chord.length - s)) - (chord.off + s * chord.drift);
  const V square = b * b + chord.a * rest, fall = cone.side * sqrt(max(square, zero));
  const V sum = b + fall;
  good = select(square > zero && sum != zero, good, zero);
  const V h = divide(rest, select(sum == zero, one, sum));
  const V change = chord.bend * (chord.length - two * s) - chord.drift - two * (chord.tilt * h);
  return {h, divide(change, select(fall == zero, one, two * fall))};
}

// phi at a point of the plane and its change in a direction.
template <class V>
struct FieldSlope {
  V phi, slope;
};

template <class V>
inline FieldSlope<V> field_along(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> p,
                                 Wide2<V> d) {
  const V e = plane.c * p.x + plane.s * plane.h1, q = plane.s * p.x - plane.c * plane.h1;
  const V rho2 = e * e + p.y * p.y, rho = sqrt(rho2);
  const V at = clamp(q - rho * part.tangent, number<V>(0), part.length), off = q - at;
  const V w = sqrt(off * off + rho2);
  // The nearest sphere is the best one, so only the distance from its centre changes.
  const V change = off * (plane.s * d.x) + e * (plane.c * d.x) + p.y * d.y;
  return {part.radius1 - part.sine * at - w, number<V>(0) - change * one_over(w)};
}

// The field on the border at abscissa s, and its change along it.
template <class V>
inline FieldSlope<V> field_on(const RoundPart<V>& part, const RoundPlane<V>& plane, const PlaneCone<V>& cone,
                              const BorderChord<V>& chord, V s, V& good) {
  const BorderHeight<V> height = height_at(cone, chord, s, good);
  return field_along(part, plane, chord.from + s * chord.along + height.at * chord.across,
                     chord.along + height.slope * chord.across);
}

// The stretch of a border inside the section.
template <class V>
struct Stretch {
  V from, to;  // abscissas
  V status;    // kBorderOutside ...
};

// The field is concave in the plane, so from an end outside the section Newton's steps along the border come
// to the section from outside, and where the tangents from both ends meet below zero there is no section
// between; below `clear` there is none between chord and border either.
template <class V>
Stretch<V> follow(const RoundPart<V>& part, const RoundPlane<V>& plane, const PlaneCone<V>& cone,
                  const BorderChord<V>& chord) {
  const V zero = number<V>(0), one = number<V>(1);
  const V unclear = number<V>(kBorderUnclear), outside = number<V>(kBorderOutside);
  const V close = number<V>(kLastStep) * part.radius1;
  const V clear = zero - (chord.height + chord.steepest * chord.length);
  V a = zero, b = chord.length, good = chord.good;
  FieldSlope<V> at_a = field_on(part, plane, cone, chord, a, good);
  FieldSlope<V> at_b = field_on(part, plane, cone, chord, b, good);
  Stretch<V> stretch{zero, zero, number<V>(kBorderInside)};
  // Which ends are still being looked for.
  V left = select(at_a.phi < zero, one, zero), right = select(at_b.phi < zero, one, zero);
  const auto never = one < zero;
  const auto give_up = [&](const auto& which, const auto& as_outside) {
    stretch.status = select(which, select(as_outside, outside, unclear), stretch.status);
    left = select(which, zero, left);
    right = select(which, zero, right);
  };
  give_up(left > zero && at_a.slope <= zero, at_a.phi < clear);
  give_up(right > zero && at_b.slope >= zero, at_b.phi < clear);
  for (int step = 0; step < kMostSteps && any(left + right > zero); ++step) {
    const auto from_a = left > zero, from_b = right > zero;
    const V step_a = select(from_a, zero - divide(at_a.phi, select(from_a, at_a.slope, one)), zero);
    const V step_b = select(from_b, divide(at_b.phi, select(from_b, at_b.slope, one)), zero);
    const V next_a = a + step_a, next_b = b - step_b;
    const auto meet = (from_a || from_b) && next_a >= next_b;
    if (any(meet)) {
      const V change = at_a.slope - at_b.slope;
      const V where = (at_b.phi - at_a.phi + at_a.slope * a - at_b.slope * b) * one_over(change);
      const V most = at_a.phi + at_a.slope * (where - a);
      give_up(meet, from_a && from_b && change > zero && most < clear);
    }
    const auto goes_a = left > zero, goes_b = right > zero;
    a = select(goes_a, next_a, a);
    b = select(goes_b, next_b, b);
    if (!any(goes_a || goes_b)) break;
    if (any(goes_a)) at_a = field_on(part, plane, cone, chord, a, good);
    if (any(goes_b)) at_b = field_on(part, plane, cone, chord, b, good);
    left = select(goes_a && step_a <= close, zero, left);
    right = select(goes_b && step_b <= close, zero, right);
    // Past the highest point of a border that misses the section.
    give_up(left > zero && at_a.slope <= zero, never);
    give_up(right > zero && at_b.slope >= zero, never);
  }
  give_up(left + right > zero, never);
  const auto some_left = b - a > number<V>(kNoChord) * part.radius1;
  const auto had = good > zero && (some_left || stretch.status == outside);
  stretch.status = select(had, stretch.status, unclear);
  stretch.from = a;
  stretch.to = b;
  return stretch;
}

}  // namespace lumbrical::LUMBRICAL_ISA
