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

// The field has a kink on the axis and at the end centres. Psi has one for every y above the point where the
// axis pierces the plane, and where edges come close to axis or centres. On a cone it has a weak one where
// the nearest sphere changes.
Singularities kinks_of(const Section& section, const Slant& slant, const Piece& piece) {
  Singularities kinks;
  const double x = piece.from_x, y = piece.from_y, dx = piece.to_x - x, dy = piece.to_y - y;
  const double scale = 1 / std::fabs(dx);
  const bool edge = piece.kind == Piece::edge;
  const double e = section.c * x + section.s * section.h1, de = section.c * dx;
  kinks.add(-x / dx, std::fabs(section.h1) * scale);
  if (edge)
    add_closest_approach(dx * dx + dy * dy, x * dx + y * dy, x * x + y * y + section.h1 * section.h1, kinks);
  if (section.length == 0) return kinks;
  const double x2 = x - section.x2;
  kinks.add(-x2 / dx, std::fabs(section.h2) * scale);
  if (de != 0) kinks.add(-e / de);
  if (edge) {
    add_closest_approach(dx * dx + dy * dy, x2 * dx + y * dy, x2 * x2 + y * y + section.h2 * section.h2,
                         kinks);
    add_closest_approach(de * de + dy * dy, e * de + y * dy, e * e + y * y, kinks);
  }
  if (slant.sine == 0) return kinks;
  for (const double start : {0.0, section.length}) {
    // cosine (q - start) = +- sine |e| on y = 0, and along an edge cosine^2 (q - start)^2 = sine^2 (e^2 +
    // y^2).
    const double q = section.s * x - section.c * section.h1 - start, dq = section.s * dx;
    for (const double sine : {slant.sine, -slant.sine}) {
      kinks.add((sine * e - slant.cosine * q) / (slant.cosine * dq - sine * de));
    }
    if (!edge) continue;
    const double cc = slant.cosine * slant.cosine, ss = slant.sine * slant.sine;
    const double a = cc * dq * dq - ss * (de * de + dy * dy), b = cc * q * dq - ss * (e * de + y * dy);
    const double c = cc * q * q - ss * (e * e + y * y), discriminant = b * b - a * c;
    if (!(discriminant > 0) || a == 0) continue;
    kinks.add((-b - std::sqrt(discriminant)) / a);
    kinks.add((-b + std::sqrt(discriminant)) / a);
  }
  return kinks;
}

PressureMoments field_by_boundary(const Section& section, const Slant& slant, const Boundary& boundary) {
  PressureMoments sum;
  for (int i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[static_cast<std::size_t>(i)];
    if (piece.kind == Piece::none || piece.from_x == piece.to_x) continue;
    const Zone& zone = section.zone[piece.zone];
    piece_nodes(piece, zone, kinks_of(section, slant, piece), [&](double x, double y, double weight) {
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
