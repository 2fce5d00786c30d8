// The pressure field phi in the plane of a triangle: what it is made of, shared by the two ways to integrate
// it.
#pragma once

#include <cmath>

#include "section/boundary_integral.h"

namespace lumbrical {

// One of the distances phi is made of: phi = level - factor sqrt(d2 + y^2), zero where factor^2 y^2 = gap.
// The gap is kept apart because where phi is small against R nothing is left of it in level^2 - factor^2 d2.
struct Distance {
  double level, factor, d2, gap;
};

struct Slant {
  double sine, cosine;  // of the cone's half angle; 0 and 1 for a capsule
};

inline Slant slant_of(const Section& section) {
  if (section.length == 0 || section.shape == Shape::flat) return {0, 1};
  const double sine = (section.radius1 - section.radius2) / section.length;
  return {sine, std::sqrt((1 - sine) * (1 + sine))};
}

inline Distance to_centre(double radius, double x, double h) {
  return {radius, 1, x * x + h * h, (radius - h) * (radius + h) - x * x};
}

/// Which distance phi is made of at p, and how far it is to where that changes.
struct FieldZone {
  Zone::Part part;
  double margin;  ///< [m]
};

inline FieldZone zone_of(const Section& section, const Slant& slant, Point2 p) {
  if (section.length == 0) return {Zone::first_end, 1e300};
  if (section.shape == Shape::flat) return {Zone::side, 1e300};
  const double e = section.c * p.x + section.s * section.h1, q = section.s * p.x - section.c * section.h1;
  const double rho = std::sqrt(e * e + p.y * p.y);
  const double first = slant.cosine * q - slant.sine * rho, second = first - slant.cosine * section.length;
  const Zone::Part beyond_first = second < 0 ? Zone::side : Zone::second_end;
  return {first < 0 ? Zone::first_end : beyond_first, min(std::fabs(first), std::fabs(second))};
}

/// phi at p, which lies in the given part.
inline double field_of(const Section& section, const Slant& slant, Zone::Part part, Point2 p) {
  Distance distance;
  if (part == Zone::side) {
    const double e = section.c * p.x + section.s * section.h1, q = section.s * p.x - section.c * section.h1;
    const double level = section.radius1 - slant.sine * q, scaled = slant.cosine * e;
    distance = {level, slant.cosine, e * e, (level - scaled) * (level + scaled)};
  } else {
    distance = part == Zone::first_end ? to_centre(section.radius1, p.x, section.h1)
                                       : to_centre(section.radius2, p.x - section.x2, section.h2);
  }
  const auto [level, factor, d2, gap] = distance;
  return (gap - factor * factor * p.y * p.y) / (level + factor * std::sqrt(d2 + p.y * p.y));
}

inline double field_of(const Section& section, const Slant& slant, Point2 p) {
  return field_of(section, slant, zone_of(section, slant, p).part, p);
}

/// Where along a piece of the boundary, whose curve belongs to `part`, integrals of phi from y = 0 to the
/// piece are not smooth.
Singularities kinks_of(const Section& section, const Slant& slant, const Piece& piece, Zone::Part part);

/// Where phi itself is not smooth along the line between two points.
Singularities line_kinks(const Section& section, const Slant& slant, Point2 from, Point2 to);

}  // namespace lumbrical
