// Quadrature over small regions: a field is smooth there, so a fan of triangles round a corner and the slim
// bulges between arcs and their chords take a few nodes each, and no logarithm. Shared by the field and its
// slope.
#pragma once

#include <cmath>

#include "section/boundary_integral.h"
#include "section/field.h"

namespace lumbrical {

/// Calls f(p, weight) at nodes for the integral over a triangle.
template <class F, std::size_t N>
void triangle_nodes(F&& f, const GaussNode (&rule)[N], Point2 a, Point2 b, Point2 c) {
  const double twice = cross(b - a, c - a);
  if (twice == 0) return;
  for (const GaussNode& outer : rule) {
    for (const GaussNode& inner : rule) {
      f(a + outer.at * ((b - a) + inner.at * (c - b)), twice * outer.at * outer.weight * inner.weight);
    }
  }
}

// Between an arc and its chord: along x as along any arc, then along y from the chord to the arc.
template <class F, std::size_t N>
void bulge_nodes(F&& f, const GaussNode (&rule)[N], const Piece& piece, const Zone& zone) {
  const double dx = piece.to_x - piece.from_x, dy = piece.to_y - piece.from_y;
  const double slope = dy / dx;
  piece_nodes(piece, zone, Singularities{}, [&](double x, double y, double weight) {
    const double chord = piece.from_y + (x - piece.from_x) * slope;
    for (const GaussNode& node : rule) {
      f(Point2{x, chord + node.at * (y - chord)}, -weight * node.weight * (y - chord));
    }
  });
}

template <class F, std::size_t N>
void region_nodes(F&& f, const GaussNode (&rule)[N], const Section& section, Point2 corner,
                  const Boundary& boundary) {
  for (std::size_t i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[i];
    if (piece.kind == Piece::none) continue;
    triangle_nodes(f, rule, corner, {piece.from_x, piece.from_y}, {piece.to_x, piece.to_y});
    if (piece.kind != Piece::arc) continue;
    // The bulge of a short arc is thin, and six nodes across it are plenty.
    const Zone& zone = section.zone[piece.zone];
    const double dx = piece.to_x - piece.from_x, dy = piece.to_y - piece.from_y;
    if (dx * dx + dy * dy < 0.25 * section.radius2 * section.radius2) {
      bulge_nodes(f, kGauss6, piece, zone);
    } else {
      bulge_nodes(f, rule, piece, zone);
    }
  }
}

// A corner of the region.
inline Point2 corner_of(const Boundary& boundary) {
  std::size_t first = 0;
  while (first + 1 < boundary.count && boundary.piece[first].kind == Piece::none) ++first;
  const Piece& piece = boundary.piece[first];
  return {piece.from_x, piece.from_y};
}

inline double reach_from(Point2 p, const Boundary& boundary) {
  double square = 0;
  for (std::size_t i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[i];
    if (piece.kind == Piece::none) continue;
    const Point2 d{piece.from_x - p.x, piece.from_y - p.y};
    square = max(square, dot(d, d));
  }
  return std::sqrt(square);
}

// The least distance of the axis, where phi has its kink, from the plane.
inline double axis_height(const Section& section, Zone::Part part) {
  if (part == Zone::first_end) return std::fabs(section.h1);
  if (part == Zone::second_end) return std::fabs(section.h2);
  return section.h1 * section.h2 > 0 ? min(std::fabs(section.h1), std::fabs(section.h2)) : 0;
}

/// Calls f(part, p, weight) at nodes for the integral over a region on which phi is smooth and which is small
/// against its distance from the axis, and says so; false where the region is not. With `strictness` above 1
/// it has to be that much smaller: for derivatives of phi, or for more digits.
template <class F>
bool small_region_nodes(const Section& section, const Slant& slant, const AreaMoments& area,
                        const Boundary& boundary, double strictness, F&& f) {
  if (section.shape == Shape::flat) return false;  // its flat ends are no part of the traced boundary
  const FieldZone here = zone_of(section, slant, area.centroid);
  const double radius = reach_from(area.centroid, boundary);
  if (!(radius < here.margin)) return false;
  const Point2 corner = corner_of(boundary);
  const double phi = field_of(section, slant, here.part, area.centroid);
  const double clearance = max(section.radius2 - phi - radius, axis_height(section, here.part));
  // n nodes on a length l at a distance d from the axis leave about (2 + 4 d / l)^(-2 n).
  const double size = clearance > 0 ? strictness * (reach_from(corner, boundary) / clearance) : 1e300;
  const auto node = [&](Point2 p, double weight) { f(here.part, p, weight); };
  if (size < 0.03) {
    region_nodes(node, kGauss4, section, corner, boundary);
  } else if (size < 0.2) {
    region_nodes(node, kGauss6, section, corner, boundary);
  } else if (size < 0.7) {
    region_nodes(node, kGauss8, section, corner, boundary);
  } else {
    return false;
  }
  return true;
}

}  // namespace lumbrical
