// The field over a region wholly inside by the value at its centroid, over a whole triangle by the rules of
// triangle_rules.h.
//
// With l the reach of the region from its centroid and d the centroid's distance from the axis:
//   one point (any region)     |error| <= area l^2 / (2 (d - l)),  for |D^2 phi| <= 1 / distance to the axis
//   degree n - 1 (a triangle)  |error| <= area 2 p / (n - 1) d (l / d)^n / (1 - l / d)
// the latter where the triangle lies on one side of the field's borders; p = |P_k(0)| of Legendre's
// polynomial, k the even one of n and n - 1. There phi is linear but for a distance, on the side that from
// the axis line times the cosine of the cone's angle: l and d are then taken across the axis, and d times
// that cosine. The distance of a point l off at an angle with cosine z is
//   d sqrt(1 - 2 z t + t^2) = d sum of f_n(z) t^n,  t = l / d,  f_n = (P_(n - 2) - P_n) / (2n - 1),
// and no |f_n| exceeds p / (n - 1): as (1 - z^2) f'' + n (n - 1) f = 0 and f' = - P_(n - 1),
//   S = f^2 + (1 - z^2) f'^2 / (n (n - 1))  has  S' = - 2 z f'^2 / (n (n - 1)),
// so S, and f^2 <= S, is at most S(0), where one of f and f' is zero: f = +-p / (n - 1) for even n, else f'
// = +-p. Weights are positive and nodes inside, so integral and rule both are at most area d sum |f_i|
// t^i, i >= n, on what they do not agree on; and p / (n - 1) falls with n.
//
// Lanes of one register may need different rules. They go through the nodes together, each with the nodes of
// its own rule, until the longest is done: the others' further nodes have no weight.
#pragma once

#include "exact/round_polygon.h"
#include "exact/triangle_rules.h"

namespace lumbrical::LUMBRICAL_ISA {

// Mean depths this near, in units of R, are as good as those of the closed forms.
inline constexpr double kPointwise = 1e-13;

template <class V>
struct PointSum {
  V volume, volume_x, volume_y;  // over the area
  V error;                       // of the volume over the area; large where no rule is good enough
};

// The field about a point where its formula is everywhere the one at the point:
//   phi = level + slope (x - point's x) - sqrt(e^2 + y^2 + height2),
// e and y the plane's coordinates from the foot of the axis, times the stretch.
template <class V>
struct FieldAbout {
  V level, slope, height2;
  Wide2<V> stretch, foot;  // foot: (e, y) of the point
  V distance, margin;      // the root at the point; how far in space it is to where the formula changes
};

template <class V>
FieldAbout<V> field_about(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> p) {
  const V zero = number<V>(0), one = number<V>(1), r = part.radius1;
  FieldAbout<V> about{r, zero, plane.h1 * plane.h1, {one, one}, p, zero, beyond<V>()};
  if (part.sphere) {
    about.distance = sqrt(dot(p, p) + about.height2);
    return about;
  }
  const V e = plane.c * p.x + plane.s * plane.h1, q = plane.s * p.x - plane.c * plane.h1;
  const V rho = sqrt(e * e + p.y * p.y);
  const V past1 = part.cosine * q - part.sine * rho, past2 = past1 - part.cosine * part.length;
  about.margin = min(abs(past1), abs(past2));
  about.level = r - part.sine * q;
  about.slope = zero - part.sine * plane.s;
  about.height2 = zero;
  about.stretch = {part.cosine * plane.c, part.cosine};
  about.foot = {part.cosine * e, part.cosine * p.y};
  about.distance = part.cosine * rho;
  const auto first = past1 < zero, second = past2 >= zero, end = first || second;
  if (!any(end)) return about;
  const V x = p.x - select(first, zero, plane.x2), h = select(first, plane.h1, plane.h2);
  about.level = select(first, r, select(second, part.radius2, about.level));
  about.slope = select(end, zero, about.slope);
  about.height2 = select(end, h * h, zero);
  about.stretch = select(end, Wide2<V>{one, one}, about.stretch);
  about.foot = select(end, Wide2<V>{x, p.y}, about.foot);
  about.distance = select(end, sqrt(x * x + p.y * p.y + h * h), about.distance);
  return about;
}

// Which rule each lane takes, if any.
template <class V>
struct RuleChoice {
  using Mask = decltype(V() < V());
  Mask takes[kTriangleRuleCount];
  std::size_t taken[kTriangleRuleCount], taken_count = 0;  // rules that any lane takes
  V pick(double TriangleRule::*value) const {
    V picked = number<V>(0);
    for (std::size_t k = 0; k < taken_count; ++k)
      picked = select(takes[taken[k]], number<V>(kTriangleRules[taken[k]].*value), picked);
    return picked;
  }
  template <class Orbit, std::size_t N>
  V pick(Orbit (TriangleRule::*orbits)[N], std::size_t i, double Orbit::*value) const {
    V picked = number<V>(0);
    for (std::size_t k = 0; k < taken_count; ++k)
      picked = select(takes[taken[k]], number<V>((kTriangleRules[taken[k]].*orbits)[i].*value), picked);
    return picked;
  }
  std::size_t most(std::size_t TriangleRule::*count) const {
    std::size_t largest = 0;
    for (std::size_t k = 0; k < taken_count; ++k) {
      const std::size_t own = kTriangleRules[taken[k]].*count;
      if (own > largest) largest = own;
    }
    return largest;
  }
};

// Means over a triangle: of the field without its slope, and of that times what each corner has in the way
// from the centroid.
template <class V>
struct MeanField {
  V mean, corner[3];
};

// `off`: the corners from the centroid in the stretched coordinates.
template <class V>
MeanField<V> mean_field(const FieldAbout<V>& about, const Wide2<V> (&off)[3], const RuleChoice<V>& rules) {
  const V zero = number<V>(0);
  const V centre = rules.pick(&TriangleRule::centre) * (about.level - about.distance);
  V mean = zero + centre, corner[3] = {zero, zero, zero};
  const auto field = [&](Wide2<V> way) {
    const Wide2<V> p = about.foot + way;
    return about.level - sqrt(dot(p, p) + about.height2);
  };
  const std::size_t corner_count = rules.most(&TriangleRule::corner_count);
  for (std::size_t orbit = 0; orbit < corner_count; ++orbit) {
    const V at = rules.pick(&TriangleRule::corner, orbit, &CornerOrbit::at);
    const V weight = rules.pick(&TriangleRule::corner, orbit, &CornerOrbit::weight), way = weight * at;
    const V phi0 = field(at * off[0]), phi1 = field(at * off[1]), phi2 = field(at * off[2]);
    mean = mean + weight * (phi0 + phi1 + phi2);
    corner[0] = corner[0] + way * phi0;
    corner[1] = corner[1] + way * phi1;
    corner[2] = corner[2] + way * phi2;
  }
  const std::size_t pair_count = rules.most(&TriangleRule::pair_count);
  for (std::size_t orbit = 0; orbit < pair_count; ++orbit) {
    const V first = rules.pick(&TriangleRule::pair, orbit, &PairOrbit::first);
    const V second = rules.pick(&TriangleRule::pair, orbit, &PairOrbit::second);
    const V weight = rules.pick(&TriangleRule::pair, orbit, &PairOrbit::weight);
    const Wide2<V> near[3] = {first * off[0], first * off[1], first * off[2]};
    const Wide2<V> far[3] = {second * off[0], second * off[1], second * off[2]};
    const V phi01 = field(near[0] + far[1]), phi12 = field(near[1] + far[2]), phi20 = field(near[2] + far[0]);
    const V phi10 = field(near[1] + far[0]), phi21 = field(near[2] + far[1]), phi02 = field(near[0] + far[2]);
    const V sum0 = phi01 + phi02, sum1 = phi12 + phi10, sum2 = phi20 + phi21;
    mean = mean + weight * (sum0 + sum1 + sum2);
    const V one = weight * first, other = weight * second;
    corner[0] = corner[0] + (one * sum0 + other * (phi10 + phi20));
    corner[1] = corner[1] + (one * sum1 + other * (phi01 + phi21));
    corner[2] = corner[2] + (one * sum2 + other * (phi02 + phi12));
  }
  return {mean, {corner[0], corner[1], corner[2]}};
}

// What rounding leaves in a volume by points: ulps of R in the corners, that is in the area.
template <class V>
V rounded_off(V radius, V size) {
  return rounding<V>() * (radius * (radius * size));
}

// Chooses the cheapest rule of a triangle whose reach from its centroid, in the stretched coordinates, is
// given; its error, over the area, or beyond anything.
template <class V, class M>
V choose_rules(M wanted, V reach, V distance, V allowed, RuleChoice<V>& rules) {
  const auto near = wanted && reach < number<V>(0.9) * distance;
  const V left = distance - reach, per = one_over(select(near, distance * left, distance));
  const V ratio = reach * (left * per), cube = ratio * ratio * ratio;
  V error = beyond<V>(), rest = distance * (distance * (distance * per));  // distance / (1 - ratio)
  auto open = near;
  for (std::size_t k = 0; k < kTriangleRuleCount; ++k) {
    rest = rest * cube;
    const V bound = number<V>(kRemainders.of[k]) * rest;
    rules.takes[k] = open && bound <= allowed;
    open = open && bound > allowed;
    error = select(rules.takes[k], bound, error);
    if (any(rules.takes[k])) rules.taken[rules.taken_count++] = k;
  }
  return error;
}

// The value at the centroid, where the region is small enough for it.
template <class V>
PointSum<V> by_centroid(const FieldAbout<V>& about, Wide2<V> centroid, V square, V radius2, V allowed) {
  const V phi = about.level - about.distance, distance = radius2 - phi, two = number<V>(2);
  PointSum<V> sum{phi, phi * centroid.x, phi * centroid.y, beyond<V>()};
  const auto small = square < two * (allowed * distance);
  if (!any(small)) return sum;
  const V reach = sqrt(square);
  const auto near = small && reach < number<V>(0.9) * distance;
  sum.error = select(near, square * one_over(two * (distance - reach)), sum.error);
  return sum;
}

// `triangle`: wholly inside, and nothing was cut away. `allowed` [m] is what it may be off.
template <class V, class M>
PointSum<V> by_points(const RoundPart<V>& part, const RoundPlane<V>& plane, const Polygon<V>& polygon,
                      Wide2<V> centroid, M triangle, V allowed) {
  const V zero = number<V>(0), twelfth = number<V>(1.0 / 12);
  // A triangle's own mean has more digits than moments of the area have.
  const Wide2<V> a = polygon.edge[0].p, b = polygon.edge[1].p, c = polygon.edge[2].p;
  const Wide2<V> middle = select(triangle, a + number<V>(1.0 / 3) * ((b - a) + (c - a)), centroid);
  const FieldAbout<V> about = field_about(part, plane, middle);
  V square = zero;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    const Wide2<V> off = edge.p - middle;
    square = select(has_length(edge), max(square, dot(off, off)), square);
  }
  const PointSum<V> sum = by_centroid(about, middle, square, part.radius2, allowed);
  const auto smooth = triangle && square < about.margin * about.margin;
  const auto more = smooth && sum.error > allowed;
  if (!any(more)) return sum;

  const Wide2<V> way[3] = {a - middle, b - middle, c - middle};
  Wide2<V> off[3];
  V across = zero;
  for (std::size_t i = 0; i < 3; ++i) {
    off[i] = {about.stretch.x * way[i].x, about.stretch.y * way[i].y};
    across = max(across, dot(off[i], off[i]));
  }
  RuleChoice<V> rules;
  const V error = choose_rules(more, sqrt(across), about.distance, allowed, rules);
  if (rules.taken_count == 0) return sum;
  const MeanField<V> field = mean_field(about, off, rules);
  // The slope has a first moment only.
  Wide2<V> moment{zero, zero};
  for (std::size_t i = 0; i < 3; ++i)
    moment = moment + (field.corner[i] + twelfth * about.slope * way[i].x) * way[i];
  const auto had = error <= allowed;
  return {select(had, field.mean, sum.volume), select(had, field.mean * middle.x + moment.x, sum.volume_x),
          select(had, field.mean * middle.y + moment.y, sum.volume_y), select(had, error, sum.error)};
}

}  // namespace lumbrical::LUMBRICAL_ISA
