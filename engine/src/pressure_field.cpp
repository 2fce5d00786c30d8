// The field law's integral: phi(p) = R - distance to the axis, integrated over the contacted area.
//
// By Green's theorem the integral is - sum over boundary pieces of  integral of Psi(x, y) dx  with
// Psi(x, y) = int_0^y phi dy' in closed form: for a sphere of radius R whose centre is D away from (x, 0),
//   Psi = R y - (y r + D^2 asinh(y / D)) / 2,  r = sqrt(D^2 + y^2),
// and the same with the distance to the axis line on the side of a cylinder or cone.
#include <algorithm>
#include <cmath>

#include "boundary_integral.h"
#include "elementary.h"
#include "field.h"

namespace lumbrical {
namespace {

// int_0^y and int_0^y y' of sqrt(d2 + y'^2), y >= 0.
struct RootIntegral {
  double zeroth, first;
};

RootIntegral root_integral(double d2, double y) {
  const double r = std::sqrt(d2 + y * y);
  if (!(d2 > 1e-280)) return {0.5 * y * r, r * r * r / 3};
  const double d = std::sqrt(d2);
  // (r^3 - d^3) / 3 with r - d = y^2 / (r + d).
  return {0.5 * (y * r + d2 * arc_sinh(y / d)), y * y / (r + d) * (r * r + r * d + d2) / 3};
}

struct Strip {
  double zeroth, first;  // Psi and int_0^y y' phi dy'
};

// Where phi is this small a share of R along the whole strip, the closed form would cancel: its terms are of
// order R.
constexpr double kShallow = 0.05;

void add_strip(const Distance& distance, double from, double to, Strip& strip) {
  if (!(from < to)) return;
  const auto [level, factor, d2, gap] = distance;
  if (gap < kShallow * level * level) {
    for (const GaussNode& node : kGauss6) {
      const double y = from + (to - from) * node.at;
      const double phi = (gap - factor * factor * y * y) / (level + factor * std::sqrt(d2 + y * y));
      strip.zeroth += (to - from) * node.weight * phi;
      strip.first += (to - from) * node.weight * phi * y;
    }
    return;
  }
  const RootIntegral upper = root_integral(d2, to);
  const RootIntegral lower = from > 0 ? root_integral(d2, from) : RootIntegral{0, 0};
  strip.zeroth += level * (to - from) - factor * (upper.zeroth - lower.zeroth);
  strip.first += level * 0.5 * (to - from) * (to + from) - factor * (upper.first - lower.first);
}

Strip strip_to(const Section& section, const Slant& slant, double x, double y) {
  const Abscissa a = at_abscissa(section, slant, x);
  const double reach = std::fabs(y);
  const double side = min(reach, a.to_side), first = min(reach, a.to_first);
  Strip strip{0, 0};
  add_strip(a.second, 0, side, strip);
  add_strip(a.side, side, first, strip);
  add_strip(a.first, max(first, side), reach, strip);
  if (y < 0) strip.zeroth = -strip.zeroth;
  return strip;
}

// A piece as a line from (x, y) by (dx, dy), and how distances change along it.
struct Run {
  double x, y, dx, dy;
  bool edge;
};

// Above a centre at (centre, h) Psi is singular for every y, and an edge that comes close to it is singular
// there.
void add_centre(const Run& run, double centre, double h, Singularities& kinks) {
  const double x = run.x - centre;
  kinks.add(-x / run.dx, std::fabs(h / run.dx));
  if (!run.edge) return;
  add_closest_approach(run.dx * run.dx + run.dy * run.dy, x * run.dx + run.y * run.dy,
                       x * x + run.y * run.y + h * h, kinks);
}

// The same for the axis line, whose distance from a plane point is the root of e^2 + y^2.
void add_axis(const Run& run, double e, double de, Singularities& kinks) {
  if (de != 0) kinks.add(-e / de);
  if (run.edge)
    add_closest_approach(de * de + run.dy * run.dy, e * de + run.y * run.dy, e * e + run.y * run.y, kinks);
}

// Where a line crosses the curve cosine q = sine sqrt(e^2 + y^2) on which the nearest sphere changes.
void add_crossings(const Run& run, const Slant& slant, double q, double dq, double e, double de,
                   Singularities& kinks) {
  const double cc = slant.cosine * slant.cosine, ss = slant.sine * slant.sine;
  const double a = cc * dq * dq - ss * (de * de + run.dy * run.dy),
               b = cc * q * dq - ss * (e * de + run.y * run.dy);
  const double c = cc * q * q - ss * (e * e + run.y * run.y), discriminant = b * b - a * c;
  if (!(discriminant > 0) || a == 0) return;
  kinks.add((-b - std::sqrt(discriminant)) / a, 0, true);
  kinks.add((-b + std::sqrt(discriminant)) / a, 0, true);
}

// Where the nearest sphere changes, cosine q = sine sqrt(e^2 + y^2), the field has a weak kink: q is the
// axial coordinate from where the change starts. Psi has it where that curve meets y = 0, and where edges
// cross it.
void add_change(const Run& run, const Slant& slant, double q, double dq, double e, double de,
                Singularities& kinks) {
  for (const double sine : {slant.sine, -slant.sine}) {
    kinks.add((sine * e - slant.cosine * q) / (slant.cosine * dq - sine * de), 0, true);
  }
  if (run.edge) add_crossings(run, slant, q, dq, e, de, kinks);
}

}  // namespace

// Going out from y = 0 the field belongs to the second end, then to the side, then to the first end. So where
// the section's curve belongs to the second end, all below it does; where it belongs to the side, the first
// end is never met.
Singularities kinks_of(const Section& section, const Slant& slant, const Piece& piece, Zone::Part part) {
  const Run run{piece.from_x, piece.from_y, piece.to_x - piece.from_x, piece.to_y - piece.from_y,
                piece.kind == Piece::edge};
  Singularities kinks;
  if (part == Zone::first_end) add_centre(run, 0, section.h1, kinks);
  if (section.length == 0) return kinks;
  const double q = section.s * run.x - section.c * section.h1, dq = section.s * run.dx;
  const double e = section.c * run.x + section.s * section.h1, de = section.c * run.dx;
  const double farthest = max(q, q + dq);
  const bool side = part == Zone::side || (part == Zone::first_end && farthest > 0);
  const bool second = part == Zone::second_end || (side && farthest > section.length);
  if (side) add_axis(run, e, de, kinks);
  if (section.shape == Shape::flat) return kinks;
  if (second) add_centre(run, section.x2, section.h2, kinks);
  if (slant.sine == 0) return kinks;
  if (side && part == Zone::first_end) add_change(run, slant, q, dq, e, de, kinks);
  if (side && second) add_change(run, slant, q - section.length, dq, e, de, kinks);
  return kinks;
}

Singularities line_kinks(const Section& section, const Slant& slant, Point2 from, Point2 to) {
  const Run run{from.x, from.y, to.x - from.x, to.y - from.y, true};
  const double length2 = run.dx * run.dx + run.dy * run.dy;
  Singularities kinks;
  kinks.refine = true;
  add_closest_approach(length2, run.x * run.dx + run.y * run.dy,
                       run.x * run.x + run.y * run.y + section.h1 * section.h1, kinks);
  if (section.length == 0) return kinks;
  const double x2 = run.x - section.x2;
  add_closest_approach(length2, x2 * run.dx + run.y * run.dy,
                       x2 * x2 + run.y * run.y + section.h2 * section.h2, kinks);
  const double q = section.s * run.x - section.c * section.h1, dq = section.s * run.dx;
  const double e = section.c * run.x + section.s * section.h1, de = section.c * run.dx;
  add_closest_approach(de * de + run.dy * run.dy, e * de + run.y * run.dy, e * e + run.y * run.y, kinks);
  for (const double axial : {q, q - section.length}) {
    if (slant.sine > 1e-6) {
      add_crossings(run, slant, axial, dq, e, de, kinks);
    } else {
      kinks.add(-axial / dq, 0, true);  // where the crossings of a capsule coincide, or nearly so
    }
  }
  return kinks;
}

namespace {

PressureMoments field_by_boundary(const Section& section, const Slant& slant, const Boundary& boundary) {
  PressureMoments sum;
  for (int i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[static_cast<std::size_t>(i)];
    if (piece.kind == Piece::none || piece.from_x == piece.to_x) continue;
    const Zone& zone = section.zone[piece.zone];
    piece_nodes(piece, zone, kinks_of(section, slant, piece, zone.part),
                [&](double x, double y, double weight) {
                  const Strip strip = strip_to(section, slant, x, y);
                  sum.volume -= weight * strip.zeroth;
                  sum.first.x -= weight * x * strip.zeroth;
                  sum.first.y -= weight * strip.first;
                });
  }
  return sum;
}

}  // namespace

double field_at(const Section& section, Point2 p) {
  const Slant slant = slant_of(section);
  return field_of(section, slant, zone_of(section, slant, p).zone, p);
}

PressureMoments field_moments(const Section& section, const AreaMoments& area, const Boundary& boundary) {
  const Slant slant = slant_of(section);
  PressureMoments moments;
  if (field_of_small_region(section, slant, area, boundary, moments)) return moments;
  return field_by_boundary(section, slant, boundary);
}

}  // namespace lumbrical
