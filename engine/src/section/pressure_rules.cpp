// See pressure_rules.h. The rules are those of the lanes, one lane wide.
#include "section/pressure_rules.h"

#include <cmath>

#define LUMBRICAL_ISA scalar
#include "lanes/field.h"
#include "lanes/point_rules.h"

namespace lumbrical {
namespace {

using scalar::Polygon;
using scalar::RoundPart;
using scalar::RoundPlane;
using scalar::Wide2;

RoundPart<double> part_of(const Section& section) {
  const Slant slant = slant_of(section);
  return scalar::round_part(section.length, section.radius1, section.radius2, slant.sine, slant.cosine,
                            section.length == 0, slant.sine != 0);
}

}  // namespace

bool field_by_points(const Section& section, const AreaMoments& area, bool whole_triangle, double tolerance,
                     PressureMoments& moments) {
  const int count = section.polygon.count;
  if (!(tolerance > 0) || count < 3 || count > static_cast<int>(Polygon<double>::kMost)) return false;
  const double allowed = max(tolerance, scalar::kPointwise) * section.radius1;
  const RoundPlane<double> plane{{}, {}, {}, section.s, section.c, section.h1, section.h2, section.x2};
  Polygon<double> polygon;
  double square = 0;
  for (int i = 0; i < count; ++i) {
    const Point2 p = section.polygon.corner[static_cast<std::size_t>(i)];
    const Point2 q = section.polygon.corner[static_cast<std::size_t>((i + 1) % count)];
    square = max(square, dot(p - area.centroid, p - area.centroid));
    polygon.edge[polygon.count++] = {{p.x, p.y}, {q.x, q.y}};
  }
  const auto sum =
      scalar::by_points(part_of(section), plane, polygon, Wide2<double>{area.centroid.x, area.centroid.y},
                        whole_triangle && count == 3, allowed);
  if (!(sum.error <= allowed)) return false;
  moments.volume = area.area * sum.volume;
  moments.first = area.area * Point2{sum.volume_x, sum.volume_y};
  moments.error = area.area * sum.error + scalar::rounded_off(section.radius1, 2 * std::sqrt(square));
  return true;
}

}  // namespace lumbrical
