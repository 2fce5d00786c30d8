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
// linear, and with M the sum of the root at both ends, E the mean of e, d its change, and z = d / M
//   integral = dx (M / 4 + (E^2 + k^2 atanh(z) / z) / M).
// What cancels in P is rounding of R over the sliver's area: less than the polygon's own formulas leave.
#pragma once

#include "base/gauss.h"
#include "exact/cone_integrals.h"

namespace lumbrical::LUMBRICAL_ISA {

// Along an edge or the line P is analytic but near y = 0 and the axis line. n nodes leave about
// (2 + 4 d / length)^(-2 n) with d that distance: pieces up to these shares of it take four, six and eight.
inline constexpr double kFourNodes = 0.2, kSixNodes = 0.65, kEightNodes = 1.25;
// Towards y = 0 that distance shrinks by the piece's length at most.
inline constexpr double kInwards = kEightNodes / (1 + kEightNodes);
// Where d vanishes, P goes with y^2 log(y) and pieces need not be shorter than this share of R.
inline constexpr double kLeastPiece = 3e-4;
// Where the plane lies nearly across the axis the conic is no hyperbola, or hardly one: nothing above holds.
// So much of s^2 has to be left of s^2 - tan(alpha)^2 c^2.
inline constexpr double kLeastSteep = 0.1;
// Pieces a lane may take of an edge: few beside lanes that have other things to do, many among its like.
inline constexpr int kFewPieces = 2, kManyPieces = 40;

// A plane's view of a cone, the same for both ends.
template <class V>
struct ConeView {
  V s, c;                               // of the angle between axis and normal
  V sine, cosine, tangent, per_cosine;  // of the cone's half angle
  V rise, fall, per_steep;              // s -+ tan(alpha) c, and one over their product
};
template <class V>
inline ConeView<V> view_of(const RoundPart<V>& part, const RoundPlane<V>& plane) {
  const V turn = part.tangent * plane.c, rise = plane.s - turn, fall = plane.s + turn;
  return {plane.s,         plane.c, part.sine, part.cosine,          part.tangent,
          part.per_cosine, rise,    fall,      one_over(rise * fall)};
}

// The sliver of an end; x is counted from under its centre.
template <class V>
struct Sliver {
  V at, h;          // [m] x of the end where the first is 0; its height over the plane
  V lower, border;  // [m] its extent in x
  V half_width2;    // [m^2] the square of half its extent in y, which it has at the border
  V gap2;           // [m^2] squared distance of y = 0 from where P is not smooth
};
template <class V>
Sliver<V> sliver_of(const ConeView<V>& view, V radius, V at, V h, V border) {
  const V zero = number<V>(0), t = view.tangent, t2 = t * t, limit = border - at;
  // The conic's point on y = 0 has q = tan(alpha) |e|.
  const V lower = view.per_steep * select(h > zero, h * (view.c + t * view.s) * view.fall,
                                          h * (view.c - t * view.s) * view.rise);
  const V first = view.c * lower + view.s * h, last = view.c * limit + view.s * h;
  const V q = view.s * limit - view.c * h, squares = q * q - t2 * (last * last);
  const V clear = select(first * last > zero, min(abs(first), abs(last)), zero);
  const V least = number<V>(kLeastPiece) * radius;
  const V gap2 = max(min(clear * clear, h * h * view.per_steep), least * least);
  return {at, h, lower, limit, divide(max(squares, zero), select(t > zero, t2, number<V>(1))), gap2};
}

// (atanh(z) / z - 1) / z^2 as a polynomial of z^2, by Chebyshev's nodes up to kMostRatio; error 2.4e-15.
inline constexpr double kMostRatio = 0.16;
inline constexpr double kArcRatio[] = {0.333333333333331339,  0.200000000002491355,  0.142857142345224006,
                                       0.111111151775580345,  0.0909074572834334415, 0.0769605618162069668,
                                       0.0661474094914890494, 0.063213115265294328,  0.0308185461529737503,
                                       0.103556050110106454};

// Of a root sqrt(e^2 + k2) on a way along which e runs by `run`, from the sum of its values at the ends, one
// over that, and the mean of e: its mean, and over the way's length its first moment about the way's middle.
template <class V>
struct RootMoments {
  V mean, lean;
};
template <class V>
inline RootMoments<V> root_moments(V twice, V per, V middle, V run, V k2) {
  const V one = number<V>(1);
  const V z = run * per, z2 = z * z;
  V rest = horner(kArcRatio, z2);
  const auto large = z2 > number<V>(kMostRatio);
  if (any(large)) {
    const V ratio = divide(twice_atanh(abs(run), twice), select(large, abs(z + z), one));
    rest = select(large, divide(ratio - one, select(large, z2, one)), rest);
  }
  const V tilt = middle * per, bend = k2 * per, own = tilt * middle;
  return {number<V>(0.25) * twice + own + bend + z2 * (bend * rest),
          z * tilt * (number<V>(0.25) * twice - number<V>(1.0 / 3) * own - bend * rest)};
}

// P(x, y), and the same of x D.
template <class V>
struct Strip {
  V zeroth, first;
};
template <class V>
inline Strip<V> strip_at(const ConeView<V>& view, V h, V x, V y) {
  const V half = number<V>(0.5), zero = number<V>(0), one = number<V>(1);
  const V y2 = y * y, k2 = h * h + y2, steep = view.rise * view.fall;
  const V reach = sqrt(max(h * h + steep * y2, zero));
  // On the conic: with S = `reach`, x = (s c h (1 + t^2) + t S) / steep and the like.
  const V along = view.s * h, across = view.tangent * view.c;
  const V e0 = view.per_steep * (along + across * reach);
  const V rho0 = view.per_steep * (view.s * reach + across * h);
  const V q0 = view.tangent * rho0, w0 = view.per_cosine * rho0;
  const V e1 = view.c * x + along, q1 = view.s * x - view.c * h;
  const V square = e1 * e1 + y2, rho = rho0 + sqrt(square), w = w0 + sqrt(q1 * q1 + square);
  const V both_roots = rho * w, per = divide(one, select(both_roots > zero, both_roots, one));
  const V width = view.c * (e1 - e0) + view.s * (q1 - q0), middle = x - half * width;
  const RootMoments<V> far = root_moments(w, per * rho, middle, width, k2);
  const RootMoments<V> out = root_moments(rho, per * w, half * (e0 + e1), view.c * width, y2);
  const V zeroth = width * (far.mean - half * (view.sine * (q0 + q1)) - view.cosine * out.mean);
  const V lean = far.lean - number<V>(1.0 / 12) * (view.sine * view.s * width) - view.cosine * out.lean;
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
void add_straight(const ConeView<V>& view, V h, Wide2<V> p, Wide2<V> d, V nodes, SliverSum<V>& sum) {
  const V zero = number<V>(0);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto here = nodes > number<V>(static_cast<double>(i));
    if (!any(here)) return;
    const GaussNode four = kGauss4[i % 4], six = kGauss6[i % 6], eight = kGauss8[i];
    const auto by_six = nodes > number<V>(5), by_eight = nodes > number<V>(7);
    const V at = select(by_eight, number<V>(eight.at), select(by_six, number<V>(six.at), number<V>(four.at)));
    const V weight = select(by_eight, number<V>(eight.weight),
                            select(by_six, number<V>(six.weight), number<V>(four.weight)));
    const V y = p.y + at * d.y;
    const Strip<V> strip = strip_at(view, h, p.x + at * d.x, y);
    const V share = select(here, weight * d.y, zero), volume = select(here, share * strip.zeroth, zero);
    sum.volume = sum.volume + volume;
    sum.x = sum.x + select(here, share * strip.first, zero);
    sum.y = sum.y + y * volume;
  }
}

// The least |y| of a straight's points.
template <class V>
inline V least_height(V y1, V y2) {
  const V zero = number<V>(0), least = min(abs(y1), abs(y2));
  return select(y1 * y2 > zero, least, zero);
}

// A straight in pieces that are short against their distance from where P is not smooth. Returns 1 where the
// pieces did not suffice.
template <class V>
V add_in_pieces(const ConeView<V>& view, const Sliver<V>& sliver, const Straight<V>& straight, int most,
                SliverSum<V>& sum) {
  const V zero = number<V>(0), one = number<V>(1);
  const Wide2<V> p = straight.p, d = straight.d;
  const V length2 = dot(d, d);
  V done = select(straight.here > zero, zero, one);
  for (int piece = 0; piece < most; ++piece) {
    const auto here = done < one;
    if (!any(here)) return zero;
    const V y = p.y + done * d.y, rest = one - done;
    // In the unit of the least distance, squared.
    const auto relative = [&](V share, double limit) {
      const V low = least_height(y, y + share * d.y);
      return length2 * (share * share) <= number<V>(limit * limit) * (sliver.gap2 + low * low);
    };
    V share = rest;
    const V whole = select(relative(rest, kEightNodes), one, zero);
    if (any(here && whole == zero)) {
      const V step = select(y * d.y >= zero, number<V>(kEightNodes), number<V>(kInwards)) *
                     sqrt((sliver.gap2 + y * y) * one_over(length2));
      share = select(whole > zero || step >= rest, rest, step);
    }
    const V nodes = select(relative(share, kFourNodes), number<V>(4),
                           select(relative(share, kSixNodes), number<V>(6), number<V>(8)));
    add_straight(view, sliver.h, p + done * d, share * d, select(here, nodes, zero), sum);
    done = select(share >= rest, one, done + share);
  }
  return select(done < one, one, zero);
}

// The part of the straight from p by d, 0 <= t <= 1, within the conic: there cos(alpha) q - sin(alpha) rho is
// concave, and points that may be in the sliver have q >= 0.
template <class V>
inline Span<V> within_conic(const ConeView<V>& view, V h, Wide2<V> p, Wide2<V> d) {
  const V zero = number<V>(0), one = number<V>(1), t2 = view.tangent * view.tangent;
  const V e = view.c * p.x + view.s * h, de = view.c * d.x, q = view.s * p.x - view.c * h, dq = view.s * d.x;
  V a = dq * dq - t2 * (de * de + d.y * d.y);
  a = select(a == zero, number<V>(-1e-280), a);  // along an asymptote of the conic
  const V b = q * dq - t2 * (e * de + p.y * d.y), c = q * q - t2 * (e * e + p.y * p.y),
          square = b * b - a * c;
  const V rise = sqrt(max(square, zero)), sum = select(b >= zero, zero - (b + rise), rise - b);
  const V root1 = divide(sum, a), root2 = divide(c, select(sum == zero, one, sum));
  const V first = min(root1, root2), second = max(root1, root2);
  // A steep straight meets both of the cone's halves; beyond the other root q is negative.
  const auto flat = a<zero, up = dq> zero, real = square > zero;
  const V from = select(flat, first, select(up, second, zero)),
          to = select(flat, second, select(up, one, first));
  // Where an edge begins in the apex of the conic, which has two straights there, rounding may leave no
  // roots.
  const auto all = c + (c + (b + b + a)) > zero && q + (q + dq) > zero;
  return {select(real, max(from, zero), zero), select(real, min(to, one), select(all, one, zero))};
}

// Where the border's line enters and leaves the polygon.
template <class V>
struct Line {
  V bottom, top;
};

// The part of an edge in the sliver. Its crossing with the border's line, if any, becomes one of the ends of
// `line`.
template <class V>
Straight<V> clipped(const ConeView<V>& view, const Sliver<V>& sliver, const Edge<V>& edge, Line<V>& line) {
  const V zero = number<V>(0), one = number<V>(1), border = sliver.border;
  const Straight<V> none{{zero, zero}, {zero, zero}, zero};
  const auto right = min(edge.p.x, edge.q.x) > border, left = max(edge.p.x, edge.q.x) < sliver.lower;
  const V near_y = least_height(edge.p.y, edge.q.y);
  const auto past = near_y * near_y > sliver.half_width2;
  // An edge past the sliver meets the line anywhere past it.
  const auto leaves = edge.p.x <= border && edge.q.x > border;
  const auto enters = edge.p.x > border && edge.q.x <= border;
  line = {select(leaves, edge.p.y, line.bottom), select(enters, edge.p.y, line.top)};
  const V met = select(right || left || past, zero, one);
  if (!any(met > zero)) return none;
  // Counted from the corner nearer to the end: a far one would bring its own rounding along.
  const auto nearer = dot(edge.p, edge.p) < dot(edge.q, edge.q);
  const Wide2<V> near = select(nearer, edge.p, edge.q), d = edge.q - edge.p;
  const auto upright = d.x == zero;
  const V per = divide(one, select(upright, one, d.x));
  const V from = (sliver.lower - near.x) * per, to = (border - near.x) * per;
  const V crossing = near.y + to * d.y;
  line.bottom = select(leaves && met > zero, crossing, line.bottom);
  line.top = select(enters && met > zero, crossing, line.top);
  const V first = select(nearer, zero, zero - one), last = select(nearer, one, zero);
  const V start = select(upright, first, max(first, min(from, to)));
  const V length = select(upright, last, min(last, max(from, to))) - start;
  const Wide2<V> base = near + start * d, along = length * d;
  const Span<V> inside = within_conic(view, sliver.h, base, along);
  const auto in = met > zero && length > zero && inside.lower < inside.upper;
  const auto here = in && d.y != zero;  // along x the integral of P dy is nothing
  return {select(here, base + inside.lower * along, none.p),
          select(here, (inside.upper - inside.lower) * along, none.d), select(here, one, zero)};
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
    const auto here = wanted && more.here > zero;
    if (!any(here)) return;
    if (any(here && filled == number<V>(static_cast<double>(count))))
      straight[count++] = {{zero, zero}, {zero, zero}, zero};
    for (std::size_t k = 0; k < count; ++k) {
      const auto mine = here && filled == number<V>(static_cast<double>(k));
      straight[k] = {select(mine, more.p, straight[k].p), select(mine, more.d, straight[k].d),
                     select(mine, one, straight[k].here)};
    }
    filled = filled + select(here, one, zero);
  }
};

// The integrals over the part of the polygon in the sliver; `lost` becomes 1 where the pieces did not
// suffice.
template <class V, class M>
SliverSum<V> over_sliver(const ConeView<V>& view, const Sliver<V>& sliver, const Polygon<V>& polygon,
                         M wanted, int pieces, V& lost) {
  const V zero = number<V>(0), one = number<V>(1);
  Straight<V> edges[Polygon<V>::kMost];
  Line<V> line{zero, zero};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    Edge<V> edge = polygon.edge[i];
    edge.p.x = edge.p.x - sliver.at;
    edge.q.x = edge.q.x - sliver.at;
    edges[i] = clipped(view, sliver, edge, line);
  }
  const V half_width = sqrt(sliver.half_width2);
  line = {max(line.bottom, zero - half_width), min(line.top, half_width)};
  // The line is the longest: first, it is not kept waiting by another lane's edges.
  Straights<V> straights;
  straights.add(wanted, {{sliver.border, line.bottom},
                         {zero, line.top - line.bottom},
                         select(line.bottom < line.top, one, zero)});
  for (std::size_t i = 0; i < polygon.count; ++i) straights.add(wanted, edges[i]);
  SliverSum<V> sum{zero, zero, zero};
  for (std::size_t k = 0; k < straights.count; ++k)
    lost = max(lost, add_in_pieces(view, sliver, straights.straight[k], pieces, sum));
  sum.x = sum.x + sliver.at * sum.volume;
  return sum;
}

// Could the polygon, between two abscissae, reach into the sliver?
template <class V>
inline auto may_reach(const Sliver<V>& sliver, V low, V high) {
  return sliver.lower < sliver.border && low - sliver.at < sliver.border && high - sliver.at > sliver.lower;
}

// Between conic and line the first end's sphere was taken for the side, and the side for the second end's.
// Few polygons reach into the slivers of both ends, so every lane begins with the one it does reach into.
template <class V>
SliverSum<V> both_slivers(const RoundPart<V>& part, const RoundPlane<V>& plane, const Polygon<V>& polygon,
                          int pieces, V& lost) {
  const V zero = number<V>(0);
  SideView<V> side{};
  set_borders(part, plane, side);
  const ConeView<V> view = view_of(part, plane);
  const Sliver<V> first = sliver_of(view, part.radius1, zero, plane.h1, side.border1);
  const Sliver<V> second = sliver_of(view, part.radius1, plane.x2, plane.h2, side.border2);
  V low = beyond<V>(), high = zero - low;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const auto here = has_length(polygon.edge[i]);
    low = select(here, min(low, polygon.edge[i].p.x), low);
    high = select(here, max(high, polygon.edge[i].p.x), high);
  }
  const auto hyperbola = view.rise * view.fall > number<V>(kLeastSteep) * (view.s * view.s);
  lost = select(hyperbola, zero, number<V>(1));
  const auto at_first = hyperbola && may_reach(first, low, high);
  const auto at_second = hyperbola && may_reach(second, low, high);
  const auto one_end = at_first || at_second, both_ends = at_first && at_second;
  const auto of = [&](V mine, V other) { return select(at_first, mine, other); };
  const Sliver<V> sliver{of(first.at, second.at),
                         of(first.h, second.h),
                         of(first.lower, second.lower),
                         of(first.border, second.border),
                         of(first.half_width2, second.half_width2),
                         of(first.gap2, second.gap2)};
  SliverSum<V> sum = over_sliver(view, sliver, polygon, one_end, pieces, lost);
  sum = {select(at_first, sum.volume, zero - sum.volume), select(at_first, sum.x, zero - sum.x),
         select(at_first, sum.y, zero - sum.y)};
  if (any(both_ends)) {
    const SliverSum<V> less = over_sliver(view, second, polygon, both_ends, pieces, lost);
    sum = {sum.volume - less.volume, sum.x - less.x, sum.y - less.y};
  }
  return sum;
}

template <class V>
void cone_slivers(RoundTerms& pairs) {
  const int pieces = pairs.patient ? kManyPieces : kFewPieces;
  for (std::size_t i = 0; i < pairs.count; i += wide::Lanes<V>::kCount) {
    const RoundPart<V> part = part_of<V>(pairs, i);
    const Wide3<V> corner[3] = {vector_at<V>(pairs.a, i), vector_at<V>(pairs.b, i), vector_at<V>(pairs.c, i)};
    RoundPlane<V> plane;
    look(part, vector_at<V>(pairs.axis, i), corner[0], corner[1], corner[2], plane);
    Polygon<V> polygon;
    set_polygon(pairs, part, plane, corner, i, polygon);
    V lost;
    const SliverSum<V> sum = both_slivers(part, plane, polygon, pieces, lost);
    put(pairs.status + i, select(lost > number<V>(0), number<V>(kUnclear), number<V>(kContact)));
    put(pairs.volume + i, sum.volume);
    put_vector(sum.x * plane.u + sum.y * plane.v - (sum.volume * plane.h1) * plane.n, i, pairs.centre);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
