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
  piece_nodes(piece, zone, Singularities{}, [&](double x, double y, double weight) {
    const double chord = piece.from_y + (x - piece.from_x) / dx * dy;
    for (const GaussNode& node : rule) {
      integrand.add({x, chord + node.at * (y - chord)}, -weight * node.weight * (y - chord));
    }
  });
}

template <std::size_t N>
void add_region(const Integrand& integrand, const GaussNode (&rule)[N], Point2 middle,
                const Boundary& boundary) {
  for (int i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[static_cast<std::size_t>(i)];
    if (piece.kind == Piece::none) continue;
    add_triangle(integrand, rule, middle, {piece.from_x, piece.from_y}, {piece.to_x, piece.to_y});
    if (piece.kind == Piece::arc) add_bulge(integrand, rule, piece, integrand.section.zone[piece.zone]);
  }
}

double reach_of(const Boundary& boundary, Point2 middle) {
  double square = 0;
  for (int i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[static_cast<std::size_t>(i)];
    if (piece.kind == Piece::none) continue;
    for (const Point2 p : {Point2{piece.from_x, piece.from_y}, Point2{piece.to_x, piece.to_y}}) {
      square = max(square, dot(p - middle, p - middle));
    }
  }
  return std::sqrt(square);
}

}  // namespace

bool field_of_small_region(const Section& section, const Slant& slant, const AreaMoments& area,
                           const Boundary& boundary, PressureMoments& moments) {
  if (section.shape == Shape::flat) return false;  // its flat ends are no part of the traced boundary
  const Point2 middle = area.centroid;
  const FieldZone here = zone_of(section, slant, middle);
  const double reach = reach_of(boundary, middle);
  if (!(reach < here.margin)) return false;
  moments = {};
  const Integrand integrand{section, slant, here.zone, moments};
  const double clearance = section.radius2 - field_of(section, slant, here.zone, middle) - reach;
  // Against singularities at a distance of d, n nodes on a length l leave about (2 + 4 d / l)^(-2 n).
  const double size = clearance > 0 ? reach / clearance : 1e300;
  if (size < 0.06) {
    add_region(integrand, kGauss4, middle, boundary);
  } else if (size < 0.25) {
    add_region(integrand, kGauss6, middle, boundary);
  } else if (size < 0.5) {
    add_region(integrand, kGauss8, middle, boundary);
  } else {
    return false;
  }
  return true;
}

}  // namespace lumbrical
