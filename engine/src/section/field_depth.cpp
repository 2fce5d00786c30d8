#include "section/field_depth.h"

#include <cmath>

#include "section/pressure.h"

namespace lumbrical {
namespace {

// The point of the edge from p to q in the plane that is nearest to the axis, which runs from (0, 0, h1) by
// (x2, 0, h2 - h1). The share s of the edge and t of the axis: the nearest points of the lines, then each
// held to its segment (Ericson, Real-Time Collision Detection, 5.1.9).
Point2 nearest_on_edge(const Section& section, Point2 p, Point2 q) {
  const Point2 d = q - p, axis{section.x2, 0};
  const double rise = section.h2 - section.h1;
  const double dd = dot(d, d), aa = dot(axis, axis) + rise * rise, da = dot(d, axis);
  const double pd = dot(p, d), pa = dot(p, axis) - section.h1 * rise;
  if (!(dd > 0)) return p;
  const double gap = dd * aa - da * da;
  double s = gap > 0 ? clamp((da * pa - pd * aa) / gap, 0, 1) : 0;
  const double t = aa > 0 ? clamp((pa + s * da) / aa, 0, 1) : 0;
  s = clamp((t * da - pd) / dd, 0, 1);
  return p + s * d;
}

}  // namespace

Deepest largest_field(const Section& section) {
  const Polygon2& polygon = section.polygon;
  Deepest best{field_at(section, polygon.corner[0]), polygon.corner[0]};
  const auto consider = [&](Point2 p) {
    const double field = field_at(section, p);
    if (field > best.depth) best = {field, p};
  };
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const std::size_t next = i + 1 == polygon.count ? 0 : i + 1;
    consider(nearest_on_edge(section, polygon.corner[i], polygon.corner[next]));
  }
  // Where the axis comes nearest to the plane: an end, or the point where it pierces.
  const double span = section.h2 - section.h1;
  const double at = section.h1 * section.h2 < 0
                        ? -section.h1 / span
                        : (std::fabs(section.h1) <= std::fabs(section.h2) ? 0.0 : 1.0);
  const Point2 foot{at * section.x2, 0}, other{(1 - at) * section.x2, 0};
  if (holds(polygon, section.radius1, foot)) consider(foot);
  if (section.h1 == section.h2 && holds(polygon, section.radius1, other)) consider(other);
  best.depth = max(0, best.depth);
  return best;
}

}  // namespace lumbrical
