// The section a primitive cuts out of a triangle's plane, and the boundary of what both have in common.
//
// Plane coordinates (x, y) have their origin at the foot of the primitive's first end O1 and x along the
// projected axis, so that every section is the set |y| <= eta(x) with eta^2 a quadratic in x on at most three
// zones: sphere 1, the side between, sphere 2. No ellipse, circle or rectangle needs a case of its own, and
// nothing is divided by the sine or cosine of the axis' angle, so the formulas hold from axis parallel to
// axis perpendicular to the plane. Everything is a difference with the primitive's own position: far from the
// origin nothing is lost.
#pragma once

#include <array>
#include <cstdint>

#include "lumbrical/math.h"
#include "model/corners.h"
#include "model/primitive.h"

namespace lumbrical {

struct Point2 {
  double x, y;
};
constexpr Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
constexpr Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
constexpr Point2 operator*(double s, Point2 a) { return {s * a.x, s * a.y}; }
constexpr double dot(Point2 a, Point2 b) { return a.x * b.x + a.y * b.y; }
constexpr double cross(Point2 a, Point2 b) { return a.x * b.y - a.y * b.x; }

/// A linear function of a plane's points.
struct Linear {
  double value = 0;  ///< where both coordinates are 0
  Point2 slope{0, 0};
  [[nodiscard]] double at(Point2 p) const { return value + dot(slope, p); }
};

/// A function's integrals over a part of a plane: of itself, and times the point. Of a depth [m^3], [m^4].
struct PlaneMoments {
  double volume = 0;
  Point2 first{0, 0};
};

/// Two triangles that share an edge run along it in opposite senses. What is reckoned of it starts from the
/// same end for both: so it is the same to the last bit, and what they have in common cancels exactly.
constexpr bool runs_back(Point2 p, Point2 q) { return q.x < p.x || (q.x == p.x && q.y < p.y); }

/// A triangle after some cuts, each of which adds a corner at most, counter-clockwise; only the first `count`
/// corners are ever read.
struct Polygon2 {
  static constexpr std::size_t kMaxCorners = 24;
  std::uint32_t count = 0;
  std::array<Point2, kMaxCorners> corner;
};

/// On lower <= x <= upper the section is |y| <= eta, eta^2 = alpha + 2 beta (x - x0) - gamma (x - x0)^2.
struct Zone {
  enum Part : std::uint8_t { first_end, side, second_end } part;  ///< whose surface the curve lies on
  double lower, upper;
  double x0, alpha, beta, gamma;
  double real_lower, real_upper;  ///< the part of [lower, upper] where eta is real; equal: none
};
inline double eta_squared(const Zone& zone, double x) {
  const double d = x - zone.x0;
  return zone.alpha + d * (2 * zone.beta - zone.gamma * d);
}

/// A primitive seen from the plane of a triangle.
struct Section {
  Vec3 origin;                      ///< [m] W: O1
  Vec3 u, v, n;                     ///< W: axes of x and y, and the triangle's outward normal
  double s = 0, c = 1;              ///< sine and cosine of the angle between axis and n (the paper's f_1)
  double length = 0;                ///< [m] H between the end centres
  double h1 = 0, h2 = 0;            ///< [m] heights of the end centres over the plane
  double x2 = 0;                    ///< [m] x of the second end; the first is at 0
  double radius1 = 0, radius2 = 0;  ///< [m]
  Shape shape = Shape::round;
  std::uint32_t zone_count = 0;
  std::array<Zone, 3> zone;  // not initialised: only the first `zone_count` are ever read
  Polygon2 polygon;          ///< the triangle, cut by the primitive's half-spaces
};

/// Outward unit normal of a triangle; false where it has no area to speak of or isn't finite.
bool normal_of(const Corners& at, Vec3& n);

/// Looks at `primitive` (round or flat) from the plane of the triangle `at` [m]. False where they can't be
/// in contact: a triangle without area or not finite, a plane that misses the primitive, or nothing left by
/// the cuts.
bool look_from_plane(const Primitive& primitive, const Corners& at, Section& section);

/// The same for the plane through `point` with unit normal `n`, of which `along` is not a multiple. Sets
/// everything but the polygon. False where the plane misses the primitive.
bool look_along(const Primitive& primitive, Vec3 point, Vec3 n, Vec3 along, Section& section);

/// [m] What rounding of the triangle `at` leaves in the heights over its plane (kPlaneRounding) of a
/// primitive at `place` [m, W].
double plane_rounding(Vec3 place, const Corners& at);

/// Area and centroid of a polygon, 0 where it is empty.
struct AreaMoments {
  double area = 0;    ///< [m^2], 0 where there is nothing
  Point2 centroid{};  ///< [m]
};
AreaMoments polygon_area(const Polygon2& polygon);

/// A triangle, its outward unit normal, and its corners in plane coordinates [m].
struct PlacedTriangle {
  std::array<Vec3, 3> corner;  ///< [m] W
  Vec3 n;
  std::array<Point2, 3> flat;
};

/// Are all corners of a triangle as near to the plane of `cut` as `near` [m]? Then removes what of the
/// polygon, a part of the triangle, lies beyond it. A corner's height comes from the same numbers for the
/// tile on the other side, with the opposite sign: so whatever rounding makes of the line where they part,
/// neither leaves a gap to the other nor covers a part of it. Of a triangle in the plane the one it faces
/// away from has all.
bool cut_along(const HalfSpace& cut, double near, const PlacedTriangle& triangle, Polygon2& polygon);

/// Removes the part of the polygon where dot(direction, p) > offset.
void cut_polygon(Point2 direction, double offset, Polygon2& polygon);

/// Does p lie beyond the edge from a to b, which has the polygon on its left? Corners that cuts have made may
/// be one but for rounding, of what is `size` [m] large: what lies between such has no direction.
inline bool is_beyond(Point2 a, Point2 b, double size, Point2 p) {
  constexpr double kOneCorner = 1e-12;
  const Point2 edge = b - a;
  return cross(edge, p - a) < 0 && dot(edge, edge) > kOneCorner * kOneCorner * (dot(a, a) + size * size);
}
inline bool holds(const Polygon2& polygon, double size, Point2 p) {
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Point2 a = polygon.corner[i];
    const Point2 b = polygon.corner[i + 1 == polygon.count ? 0 : i + 1];
    if (is_beyond(a, b, size, p)) return false;
  }
  return true;
}

/// The point of W at plane coordinates p.
inline Vec3 to_world(const Section& section, Point2 p) {
  return section.origin - section.h1 * section.n + p.x * section.u + p.y * section.v;
}

/// Is the point of the plane inside the section?
inline bool inside_section(const Section& section, Point2 p) {
  for (std::size_t i = 0; i < section.zone_count; ++i) {
    const Zone& zone = section.zone[i];
    if (p.x >= zone.lower && p.x <= zone.upper) return eta_squared(zone, p.x) >= p.y * p.y;
  }
  return false;
}

/// A quick look before the boundary is traced: `none` is certain, `inside` (the whole polygon) is exact.
enum class Overlap : std::uint8_t { none, partial, inside };
Overlap classify(const Section& section);

/// Where a quadratic a t^2 + 2 b t + c is positive on [lower, upper], known to be one interval. Empty: first
/// >= second.
struct Interval {
  double first = 0, second = 0;
};
Interval positive_interval(double a, double b, double c, double lower, double upper);

/// [m] From where to where in x the section reaches. Empty where its curve is real nowhere.
Interval real_extent(const Section& section);

/// A piece of the boundary of polygon and section: along an edge of the polygon, or along the section's own
/// curve y = +-eta, or along y = 0 where the edge has left the section's range of x. All pieces together run
/// once round in the sense that  integral of f over the region = - sum of pieces of  integral of (int_0^y f
/// dy') dx.
struct Piece {
  enum Kind : std::uint8_t { edge, arc, none } kind;
  std::int8_t side;  ///< of an arc: +1 above, -1 below y = 0
  std::uint8_t zone;
  double from_x, from_y, to_x, to_y;
};
struct Boundary {
  // Within a zone an edge falls into five at most: nothing, an arc, the edge, an arc, nothing. The four lines
  // where zones begin and end cross a convex polygon's edges twice each, and divide them.
  static constexpr std::size_t kMaxPieces = 5 * (Polygon2::kMaxCorners + 2 * 4);
  std::uint32_t count;
  std::array<Piece, kMaxPieces> piece;  // not initialised: only the first `count` are ever read
};
void trace_boundary(const Section& section, Boundary& boundary);

/// The part of the line base + t * direction, lower <= t <= upper, inside the section.
Interval inside_interval(const Section& section, Point2 base, Point2 direction, double lower, double upper);

/// Area and centroid of what polygon and section have in common; closed form. The boundary is only looked at
/// where they overlap in part.
AreaMoments common_area(const Section& section, Overlap overlap, const Boundary& boundary);

}  // namespace lumbrical
