// The field's integrals over the part of a polygon on the side of a capsule or cone whose axis lies nearly
// along the plane, where the closed form of cone_integrals.h divides by next to nothing.
//
// By Green's theorem the integral of phi is - sum over the boundary of  integral of Psi(x, y) dx,  Psi(x, y)
// the integral of phi over y' from 0 to y, and so with the moments: pressure_field.cpp in lanes, with Gauss
// nodes along edges and arcs of the rim. n nodes on a length l whose integrand is singular at a distance d
// leave about (2 + 4 d / l)^(-2 n); lanes for which sixteen on half a piece would not do are given up.
#pragma once

#include "base/gauss.h"
#include "exact/cone_integrals.h"
#include "exact/strip_integrals.h"

namespace lumbrical::LUMBRICAL_ISA {

// d / l from which so many nodes leave rounding only; below the last a piece is halved.
inline constexpr double kClearFor12 = 0.5, kClearFor16 = 0.25, kClearForHalves = 0.125;
// Of R: with the axis this close to the plane all along a piece its logarithms are rounding.
inline constexpr double kAxisInPlane = 1e-9;

template <class V>
struct FlatSide {
  V radius, start, slope;  // e = start + slope x, the axis' height over the plane but for a factor near 1
  V level, fall, cosine;   // phi = level - fall x - cosine sqrt(e^2 + y^2)
};

template <class V>
inline FlatSide<V> flat_side(const RoundPart<V>& part, const RoundPlane<V>& plane) {
  return {part.radius1,        plane.s * plane.h1, plane.c, part.radius1 + part.sine * (plane.c * plane.h1),
          part.sine * plane.s, part.cosine};
}

// A piece of the boundary: the line from p by d, or, above or below it, the rim.
template <class V>
struct FlatPiece {
  Wide2<V> p, d;
  V arc;  // 0: the line; +1, -1: the rim on that side of y = 0, from p.x by d.x
};

template <class V>
inline void add_flat_node(const FlatSide<V>& side, Wide2<V> p, V weight, Moments<V>& sum) {
  const V zero = number<V>(0), e = side.start + side.slope * p.x, level = side.level - side.fall * p.x;
  const V near = side.cosine * e;
  StripSum<V> strip{zero, zero};
  add_strip(StripField<V>{level, side.cosine, e * e, (level - near) * (level + near)}, zero, abs(p.y), strip);
  const V share = weight * select(p.y < zero, zero - strip.zeroth, strip.zeroth);
  sum.volume = sum.volume - share;
  sum.volume_x = sum.volume_x - p.x * share;
  sum.volume_y = sum.volume_y - weight * strip.first;
}

template <class V, class M, std::size_t N>
inline void add_flat_nodes(const FlatSide<V>& side, const StripRim<V>& rim, const FlatPiece<V>& piece, V from,
                           V length, const GaussNode (&rule)[N], M here, Moments<V>& sum) {
  const V zero = number<V>(0);
  const auto on_rim = piece.arc != zero;
  Moments<V> own = no_moments<V>();
  for (const GaussNode& node : rule) {
    Wide2<V> p = piece.p + (from + length * number<V>(node.at)) * piece.d;
    if (any(here && on_rim)) p.y = select(on_rim, piece.arc * eta_of(rim, p.x), p.y);
    add_flat_node(side, p, length * number<V>(node.weight) * piece.d.x, own);
  }
  add_volumes(here, own, sum);
}

// How far beyond a piece, as a share of it, where a linear function that is f1 and f2 at its ends is zero.
template <class V>
inline V clear_of_zero(V f1, V f2) {
  const V zero = number<V>(0), span = abs(f2 - f1);
  const V clear = divide(min(abs(f1), abs(f2)), select(span > zero, span, number<V>(1)));
  return select(span > zero, select(f1 * f2 > zero, clear, zero), beyond<V>());
}

// The same of the point of a line's complex continuation where it meets the axis.
template <class V>
inline V line_clear_of_axis(V e, V de, Wide2<V> p, Wide2<V> d) {
  const V zero = number<V>(0), one = number<V>(1);
  const V a = de * de + d.y * d.y, per = one_over(a), at = zero - (e * de + p.y * d.y) * per;
  const V off = max(zero, max(zero - at, at - one));
  const V blur2 = max((e * e + p.y * p.y) * per - at * at, zero);
  return select(a > zero, sqrt(off * off + blur2), beyond<V>());
}

// And of the nearest end of the rim, where it runs into y = 0: not before its square f could have fallen to
// zero.
template <class V>
inline V rim_clear_of_end(const StripRim<V>& rim, V x, V per_length) {
  const V zero = number<V>(0), two = number<V>(2);
  const V f = max(rim.alpha + x * (rim.beta + rim.beta - rim.gamma * x), zero);
  const V slope = abs(two * (rim.beta - rim.gamma * x));
  const V steep = slope + sqrt(slope * slope + number<V>(4) * abs(rim.gamma) * f);
  return select(steep > zero, two * f * one_over(steep) * per_length, beyond<V>());
}

template <class V>
inline V clear_of(const FlatSide<V>& side, const StripRim<V>& rim, const FlatPiece<V>& piece) {
  const V zero = number<V>(0), x1 = piece.p.x, x2 = x1 + piece.d.x;
  const V e1 = side.start + side.slope * x1, e2 = side.start + side.slope * x2, de = side.slope * piece.d.x;
  const V small = number<V>(kAxisInPlane) * side.radius;
  V clear = select(abs(e1) <= small && abs(e2) <= small, beyond<V>(), clear_of_zero(e1, e2));
  const V per = one_over(abs(piece.d.x));
  const V arc = min(min(rim_clear_of_end(rim, x1, per), rim_clear_of_end(rim, x2, per)),
                    clear_of_zero(side.level - side.fall * x1, side.level - side.fall * x2));
  const V line = line_clear_of_axis(e1, de, piece.p, piece.d);
  return min(clear, select(piece.arc == zero, line, arc));
}

// Adds the integrals along a piece; `lost` becomes 1 where they could not be had.
template <class V, class M>
void add_flat_piece(const FlatSide<V>& side, const StripRim<V>& rim, const FlatPiece<V>& piece, M wanted,
                    Moments<V>& sum, V& lost) {
  const V zero = number<V>(0), one = number<V>(1), half = number<V>(0.5);
  const auto here = wanted && piece.d.x != zero;
  if (!any(here)) return;
  const V clear = clear_of(side, rim, piece);
  const auto by12 = here && clear >= number<V>(kClearFor12);
  const auto by16 = here && clear < number<V>(kClearFor12) && clear >= number<V>(kClearFor16);
  const auto halves = here && clear < number<V>(kClearFor16) && clear >= number<V>(kClearForHalves);
  if (any(by12)) add_flat_nodes(side, rim, piece, zero, one, kGauss12, by12, sum);
  if (any(by16)) add_flat_nodes(side, rim, piece, zero, one, kGauss16, by16, sum);
  if (any(halves)) {
    add_flat_nodes(side, rim, piece, zero, half, kGauss16, halves, sum);
    add_flat_nodes(side, rim, piece, half, half, kGauss16, halves, sum);
  }
  lost = select(here && clear < number<V>(kClearForHalves), one, lost);
}

// The rim in place of the line from p to q.
template <class V, class M>
void add_flat_arc(const FlatSide<V>& side, const StripRim<V>& rim, Wide2<V> p, Wide2<V> q, M here,
                  Moments<V>& sum, V& lost) {
  const RimArc<V> arc = arc_of(rim, p, q);
  add_flat_piece(side, rim, FlatPiece<V>{{arc.x1, number<V>(0)}, {arc.x2 - arc.x1, number<V>(0)}, arc.side},
                 here && rim.real_lower < rim.real_upper, sum, lost);
}

// What of the polygon lies in the side's section. False where it could not be had.
template <class V, class M>
auto add_flat_side(const RoundPart<V>& part, const RoundPlane<V>& plane, const SideView<V>& view,
                   const Polygon<V>& polygon, const Directions<V>& directions, M wanted, Moments<V>& sum,
                   InsideParts<V>& inside) {
  const V zero = number<V>(0);
  const FlatSide<V> side = flat_side(part, plane);
  StripRim<V> rim = view.rim;
  Moments<V> own = no_moments<V>();
  V lost = zero;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    const auto here = wanted && has_length(edge);
    if (!any(here)) continue;
    const StripEdge<V> on = add_strip_edge(edge, directions.t[i], here, rim, own);
    add_flat_piece(side, rim, FlatPiece<V>{on.enters, on.leaves - on.enters, zero},
                   here && on.inside.lower < on.inside.upper, own, lost);
    add_flat_arc(side, rim, edge.p, on.enters, here, own, lost);
    add_flat_arc(side, rim, on.leaves, edge.q, here, own, lost);
    inside.add(i, here && on.inside.lower < on.inside.upper, on.inside.lower, on.inside.upper);
  }
  add_where(wanted, own, sum);
  return rim.too_round == zero && lost == zero;
}

}  // namespace lumbrical::LUMBRICAL_ISA
