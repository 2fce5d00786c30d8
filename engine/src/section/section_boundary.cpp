// Traces the boundary of what a triangle and a primitive's section have in common, where they have anything.
#include <cmath>

#include "section/section.h"

namespace lumbrical {
namespace {

// A line in one zone: parameters base + t * direction, and the zone's share of [lower, upper].
Interval zone_interval(const Zone& zone, Point2 base, Point2 direction, double lower, double upper) {
  if (direction.x == 0) {
    return base.x >= zone.lower && base.x < zone.upper ? Interval{lower, upper} : Interval{lower, lower};
  }
  const double t1 = (zone.lower - base.x) / direction.x, t2 = (zone.upper - base.x) / direction.x;
  return {max(lower, min(t1, t2)), min(upper, max(t1, t2))};
}

Interval inside_zone(const Zone& zone, Point2 base, Point2 direction, Interval range) {
  const double x = base.x - zone.x0;
  const double a = -(zone.gamma * direction.x * direction.x + direction.y * direction.y);
  const double b = (zone.beta - zone.gamma * x) * direction.x - base.y * direction.y;
  const double c = zone.alpha + x * (2 * zone.beta - zone.gamma * x) - base.y * base.y;
  return positive_interval(a, b, c, range.first, range.second);
}

// A polygon edge as base + t * direction with the base at the point nearest to the origin: an edge of 100 m
// through a section of millimetres then loses nothing.
struct EdgeLine {
  Point2 base, direction;
  double lower = 0, upper = 0;
  [[nodiscard]] Point2 at(double t) const { return base + t * direction; }
};

EdgeLine line_through(Point2 p, Point2 q) {
  const bool reverse = runs_back(p, q);
  const Point2 from = reverse ? q : p, to = reverse ? p : q, d = to - from;
  const double length2 = dot(d, d);
  const double t = length2 > 0 ? clamp(-dot(from, d) / length2, 0, 1) : 0;
  const Point2 base = t == 0 ? from : t == 1 ? to : from + t * d;
  return reverse ? EdgeLine{base, q - p, t - 1, t} : EdgeLine{base, d, -t, 1 - t};
}

void add_piece(Piece::Kind kind, int side, std::size_t zone, Point2 from, Point2 to, Boundary& boundary) {
  if (boundary.count == Boundary::kMaxPieces) return;
  boundary.piece[boundary.count++] = {
      kind, static_cast<std::int8_t>(side), static_cast<std::uint8_t>(zone), from.x, from.y, to.x, to.y};
}

void add_nothing(double from_x, double to_x, Boundary& boundary) {
  if (from_x != to_x) add_piece(Piece::none, 1, 0, {from_x, 0}, {to_x, 0}, boundary);
}

// The section's curve at x; exactly 0 at its own ends, where rounding would leave the root of a small number.
double eta(const Zone& zone, double x) {
  const bool at_end = (x == zone.real_lower && x > zone.lower) || (x == zone.real_upper && x < zone.upper);
  return at_end ? 0 : std::sqrt(max(0, eta_squared(zone, x)));
}

// The part t1..t2 of an edge that runs outside the section: the section's own curve takes its place.
void add_outside(const Zone& zone, std::size_t index, const EdgeLine& line, double t1, double t2,
                 Boundary& boundary) {
  if (!(t1 < t2)) return;
  const Point2 from = line.at(t1), to = line.at(t2);
  if (!(zone.real_lower < zone.real_upper)) return add_nothing(from.x, to.x, boundary);
  const double x1 = clamp(from.x, zone.real_lower, zone.real_upper);
  const double x2 = clamp(to.x, zone.real_lower, zone.real_upper);
  const double middle = line.direction.x == 0 ? t1 : (0.5 * (x1 + x2) - line.base.x) / line.direction.x;
  const int side = line.at(middle).y < 0 ? -1 : 1;
  const double y1 = side * eta(zone, x1);
  const double y2 = side * eta(zone, x2);
  add_nothing(from.x, x1, boundary);
  if (x1 != x2) add_piece(Piece::arc, side, index, {x1, y1}, {x2, y2}, boundary);
  add_nothing(x2, to.x, boundary);
}

void trace_edge(const Section& section, Point2 p, Point2 q, Boundary& boundary) {
  const EdgeLine line = line_through(p, q);
  double covered_lower = line.upper, covered_upper = line.lower;
  for (std::size_t i = 0; i < section.zone_count; ++i) {
    const Zone& zone = section.zone[i];
    const Interval range = zone_interval(zone, line.base, line.direction, line.lower, line.upper);
    if (!(range.first < range.second)) continue;
    covered_lower = min(covered_lower, range.first);
    covered_upper = max(covered_upper, range.second);
    const Interval inside = inside_zone(zone, line.base, line.direction, range);
    if (inside.first < inside.second) {
      add_outside(zone, i, line, range.first, inside.first, boundary);
      add_piece(Piece::edge, 1, i, line.at(inside.first), line.at(inside.second), boundary);
      add_outside(zone, i, line, inside.second, range.second, boundary);
    } else {
      add_outside(zone, i, line, range.first, range.second, boundary);
    }
  }
  if (covered_lower > covered_upper) {
    add_nothing(p.x, q.x, boundary);
    return;
  }
  if (covered_lower > line.lower) add_nothing(p.x, line.at(covered_lower).x, boundary);
  if (covered_upper < line.upper) add_nothing(line.at(covered_upper).x, q.x, boundary);
}

}  // namespace

Overlap classify(const Section& section) {
  const Polygon2& polygon = section.polygon;
  Point2 low = polygon.corner[0], high = low;
  bool inside = inside_section(section, low);
  for (std::size_t i = 1; i < polygon.count; ++i) {
    const Point2 p = polygon.corner[i];
    low = {min(low.x, p.x), min(low.y, p.y)};
    high = {max(high.x, p.x), max(high.y, p.y)};
    inside = inside && inside_section(section, p);
  }
  if (inside) return Overlap::inside;
  if (low.y >= section.radius1 || high.y <= -section.radius1) return Overlap::none;
  for (std::size_t i = 0; i < section.zone_count; ++i) {
    const Zone& zone = section.zone[i];
    if (zone.real_lower < zone.real_upper && low.x < zone.real_upper && high.x > zone.real_lower) {
      return Overlap::partial;
    }
  }
  return Overlap::none;
}

void trace_boundary(const Section& section, Boundary& boundary) {
  boundary.count = 0;
  for (std::size_t i = 0; i < section.polygon.count; ++i) {
    const std::size_t next = i + 1 == section.polygon.count ? 0 : i + 1;
    trace_edge(section, section.polygon.corner[i], section.polygon.corner[next], boundary);
  }
}

Interval inside_interval(const Section& section, Point2 base, Point2 direction, double lower, double upper) {
  Interval all{upper, lower};
  for (std::size_t i = 0; i < section.zone_count; ++i) {
    const Zone& zone = section.zone[i];
    const Interval range = zone_interval(zone, base, direction, lower, upper);
    if (!(range.first < range.second)) continue;
    const Interval inside = inside_zone(zone, base, direction, range);
    if (!(inside.first < inside.second)) continue;
    all.first = min(all.first, inside.first);
    all.second = max(all.second, inside.second);
  }
  return all;
}

}  // namespace lumbrical
