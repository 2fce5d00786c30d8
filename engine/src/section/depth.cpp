// dl_max in closed form. The surface below the plane is swept by spheres at parameter 0 <= t <= 1 along the
// axis, of radius R(t), height h(t) and abscissa x(t); depth is the maximum over t of  sqrt(R(t)^2 -
// distance(t)^2) - h(t).
#include "section/depth.h"

#include <cmath>

namespace lumbrical {
namespace {

// sqrt(a t^2 + 2 b t + c) - h1 - t dh on 0 <= t <= 1, concave where the root is real.
struct SweptDepth {
  double a, b, c, h1, dh;
};

double value_at(const SweptDepth& f, double t) {
  const double q = f.c + t * (2 * f.b + t * f.a);
  return q >= 0 ? std::sqrt(q) - f.h1 - t * f.dh : -1e300;
}

struct Largest {
  double t, value;
};

// Its stationary point solves (a t + b) / sqrt(q) = dh; the form is chosen so that nothing cancels whatever
// the sign of b. A wrong candidate does no harm: the ends are tried as well.
Largest largest_value(const SweptDepth& f) {
  const Largest first{0, value_at(f, 0)}, last{1, value_at(f, 1)};
  const Largest end = first.value >= last.value ? first : last;
  const double g = f.dh * f.dh - f.a;
  if (!(g > 0)) return end;
  const double root = std::sqrt(max(0, (f.b * f.b - f.a * f.c) / g));
  const double with = f.b + f.dh * root, against = f.b - f.dh * root;
  const double t = f.b * f.dh >= 0 ? (f.b * f.b - f.dh * f.dh * f.c) / (g * with) : -against / f.a;
  if (!(t > 0 && t < 1)) return end;
  const Largest inner{t, value_at(f, t)};
  return inner.value > end.value ? inner : end;
}

double round_depth(const Section& section, Point2 p) {
  const double dr = section.radius2 - section.radius1, r1 = section.radius1;
  const double y2 = p.y * p.y;
  const SweptDepth f{dr * dr - section.x2 * section.x2, r1 * dr + p.x * section.x2, r1 * r1 - p.x * p.x - y2,
                     section.h1, section.h2 - section.h1};
  return section.length > 0 ? largest_value(f).value : value_at(f, 0);
}

// Side or lower base, whichever comes first.
double flat_depth(const Section& section, Point2 p) {
  const double s = section.s, c = section.c;
  const double side = std::sqrt(max(0, (section.radius1 - p.y) * (section.radius1 + p.y)));
  const double through_side = s > 0 ? s * side - c * (p.x - c * side) / s - section.h1 : 1e300;
  const double through_base = c > 0 ? (s * p.x - c * section.h1) / c : 1e300;
  return max(0, min(through_side, through_base));
}

// On the rim, where x = c sqrt(R^2 - y^2), side and base are the same way out. There depth must not be had
// from either: if the axis lies nearly in the plane or stands nearly upright, one of the two is a cliff, and
// the last digit of x decides which side of it one is on.
double rim_depth(const Section& section, double y) {
  return section.s * std::sqrt(max(0, (section.radius1 - y) * (section.radius1 + y))) - section.h1;
}

// Of a round shape: the abscissa of the end that reaches deepest.
double deeper_end(const Section& section) {
  return section.radius1 - section.h1 >= section.radius2 - section.h2 ? 0 : section.x2;
}

// The deepest point of the whole section; it lies on y = 0 by symmetry.
Deepest deepest_of_section(const Section& section) {
  const bool flat = section.shape == Shape::flat;
  double x = section.c * section.radius1;  // flat: under the lowest point of the rim
  if (!flat) x = deeper_end(section);
  if (inside_section(section, {x, 0})) {
    return {max(0, flat ? rim_depth(section, 0) : depth_at(section, {x, 0})), {x, 0}};
  }
  const double reach = 2 * (section.length + section.radius1 + std::fabs(section.h1));
  const Interval range = inside_interval(section, {0, 0}, {1, 0}, -reach, reach);
  const Point2 nearest{clamp(x, range.first, range.second), 0};
  return {max(0, depth_at(section, nearest)), nearest};
}

// Among all points of a line and all spheres, the sphere that reaches deepest; the answer is the line's
// parameter.
double deepest_on_line(const Section& section, Point2 base, Point2 unit) {
  const Point2 normal{-unit.y, unit.x};
  const double distance = -dot(base, normal), slope = section.x2 * normal.x;
  const double dr = section.radius2 - section.radius1, r1 = section.radius1;
  const SweptDepth f{dr * dr - slope * slope, r1 * dr - distance * slope, r1 * r1 - distance * distance,
                     section.h1, section.h2 - section.h1};
  const double t = section.length > 0 ? largest_value(f).t : 0;
  return dot(Point2{t * section.x2, 0} - base, unit);
}

void consider(const Section& section, Point2 p, Deepest& best) {
  const double depth = depth_at(section, p);
  if (depth > best.depth) best = {depth, p};
}

// A flat cylinder along a line: deepest of the side alone, and where side and base meet (x = c sqrt(R^2 -
// y^2)).
void consider_flat_line(const Section& section, Point2 base, Point2 unit, Interval inside, Deepest& best) {
  const double radius = section.radius1, c = section.c;
  const double denominator = std::sqrt(unit.y * unit.y + c * c * unit.x * unit.x);
  if (std::fabs(unit.y) > 0 && denominator > 0) {
    const double y = -radius * c * unit.x * (unit.y < 0 ? -1 : 1) / denominator;
    consider(section, base + clamp((y - base.y) / unit.y, inside.first, inside.second) * unit, best);
  }
  // Where the line meets the rim, x^2 = c^2 (R^2 - y^2), counted from where it meets x = 0 or y = 0,
  // whichever it runs across: then nothing cancels, however small c is.
  const double scaled = c * unit.y, qa = unit.x * unit.x + scaled * scaled;
  if (!(qa > 0)) return;
  const bool across = std::fabs(unit.x) > std::fabs(scaled);
  const double start = across ? -base.x / unit.x : -base.y / unit.y;
  const double x = across ? 0 : base.x + start * unit.x, y0 = across ? base.y + start * unit.y : 0;
  const double square =
      across ? scaled * scaled * radius * radius + unit.x * unit.x * (radius - y0) * (radius + y0)
             : unit.x * unit.x * radius * radius + unit.y * unit.y * (c * radius - x) * (c * radius + x);
  if (!(square >= 0)) return;
  const double middle = -(x * unit.x + c * c * y0 * unit.y) / qa, half = c * std::sqrt(square) / qa;
  for (const double offset : {middle - half, middle + half}) {
    const double t = start + offset;
    const Point2 p{x + offset * unit.x, y0 + offset * unit.y};
    // Seen from above the rim is half an ellipse, x >= 0. What rounding puts beside it or beside the edge
    // still counts: the rim may run along the section's border.
    const double slack = 1e-13 * radius;
    if (t < inside.first - slack || t > inside.second + slack || p.x < -slack) continue;
    if (rim_depth(section, p.y) > best.depth) best = {rim_depth(section, p.y), p};
  }
}

// Concave along the line: nothing is deeper than the part inside that is nearest to the line's deepest point.
// What the edge has of that lies inside as a rule, and then nobody needs to know where the others begin.
void consider_round_line(const Section& section, Point2 base, Point2 unit, double lower, double upper,
                         Deepest& best) {
  const double deepest = deepest_on_line(section, base, unit);
  double t = clamp(deepest, lower, upper);
  if (!inside_section(section, base + t * unit)) {
    const Interval inside = inside_interval(section, base, unit, lower, upper);
    if (!(inside.first < inside.second)) return;
    t = clamp(deepest, inside.first, inside.second);
  }
  consider(section, base + t * unit, best);
}

void consider_edge(const Section& section, Point2 p, Point2 q, Deepest& best) {
  const Point2 d = q - p;
  const double length = std::sqrt(dot(d, d));
  if (!(length > 0)) return;
  const Point2 unit = (1 / length) * d;
  const double nearest = clamp(-dot(p, unit), 0, length);
  const Point2 base = nearest == 0 ? p : p + nearest * unit;
  if (section.shape == Shape::round)
    return consider_round_line(section, base, unit, -nearest, length - nearest, best);
  const Interval inside = inside_interval(section, base, unit, -nearest, length - nearest);
  if (!(inside.first < inside.second)) return;
  consider(section, base + inside.first * unit, best);
  consider(section, base + inside.second * unit, best);
  consider_flat_line(section, base, unit, inside, best);
}

}  // namespace

double depth_at(const Section& section, Point2 p) {
  return section.shape == Shape::flat ? flat_depth(section, p) : round_depth(section, p);
}

Deepest largest_depth(const Section& section) {
  const Polygon2& polygon = section.polygon;
  const bool round = section.shape == Shape::round;
  const Point2 middle{round ? deeper_end(section) : 0, 0};
  // From the deepest point of all depth falls to every side. So where the polygon doesn't hold it, none of
  // its points is deeper than the one at which the way to it enters, on an edge that faces the deepest point.
  const bool falls = round && inside_section(section, middle);
  if (!falls || holds(polygon, section.radius1, middle)) {
    const Deepest all = deepest_of_section(section);
    if (holds(polygon, section.radius1, all.point)) return all;
  }
  Deepest best{0, polygon.corner[0]};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const std::size_t next = i + 1 == polygon.count ? 0 : i + 1;
    const Point2 p = polygon.corner[i], q = polygon.corner[next];
    if (!falls || is_beyond(p, q, section.radius1, middle)) consider_edge(section, p, q, best);
  }
  return best;
}

}  // namespace lumbrical
