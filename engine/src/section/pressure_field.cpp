// The field law's integral: phi(p) = R - distance to the axis, integrated over the contacted area.
//
// By Green's theorem the integral is - sum over boundary pieces of  integral of Psi(x, y) dx  with
// Psi(x, y) = int_0^y phi dy' in closed form: for a sphere of radius R whose centre is D away from (x, 0),
//   Psi = R y - (y r + D^2 asinh(y / D)) / 2,  r = sqrt(D^2 + y^2),
// and the same with the distance to the axis line on the side of a cylinder or cone.
#include <cmath>

#include "exact/exact_kernels.h"
#include "section/boundary_integral.h"
#include "section/field.h"
#include "section/pressure.h"
#include "section/small_region.h"
#include "section/stated_errors.h"

namespace lumbrical {
namespace {

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

StripSection strip_section(const Section& section, const Slant& slant) {
  const auto kind = section.length == 0            ? StripSection::sphere
                    : section.shape == Shape::flat ? StripSection::side_only
                                                   : StripSection::hull;
  return {kind,      section.radius1, section.radius2, section.h1, section.h2,  section.x2,
          section.s, section.c,       section.length,  slant.sine, slant.cosine};
}

// Computes the nodes gathered so far and adds them up, in their order.
void add_nodes(const ExactKernels& kernels, const StripSection& section, StripNodes& nodes,
               PressureMoments& sum) {
  for (std::size_t k = nodes.count; k % 16 != 0; ++k) nodes.x[k] = nodes.y[k] = 0;
  kernels.strip_nodes(section, nodes);
  for (std::size_t k = 0; k < nodes.count; ++k) {
    const double share = nodes.weight[k] * nodes.zeroth[k];
    sum.volume -= share;
    sum.first.x -= nodes.x[k] * share;
    sum.first.y -= nodes.weight[k] * nodes.first[k];
  }
  nodes.count = 0;
}

PressureMoments field_by_boundary(const ExactKernels& kernels, const Section& section, const Slant& slant,
                                  const Boundary& boundary) {
  PressureMoments sum;
  StripNodes nodes;
  const StripSection strips = strip_section(section, slant);
  const auto kinks = [&](const Piece& piece, const Zone& zone) {
    return kinks_of(section, slant, piece, zone.part);
  };
  boundary_nodes(section, boundary, kinks, [&](double x, double y, double weight) {
    if (nodes.count == StripNodes::kCapacity) add_nodes(kernels, strips, nodes, sum);
    const std::size_t k = nodes.count++;
    nodes.x[k] = x;
    nodes.y[k] = y;
    nodes.weight[k] = weight;
  });
  add_nodes(kernels, strips, nodes, sum);
  sum.error = kBoundaryError * section.radius1 * section.radius1 * section.radius1;
  return sum;
}

// By product rules; false where the region is too large or phi not smooth on it.
bool field_of_small_region(const Section& section, const Slant& slant, const AreaMoments& area,
                           const Boundary& boundary, PressureMoments& moments) {
  moments = {};
  moments.error = kDiscError * section.radius1 * section.radius1 * section.radius1;
  return small_region_nodes(section, slant, area, boundary, 1, [&](Zone::Part part, Point2 p, double weight) {
    const double share = weight * field_of(section, slant, part, p);
    moments.volume += share;
    moments.first = moments.first + share * p;
  });
}

}  // namespace

double field_at(const Section& section, Point2 p) {
  const Slant slant = slant_of(section);
  return field_of(section, slant, p);
}

PressureMoments field_moments(const ExactKernels& kernels, const Section& section, const AreaMoments& area,
                              const Boundary& boundary) {
  const Slant slant = slant_of(section);
  PressureMoments moments;
  if (field_of_small_region(section, slant, area, boundary, moments)) return moments;
  return field_by_boundary(kernels, section, slant, boundary);
}

}  // namespace lumbrical
