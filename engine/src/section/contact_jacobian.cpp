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

#include "section/field.h"
#include "section/small_region.h"

namespace lumbrical {
namespace {

// A cut almost in the triangle's plane sweeps over it at once: there the wrench steps and has no derivative.
constexpr double kNoCut = 1e-9;

// [share of the radius] As near to a cut as this an edge of the triangle lies in it, as does that of the next
// triangle, which may have no contact. What both lose and gain there is what one triangle would at the cut,
// to another segment; to another part of the palm it is what an edge would.
constexpr double kInCut = 1e-9;

// The part of the plane where dot(direction, p) <= offset; of a cut, `along` is the part of its normal along
// n.
struct HalfPlane {
  Point2 direction;
  double offset, along;
};
double across(const HalfPlane& cut) { return std::sqrt(dot(cut.direction, cut.direction)); }

// A triangle in its plane, and what cuts it.
struct Facet {
  Vec3 arm;      // W: from the joint to the origin of x and y
  Vec3 u, v, n;  // W: axes of x and y, normal
  std::array<Point2, 3> corner;
  std::uint32_t cut_count = 0;
  std::array<HalfPlane, Slab::kMostFaces> cut;
  [[nodiscard]] Vec3 at(Point2 p) const { return arm + (p.x * u + p.y * v); }
};

HalfPlane half_plane(const HalfSpace& cut, Vec3 origin, const Facet& facet) {
  return {{dot(cut.normal, facet.u), dot(cut.normal, facet.v)},
          dot(cut.normal, cut.point - origin) + cut.offset,
          dot(cut.normal, facet.n)};
}

// What lies in the triangle's plane cuts nothing off: there is a contact.
bool add_cut(const HalfPlane& cut, Facet& facet) {
  if (!(across(cut) > kNoCut)) return false;
  facet.cut[facet.cut_count++] = cut;
  return true;
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
  [[nodiscard]] double at(Point2 p) const { return field_of(section, slant, p); }
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
struct LinearField : Linear {
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

/// What the terms of edges and cuts ask of a contact.
struct ContactPlace {
  Point2 middle;
  double radius = 0;  // [m]
  bool palm = false;
};

// Next to the contact's centre: far away rounding parts them.
bool lies_in(const HalfPlane& cut, const Line& line, const ContactPlace& place) {
  const double per = 1 / across(cut);
  const Point2 foot = line.base + dot(place.middle - line.base, line.direction) * line.direction;
  return std::fabs(per * (cut.offset - dot(cut.direction, foot))) <= kInCut * place.radius &&
         std::fabs(per * dot(cut.direction, line.direction)) <= kInCut;
}

/// Of a facet's cuts, in which an edge lies.
using Taken = std::array<bool, Slab::kMostFaces>;

template <class Field>
void add_edge_terms(const Facet& facet, const Field& field, const ContactPlace& place, Taken& taken,
                    Matrix6& sum) {
  for (std::size_t i = 0; i < 3; ++i) {
    Line line = line_between(facet.corner[i], facet.corner[(i + 1) % 3]);
    const Point2 outward{line.direction.y, -line.direction.x};
    Vec3 e = line.direction.x * facet.v - line.direction.y * facet.u;
    bool beyond = false;  // of a triangle beyond a cut nothing but rounding is there
    for (std::size_t k = 0; k < facet.cut_count; ++k) {
      const HalfPlane& cut = facet.cut[k];
      if (!lies_in(cut, line, place)) {
        clip(cut, line);
        continue;
      }
      taken[k] = true;
      beyond = beyond || dot(cut.direction, outward) < 0;
      // The palm's other part, of the same segment, gains what this one loses.
      if (!place.palm) e = (cut.along / across(cut)) * facet.n;
    }
    if (beyond || !(line.lower < line.upper)) continue;
    field.clip(line);
    add_line(facet, field, line, e, sum);
  }
}

template <class Field>
void add_cut_terms(const Facet& facet, const Field& field, const Taken& taken, Matrix6& sum) {
  for (std::size_t k = 0; k < facet.cut_count; ++k) {
    if (taken[k]) continue;
    const HalfPlane& cut = facet.cut[k];
    Line line = border_of(cut, across(cut));
    clip_to_triangle(facet, line);
    for (std::size_t i = 0; i < facet.cut_count; ++i) {
      if (i != k) clip(facet.cut[i], line);
    }
    if (!(line.lower < line.upper)) continue;
    field.clip(line);
    add_line(facet, field, line, (cut.along / across(cut)) * facet.n, sum);
  }
}

template <class Field>
void add_line_terms(const Facet& facet, const Field& field, const ContactPlace& place, Matrix6& sum) {
  Taken taken{};
  add_edge_terms(facet, field, place, taken, sum);
  add_cut_terms(facet, field, taken, sum);
}

}  // namespace

bool add_contact_jacobian(const Primitive& primitive, const Contact& contact, Vec3 joint, const Corners& at,
                          Matrix6& sum, const SlopeMoments& bulge) {
  Section section;
  if (primitive.shape != Shape::round || !look_from_plane(primitive, at, section)) return false;
  const Overlap overlap = classify(section);
  if (overlap == Overlap::none) return false;
  Boundary boundary;
  trace_boundary(section, boundary);
  const AreaMoments area = common_area(section, overlap, boundary);
  if (!(area.area > 0)) return false;

  Facet facet;
  facet.arm = (section.origin - joint) - section.h1 * section.n;
  facet.u = section.u;
  facet.v = section.v;
  facet.n = section.n;
  const Vec3 corner[3] = {at.a - section.origin, at.b - section.origin, at.c - section.origin};
  for (std::size_t i = 0; i < 3; ++i)
    facet.corner[i] = {dot(corner[i], section.u), dot(corner[i], section.v)};
  for (std::size_t i = 0; i < primitive.cut_count; ++i) {
    HalfPlane cut = half_plane(primitive.cut[i], section.origin, facet);
    cut.offset += section.h1 * cut.along;  // from O1 down to its foot
    add_cut(cut, facet);
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
  const ContactPlace place{{dot(centre, section.u), dot(centre, section.v)},
                           max(section.radius1, section.radius2),
                           primitive.segment == kPalmSegment};
  add_line_terms(facet, SectionField{section, slant_of(section)}, place, sum);
  return true;
}

bool add_contact_jacobian(const Slab& slab, const Contact& contact, Vec3 joint, const Corners& at,
                          Matrix6& sum) {
  Facet facet;
  if (slab.face_count == 0 || !normal_of(at, facet.n)) return false;
  const auto& [a, b, c] = at;
  facet.arm = a - joint;
  facet.u = unit_or(b - a, Vec3{});
  facet.v = cross(facet.n, facet.u);
  facet.corner = {Point2{0, 0}, Point2{dot(b - a, facet.u), dot(b - a, facet.v)},
                  Point2{dot(c - a, facet.u), dot(c - a, facet.v)}};
  Polygon2 polygon;
  polygon.count = 3;
  for (std::size_t i = 0; i < 3; ++i) polygon.corner[i] = facet.corner[i];
  for (std::size_t i = 0; i < slab.face_count && polygon.count >= 3; ++i) {
    const HalfPlane cut = half_plane(slab.face[i], a, facet);
    if (add_cut(cut, facet)) cut_polygon(cut.direction, cut.offset, polygon);
  }
  if (polygon.count < 3 || !(polygon_area(polygon).area > 0)) return false;

  const HalfPlane skin = half_plane(slab.face[0], a, facet);
  const LinearField field{{skin.offset, -1.0 * skin.direction}};
  SlopeMoments slope;
  const auto add = [&](Point2 p, double weight) { slope.add(p, -weight * skin.along); };
  for (std::size_t i = 1; i + 1 < polygon.count; ++i) {
    triangle_nodes(add, kGauss4, polygon.corner[0], polygon.corner[i], polygon.corner[i + 1]);
  }
  add_area_terms(facet, contact.volume, contact.centre - a, slope, sum);
  const Vec3 centre = contact.centre - a;
  add_line_terms(facet, field, {{dot(centre, facet.u), dot(centre, facet.v)}, slab.thickness, true}, sum);
  return true;
}

}  // namespace lumbrical
