// The ladder of precision in lanes: the field over a region wholly inside by one, three or seven points.
// Bounds and rules are those of pressure_rules.h.
#pragma once

#include "lanes/disc_integrals.h"
#include "lanes/triangle_rules.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class V>
struct PointSum {
  V volume, volume_x, volume_y;  // over the area
  V error;                       // of the volume over the area; large where no rule is good enough
};

template <class V, std::size_t N>
inline void by_rule(const RoundPart<V>& part, const RoundPlane<V>& plane, const Polygon<V>& polygon,
                    const Barycentric (&rule)[N], PointSum<V>& sum) {
  const V zero = number<V>(0);
  sum.volume = sum.volume_x = sum.volume_y = zero;
  for (const Barycentric& node : rule) {
    const Wide2<V> p = number<V>(node.a) * polygon.edge[0].p + number<V>(node.b) * polygon.edge[1].p +
                       number<V>(node.c) * polygon.edge[2].p;
    const V share = number<V>(node.weight) * field_at(part, plane, p).phi;
    sum.volume = sum.volume + share;
    sum.volume_x = sum.volume_x + share * p.x;
    sum.volume_y = sum.volume_y + share * p.y;
  }
}

// `triangle`: nothing was cut away. `allowed` [m] is the tolerance times R.
template <class V, class M>
PointSum<V> by_points(const RoundPart<V>& part, const RoundPlane<V>& plane, const Polygon<V>& polygon,
                      Wide2<V> centroid, M triangle, V allowed) {
  const V zero = number<V>(0), one = number<V>(1);
  const FieldValue<V> field = field_at(part, plane, centroid);
  V square = zero;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    const Wide2<V> off = edge.p - centroid;
    square = choose(has_length(edge), greater(square, dot(off, off)), square);
  }
  const V reach = root(square), distance = part.radius2 - field.phi;
  const auto near = reach < number<V>(0.9) * distance;
  const V ratio = quotient(reach, choose(near, distance, one));
  const V none = beyond<V>();
  PointSum<V> sum{field.phi, field.phi * centroid.x, field.phi * centroid.y,
                  choose(near, square * one_over(number<V>(2) * (distance - reach)), none)};
  const auto smooth = both(triangle, both(near, reach < field.margin));
  const V ratio3 = ratio * ratio * ratio, rest = distance * one_over(one - ratio);
  const V three = number<V>(4.0 / 5) * (ratio3 * rest),
          seven = number<V>(4.0 / 11) * (ratio3 * (ratio3 * rest));
  const auto more = both(smooth, sum.error > allowed);
  const auto use3 = both(more, three <= allowed);
  const auto use7 = both(both(more, three > allowed), seven <= allowed);
  const auto take = [&](const auto& which, const PointSum<V>& other, V error) {
    sum = {choose(which, other.volume, sum.volume), choose(which, other.volume_x, sum.volume_x),
           choose(which, other.volume_y, sum.volume_y), choose(which, error, sum.error)};
  };
  PointSum<V> other = sum;
  if (some(use3)) {
    by_rule(part, plane, polygon, kThreePoints, other);
    take(use3, other, three);
  }
  if (some(use7)) {
    by_rule(part, plane, polygon, kSevenPoints, other);
    take(use7, other, seven);
  }
  return sum;
}

}  // namespace lumbrical::LUMBRICAL_ISA
