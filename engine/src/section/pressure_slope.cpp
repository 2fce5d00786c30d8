// How fast the pressure field changes along a plane's normal, integrated over the contacted area: the volume
// term of the contact's Jacobian.
//
// In the part of an end that is h over the plane d phi / dn = h / r, with r the distance from its centre. On
// the side, where phi = level - cosine r with r the distance from the axis line, it is
// -c sine + s cosine e / r. So all of it is constant + factor / sqrt(D^2 + y^2) at one x, whose integrals
// over y are closed; those over x follow pressure_field.cpp. 1 / r is one degree more singular than r:
// the quadrature is refined.
#include <cmath>

#include "base/elementary.h"
#include "section/boundary_integral.h"
#include "section/field.h"
#include "section/pressure.h"
#include "section/small_region.h"

namespace lumbrical {
namespace {

// d phi / dn = constant + factor / sqrt(d2 + y^2).
struct Slope {
  double constant, factor, d2;
};

Slope slope_in(const Section& section, const Slant& slant, Zone::Part part, double x) {
  if (part == Zone::first_end) return {0, section.h1, x * x + section.h1 * section.h1};
  if (part == Zone::second_end) {
    const double dx = x - section.x2;
    return {0, section.h2, dx * dx + section.h2 * section.h2};
  }
  const double e = section.c * x + section.s * section.h1;
  return {-slant.sine * section.c, slant.cosine * section.s * e, e * e};
}

// Integrals over y of the slope times 1, y and y^2.
struct SlopeStrip {
  double zeroth = 0, first = 0, second = 0;
};

// The antiderivatives of 1, y and y^2 over sqrt(d2 + y^2), y >= 0.
SlopeStrip inverse_root_integral(double d2, double y) {
  const double d = std::sqrt(d2), r = std::sqrt(d2 + y * y), angle = arc_sinh(y / d);
  return {angle, y * y / (r + d), 0.5 * (y * r - d2 * angle)};
}

// Where a strip is this short against the distance from the axis, the closed form of y^2 / r would cancel.
constexpr double kShort = 0.3;

void add_strip(const Slope& slope, double from, double to, SlopeStrip& strip) {
  if (!(from < to)) return;
  const auto [constant, factor, d2] = slope;
  if (to * to < kShort * kShort * d2) {
    for (const GaussNode& node : kGauss8) {
      const double y = from + (to - from) * node.at;
      const double share = (to - from) * node.weight * (constant + factor / std::sqrt(d2 + y * y));
      strip.zeroth += share;
      strip.first += share * y;
      strip.second += share * y * y;
    }
    return;
  }
  const double width = to - from, sum = to + from;
  strip.zeroth += constant * width;
  strip.first += 0.5 * constant * width * sum;
  strip.second += constant * width * (sum * sum - to * from) / 3;
  if (!(d2 > 1e-280)) return;  // the factor is no larger than the root of d2, and the integral vanishes
  const SlopeStrip upper = inverse_root_integral(d2, to), lower = inverse_root_integral(d2, from);
  strip.zeroth += factor * (upper.zeroth - lower.zeroth);
  strip.first += factor * (upper.first - lower.first);
  strip.second += factor * (upper.second - lower.second);
}

// How far out in y the nearest sphere of the hull changes: `axial` [m] is along the axis from where the
// change starts, e2 the part of the squared distance from the axis line that is not y's.
double change(double axial, const Slant& slant, double e2) {
  if (axial <= 0) return 0;
  if (slant.sine == 0) return 1e300;
  const double rho = slant.cosine * axial / slant.sine;
  return std::sqrt(max(0, rho * rho - e2));
}

// Going out in y the field belongs to the second end, then to the side, then to the first end.
SlopeStrip slope_strip_to(const Section& section, const Slant& slant, double x, double y) {
  double to_side = 0, to_first = 0;
  if (section.length != 0 && section.shape == Shape::flat) to_first = 1e300;
  if (section.length != 0 && section.shape != Shape::flat) {
    const double e = section.c * x + section.s * section.h1, q = section.s * x - section.c * section.h1;
    to_first = change(q, slant, e * e);
    to_side = change(q - section.length, slant, e * e);
  }
  const double reach = std::fabs(y);
  const double side = min(reach, to_side), first = min(reach, to_first);
  SlopeStrip strip;
  add_strip(slope_in(section, slant, Zone::second_end, x), 0, side, strip);
  add_strip(slope_in(section, slant, Zone::side, x), side, first, strip);
  add_strip(slope_in(section, slant, Zone::first_end, x), max(first, side), reach, strip);
  if (y < 0) {
    strip.zeroth = -strip.zeroth;
    strip.second = -strip.second;
  }
  return strip;
}

SlopeMoments slope_by_boundary(const Section& section, const Slant& slant, const Boundary& boundary) {
  SlopeMoments sum;
  const auto kinks = [&](const Piece& piece, const Zone& zone) {
    Singularities singular = kinks_of(section, slant, piece, zone.part);
    singular.refine = true;
    return singular;
  };
  boundary_nodes(section, boundary, kinks, [&](double x, double y, double weight) {
    const SlopeStrip strip = slope_strip_to(section, slant, x, y);
    sum.one -= weight * strip.zeroth;
    sum.x -= weight * x * strip.zeroth;
    sum.xx -= weight * x * x * strip.zeroth;
    sum.y -= weight * strip.first;
    sum.xy -= weight * x * strip.first;
    sum.yy -= weight * strip.second;
  });
  return sum;
}

}  // namespace

SlopeMoments slope_moments(const Section& section, const AreaMoments& area, const Boundary& boundary) {
  const Slant slant = slant_of(section);
  SlopeMoments sum;
  const auto add = [&](Zone::Part part, Point2 p, double weight) {
    const Slope slope = slope_in(section, slant, part, p.x);
    sum.add(p, weight * (slope.constant + slope.factor / std::sqrt(slope.d2 + p.y * p.y)));
  };
  if (small_region_nodes(section, slant, area, boundary, 2, add)) return sum;
  return slope_by_boundary(section, slant, boundary);
}

}  // namespace lumbrical
