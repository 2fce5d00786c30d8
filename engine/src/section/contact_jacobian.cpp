// The contact's Jacobian: line integrals of phi along the triangle's edges and along the cuts, and the volume
// term, the integral of d phi / dn over the contacted area.
//
// With r = p - joint, B = (n, r x n) and D = (grad phi, r x grad phi) the wrench over K_s is the integral of
// phi B and its change under the twist (t, w) of the segment that of -B D^T, plus what the cuts gain by
// moving along, plus F x t in the torque, because the joint moves. The part of D in the plane is a derivative
// in the plane and goes to the boundary by the divergence theorem. There phi vanishes on the primitive's
// surface, and along a cut what it leaves cancels what the cut gains but for the part along n. So remain
//   - integral along the edges of the triangle of phi B (e, r x e)^T, e the outward normal in the plane,
//   + integral of phi dB/dx (u, r x u)^T + phi dB/dy (v, r x v)^T over the area,
//   - integral of d phi / dn  B B^T over the area,
//   + integral along the cuts of phi (m n) / |m x n|  B B^T, m the outward normal of the cut.
#include "section/contact_jacobian.h"

#include <array>
#include <cmath>

#include "exact/field.h"
#include "section/small_region.h"

namespace lumbrical {
namespace {

// A cut almost in the triangle's plane sweeps over it at once: there the wrench steps and has no derivative.
constexpr double kNoCut = 1e-9;

// The part of the plane where dot(direction, p) <= offset; of a cut, `along` is the part of its normal along
// n.
struct HalfPlane {
  Point2 direction;
  double offset, along;
};

// A triangle in its plane, and what cuts it.
struct Facet {
  Vec3 arm;      // W: from the joint to the origin of x and y
  Vec3 u, v, n;  // W: axes of x and y, normal
  std::array<Point2, 3> corner;
  int cut_count = 0;
  std::array<HalfPlane, Slab::kMostFaces> cut;
  [[nodiscard]] Vec3 at(Point2 p) const { return arm + (p.x * u + p.y * v); }
};

void add_cut(const HalfSpace& cut, Vec3 origin, Facet& facet) {
  facet.cut[static_cast<std::size_t>(facet.cut_count++)] = {
      {dot(cut.normal, facet.u), dot(cut.normal, facet.v)},
      dot(cut.normal, cut.point - origin) + cut.offset,
      dot(cut.normal, facet.n)};
}

// (direction, r x direction): what a force or a motion along a line amounts to at the joint.
Wrench screw(Vec3 r, Vec3 direction) { return {direction, cross(r, direction)}; }

void add_outer(double weight, const Wrench& left, const Wrench& right, Matrix6& sum) {
  const double row[6] = {left.force.x,  left.force.y,  left.force.z,
                         left.torque.x, left.torque.y, left.torque.z};
  const double column[6] = {right.force.x,  right.force.y,  right.force.z,
                            right.torque.x, right.torque.y, right.torque.z};
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k) sum[i][k] += weight * row[i] * column[k];
  }
}

void add_symmetric(double weight, const Wrench& a, const Wrench& b, Matrix6& sum) {
  add_outer(weight, a, b, sum);
  add_outer(weight, b, a, sum);
}

// The two integrals over the area, and the joint's own motion.
// `volume` is the integral of phi, `centre` the centre of pressure from the origin of x and y.
void add_area_terms(const Facet& facet, double volume, Vec3 centre, const SlopeMoments& slope, Matrix6& sum) {
  const Wrench b = screw(facet.arm, facet.n), bx{{}, -facet.v}, by{{}, facet.u};
  const Vec3 at = facet.arm + centre;
  add_outer(volume, bx, screw(at, facet.u), sum);
  add_outer(volume, by, screw(at, facet.v), sum);

  add_outer(-slope.one, b, b, sum);
  add_symmetric(-slope.x, b, bx, sum);
  add_symmetric(-slope.y, b, by, sum);
  add_outer(-slope.xx, bx, bx, sum);
  add_symmetric(-slope.xy, bx, by, sum);
  add_outer(-slope.yy, by, by, sum);

  const Vec3 force = volume * facet.n;
  sum[3][1] -= force.z;
  sum[3][2] += force.y;
  sum[4][0] += force.z;
  sum[4][2] -= force.x;
  sum[5][0] -= force.y;
  sum[5][1] += force.x;
}

// A line base + t direction with |direction| = 1, lower <= t <= upper.
struct Line {
  Point2 base, direction;
  double lower, upper;
  [[nodiscard]] Point2 at(double t) const { return base + t * direction; }
};

// With the base at the foot of the origin an edge of 100 m through a primitive of millimetres loses nothing.
Line line_between(Point2 p, Point2 q) {
  const double length = std::sqrt(dot(q - p, q - p));
  const Point2 direction = (1 / length) * (q - p);
  const double t = dot(p, direction);
  return {p - t * direction, direction, t, t + length};
}

// The border of a half-plane; infinite, its normal on the right.
Line border_of(const HalfPlane& half, double length) {
  const Point2 normal = (1 / length) * half.direction;
  return {(half.offset / length) * normal, {-normal.y, normal.x}, -1e300, 1e300};
}

void clip(const HalfPlane& half, Line& line) {
  const double rate = dot(half.direction, line.direction), gap = half.offset - dot(half.direction, line.base);
  if (rate > 0) line.upper = min(line.upper, gap / rate);
  if (rate < 0) line.lower = max(line.lower, gap / rate);
  if (rate == 0 && gap < 0) line.upper = line.lower;
}

void clip_to_triangle(const Facet& facet, Line& line) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Point2 p = facet.corner[i], d = facet.corner[(i + 1) % 3] - p;
    const Point2 outward{d.y, -d.x};
    clip({outward, dot(outward, p), 0}, line);
  }
}

// phi in the plane of a section.
struct SectionField {
  const Section& section;
  Slant slant;
  [[nodiscard]] double at(Point2 p) const {
    return field_of(section, slant, zone_of(section, slant, p).zone, p);
  }
  [[nodiscard]] Singularities kinks(Point2 from, Point2 to) const {
    return line_kinks(section, slant, from, to);
  }
  void clip(Line& line) const {
    const Interval inside = inside_interval(section, line.base, line.direction, line.lower, line.upper);
    line.lower = inside.first;
    line.upper = inside.second;
  }
};

// phi of a slab: linear, and the faces are all there is to clip at.
struct LinearField {
  double value;
  Point2 slope;
  [[nodiscard]] double at(Point2 p) const { return value + dot(slope, p); }
  [[nodiscard]] static Singularities kinks(Point2, Point2) { return {}; }
  static void clip(Line&) {}
};

// + integral along the line of phi B (e, r x e)^T: both factors are linear along the line.
template <class Field>
void add_line(const Facet& facet, const Field& field, const Line& line, Vec3 e, Matrix6& sum) {
  const double length = line.upper - line.lower;
  if (!(length > 0)) return;
  const Point2 from = line.at(line.lower), to = line.at(line.upper);
  double zeroth = 0, first = 0, second = 0;
  graded_nodes(0, 1, field.kinks(from, to), [&](double t, double weight) {
    const double share = weight * length * field.at(from + t * (to - from));
    zeroth += share;
    first += share * t;
    second += share * t * t;
  });
  const Vec3 start = facet.at(from), step = facet.at(to) - start;
  const Wrench b = screw(start, facet.n), along = screw(start, e);
  const Wrench db{{}, cross(step, facet.n)}, dalong{{}, cross(step, e)};
  add_outer(zeroth, b, along, sum);
  add_outer(first, b, dalong, sum);
  add_outer(first, db, along, sum);
  add_outer(second, db, dalong, sum);
}

template <class Field>
void add_line_terms(const Facet& facet, const Field& field, Matrix6& sum) {
  for (std::size_t i = 0; i < 3; ++i) {
    Line line = line_between(facet.corner[i], facet.corner[(i + 1) % 3]);
    for (int k = 0; k < facet.cut_count; ++k) clip(facet.cut[static_cast<std::size_t>(k)], line);
    if (!(line.lower < line.upper)) continue;
    field.clip(line);
    add_line(facet, field, line, line.direction.x * facet.v - line.direction.y * facet.u, sum);
  }
  for (int k = 0; k < facet.cut_count; ++k) {
    const HalfPlane& cut = facet.cut[static_cast<std::size_t>(k)];
    const double across = std::sqrt(dot(cut.direction, cut.direction));
    if (!(across > kNoCut)) continue;
    Line line = border_of(cut, across);
    clip_to_triangle(facet, line);
    for (int i = 0; i < facet.cut_count; ++i) {
      if (i != k) clip(facet.cut[static_cast<std::size_t>(i)], line);
    }
    if (!(line.lower < line.upper)) continue;
    field.clip(line);
    add_line(facet, field, line, (cut.along / across) * facet.n, sum);
  }
}

}  // namespace

bool add_contact_jacobian(const Primitive& primitive, const Contact& contact, Vec3 joint, Vec3 a, Vec3 b,
                          Vec3 c, Matrix6& sum, const SlopeMoments& bulge) {
  Section section;
  if (primitive.shape != Shape::round || !look_from_plane(primitive, a, b, c, section)) return false;
  const Overlap overlap = classify(section);
  if (overlap == Overlap::apart) return false;
  Boundary boundary;
  trace_boundary(section, boundary);
  const AreaMoments area =
      overlap == Overlap::inside ? polygon_area(section.polygon) : section_area(section, boundary);
  if (!(area.area > 0)) return false;

  Facet facet;
  facet.arm = (section.origin - joint) - section.h1 * section.n;
  facet.u = section.u;
  facet.v = section.v;
  facet.n = section.n;
  const Vec3 corner[3] = {a - section.origin, b - section.origin, c - section.origin};
  for (std::size_t i = 0; i < 3; ++i)
    facet.corner[i] = {dot(corner[i], section.u), dot(corner[i], section.v)};
  for (std::size_t i = 0; i < primitive.cut_count; ++i) {
    add_cut(primitive.cut[i], section.origin, facet);
    HalfPlane& cut = facet.cut[i];
    cut.offset += section.h1 * cut.along;  // from O1 down to its foot
  }
  const Vec3 centre = (contact.centre - section.origin) + section.h1 * section.n;
  SlopeMoments slope = slope_moments(section, area, boundary);
  slope.one += bulge.one;
  slope.x += bulge.x;
  slope.y += bulge.y;
  slope.xx += bulge.xx;
  slope.xy += bulge.xy;
  slope.yy += bulge.yy;
  add_area_terms(facet, contact.volume, centre, slope, sum);
  add_line_terms(facet, SectionField{section, slant_of(section)}, sum);
  return true;
}

bool add_contact_jacobian(const Slab& slab, const Contact& contact, Vec3 joint, Vec3 a, Vec3 b, Vec3 c,
                          Matrix6& sum) {
  Facet facet;
  if (slab.face_count == 0 || !normal_of(a, b, c, facet.n)) return false;
  facet.arm = a - joint;
  facet.u = unit_or(b - a, Vec3{});
  facet.v = cross(facet.n, facet.u);
  facet.corner = {Point2{0, 0}, Point2{dot(b - a, facet.u), dot(b - a, facet.v)},
                  Point2{dot(c - a, facet.u), dot(c - a, facet.v)}};
  Polygon2 polygon;
  polygon.count = 3;
  for (std::size_t i = 0; i < 3; ++i) polygon.corner[i] = facet.corner[i];
  for (int i = 0; i < slab.face_count && polygon.count >= 3; ++i) {
    add_cut(slab.face[static_cast<std::size_t>(i)], a, facet);
    const HalfPlane& cut = facet.cut[static_cast<std::size_t>(i)];
    cut_polygon(cut.direction, cut.offset, polygon);
  }
  if (polygon.count < 3 || !(polygon_area(polygon).area > 0)) return false;

  const HalfPlane& skin = facet.cut[0];
  const LinearField field{skin.offset, -1.0 * skin.direction};
  SlopeMoments slope;
  const auto add = [&](Point2 p, double weight) { slope.add(p, -weight * skin.along); };
  for (std::size_t i = 1; i + 1 < static_cast<std::size_t>(polygon.count); ++i) {
    triangle_nodes(add, kGauss4, polygon.corner[0], polygon.corner[i], polygon.corner[i + 1]);
  }
  add_area_terms(facet, contact.volume, contact.centre - a, slope, sum);
  add_line_terms(facet, field, sum);
  return true;
}

}  // namespace lumbrical
