#include "section/slab.h"

#include "section/section.h"
#include "section/stated_errors.h"

namespace lumbrical {
namespace {

struct Plane {
  Vec3 origin, u, v, n;
};

// dot(face normal, p - face point): negative inside.
Linear height_over(const HalfSpace& face, const Plane& plane) {
  return {dot(face.normal, plane.origin - face.point),
          {dot(face.normal, plane.u), dot(face.normal, plane.v)}};
}

// Integral of a linear function and of p times it: the three-midpoint rule is exact for quadratics.
PlaneMoments moments_of(const Polygon2& polygon, const Linear& f) {
  PlaneMoments sum;
  const Point2 a = polygon.corner[0];
  for (std::size_t i = 1; i + 1 < polygon.count; ++i) {
    const Point2 b = polygon.corner[i], c = polygon.corner[i + 1];
    const double weight = cross(b - a, c - a) / 6;
    for (const Point2 middle : {0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)}) {
      sum.volume += weight * f.at(middle);
      sum.first = sum.first + (weight * f.at(middle)) * middle;
    }
  }
  return sum;
}

// What the faces leave of the triangle; no corners where nothing is left.
Polygon2 polygon_in(const Slab& slab, const Corners& at, const Plane& plane) {
  const auto& [a, b, c] = at;
  Polygon2 polygon;
  polygon.count = 3;
  polygon.corner[0] = {0, 0};
  polygon.corner[1] = {dot(b - a, plane.u), dot(b - a, plane.v)};
  polygon.corner[2] = {dot(c - a, plane.u), dot(c - a, plane.v)};
  const PlacedTriangle triangle{
      {a, b, c}, plane.n, {polygon.corner[0], polygon.corner[1], polygon.corner[2]}};
  for (std::size_t i = 0; i < slab.face_count && polygon.count >= 3; ++i) {
    const HalfSpace& face = slab.face[i];
    if (cut_along(face, kAlongCut * slab.thickness, triangle, polygon)) continue;
    const Linear height = height_over(face, plane);
    cut_polygon(height.slope, -height.value, polygon);
  }
  return polygon;
}

Point2 deepest_corner(const Polygon2& polygon, const Linear& field) {
  Point2 deepest = polygon.corner[0];
  for (std::size_t i = 1; i < polygon.count; ++i) {
    const Point2 p = polygon.corner[i];
    if (field.at(p) > field.at(deepest)) deepest = p;
  }
  return deepest;
}

}  // namespace

bool collide_slab(const Slab& slab, Law law, double point_area, const Corners& at, Contact& contact) {
  Plane plane{at.a, {}, {}, {}};
  if (!normal_of(at, plane.n)) return false;
  plane.u = unit_or(at.b - at.a, Vec3{});
  plane.v = cross(plane.n, plane.u);
  const Polygon2 polygon = polygon_in(slab, at, plane);
  if (polygon.count < 3) return false;
  const AreaMoments area = polygon_area(polygon);
  if (!(area.area > 0)) return false;

  const Linear over = height_over(slab.face[0], plane), field{-over.value, -1.0 * over.slope};
  const Point2 deepest = deepest_corner(polygon, field);
  const double depth = max(0, field.at(deepest));
  double volume = area.area * depth;
  Point2 centre = area.centroid;
  if (law == Law::field || law == Law::column) {
    const PlaneMoments moments = moments_of(polygon, field);
    volume = moments.volume;
    if (volume > 0) centre = (1 / volume) * moments.first;
  } else if (law == Law::centroid) {
    volume = area.area * field.at(area.centroid);
  } else if (law == Law::point) {
    volume = point_area * depth;
    centre = deepest;
  }
  const auto to_world = [&](Point2 p) { return plane.origin + p.x * plane.u + p.y * plane.v; };
  contact.depth = depth;
  contact.area = area.area;
  contact.volume = max(0, volume);
  contact.centroid = to_world(area.centroid);
  contact.centre = to_world(centre);
  contact.normal = plane.n;
  contact.error = slab_error(slab, at, area.area);
  return true;
}

double slab_error(const Slab& slab, const Corners& at, double area) {
  const double r = slab.thickness;
  return kDiscError * r * r * r + plane_rounding(slab.face[1].point, at) * area;
}

}  // namespace lumbrical
