#include "section/prism.h"

#include <cmath>

#include "section/section.h"

namespace lumbrical {
namespace {

// value + dot(slope, p): depth as a function of the plane point.
struct Linear {
  double value;
  Point2 slope;
  [[nodiscard]] double at(Point2 p) const { return value + dot(slope, p); }
};

struct Plane {
  Vec3 origin, u, v, n;
};

// dot(face normal, p - face point): negative inside.
Linear height_over(const HalfSpace& face, const Plane& plane) {
  return {dot(face.normal, plane.origin - face.point),
          {dot(face.normal, plane.u), dot(face.normal, plane.v)}};
}

struct Moments {
  double volume = 0;
  Point2 first{0, 0};
};

// Integral of a linear function and of p times it: the three-midpoint rule is exact for quadratics.
void add_moments(const Polygon2& polygon, const Linear& f, Moments& sum) {
  const Point2 a = polygon.corner[0];
  for (int i = 1; i + 1 < polygon.count; ++i) {
    const Point2 b = polygon.corner[static_cast<std::size_t>(i)],
                 c = polygon.corner[static_cast<std::size_t>(i + 1)];
    const double weight = cross(b - a, c - a) / 6;
    for (const Point2 middle : {0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)}) {
      sum.volume += weight * f.at(middle);
      sum.first = sum.first + (weight * f.at(middle)) * middle;
    }
  }
}

// Depth along -n is the least of the faces' linear depths: on each part of the polygon one face is the way
// out.
struct Column {
  int count = 0;
  std::array<Linear, Prism::kMaxFaces> exit;
};

Column columns_of(const Prism& prism, const Plane& plane) {
  Column column;
  for (int i = 0; i < prism.face_count; ++i) {
    const HalfSpace& face = prism.face[static_cast<std::size_t>(i)];
    const double along = dot(face.normal, plane.n);
    if (!(along < -1e-12)) continue;  // going along -n never leaves through this face
    const Linear height = height_over(face, plane);
    column.exit[static_cast<std::size_t>(column.count++)] = {height.value / along,
                                                             (1 / along) * height.slope};
  }
  return column;
}

Polygon2 part_through(const Column& column, int face, const Polygon2& polygon) {
  Polygon2 part = polygon;
  const Linear& own = column.exit[static_cast<std::size_t>(face)];
  for (int i = 0; i < column.count && part.count >= 3; ++i) {
    if (i == face) continue;
    const Linear& other = column.exit[static_cast<std::size_t>(i)];
    cut_polygon(own.slope - other.slope, other.value - own.value, part);
  }
  return part;
}

double least(const Column& column, Point2 p) {
  double depth = 1e300;
  for (int i = 0; i < column.count; ++i) depth = min(depth, column.exit[static_cast<std::size_t>(i)].at(p));
  return column.count > 0 ? max(0, depth) : 0;
}

struct ColumnResult {
  Moments moments;
  double deepest = 0;
  Point2 deepest_at{0, 0};
};

// The one face through which all of the polygon leaves, or -1. What is the least of linear functions at every
// corner is it everywhere between.
int only_exit(const Column& column, const Polygon2& polygon) {
  const auto is_least = [&](int face, Point2 p) {
    const double own = column.exit[static_cast<std::size_t>(face)].at(p);
    for (int i = 0; i < column.count; ++i) {
      if (column.exit[static_cast<std::size_t>(i)].at(p) < own) return false;
    }
    return true;
  };
  for (int face = 0; face < column.count; ++face) {
    int corner = 0;
    while (corner < polygon.count && is_least(face, polygon.corner[static_cast<std::size_t>(corner)]))
      ++corner;
    if (corner == polygon.count) return face;
    if (corner > 0) return -1;  // the least at the first corner, and not at another
  }
  return -1;
}

void add_part(const Column& column, int face, const Polygon2& part, ColumnResult& result) {
  add_moments(part, column.exit[static_cast<std::size_t>(face)], result.moments);
  for (int i = 0; i < part.count; ++i) {
    const Point2 p = part.corner[static_cast<std::size_t>(i)];
    const double depth = least(column, p);
    if (depth > result.deepest) {
      result.deepest = depth;
      result.deepest_at = p;
    }
  }
}

ColumnResult run_columns(const Column& column, const Polygon2& polygon) {
  ColumnResult result;
  if (const int face = only_exit(column, polygon); face >= 0) {
    add_part(column, face, polygon, result);
    return result;
  }
  for (int face = 0; face < column.count; ++face) {
    const Polygon2 part = part_through(column, face, polygon);
    if (part.count >= 3) add_part(column, face, part, result);
  }
  return result;
}

// How far the corners lie over the faces.
struct Heights {
  std::array<std::array<double, 3>, Prism::kMaxFaces> over;
  bool beside = false;  // all of them over one face: most triangles end here
};

Heights heights_of(const Prism& prism, Vec3 a, Vec3 b, Vec3 c) {
  Heights heights;
  for (std::size_t i = 0; i < static_cast<std::size_t>(prism.face_count); ++i) {
    const HalfSpace& face = prism.face[i];
    heights.over[i] = {dot(face.normal, a - face.point), dot(face.normal, b - face.point),
                       dot(face.normal, c - face.point)};
    const auto& [ha, hb, hc] = heights.over[i];
    if (ha > 0 && hb > 0 && hc > 0) {
      heights.beside = true;
      break;
    }
  }
  return heights;
}

}  // namespace

bool collide_prism(const Prism& prism, Law law, double point_area, Vec3 a, Vec3 b, Vec3 c, Contact& contact) {
  const Heights heights = heights_of(prism, a, b, c);
  if (heights.beside) return false;
  Plane plane{a, {}, {}, {}};
  if (!normal_of(a, b, c, plane.n)) return false;
  plane.u = unit_or(b - a, Vec3{});
  plane.v = cross(plane.n, plane.u);
  Polygon2 polygon;
  polygon.count = 3;
  polygon.corner[0] = {0, 0};
  polygon.corner[1] = {dot(b - a, plane.u), dot(b - a, plane.v)};
  polygon.corner[2] = {dot(c - a, plane.u), dot(c - a, plane.v)};
  for (int i = 0; i < prism.face_count && polygon.count >= 3; ++i) {
    const auto& [ha, hb, hc] = heights.over[static_cast<std::size_t>(i)];
    if (ha <= 0 && hb <= 0 && hc <= 0) continue;
    const Linear height = height_over(prism.face[static_cast<std::size_t>(i)], plane);
    cut_polygon(height.slope, -height.value, polygon);
  }
  if (polygon.count < 3) return false;
  const AreaMoments area = polygon_area(polygon);
  if (!(area.area > 0)) return false;

  const Column column = columns_of(prism, plane);
  const ColumnResult result = run_columns(column, polygon);
  const auto to_world = [&](Point2 p) { return plane.origin + p.x * plane.u + p.y * plane.v; };
  Moments pressure{area.area * result.deepest, {0, 0}};
  Point2 centre = area.centroid;
  if (law == Law::field || law == Law::column) {
    pressure = result.moments;
    if (law == Law::field) {
      const Linear height = height_over(prism.face[0], plane);
      pressure = {};
      add_moments(polygon, {-height.value, -1.0 * height.slope}, pressure);
    }
    if (pressure.volume > 0) centre = (1 / pressure.volume) * pressure.first;
  } else if (law == Law::centroid) {
    pressure.volume = area.area * least(column, area.centroid);
  } else if (law == Law::point) {
    pressure.volume = point_area * result.deepest;
    centre = result.deepest_at;
  }
  contact.depth = result.deepest;
  contact.area = area.area;
  contact.volume = max(0, pressure.volume);
  contact.centroid = to_world(area.centroid);
  contact.centre = to_world(centre);
  contact.normal = plane.n;
  return true;
}

}  // namespace lumbrical
