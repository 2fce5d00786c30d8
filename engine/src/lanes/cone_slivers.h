// What a cone's contact gains where its field is not the formula of its zone, one source for every
// instruction set. A lane is a pair; lanes never meet.
//
// The kernel before this one parts the polygon at lines x = const (round_polygon.h). But the field changes
// its formula on the conics through the same points of the rim: with the axial coordinate q and the distance
// rho from the axis line, counted from an end of the cone, the side's field exceeds the end sphere's by
//   D = sqrt(q^2 + rho^2) - sin(alpha) q - cos(alpha) rho,
// zero to second order on the conic cos(alpha) q = sin(alpha) rho. That encloses a convex region, of which
// the line x = border takes off a cap: the sliver. With P(x, y) the integral of D over x from the conic,
// Green's theorem gives the integral of D over sliver and polygon as that of P dy along what is straight of
// their common boundary. P is closed: on a way dx along x both roots are of the form sqrt(e^2 + k^2), e
// linear, and with m the mean of the root at both ends, E the mean of e, d its change, and z = d / (2m)
//   integral = dx / 2 (m + (E^2 + k^2 atanh(z) / z) / m).
// What cancels in P is rounding of R over the sliver's area: less than the polygon's own formulas leave.
#pragma once

#include "lanes/cone_integrals.h"

namespace lumbrical::LUMBRICAL_ISA {

// Along an edge or the line P is analytic but near y = 0 and the axis line. n nodes leave about
// (2 + 4 d / length)^(-2 n) with d that distance: pieces up to these shares of it take four, six and eight.
inline constexpr double kFourNodes = 0.125, kSixNodes = 0.5, kEightNodes = 1;
// Where d vanishes, P goes with y^2 log(y) and pieces need not be shorter than this share of R.
inline constexpr double kLeastPiece = 3e-4;
// Pieces a lane may take of an edge: few beside lanes that have other things to do, many among its like.
inline constexpr int kFewPieces = 2, kManyPieces = 40;

// The sliver of an end; x is counted from under its centre.
template <class V>
struct Sliver {
  V at, h;                  // [m] x of the end where the first is 0; its height over the plane
  V s, c;                   // of the angle between axis and normal
  V sine, cosine, tangent;  // of the cone's half angle
  V steep, per_steep;       // s^2 - tan(alpha)^2 c^2: positive where the conic is a hyperbola
  V lower, border;          // [m] its extent in x
  V half_width;             // [m] at the border
  V gap2;                   // [m^2] squared distance of y = 0 from where P is not smooth
};

// Meaningless where the conic is no hyperbola.
template <class V>
Sliver<V> sliver_of(const RoundPart<V>& part, const RoundPlane<V>& plane, V at, V h, V border) {
  const V zero = number<V>(0), one = number<V>(1), t = part.tangent, s = plane.s, c = plane.c;
  const V rise = s - t * c, fall = s + t * c, steep = rise * fall, per_steep = one_over(steep);
  const V limit = border - at;
  // The conic's point on y = 0 has q = tan(alpha) |e|.
  const V lower = choose(h > zero, h * (c + t * s) * fall, h * (c - t * s) * rise) * per_steep;
  const V first = c * lower + s * h, last = c * limit + s * h;
  const V q = quotient(s * limit - c * h, choose(t > zero, t, one));
  const V half_width = root(greater((q - last) * (q + last), zero));
  const V clear = choose(first * last > zero, lesser(magnitude(first), magnitude(last)), zero);
  const V least = number<V>(kLeastPiece) * part.radius1;
  const V gap2 = greater(lesser(clear * clear, h * h * per_steep), least * least);
  return {at, h, s, c, part.sine, part.cosine, t, steep, per_steep, lower, limit, half_width, gap2};
}

// Of a root sqrt(e^2 + k2) on a way along which e runs by `run`, from its values at the ends and the mean of
// e: its mean, and over the way's length its first moment about the way's middle.
template <class V>
struct RootMoments {
  V mean, lean;
};
template <class V>
inline RootMoments<V> root_moments(V from, V to, V middle, V run, V k2) {
  const V half = number<V>(0.5), one = number<V>(1), m = half * (from + to), per = one_over(m);
  const V z = half * (run * per), z2 = z * z;
  V beyond_one = horner(kArcTangentHyperbolic, z2), ratio = one + z2 * beyond_one;  // atanh(z) / z
  const auto large = z2 > number<V>(0.029);
  if (some(large)) {
    const V full = quotient(twice_atanh(magnitude(run), from + to), choose(large, magnitude(z), one)) * half;
    ratio = choose(large, full, ratio);
    beyond_one = choose(large, quotient(full - one, choose(large, z2, one)), beyond_one);
  }
  const V tilt = middle * per;
  return {
      half * (m + tilt * middle + per * k2 * ratio),
      half * z * tilt * (half * m - number<V>(1.0 / 6) * (tilt * middle) - half * (per * k2 * beyond_one))};
}

// P(x, y), and the same of x D.
template <class V>
struct Strip {
  V zeroth, first;
};
template <class V>
inline Strip<V> strip_at(const Sliver<V>& sliver, V x, V y) {
  const V half = number<V>(0.5), zero = number<V>(0), y2 = y * y, h2 = sliver.h * sliver.h;
  const V reach = root(greater(h2 + sliver.steep * y2, zero));
  // On the conic: with S = `reach`, x = (s c h (1 + t^2) + t S) / steep and the like.
  const V along = sliver.s * sliver.h, across = sliver.tangent * sliver.c;
  const V e0 = sliver.per_steep * (along + across * reach);
  const V rho0 = sliver.per_steep * (sliver.s * reach + across * sliver.h);
  const V q0 = sliver.tangent * rho0, w0 = root(q0 * q0 + rho0 * rho0);
  const V e1 = sliver.c * x + along, q1 = sliver.s * x - sliver.c * sliver.h;
  const V rho1 = root(e1 * e1 + y2), w1 = root(q1 * q1 + rho1 * rho1);
  const V de = e1 - e0, dq = q1 - q0, width = sliver.c * de + sliver.s * dq, middle = x - half * width;
  const RootMoments<V> w = root_moments(w0, w1, middle, width, h2 + y2);
  const RootMoments<V> rho = root_moments(rho0, rho1, half * (e0 + e1), sliver.c * width, y2);
  const V zeroth = width * (w.mean - sliver.sine * (half * (q0 + q1)) - sliver.cosine * rho.mean);
  const V lean = w.lean - sliver.sine * (sliver.s * width * number<V>(1.0 / 12)) - sliver.cosine * rho.lean;
  return {zeroth, middle * zeroth + width * width * lean};
}

// Integrals of D, x D and y D.
template <class V>
struct SliverSum {
  V volume, x, y;
};

// A straight part of the boundary from p by d; `here` is 1 where there is one.
template <class V>
struct Straight {
  Wide2<V> p, d;
  V here;
};

// Adds the integral of P dy along p + t d, 0 <= t <= 1, by as many nodes as each lane needs: 4, 6, 8 or none.
template <class V>
void add_straight(const Sliver<V>& sliver, Wide2<V> p, Wide2<V> d, V nodes, SliverSum<V>& sum) {
  const V zero = number<V>(0);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto here = nodes > number<V>(static_cast<double>(i));
    if (!some(here)) return;
    const GaussNode four = kGauss4[i % 4], six = kGauss6[i % 6], eight = kGauss8[i];
    const auto by_six = nodes > number<V>(5), by_eight = nodes > number<V>(7);
    const V at = choose(by_eight, number<V>(eight.at), choose(by_six, number<V>(six.at), number<V>(four.at)));
    const V weight = choose(by_eight, number<V>(eight.weight),
                            choose(by_six, number<V>(six.weight), number<V>(four.weight)));
    const V y = p.y + at * d.y;
    const Strip<V> strip = strip_at(sliver, p.x + at * d.x, y);
    const V share = choose(here, weight * d.y, zero), volume = choose(here, share * strip.zeroth, zero);
    sum.volume = sum.volume + volume;
    sum.x = sum.x + choose(here, share * strip.first, zero);
    sum.y = sum.y + y * volume;
  }
}

// The least |y| of a straight's points.
template <class V>
inline V least_height(V y1, V y2) {
  const V zero = number<V>(0), least = lesser(magnitude(y1), magnitude(y2));
  return choose(y1 * y2 > zero, least, zero);
}

// A straight in pieces that are short against their distance from where P is not smooth: towards y = 0 that
// distance shrinks by half at most on every one. Returns 1 where the pieces did not suffice.
template <class V>
V add_in_pieces(const Sliver<V>& sliver, const Straight<V>& straight, int most, SliverSum<V>& sum) {
  const V zero = number<V>(0), one = number<V>(1), half = number<V>(0.5);
  const Wide2<V> p = straight.p, d = straight.d;
  const V length2 = dot(d, d), per_length = one_over(root(length2));
  V done = choose(straight.here > zero, zero, one);
  for (int piece = 0; piece < most; ++piece) {
    const auto here = done < one;
    if (!some(here)) return zero;
    const V y = p.y + done * d.y, rest = one - done;
    const auto near2 = [&](V share) {
      const V low = least_height(y, y + share * d.y);
      return sliver.gap2 + low * low;
    };
    const V distance = root(sliver.gap2 + y * y);
    const V step = choose(y * d.y >= zero, one, half) * (number<V>(kEightNodes) * (distance * per_length));
    const auto all = length2 * (rest * rest) <= number<V>(kEightNodes * kEightNodes) * near2(rest);
    const V share = choose(either(all, step >= rest), rest, step);
    const V squared = length2 * (share * share), clear2 = near2(share);
    V nodes = choose(squared <= number<V>(kSixNodes * kSixNodes) * clear2, number<V>(6), number<V>(8));
    nodes = choose(squared <= number<V>(kFourNodes * kFourNodes) * clear2, number<V>(4), nodes);
    add_straight(sliver, p + done * d, share * d, choose(here, nodes, zero), sum);
    done = choose(share >= rest, one, done + share);
  }
  return choose(done < one, one, zero);
}

// Where the straight near + tau along keeps to lower <= coordinate <= upper.
template <class V>
inline void keep_between(V near, V along, V lower, V upper, Span<V>& tau) {
  const V zero = number<V>(0), one = number<V>(1);
  const auto level = along == zero;
  const V per = quotient(one, choose(level, one, along));
  const V from = (lower - near) * per, to = (upper - near) * per;
  const V out = choose(either(near<lower, near> upper), beyond<V>(), zero - beyond<V>());
  tau.lower = greater(tau.lower, choose(level, out, lesser(from, to)));
  tau.upper = lesser(tau.upper, choose(level, zero - out, greater(from, to)));
}

// The part of the straight from p by d, 0 <= t <= 1, within the conic: there cos(alpha) q - sin(alpha) rho is
// concave, and points that may be in the sliver have q >= 0.
template <class V>
inline Span<V> within_conic(const Sliver<V>& sliver, Wide2<V> p, Wide2<V> d) {
  const V zero = number<V>(0), one = number<V>(1), t2 = sliver.tangent * sliver.tangent;
  const V e = sliver.c * p.x + sliver.s * sliver.h, de = sliver.c * d.x;
  const V q = sliver.s * p.x - sliver.c * sliver.h, dq = sliver.s * d.x;
  V a = dq * dq - t2 * (de * de + d.y * d.y);
  a = choose(a == zero, number<V>(-1e-280), a);
  const V b = q * dq - t2 * (e * de + p.y * d.y), c = q * q - t2 * (e * e + p.y * p.y),
          square = b * b - a * c;
  const V rise = root(greater(square, zero)), sum = choose(b >= zero, zero - (b + rise), rise - b);
  const V root1 = quotient(sum, a), root2 = quotient(c, choose(sum == zero, one, sum));
  const V first = lesser(root1, root2), second = greater(root1, root2);
  // A steep straight meets both of the cone's halves; beyond the other root q is negative.
  const auto flat = a<zero, up = dq> zero, real = square > zero;
  const V from = choose(flat, first, choose(up, second, zero)),
          to = choose(flat, second, choose(up, one, first));
  return {choose(real, greater(from, zero), zero),
          choose(real, lesser(to, one), choose(c > zero, one, zero))};
}

// The part of an edge in the sliver.
template <class V>
inline Straight<V> clipped(const Sliver<V>& sliver, const Edge<V>& edge) {
  const V zero = number<V>(0), one = number<V>(1);
  // Counted from the corner nearer to the end: a far one would bring its own rounding along.
  const auto nearer = dot(edge.p, edge.p) < dot(edge.q, edge.q);
  const Wide2<V> near = choose(nearer, edge.p, edge.q), d = edge.q - edge.p;
  Span<V> tau{choose(nearer, zero, zero - one), choose(nearer, one, zero)};
  keep_between(near.x, d.x, sliver.lower, sliver.border, tau);
  keep_between(near.y, d.y, zero - sliver.half_width, sliver.half_width, tau);
  const auto met = both(has_length(edge), tau.lower < tau.upper);
  Straight<V> none{{zero, zero}, {zero, zero}, zero};
  if (!some(met)) return none;
  const Wide2<V> start = near + tau.lower * d, along = (tau.upper - tau.lower) * d;
  const Span<V> inside = within_conic(sliver, start, along);
  const Wide2<V> rest = (inside.upper - inside.lower) * along;
  const auto here = both(met, both(inside.lower < inside.upper, rest.y != zero));
  return {choose(here, start + inside.lower * along, none.p), choose(here, rest, none.d),
          choose(here, one, zero)};
}

// What is straight of the boundary of sliver and polygon, gathered at the front in every lane.
template <class V>
struct Straights {
  std::size_t count = 0;  // the most of any lane
  Straight<V> straight[Polygon<V>::kMost + 1];
  V filled = number<V>(0);

  template <class M>
  void add(M wanted, const Straight<V>& more) {
    const V zero = number<V>(0), one = number<V>(1);
    const auto here = both(wanted, more.here > zero);
    if (!some(here)) return;
    if (some(both(here, filled == number<V>(static_cast<double>(count)))))
      straight[count++] = {{zero, zero}, {zero, zero}, zero};
    for (std::size_t k = 0; k < count; ++k) {
      const auto mine = both(here, filled == number<V>(static_cast<double>(k)));
      straight[k] = {choose(mine, more.p, straight[k].p), choose(mine, more.d, straight[k].d),
                     choose(mine, one, straight[k].here)};
    }
    filled = filled + choose(here, one, zero);
  }
};

// The part of the border's line in sliver and polygon, upwards.
template <class V>
Straight<V> line_in(const Sliver<V>& sliver, const Polygon<V>& polygon) {
  const V zero = number<V>(0), one = number<V>(1), border = sliver.border;
  V bottom = zero, top = zero;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    const auto leaves = both(edge.p.x <= border, edge.q.x > border);
    const auto enters = both(edge.p.x > border, edge.q.x <= border);
    if (!some(either(leaves, enters))) continue;
    const V y = crossing_of(edge, edge.p.x - border, edge.q.x - border).point.y;
    bottom = choose(leaves, y, bottom);
    top = choose(enters, y, top);
  }
  bottom = greater(bottom, zero - sliver.half_width);
  top = lesser(top, sliver.half_width);
  return {{border, bottom}, {zero, top - bottom}, choose(bottom < top, one, zero)};
}

// The integrals over the part of the polygon in the sliver; `lost` becomes 1 where the pieces did not
// suffice.
template <class V, class M>
SliverSum<V> over_sliver(const Sliver<V>& sliver, const Polygon<V>& polygon, M wanted, int pieces, V& lost) {
  Polygon<V> moved = polygon;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    moved.edge[i].p.x = polygon.edge[i].p.x - sliver.at;
    moved.edge[i].q.x = polygon.edge[i].q.x - sliver.at;
  }
  Straights<V> straights;
  straights.add(wanted, line_in(sliver, moved));
  for (std::size_t i = 0; i < moved.count; ++i) straights.add(wanted, clipped(sliver, moved.edge[i]));
  const V zero = number<V>(0);
  SliverSum<V> sum{zero, zero, zero};
  for (std::size_t k = 0; k < straights.count; ++k)
    lost = greater(lost, add_in_pieces(sliver, straights.straight[k], pieces, sum));
  sum.x = sum.x + sliver.at * sum.volume;
  return sum;
}

// Could the polygon, between two abscissae, reach into the sliver?
template <class V>
inline auto may_reach(const Sliver<V>& sliver, V low, V high) {
  return both(sliver.lower < sliver.border,
              both(low - sliver.at<sliver.border, high - sliver.at> sliver.lower));
}

// Between conic and line the first end's sphere was taken for the side, and the side for the second end's.
// Few polygons reach into the slivers of both ends, so every lane begins with the one it does reach into.
template <class V>
SliverSum<V> both_slivers(const RoundPart<V>& part, const RoundPlane<V>& plane, const Polygon<V>& polygon,
                          int pieces, V& lost) {
  const V zero = number<V>(0);
  SideView<V> side{};
  set_borders(part, plane, side);
  const Sliver<V> first = sliver_of(part, plane, zero, plane.h1, side.border1);
  const Sliver<V> second = sliver_of(part, plane, plane.x2, plane.h2, side.border2);
  V low = beyond<V>(), high = zero - low;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const auto here = has_length(polygon.edge[i]);
    low = choose(here, lesser(low, polygon.edge[i].p.x), low);
    high = choose(here, greater(high, polygon.edge[i].p.x), high);
  }
  const auto hyperbola = number<V>(2) * first.steep > plane.s * plane.s;
  lost = choose(hyperbola, zero, number<V>(1));
  const auto at_first = both(hyperbola, may_reach(first, low, high));
  const auto at_second = both(hyperbola, may_reach(second, low, high));
  const auto one_end = either(at_first, at_second), both_ends = both(at_first, at_second);
  Sliver<V> sliver = first;
  sliver.at = choose(at_first, first.at, second.at);
  sliver.h = choose(at_first, first.h, second.h);
  sliver.lower = choose(at_first, first.lower, second.lower);
  sliver.border = choose(at_first, first.border, second.border);
  sliver.half_width = choose(at_first, first.half_width, second.half_width);
  sliver.gap2 = choose(at_first, first.gap2, second.gap2);
  SliverSum<V> sum = over_sliver(sliver, polygon, one_end, pieces, lost);
  sum = {choose(at_first, sum.volume, zero - sum.volume), choose(at_first, sum.x, zero - sum.x),
         choose(at_first, sum.y, zero - sum.y)};
  if (some(both_ends)) {
    const SliverSum<V> less = over_sliver(second, polygon, both_ends, pieces, lost);
    sum = {sum.volume - less.volume, sum.x - less.x, sum.y - less.y};
  }
  return sum;
}

template <class V>
void cone_slivers(SliverTerms& terms) {
  RoundTerms<double>& pairs = terms.pairs;
  const int pieces = terms.patient ? kManyPieces : kFewPieces;
  for (std::size_t i = 0; i < pairs.count; i += wide::Lanes<V>::kCount) {
    const RoundPart<V> part = part_of<V>(pairs, i);
    const Wide3<V> corner[3] = {vector_at<V>(pairs.a, i), vector_at<V>(pairs.b, i), vector_at<V>(pairs.c, i)};
    RoundPlane<V> plane;
    look(part, vector_at<V>(pairs.axis, i), corner[0], corner[1], corner[2], plane);
    Polygon<V> polygon;
    set_polygon(pairs, part, plane, corner, i, polygon);
    V lost;
    const SliverSum<V> sum = both_slivers(part, plane, polygon, pieces, lost);
    put(pairs.status + i, choose(lost > number<V>(0), number<V>(kUnsure), number<V>(kContact)));
    put(pairs.volume + i, sum.volume);
    put_vector(sum.x * plane.u + sum.y * plane.v - (sum.volume * plane.h1) * plane.n, i, pairs.centre);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
