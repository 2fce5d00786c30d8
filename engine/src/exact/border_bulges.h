// Near borders that run through triangles once: the chord of the part inside the section and what lies
// between it and the border, one source for every instruction set. A tile's border in a triangle is a lane.
#pragma once

#include "base/always_inline.h"
#include "base/gauss.h"
#include "exact/border_chord.h"
#include "exact/field_across.h"

namespace lumbrical::LUMBRICAL_ISA {

// What quadrature may leave of a bulge: this share of its chord over its height, within these limits.
inline constexpr double kBulgeError = 1e-13, kLeastBulgeError = 1e-15, kMostBulgeError = 3e-9;

// Rules along the chord.
inline constexpr std::size_t kRules = 6, kMostNodes = 24;
struct ChordRules {
  GaussNode node[kRules][kMostNodes];  // none: weight 0
};
template <std::size_t N>
constexpr void set_rule(const GaussNode (&from)[N], GaussNode (&to)[kMostNodes]) {
  for (std::size_t k = 0; k < N; ++k) to[k] = from[k];
}
constexpr ChordRules chord_rules() {
  ChordRules rules{};
  set_rule(kGauss4, rules.node[0]);
  set_rule(kGauss6, rules.node[1]);
  set_rule(kGauss8, rules.node[2]);
  set_rule(kGauss12, rules.node[3]);
  set_rule(kGauss16, rules.node[4]);
  set_rule(kGauss24, rules.node[5]);
  return rules;
}
inline constexpr ChordRules kChordRules = chord_rules();

// Sum of the distances of a singularity from both ends of the chord, in chords. The ellipse round the chord
// through it tells how far a function can be continued, and so what a Gauss rule leaves.
template <class V>
V least_extent(const RoundPlane<V>& plane, const BorderChord<V>& chord, Wide3<V> joint) {
  const V zero = number<V>(0), one = number<V>(1), far = beyond<V>(), l = chord.length;
  const auto rooted = [&](V square) { return sqrt(max(square, zero)); };
  const Wide2<V> p = chord.from, q = chord.from + l * chord.along;
  // The joint, where both field and border have their apex.
  const Wide2<V> foot{dot(joint, plane.u), dot(joint, plane.v)};
  const V height = plane.h1 + dot(joint, plane.n);
  const auto from_joint = [&](Wide2<V> at) { return sqrt(dot(at - foot, at - foot) + height * height); };
  V extent = (from_joint(p) + from_joint(q)) * one_over(l);
  // The tile's axis.
  const auto from_axis = [&](Wide2<V> at) {
    const V e = plane.c * at.x + plane.s * plane.h1;
    return sqrt(e * e + at.y * at.y);
  };
  const V e = plane.c * chord.along.x, turn = sqrt(e * e + chord.along.y * chord.along.y);
  extent = min(extent, (from_axis(p) + from_axis(q)) * one_over(turn * l));
  // Where lines across the chord touch the cone: A s^2 + 2 B s + C = 0.
  const V a = chord.tilt * chord.tilt - chord.a * chord.bend, c = chord.b * chord.b;
  const V b = chord.b * chord.tilt + number<V>(0.5) * (chord.a * chord.bend) * l;
  const V square = b * b - a * c, end_b = chord.b + l * chord.tilt;
  const V no_roots = (rooted(c) + rooted(end_b * end_b)) * one_over(rooted(a) * l);
  const V sum = select(b < zero, rooted(square) - b, zero - (b + rooted(square)));
  const V middle = number<V>(0.5) * l;
  const V one_root = select(a == zero, far, abs(divide(sum, select(a == zero, one, a)) - middle));
  const V other_root = select(sum == zero, far, abs(divide(c, select(sum == zero, one, sum)) - middle));
  const V roots = number<V>(2) * min(one_root, other_root) * one_over(l);
  return min(extent, select(square < zero, no_roots, roots));
}

// The first rule that leaves no more than `error`; kRules where none does. n nodes leave about rho^(-2 n),
// rho the sum of the ellipse's axes; a height that is zero at both ends has grown by rho^2 where the ellipse
// is.
template <class V>
V rule_for(V extent, V error) {
  const V one = number<V>(1), least = max(extent, one);
  const V rho = least + sqrt(least * least - one), rho2 = rho * rho, rho4 = rho2 * rho2, rho8 = rho4 * rho4;
  const V rho6 = rho4 * rho2, rho14 = rho8 * rho6;
  const V power[kRules] = {rho6,         rho8 * rho2,         rho14,
                           rho14 * rho8, rho14 * rho8 * rho8, (rho14 * rho8) * (rho8 * rho8 * rho8)};
  V rule = number<V>(kRules);
  for (std::size_t k = kRules; k-- > 0;)
    rule = select(power[k] * error >= one, number<V>(static_cast<double>(k)), rule);
  return rule;
}

// Where along the chord and along its border the tile's own field passes over to that of the joint's sphere;
// the end of the chord where it does not. The far end has no part in a near border.
inline constexpr std::size_t kBreaks = 4;

// The two roots of a s^2 + 2 b s + c that are real but for rounding, otherwise `none`. (A capsule's are one.)
template <class V>
Wide2<V> real_roots(V a, V b, V c, V none) {
  const V zero = number<V>(0), one = number<V>(1), square = b * b - a * c;
  const V rise = sqrt(max(square, zero)), sum = select(b < zero, rise - b, zero - (b + rise));
  const auto real = square > number<V>(-1e-13) * (b * b + abs(a * c));
  return {select(real && a != zero, divide(sum, select(a == zero, one, a)), none),
          select(real && sum != zero, divide(c, select(sum == zero, one, sum)), none)};
}

// On the chord f = cos(alpha) q - sin(alpha) rho vanishes, q from the joint's end; of the roots of its
// quadratic those with q < 0 are of the cone's mirror image.
template <class V>
void breaks_on_chord(const RoundPart<V>& part, const RoundPlane<V>& plane, const BorderChord<V>& chord, V end,
                     V (&at)[kBreaks]) {
  const V zero = number<V>(0), l = chord.length;
  const Wide2<V> p = chord.from, d = chord.along;
  const V e = plane.c * p.x + plane.s * plane.h1, q = plane.s * p.x - plane.c * plane.h1 - end;
  const V de = plane.c * d.x, dq = plane.s * d.x, axial = part.cosine * q, steep = part.cosine * dq;
  const V spread2 = part.sine * part.sine;
  const Wide2<V> roots = real_roots(steep * steep - spread2 * (de * de + d.y * d.y),
                                    axial * steep - spread2 * (e * de + p.y * d.y),
                                    axial * axial - spread2 * (e * e + p.y * p.y), l);
  const auto proper = [&](V s) { return s > zero && s < l && q + s * dq >= zero; };
  at[0] = select(proper(roots.x), roots.x, l);
  at[1] = select(proper(roots.y), roots.y, l);
}

// On the border f is the same for both of its tiles i and j, and so is the distance g across the cone: q_i =
// cos(alpha_i) f + sin(alpha_i) g. So there f is 0 in a plane through the joint, q_i sin(alpha_j) = q_j
// sin(alpha_i), which meets the triangle's plane in a line.
template <class V>
void breaks_on_border(const BorderChord<V>& chord, Wide3<V> line, V (&at)[kBreaks]) {
  const V zero = number<V>(0), l = chord.length, two = number<V>(2);
  // line.x + line.y s + line.z h = 0: a point of it, and its direction.
  const V square = line.y * line.y + line.z * line.z, foot = zero - line.x * one_over(square);
  const V per = one_over(sqrt(square)), s0 = foot * line.y, h0 = foot * line.z;
  const V ds = line.z * per, dh = zero - line.y * per;
  // a h^2 + 2 (b + tilt s) h - bend s (l - s) = 0 along it.
  const V half = number<V>(0.5), bend = chord.bend;
  const V aa = chord.a * dh * dh + two * chord.tilt * ds * dh + bend * ds * ds;
  const V bb = chord.a * h0 * dh + (chord.b + chord.tilt * s0) * dh + chord.tilt * ds * h0 +
               bend * (s0 - half * l) * ds;
  const V cc = chord.a * h0 * h0 + two * (chord.b + chord.tilt * s0) * h0 - bend * s0 * (l - s0);
  const V far = beyond<V>();
  const Wide2<V> roots = real_roots(aa, bb, cc, far);
  const auto place = [&](V t) {
    const V s = s0 + t * ds, h = h0 + t * dh;
    const auto on_chord = s > zero && s < l && square > zero && t < far;
    return select(on_chord && abs(h) <= two * chord.height, s, l);
  };
  at[2] = place(roots.x);
  at[3] = place(roots.y);
}

template <class V>
void put_in_order(V (&at)[kBreaks]) {
  const auto in_order = [&](std::size_t i, std::size_t k) {
    const V low = min(at[i], at[k]), high = max(at[i], at[k]);
    at[i] = low;
    at[k] = high;
  };
  in_order(0, 1);
  in_order(2, 3);
  in_order(0, 2);
  in_order(1, 3);
  in_order(1, 2);
}

// Integrals over a bulge: of one and of the field, each with its first moments along the chord and across.
template <class V>
struct BulgeSum {
  V area, area_along, area_across, volume, along, across;
};

// `ends`: the end at the joint. The stretch of the chord from abscissa `from` to `to`. `extent` is that of
// the whole chord: a point whose distances from the ends of the chord sum up to E of its lengths has 1 + (E -
// 1) / share of the stretch's.
template <class V>
void add_along(const RoundPart<V>& part, const RoundPlane<V>& plane, const PlaneCone<V>& cone,
               const BorderChord<V>& chord, const V (&ends)[1], V from, V to, V extent, V error,
               BulgeSum<V>& sum, V& good) {
  const V zero = number<V>(0), one = number<V>(1), half = number<V>(0.5), length = to - from;
  const auto here = good > zero && length > zero;
  if (!any(here)) return;
  const V rule = rule_for(one + (extent - one) * chord.length * one_over(length), error);
  decltype(rule == rule) own[kRules];
  for (std::size_t k = 0; k < kRules; ++k) own[k] = rule == number<V>(static_cast<double>(k));
  for (std::size_t j = 0; j < kMostNodes; ++j) {
    V at = half, weight = zero;
    for (std::size_t k = 0; k < kRules; ++k) {
      const GaussNode node = kChordRules.node[k][j];
      at = select(own[k], number<V>(node.at), at);
      weight = select(own[k], number<V>(node.weight), weight);
    }
    const auto counts = here && weight > zero;
    if (!any(counts)) break;
    const V s = from + at * length;
    V fine = good;
    const V height = height_at(cone, chord, s, fine).at;
    const Wide2<V> foot = chord.from + s * chord.along;
    const WayMeans<V> means = means_across(part, plane, ends, foot, chord.across, height, counts);
    good = select(counts, select(means.smooth > zero, fine, zero), good);
    const V area = select(counts, weight * length * height, zero), volume = area * means.mean;
    sum.area = sum.area + area;
    sum.area_along = sum.area_along + area * s;
    sum.area_across = sum.area_across + area * (half * height);
    sum.volume = sum.volume + volume;
    sum.along = sum.along + volume * s;
    sum.across = sum.across + (area * means.lean) * height;
  }
  good = select(here && rule == number<V>(kRules), zero, good);
}

// `ring` is the field's (BorderTerms) as a linear function over the chord; `good` becomes 0 where the lanes
// don't do.
template <class V>
BulgeSum<V> bulge_over(const RoundPart<V>& part, const RoundPlane<V>& plane, const PlaneCone<V>& cone,
                       const BorderChord<V>& chord, Wide3<V> joint, Wide3<V> ring, V& good) {
  const V zero = number<V>(0), l = chord.length;
  const V extent = least_extent(plane, chord, joint);
  const V error = clamp(number<V>(kBulgeError) * l * one_over(chord.height), number<V>(kLeastBulgeError),
                        number<V>(kMostBulgeError));
  const V quarter = number<V>(0.25) * (part.length * part.length);
  const V ends[1] = {select(dot(joint, joint) > quarter, part.length, zero)};
  V breaks[kBreaks];
  breaks_on_chord(part, plane, chord, ends[0], breaks);
  breaks_on_border(chord, ring, breaks);
  put_in_order(breaks);
  BulgeSum<V> sum{zero, zero, zero, zero, zero, zero};
  V from = zero;
  for (const V to : breaks) {
    add_along(part, plane, cone, chord, ends, from, to, extent, error, sum, good);
    from = to;
  }
  add_along(part, plane, cone, chord, ends, from, l, extent, error, sum, good);
  return sum;
}

// The chord of the stretch of a border inside the section, from which the field must not fall below zero.
template <class V>
struct InnerChord {
  BorderChord<V> chord;
  Wide2<V> step;  // from the start of the whole chord to its own
  V good;         // 0 where there is none
};
template <class V>
LUMBRICAL_INLINE inline InnerChord<V> chord_inside(const RoundPart<V>& part, const RoundPlane<V>& plane,
                                                   const PlaneCone<V>& cone, const BorderChord<V>& whole,
                                                   const Stretch<V>& stretch) {
  const V zero = number<V>(0), inside = number<V>(kBorderInside);
  V good = number<V>(1);
  const V first_height = height_at(cone, whole, stretch.from, good).at;
  const V last_height = height_at(cone, whole, stretch.to, good).at;
  const Wide2<V> step = stretch.from * whole.along + first_height * whole.across;
  const Wide2<V> last = whole.from + stretch.to * whole.along + last_height * whole.across;
  const ConePoint<V> start =
      whole.start + ConePoint<V>{dot(cone.x, step), dot(cone.y, step), dot(cone.z, step)};
  InnerChord<V> inner{chord_over(cone, whole.from + step, last, start), step, zero};
  const BorderChord<V>& chord = inner.chord;
  good = select(chord.good > zero, good, zero);
  const V middle = field_on(part, plane, cone, chord, number<V>(0.5) * chord.length, good).phi;
  good = select(middle >= zero - number<V>(kFieldRounding) * part.radius1, good, zero);
  inner.good = select(stretch.status == inside, good, zero);
  return inner;
}

template <class V>
void border_bulges(BorderTerms& terms) {
  const V zero = number<V>(0), inside = number<V>(kBorderInside), unclear = number<V>(kBorderUnclear);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const auto row = [i](const double* from) { return get(from + i, V{}); };
    const RoundPart<V> part = round_part(row(terms.length), row(terms.radius1), row(terms.radius2),
                                         row(terms.sine), row(terms.cosine), false, true);
    RoundPlane<V> plane;
    const auto fine = look(part, vector_at<V>(terms.axis, i), vector_at<V>(terms.a, i),
                           vector_at<V>(terms.b, i), vector_at<V>(terms.c, i), plane);
    const auto in_plane = [&](Wide3<V> p) { return Wide2<V>{dot(p, plane.u), dot(p, plane.v)}; };
    const Wide3<V> joint = vector_at<V>(terms.joint, i), from = vector_at<V>(terms.from, i);
    const Wide3<V> to = vector_at<V>(terms.to, i);
    const Wide3<V> x = vector_at<V>(terms.x, i), y = vector_at<V>(terms.y, i), z = vector_at<V>(terms.z, i);
    const PlaneCone<V> cone{in_plane(x), in_plane(y), in_plane(z), row(terms.side)};
    const BorderChord<V> whole = chord_over(cone, in_plane(joint + from), in_plane(joint + to),
                                            ConePoint<V>{dot(x, from), dot(y, from), dot(z, from)});
    const Stretch<V> stretch = follow(part, plane, cone, whole);

    const InnerChord<V> inner = chord_inside(part, plane, cone, whole, stretch);
    const BorderChord<V>& chord = inner.chord;
    const Wide2<V> step = inner.step;
    V good = inner.good;
    BulgeSum<V> sum{zero, zero, zero, zero, zero, zero};
    if (any(good > zero)) {
      const Wide3<V> ring = vector_at<V>(terms.ring, i);
      const Wide2<V> own = in_plane(ring);
      const Wide3<V> over{dot(ring, from) + dot(own, step), dot(own, chord.along), dot(own, chord.across)};
      sum = bulge_over(part, plane, cone, chord, joint, over, good);
    }

    const auto kept = stretch.status == inside, had = fine && kept && good > zero;
    const auto missed = fine && stretch.status == number<V>(kBorderOutside);
    put(terms.status + i, select(had, inside, select(missed, number<V>(kBorderOutside), unclear)));
    const auto in_space = [&](V along, V across) {
      const Wide2<V> p = along * chord.along + across * chord.across;
      return p.x * plane.u + p.y * plane.v;
    };
    const Wide3<V> begin = from + step.x * plane.u + step.y * plane.v;
    put_vector(select(had, begin, from), i, terms.start);
    put_vector(select(had, begin + in_space(chord.length, zero), to), i, terms.end);
    const Wide2<V> across = select(had, chord.across, whole.across);
    put_vector(across.x * plane.u + across.y * plane.v, i, terms.across);
    put(terms.height + i, select(had, chord.height, whole.height));
    put(terms.area + i, sum.area);
    put(terms.volume + i, sum.volume);
    const Wide3<V> base = joint + begin;
    put_vector(sum.area * base + in_space(sum.area_along, sum.area_across), i, terms.area_first);
    put_vector(sum.volume * base + in_space(sum.along, sum.across), i, terms.first);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
