// With the axial coordinate q and the distance rho from the axis line counted from an end of the cone, the
// side's field exceeds the end sphere's by D = sqrt(q^2 + rho^2) - sin(alpha) q - cos(alpha) rho, zero on the
// conic. At abscissa x the sliver is |y| <= y_b, y_b^2 = (q / tan(alpha))^2 - e^2, so by Green's theorem the
// integral of D over sliver and polygon is - sum over edges of  integral of (int_0^clamp(y, -y_b, y_b) D dy')
// dx: outside the sliver an edge counts by its abscissa alone.
#include "section/cone_slivers.h"

#include <cmath>

#include "lanes/field.h"
#include "section/boundary_integral.h"

namespace lumbrical {
namespace {

struct Sliver {
  double lower, upper;  // in x
};

// q >= tan(alpha) |e| are two half-lines.
Sliver sliver_of(const ConeEnd& end, double border) {
  const double t = end.sine / end.cosine;
  Sliver sliver{-1e300, border};
  for (const double sign : {1.0, -1.0}) {
    const double a = end.s - sign * t * end.c, b = end.h * (end.c + sign * t * end.s);
    if (a > 0) sliver.lower = max(sliver.lower, b / a);
    if (a < 0) sliver.upper = min(sliver.upper, b / a);
    if (a == 0 && b > 0) sliver.upper = -1e300;
  }
  return sliver;
}

double half_width(const ConeEnd& end, double x) {
  const double q = (end.s * x - end.c * end.h) * end.cosine, e = (end.c * x + end.s * end.h) * end.sine;
  return q > 0 ? std::sqrt(max(0, (q - e) * (q + e))) / end.sine : 0;
}

// Where along the piece from p by d, 0 <= t <= 1, the integrand is not smooth.
Singularities kinks_along(const ConeEnd& end, const Sliver& sliver, Point2 p, Point2 d) {
  Singularities kinks;
  kinks.add((sliver.lower - p.x) / d.x, 0, true);
  kinks.add((sliver.upper - p.x) / d.x, 0, true);
  const double t = end.sine / end.cosine;
  for (const double sign : {1.0, -1.0}) {
    const double a = end.s - sign * t * end.c;
    if (a != 0) kinks.add((end.h * (end.c + sign * t * end.s) / a - p.x) / d.x, 0, true);
  }
  const double e = end.c * p.x + end.s * end.h, de = end.c * d.x;
  if (de != 0) kinks.add(-e / de, 0, true);
  add_closest_approach(de * de + d.y * d.y, e * de + p.y * d.y, e * e + p.y * p.y, kinks);
  // Crossings with the conic q^2 = tan^2 (e^2 + y^2).
  const double q = end.s * p.x - end.c * end.h, dq = end.s * d.x, t2 = t * t;
  const double qa = dq * dq - t2 * (de * de + d.y * d.y), qb = q * dq - t2 * (e * de + p.y * d.y);
  const double qc = q * q - t2 * (e * e + p.y * p.y), square = qb * qb - qa * qc;
  if (square > 0) {
    const double root = qb >= 0 ? -(qb + std::sqrt(square)) : std::sqrt(square) - qb;
    if (qa != 0) kinks.add(root / qa, 0, true);
    if (root != 0) kinks.add(qc / root, 0, true);
  }
  return kinks;
}

void add_nodes(const FieldKernels& kernels, const ConeEnd& end, StripNodes& nodes, PressureMoments& sum) {
  for (std::size_t k = nodes.count; k % 16 != 0; ++k) nodes.x[k] = nodes.y[k] = 0;
  kernels.sliver_nodes(end, nodes);
  for (std::size_t k = 0; k < nodes.count; ++k) {
    const double share = nodes.weight[k] * nodes.zeroth[k];
    sum.volume -= share;
    sum.first.x -= nodes.x[k] * share;
    sum.first.y -= nodes.weight[k] * nodes.first[k];
  }
  nodes.count = 0;
}

// The integral of D over the part of the polygon in the sliver of the end under x = `at`.
PressureMoments over_sliver(const FieldKernels& kernels, const Section& section, const ConeEnd& end,
                            double at, double border) {
  PressureMoments sum;
  const Sliver sliver = sliver_of(end, border - at);
  if (!(sliver.lower < sliver.upper)) return sum;
  StripNodes nodes;
  const Polygon2& polygon = section.polygon;
  for (int i = 0; i < polygon.count; ++i) {
    const Point2 corner = polygon.corner[static_cast<std::size_t>(i)];
    const Point2 next = polygon.corner[static_cast<std::size_t>(i + 1 == polygon.count ? 0 : i + 1)];
    const Point2 p{corner.x - at, corner.y}, q{next.x - at, next.y};
    const double from = clamp(p.x, sliver.lower, sliver.upper), to = clamp(q.x, sliver.lower, sliver.upper);
    if (from == to) continue;
    const Point2 near = dot(p, p) < dot(q, q) ? p : q;
    const double slope = (q.y - p.y) / (q.x - p.x);
    const Point2 start{from, near.y + (from - near.x) * slope}, along{to - from, (to - from) * slope};
    graded_nodes(0, 1, kinks_along(end, sliver, start, along), [&](double t, double weight) {
      if (nodes.count == StripNodes::kCapacity) add_nodes(kernels, end, nodes, sum);
      const std::size_t k = nodes.count++;
      nodes.x[k] = start.x + t * along.x;
      const double most = half_width(end, nodes.x[k]);
      nodes.y[k] = clamp(start.y + t * along.y, -most, most);
      nodes.weight[k] = weight * along.x;
    });
  }
  add_nodes(kernels, end, nodes, sum);
  sum.first.x += at * sum.volume;
  return sum;
}

}  // namespace

void add_slivers(const FieldKernels& kernels, const Section& section, Contact& contact) {
  const Slant slant = slant_of(section);
  const Borders borders = zone_borders(section);
  const ConeEnd end1{section.radius1, section.h1, section.s, section.c, slant.sine, slant.cosine};
  const ConeEnd end2{section.radius2, section.h2, section.s, section.c, slant.sine, slant.cosine};
  const PressureMoments first = over_sliver(kernels, section, end1, 0, borders.first);
  const PressureMoments second = over_sliver(kernels, section, end2, section.x2, borders.second);
  // Between conic and line the first end's sphere was taken for the side, and the side for the second end's.
  const double more = first.volume - second.volume;
  const Point2 moment = first.first - second.first;
  const double volume = contact.volume + more;
  if (!(volume > 0)) return;
  const Vec3 foot = to_world(section, {0, 0});
  const Vec3 whole = contact.volume * (contact.centre - foot) + moment.x * section.u + moment.y * section.v;
  contact.volume = volume;
  contact.centre = foot + (1 / volume) * whole;
}

}  // namespace lumbrical
