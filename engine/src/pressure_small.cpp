// The field's integral over small regions: phi is smooth there, so a fan of triangles round the centroid and
// the slim bulges between arcs and their chords take a few nodes each, and no logarithm.
#include "boundary_integral.h"
#include "field.h"

namespace lumbrical {
namespace {

struct Integrand {
  const Section& section;
  const Slant& slant;
  int zone;
  PressureMoments& sum;
  void add(Point2 p, double weight) const {
    const double share = weight * field_of(section, slant, zone, p);
    sum.volume += share;
    sum.first = sum.first + share * p;
  }
};

template <std::size_t N>
void add_triangle(const Integrand& integrand, const GaussNode (&rule)[N], Point2 a, Point2 b, Point2 c) {
  const double twice = cross(b - a, c - a);
  if (twice == 0) return;
  for (const GaussNode& outer : rule) {
    for (const GaussNode& inner : rule) {
      integrand.add(a + outer.at * ((b - a) + inner.at * (c - b)),
                    twice * outer.at * outer.weight * inner.weight);
    }
  }
}

// Between an arc and its chord: along x as along any arc, then along y from the chord to the arc.
template <std::size_t N>
void add_bulge(const Integrand& integrand, const GaussNode (&rule)[N], const Piece& piece, const Zone& zone) {
  const double dx = piece.to_x - piece.from_x, dy = piece.to_y - piece.from_y;
  const double slope = dy / dx;
  piece_nodes(piece, zone, Singularities{}, [&](double x, double y, double weight) {
    const double chord = piece.from_y + (x - piece.from_x) * slope;
    for (const GaussNode& node : rule) {
      integrand.add({x, chord + node.at * (y - chord)}, -weight * node.weight * (y - chord));
    }
  });
}

template <std::size_t N>
void add_region(const Integrand& integrand, const GaussNode (&rule)[N], Point2 corner,
                const Boundary& boundary) {
  for (int i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[static_cast<std::size_t>(i)];
    if (piece.kind == Piece::none) continue;
    add_triangle(integrand, rule, corner, {piece.from_x, piece.from_y}, {piece.to_x, piece.to_y});
    if (piece.kind != Piece::arc) continue;
    // The bulge of a short arc is thin, and four nodes across it are plenty.
    const Zone& zone = integrand.section.zone[piece.zone];
    const double dx = piece.to_x - piece.from_x, dy = piece.to_y - piece.from_y;
    if (dx * dx + dy * dy < 0.25 * integrand.section.radius2 * integrand.section.radius2) {
      add_bulge(integrand, kGauss4, piece, zone);
    } else {
      add_bulge(integrand, rule, piece, zone);
    }
  }
}

// A corner of the region.
Point2 corner_of(const Boundary& boundary) {
  int first = 0;
  while (first + 1 < boundary.count && boundary.piece[static_cast<std::size_t>(first)].kind == Piece::none)
    ++first;
  const Piece& piece = boundary.piece[static_cast<std::size_t>(first)];
  return {piece.from_x, piece.from_y};
}

double reach_from(Point2 p, const Section& section, const Boundary& boundary) {
  double square = 0;
  const auto include = [&](double x, double y) {
    const Point2 d{x - p.x, y - p.y};
    square = max(square, dot(d, d));
  };
  for (int i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[static_cast<std::size_t>(i)];
    if (piece.kind == Piece::none) continue;
    include(piece.from_x, piece.from_y);
    if (piece.kind != Piece::arc) continue;
    // An arc reaches beyond its ends, as far out as the zone's curve is high between them.
    const Zone& zone = section.zone[piece.zone];
    const double lower = min(piece.from_x, piece.to_x), upper = max(piece.from_x, piece.to_x);
    const double vertex = zone.gamma > 0 ? clamp(zone.x0 + zone.beta / zone.gamma, lower, upper) : lower;
    const double height = std::sqrt(
        max(0, max(eta_squared(zone, vertex), max(piece.from_y * piece.from_y, piece.to_y * piece.to_y))));
    include(lower, piece.side * height);
    include(upper, piece.side * height);
  }
  return std::sqrt(square);
}

// The least distance of the axis, where phi has its kink, from the plane.
double axis_height(const Section& section, int zone) {
  if (zone == 0) return std::fabs(section.h1);
  if (zone == 2) return std::fabs(section.h2);
  return section.h1 * section.h2 > 0 ? min(std::fabs(section.h1), std::fabs(section.h2)) : 0;
}

}  // namespace

bool field_of_small_region(const Section& section, const Slant& slant, const AreaMoments& area,
                           const Boundary& boundary, PressureMoments& moments) {
  if (section.shape == Shape::flat) return false;  // its flat ends are no part of the traced boundary
  const FieldZone here = zone_of(section, slant, area.centroid);
  const double radius = reach_from(area.centroid, section, boundary);
  if (!(radius < here.margin)) return false;
  const Point2 corner = corner_of(boundary);
  const double phi = field_of(section, slant, here.zone, area.centroid);
  const double clearance = max(section.radius2 - phi - radius, axis_height(section, here.zone));
  // n nodes on a length l at a distance d from the axis leave about (2 + 4 d / l)^(-2 n).
  const double size = clearance > 0 ? reach_from(corner, section, boundary) / clearance : 1e300;
  moments = {};
  const Integrand integrand{section, slant, here.zone, moments};
  if (size < 0.12) {
    add_region(integrand, kGauss4, corner, boundary);
  } else if (size < 0.35) {
    add_region(integrand, kGauss6, corner, boundary);
  } else if (size < 0.7) {
    add_region(integrand, kGauss8, corner, boundary);
  } else {
    return false;
  }
  return true;
}

}  // namespace lumbrical
