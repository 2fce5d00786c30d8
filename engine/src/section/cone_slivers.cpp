// With the axial coordinate q and the distance rho from the axis line counted from an end of the cone, the
// side's field exceeds the end sphere's by
//   D = sqrt(q^2 + rho^2) - sin(alpha) q - cos(alpha) rho = f^2 / (sqrt(q^2 + rho^2) + sin(alpha) q +
//   cos(alpha) rho), f = cos(alpha) q - sin(alpha) rho,
// zero on the conic f = 0. The conic encloses a convex region, of which the line x = border takes off a cap:
// the sliver. With P(x, y) the integral of D over x from the conic, zero on it, Green's theorem gives the
// integral of D over sliver and polygon as that of P dy along what is straight of their common boundary.
#include "section/cone_slivers.h"

#include <cmath>

#include "lanes/field.h"

namespace lumbrical {
namespace {

// P is analytic but for the axis line, seen |e| away. n nodes leave about (2 + 4 d / length)^(-2 n) with d
// that distance; of something as small as a sliver, nine digits are plenty.
constexpr double kShort = 0.125, kMiddling = 0.5;  // of |e|: pieces four and six nodes will do for
constexpr int kMostPieces = 8;
constexpr double kNarrow = 0.2, kWide = 1;  // of |e|: slivers four and eight nodes will do for, across

struct Sliver {
  ConeEnd end;
  double lower, border;  // [m] its extent in x, counted from under the end's centre
  double half_width;     // [m] at the border
  double clear;          // [m] least distance of the plane's points in it from the axis line
};

// How an attempt at a sliver went. A region whose integrand is not smooth enough is for the general path.
enum class Reach : std::uint8_t { nothing, something, unsure };

Reach sliver_of(const ConeEnd& end, double border, Sliver& sliver) {
  const double t = end.sine / end.cosine, rise = end.s - t * end.c, fall = end.s + t * end.c;
  if (!(2 * rise * fall > end.s * end.s)) return Reach::unsure;
  sliver.end = end;
  sliver.border = border;
  sliver.lower = end.h > 0 ? end.h * (end.c + t * end.s) / rise : end.h * (end.c - t * end.s) / fall;
  if (!(sliver.lower < border)) return Reach::nothing;
  const double first = end.c * sliver.lower + end.s * end.h, last = end.c * border + end.s * end.h;
  sliver.clear = min(std::fabs(first), std::fabs(last));
  const double width = border - sliver.lower;
  if (!(first * last > 0 && width < kWide * sliver.clear)) return Reach::unsure;
  sliver.end.inner = width < kNarrow * sliver.clear ? 4 : 8;
  const double q = (end.s * border - end.c * end.h) / t;
  sliver.half_width = std::sqrt(max(0, (q - last) * (q + last)));
  return Reach::something;
}

// Where the straight near + tau along, first <= tau <= second, keeps to lower <= coordinate <= upper.
void keep_between(double near, double along, double lower, double upper, Interval& tau) {
  const double from = (lower - near) / along, to = (upper - near) / along;
  if (along > 0 || along < 0) {
    tau.first = max(tau.first, min(from, to));
    tau.second = min(tau.second, max(from, to));
  } else if (near < lower || near > upper) {
    tau.second = tau.first;
  }
}

// The part of the straight from p by d, 0 <= t <= 1, where f >= 0: f is concave, and the sliver's points have
// q > 0.
Interval within_conic(const ConeEnd& end, Point2 p, Point2 d) {
  const double t2 = end.sine * end.sine / (end.cosine * end.cosine);
  const double e = end.c * p.x + end.s * end.h, de = end.c * d.x;
  const double q = end.s * p.x - end.c * end.h, dq = end.s * d.x;
  const double a = dq * dq - t2 * (de * de + d.y * d.y), b = q * dq - t2 * (e * de + p.y * d.y);
  const double c = q * q - t2 * (e * e + p.y * p.y), square = b * b - a * c;
  if (!(square > 0)) return c > 0 ? Interval{0, 1} : Interval{0, 0};
  const double root = b >= 0 ? -(b + std::sqrt(square)) : std::sqrt(square) - b;
  const double one = a != 0 ? root / a : 1e300, other = root != 0 ? c / root : 1e300;
  const double first = min(one, other), second = max(one, other);
  if (a < 0) return {max(0, first), min(1, second)};
  // Two cones meet the straight; beyond the other root q is negative.
  return dq > 0 ? Interval{max(0, second), 1} : Interval{0, min(1, first)};
}

struct SliverSum {
  const FieldKernels& kernels;
  const Sliver& sliver;
  StripNodes nodes;
  PressureMoments sum;
  bool smooth = true;
  SliverSum(const FieldKernels& k, const Sliver& s) : kernels(k), sliver(s) {}

  void flush() {
    for (std::size_t k = nodes.count; k % 16 != 0; ++k) nodes.x[k] = nodes.y[k] = 0;
    kernels.sliver_nodes(sliver.end, nodes);
    for (std::size_t k = 0; k < nodes.count; ++k) {
      const double share = nodes.weight[k] * nodes.zeroth[k];
      sum.volume += share;
      sum.first.x += nodes.weight[k] * nodes.first[k];
      sum.first.y += nodes.y[k] * share;
    }
    nodes.count = 0;
  }

  template <std::size_t N>
  void add_nodes(Point2 p, Point2 d, const GaussNode (&rule)[N]) {
    if (nodes.count + N > StripNodes::kCapacity) flush();
    for (const GaussNode& node : rule) {
      const std::size_t k = nodes.count++;
      nodes.x[k] = p.x + node.at * d.x;
      nodes.y[k] = p.y + node.at * d.y;
      nodes.weight[k] = node.weight * d.y;
    }
  }

  // The integral of P dy along a straight in the sliver.
  void add_straight(Point2 p, Point2 d) {
    const double length = std::sqrt(dot(d, d)), share = length / sliver.clear;
    if (d.y == 0) return;
    if (share <= kShort) return add_nodes(p, d, kGauss4);
    if (share <= kMiddling) return add_nodes(p, d, kGauss6);
    const double pieces = share <= 1 ? 1 : std::ceil(share);
    if (!(pieces <= kMostPieces)) {
      smooth = false;
      return;
    }
    const Point2 step = (1 / pieces) * d;
    for (double i = 0; i < pieces; ++i) add_nodes(p + i * step, step, kGauss8);
  }
};

// The integral of D over the part of the polygon in the sliver of the end under x = `at`; false where it is
// not smooth enough.
bool over_sliver(const FieldKernels& kernels, const Section& section, const ConeEnd& end, double at,
                 double border, PressureMoments& result) {
  Sliver sliver;
  const Reach reach = sliver_of(end, border - at, sliver);
  if (reach != Reach::something) return reach == Reach::nothing;
  SliverSum integral(kernels, sliver);
  const Polygon2& polygon = section.polygon;
  Interval cut{0, 0};  // of the border's line in the polygon
  for (int i = 0; i < polygon.count; ++i) {
    const Point2 corner = polygon.corner[static_cast<std::size_t>(i)];
    const Point2 next = polygon.corner[static_cast<std::size_t>(i + 1 == polygon.count ? 0 : i + 1)];
    const Point2 p{corner.x - at, corner.y}, q{next.x - at, next.y}, d = q - p;
    const bool p_nearer = dot(p, p) < dot(q, q);
    const Point2 near = p_nearer ? p : q;
    const bool p_in = p.x <= sliver.border, q_in = q.x <= sliver.border;
    if (p_in != q_in) {
      const double y = near.y + (sliver.border - near.x) * (d.y / d.x);
      (p_in ? cut.first : cut.second) = y;
    }
    Interval tau = p_nearer ? Interval{0, 1} : Interval{-1, 0};
    keep_between(near.x, d.x, sliver.lower, sliver.border, tau);
    keep_between(near.y, d.y, -sliver.half_width, sliver.half_width, tau);
    if (!(tau.first < tau.second)) continue;
    const Point2 start = near + tau.first * d, along = (tau.second - tau.first) * d;
    const Interval inside = within_conic(end, start, along);
    if (inside.first < inside.second)
      integral.add_straight(start + inside.first * along, (inside.second - inside.first) * along);
  }
  const double from = max(cut.first, -sliver.half_width), to = min(cut.second, sliver.half_width);
  if (from < to) integral.add_straight({sliver.border, from}, {0, to - from});
  integral.flush();
  result = integral.sum;
  result.first.x += at * result.volume;
  return integral.smooth;
}

}  // namespace

bool add_slivers(const FieldKernels& kernels, const Section& section, Contact& contact) {
  const Slant slant = slant_of(section);
  const Borders borders = zone_borders(section);
  const ConeEnd end1{section.radius1, section.h1, section.s, section.c, slant.sine, slant.cosine};
  const ConeEnd end2{section.radius2, section.h2, section.s, section.c, slant.sine, slant.cosine};
  PressureMoments first, second;
  if (!over_sliver(kernels, section, end1, 0, borders.first, first) ||
      !over_sliver(kernels, section, end2, section.x2, borders.second, second)) {
    return false;
  }
  // Between conic and line the first end's sphere was taken for the side, and the side for the second end's.
  const double more = first.volume - second.volume;
  const Point2 moment = first.first - second.first;
  const double volume = contact.volume + more;
  if (!(volume > 0)) return true;
  const Vec3 foot = to_world(section, {0, 0});
  const Vec3 whole = contact.volume * (contact.centre - foot) + moment.x * section.u + moment.y * section.v;
  contact.volume = volume;
  contact.centre = foot + (1 / volume) * whole;
  return true;
}

}  // namespace lumbrical
