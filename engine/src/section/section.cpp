// Builds the section of a primitive with a triangle's plane, and cuts the triangle to what the primitive
// keeps. Corrects Eq. 1-2 of the paper: see docs/mechanics.md.
#include "section/section.h"

#include <cmath>
#include <limits>

#include "section/plane_limits.h"
#include "section/stated_errors.h"

namespace lumbrical {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Ends, axes and heights. The first end is the larger sphere or, between equals, the deeper one.
void set_axes(const Primitive& primitive, Vec3 point, Vec3 along, Section& section) {
  Vec3 end1 = primitive.end1, end2 = primitive.end2;
  double radius1 = primitive.radius1, radius2 = primitive.radius2;
  const bool by_height = primitive.shape == Shape::flat || radius1 == radius2;
  const bool swap = by_height ? dot(end2 - end1, section.n) < 0 : radius2 > radius1;
  if (swap) {
    std::swap(end1, end2);
    std::swap(radius1, radius2);
  }
  Vec3 axis = end2 - end1;
  double length = norm(axis);
  if (primitive.shape == Shape::round && !has_two_ends(length, radius1, radius2)) {
    length = 0;  // the smaller sphere lies inside the larger: nothing else is left
    radius2 = radius1;
  }
  axis = length > 0 ? axis / length : section.n;
  const Vec3 side = cross(section.n, axis);
  const double s = norm(side);
  section.shape = primitive.shape;
  section.origin = end1;
  section.length = length;
  section.radius1 = radius1;
  section.radius2 = radius2;
  section.s = s > kNoDirection ? s : 0;
  section.c = dot(section.n, axis);
  // For small s rounding tilts the quotient out of the plane; one projection puts it back.
  const Vec3 across = s > kNoDirection ? side / s : cross(section.n, along);
  section.v = unit_or(across - dot(across, section.n) * section.n, Vec3{});
  section.u = cross(section.v, section.n);
  section.h1 = dot(section.n, end1 - point);
  section.h2 = section.h1 + section.c * length;
  section.x2 = section.s * length;
}

// The plane passes the primitive by. For a cylinder this is the paper's Eq. 2 as it should read:
// -R sin f1 < D < H |cos f1| + R sin f1, with D the larger of the two values of Eq. 1.
bool plane_misses(const Primitive& primitive, Vec3 point, Vec3 n) {
  const double h1 = dot(n, primitive.end1 - point), h2 = dot(n, primitive.end2 - point);
  double reach1 = primitive.radius1, reach2 = primitive.radius2;
  if (primitive.shape == Shape::flat) {
    const Vec3 axis = primitive.end2 - primitive.end1;
    reach1 = reach2 = primitive.radius1 * norm(cross(n, axis)) / norm(axis);
  }
  return !(min(h1 - reach1, h2 - reach2) <= 0 && max(h1 + reach1, h2 + reach2) >= 0);
}

void add_zone(Zone::Part part, double lower, double upper, double x0, double alpha, double beta, double gamma,
              Section& section) {
  if (!(lower < upper)) return;
  Zone zone{part, lower, upper, x0, alpha, beta, gamma, 0, 0};
  const Interval real = positive_interval(-gamma, beta, alpha, lower - x0, upper - x0);
  if (real.first < real.second) {
    // Exactly the border where the curve goes on beyond it: eta() tells the curve's own ends by that.
    zone.real_lower = real.first > lower - x0 ? real.first + x0 : lower;
    zone.real_upper = real.second < upper - x0 ? real.second + x0 : upper;
  }
  section.zone[section.zone_count++] = zone;
}

void add_sphere_zone(Zone::Part part, double lower, double upper, double x0, double radius, double h,
                     Section& section) {
  add_zone(part, lower, upper, x0, (radius - h) * (radius + h), 0, 1, section);
}

// A cylinder with flat ends: the side only, over the x-range in which the axial coordinate s x - c h1 is in
// [0, H].
void set_flat_zone(Section& section) {
  const double s = section.s, c = section.c, h1 = section.h1, radius = section.radius1;
  double lower = -kInfinity, upper = kInfinity;
  if (s > 0) {
    lower = c * h1 / s;
    upper = (section.length + c * h1) / s;
  } else if (!(h1 <= 0 && section.h2 >= 0)) {
    return;
  }
  add_zone(Zone::side, lower, upper, 0, (radius - s * h1) * (radius + s * h1), -c * s * h1, c * c, section);
}

// Where in x a round section's first zone ends and its last begins. At abscissa x the sphere of the hull
// that reaches farthest in y is the one at parameter t(x) = (g + x x2) / G along the axis, g = r1 dr - h1
// dh, G = H^2 - dr^2: linear in x and clamped to [0, 1], which makes three zones.
struct Borders {
  double first, second;
};
Borders zone_borders(const Section& section) {
  const double dr = section.radius2 - section.radius1, dh = section.h2 - section.h1;
  const double G = (section.length - dr) * (section.length + dr);
  const double g = section.radius1 * dr - section.h1 * dh;
  if (section.x2 > 0) return {-g / section.x2, (G - g) / section.x2};
  return {g >= 0 ? -kInfinity : kInfinity, g >= G ? -kInfinity : kInfinity};
}

// The hull of two spheres.
void set_round_zones(Section& section) {
  const double r1 = section.radius1, h1 = section.h1, x2 = section.x2;
  if (section.length == 0) return add_sphere_zone(Zone::first_end, -kInfinity, kInfinity, 0, r1, h1, section);
  const double dr = section.radius2 - r1, dh = section.h2 - h1;
  const double G = (section.length - dr) * (section.length + dr);
  const double g = r1 * dr - h1 * dh;
  const Borders border = zone_borders(section);
  add_sphere_zone(Zone::first_end, -kInfinity, border.first, 0, r1, h1, section);
  add_zone(Zone::side, border.first, border.second, 0, (r1 - h1) * (r1 + h1) + g * g / G, g * x2 / G,
           (dh - dr) * (dh + dr) / G, section);
  add_sphere_zone(Zone::second_end, border.second, kInfinity, x2, section.radius2, section.h2, section);
}

void set_polygon(const Primitive& primitive, const Corners& at, Section& section) {
  PlacedTriangle triangle{{at.a, at.b, at.c}, section.n, {}};
  section.polygon.count = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 corner = triangle.corner[i] - section.origin;
    triangle.flat[i] = section.polygon.corner[i] = {dot(corner, section.u), dot(corner, section.v)};
  }
  for (std::size_t i = 0; i < primitive.cut_count; ++i) {
    const HalfSpace& cut = primitive.cut[i];
    if (cut_along(cut, kAlongCut * section.radius1, triangle, section.polygon)) continue;
    const Point2 direction{dot(cut.normal, section.u), dot(cut.normal, section.v)};
    const double offset =
        dot(cut.normal, cut.point - section.origin) + cut.offset + section.h1 * dot(cut.normal, section.n);
    cut_polygon(direction, offset, section.polygon);
  }
}

// As near to a cut as this share of its corners' distance a triangle lies in it.
constexpr double kInPlane = 16e-15;

// How far each corner of a polygon lies beyond what is kept.
using Excess = std::array<double, Polygon2::kMaxCorners>;

void cut_by(const Excess& excess, Polygon2& polygon) {
  Polygon2 kept;
  for (std::size_t here = 0; here < polygon.count; ++here) {
    const std::size_t next = here + 1 == polygon.count ? 0 : here + 1;
    const Point2 p = polygon.corner[here], q = polygon.corner[next];
    const double ep = excess[here], eq = excess[next];
    if (ep <= 0 && kept.count < Polygon2::kMaxCorners) kept.corner[kept.count++] = p;
    if ((ep <= 0) != (eq <= 0) && kept.count < Polygon2::kMaxCorners) {
      kept.corner[kept.count++] =
          runs_back(p, q) ? q + (eq / (eq - ep)) * (p - q) : p + (ep / (ep - eq)) * (q - p);
    }
  }
  polygon.count = kept.count < 3 ? 0 : kept.count;
  for (std::size_t i = 0; i < polygon.count; ++i) polygon.corner[i] = kept.corner[i];
}

}  // namespace

bool normal_of(const Corners& at, Vec3& n) {
  const auto& [a, b, c] = at;
  const Vec3 ab = b - a, ac = c - a, bc = c - b;
  const Vec3 normal = cross(ab, ac);
  const double length = norm(normal);
  const double longest = max(dot(ab, ab), max(dot(ac, ac), dot(bc, bc)));
  if (!(length > kNoNormal * longest) || !(longest < kMostEdgeSquared) || !(length > kLeastTwiceArea))
    return false;
  n = normal / length;
  return true;
}

Interval positive_interval(double a, double b, double c, double lower, double upper) {
  if (a == 0) {
    if (b == 0) return c > 0 ? Interval{lower, upper} : Interval{lower, lower};
    const double root = -c / (2 * b);
    return b > 0 ? Interval{max(lower, root), upper} : Interval{lower, min(upper, root)};
  }
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0)) return a > 0 ? Interval{lower, upper} : Interval{lower, lower};
  const double q = b >= 0 ? -(b + std::sqrt(discriminant)) : std::sqrt(discriminant) - b;
  const double root1 = q / a, root2 = c / q;  // q is not zero: the discriminant is positive
  const double first = min(root1, root2), second = max(root1, root2);
  if (a < 0) return {max(lower, first), min(upper, second)};
  const Interval left{lower, min(upper, first)}, right{max(lower, second), upper};
  return left.second - left.first > right.second - right.first ? left : right;
}

Interval real_extent(const Section& section) {
  Interval extent{1e300, -1e300};
  for (std::size_t i = 0; i < section.zone_count; ++i) {
    const Zone& zone = section.zone[i];
    if (!(zone.real_lower < zone.real_upper)) continue;
    extent.first = min(extent.first, zone.real_lower);
    extent.second = max(extent.second, zone.real_upper);
  }
  return extent;
}

bool cut_along(const HalfSpace& cut, double near, const PlacedTriangle& triangle, Polygon2& polygon) {
  double height[3], most = 0, farthest2 = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 from_cut = triangle.corner[i] - cut.point;
    height[i] = dot(cut.normal, from_cut) - cut.offset;
    most = max(most, std::fabs(height[i]));
    farthest2 = max(farthest2, dot(from_cut, from_cut));
  }
  if (!(dot(cut.normal, cut.normal) > 0) || !(most <= near)) return false;
  if (most * most <= kInPlane * kInPlane * farthest2) {
    if (dot(cut.normal, triangle.n) > 0) polygon.count = 0;
    return true;
  }
  const auto& [a, b, c] = triangle.flat;
  const double twice = cross(b - a, c - a);
  Excess excess;  // of as many as there are corners
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Point2 p = polygon.corner[i] - a;
    const double of_b = cross(p, c - a) / twice, of_c = cross(b - a, p) / twice;
    excess[i] = (1 - of_b - of_c) * height[0] + of_b * height[1] + of_c * height[2];
  }
  cut_by(excess, polygon);
  return true;
}

void cut_polygon(Point2 direction, double offset, Polygon2& polygon) {
  Excess excess;  // of as many as there are corners
  bool outside = false;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    excess[i] = dot(direction, polygon.corner[i]) - offset;
    outside = outside || excess[i] > 0;
  }
  if (outside) cut_by(excess, polygon);
}

bool look_along(const Primitive& primitive, Vec3 point, Vec3 n, Vec3 along, Section& section) {
  if (plane_misses(primitive, point, n)) return false;
  section.n = n;
  set_axes(primitive, point, along, section);
  section.zone_count = 0;
  if (section.shape == Shape::flat) {
    set_flat_zone(section);
  } else {
    set_round_zones(section);
  }
  return section.zone_count > 0;
}

double plane_rounding(Vec3 place, const Corners& at) {
  const Vec3 a = at.a - place, b = at.b - place, c = at.c - place;
  const Vec3 ab = b - a, ac = c - a, bc = c - b, raw = cross(ab, ac);
  const double far = max(dot(a, a), max(dot(b, b), dot(c, c)));
  const double longest = max(dot(ab, ab), max(dot(ac, ac), dot(bc, bc)));
  return kPlaneRounding * std::sqrt(far) * (longest / norm(raw));
}

bool look_from_plane(const Primitive& primitive, const Corners& at, Section& section) {
  Vec3 n;
  if (!normal_of(at, n) || !look_along(primitive, at.a, n, at.b - at.a, section)) return false;
  set_polygon(primitive, at, section);
  return section.polygon.count >= 3;
}

}  // namespace lumbrical
