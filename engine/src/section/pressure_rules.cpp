// See pressure_rules.h.
#include "section/pressure_rules.h"

#include <cmath>

#include "lanes/field.h"
#include "lanes/triangle_rules.h"

namespace lumbrical {
namespace {

template <std::size_t N>
PressureMoments by_rule(const Section& section, const Slant& slant, int zone, double area,
                        const Barycentric (&rule)[N]) {
  PressureMoments sum;
  const auto& corner = section.polygon.corner;
  for (const Barycentric& node : rule) {
    const Point2 p = node.a * corner[0] + node.b * corner[1] + node.c * corner[2];
    const double share = area * node.weight * field_of(section, slant, zone, p);
    sum.volume += share;
    sum.first = sum.first + share * p;
  }
  return sum;
}

double legendre_bound(double degree, double l, double d) {
  double power = 1;
  const double ratio = l / d;
  for (int i = 0; i <= static_cast<int>(degree); ++i) power *= ratio;
  return 4 * d / (2 * degree + 1) * power / (1 - ratio);
}

}  // namespace

bool field_by_points(const Section& section, const AreaMoments& area, bool whole_triangle, double tolerance,
                     PressureMoments& moments) {
  if (!(tolerance > 0)) return false;
  const Slant slant = slant_of(section);
  const FieldZone here = zone_of(section, slant, area.centroid);
  double square = 0;
  for (int i = 0; i < section.polygon.count; ++i) {
    const Point2 off = section.polygon.corner[static_cast<std::size_t>(i)] - area.centroid;
    square = max(square, dot(off, off));
  }
  const double reach = std::sqrt(square), allowed = tolerance * section.radius1;
  const double phi = field_of(section, slant, here.zone, area.centroid);
  const double distance = section.radius2 - phi;  // of the centroid from the axis, at least
  if (!(reach < 0.9 * distance)) return false;
  const double one = square / (2 * (distance - reach));
  if (one <= allowed) {
    moments = {area.area * phi, (area.area * phi) * area.centroid, area.area * one};
    return true;
  }
  if (!whole_triangle || section.polygon.count != 3 || !(reach < here.margin)) return false;
  const double three = legendre_bound(2, reach, distance), seven = legendre_bound(5, reach, distance);
  if (three <= allowed) {
    moments = by_rule(section, slant, here.zone, area.area, kThreePoints);
    moments.error = area.area * three;
    return true;
  }
  if (seven > allowed) return false;
  moments = by_rule(section, slant, here.zone, area.area, kSevenPoints);
  moments.error = area.area * seven;
  return true;
}

}  // namespace lumbrical
