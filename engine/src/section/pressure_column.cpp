// The column law's integral: the paper's depth, along -n to the primitive's own surface, integrated over the
// area.
//
// As in pressure_field.cpp the inner integral over y is in closed form. Columns leave a hull of two spheres
// through the deeper one, through the side or through the higher one: at abscissa x in this order from y = 0
// outward. Depth is the maximum over t of sqrt(a t^2 + 2 b t + c) - h - t dh (section/depth.cpp), so the ways
// out meet where its derivative vanishes at an end: where b^2 or (a + b)^2 is dh^2 times the end's own
// square.
#include <cmath>
#include <utility>

#include "base/elementary.h"
#include "section/boundary_integral.h"
#include "section/pressure.h"
#include "section/stated_errors.h"

namespace lumbrical {
namespace {

struct Strip {
  double zeroth, first;  // int_0^y d dy' and int_0^y y' d dy'
};

Strip operator+(Strip a, Strip b) { return {a.zeroth + b.zeroth, a.first + b.first}; }

/// An end as columns see it.
struct ColumnEnd {
  double x, radius, h;  // [m] abscissa, and height over the plane

  // [m^2] How far the sphere reaches in y, squared.
  [[nodiscard]] double square_at(double at) const { return (radius - (at - x)) * (radius + (at - x)); }
};

/// A section's primitive, from the end that lies deeper to the other.
struct Columns {
  ColumnEnd low, high;
  double dr, dx, dh;  // from low to high; dh >= 0
  double a, g;        // dr^2 - dx^2 and dh^2 - a, of all columns
  bool sphere, flat;

  explicit Columns(const Section& section)
      : low{0, section.radius1, section.h1},
        high{section.x2, section.radius2, section.h2},
        sphere(section.length == 0),
        flat(section.shape == Shape::flat) {
    if (high.h < low.h) std::swap(low, high);
    dr = high.radius - low.radius;
    dx = high.x - low.x;
    dh = high.h - low.h;
    a = (dr - dx) * (dr + dx);
    g = (section.length - dr) * (section.length + dr);
  }
  [[nodiscard]] double b_at(double x) const { return low.radius * dr + (x - low.x) * dx; }
};

// Between y1 and y2, of the root of d + a y^2, a not 0, and of y times it.
Strip roots_between(double d, double a, double y1, double y2) {
  const double w1 = std::sqrt(max(0, d + a * y1 * y1)), w2 = std::sqrt(max(0, d + a * y2 * y2)),
               sum = w1 + w2;
  if (!(sum > 0)) return {0, 0};
  const double wide = y2 - y1, squares = wide * (y1 + y2), scale = std::sqrt(std::fabs(a));
  const double turn = a < 0 ? arc_tan2(scale * (y2 * w1 - y1 * w2), w1 * w2 - a * y1 * y2)
                            : log_1p((scale * wide + a * squares / sum) / (scale * y1 + w1));
  return {0.5 * (y2 * w2 - y1 * w1 + d / scale * turn), (w1 * w1 + w1 * w2 + w2 * w2) / sum * squares / 3};
}

// Of a depth that is `height` less than `roots` times `scale`.
Strip below(double height, Strip roots, double scale, double y1, double y2) {
  const double wide = y2 - y1;
  return {scale * roots.zeroth - height * wide, scale * roots.first - 0.5 * height * wide * (y1 + y2)};
}

Strip through_sphere(const ColumnEnd& end, double x, double y1, double y2) {
  if (!(y1 < y2)) return {0, 0};
  return below(end.h, roots_between(max(0, end.square_at(x)), -1, y1, y2), 1, y1, y2);
}

Strip through_base(const Section& section, double x, double y) {
  const double base = section.c > 0 ? (section.s * x - section.c * section.h1) / section.c : 0;
  return {base * y, 0.5 * base * y * y};
}

// Through the side depth is (dh b - sqrt(g D)) / a - h with D = b^2 - a c = d + a y^2.
Strip through_side(const Columns& columns, double x, double y1, double y2) {
  if (!(y1 < y2)) return {0, 0};
  const double a = columns.a, g = columns.g, h = columns.low.h;
  const double b = columns.b_at(x), along = columns.dh * b, c = columns.low.square_at(x), d = b * b - a * c;
  constexpr double kEnough = 0.0025;  // of the length squared, for nothing to cancel
  if (std::fabs(a) > kEnough * g)
    return below(h - along / a, roots_between(d, a, y1, y2), -std::sqrt(g) / a, y1, y2);
  Singularities ends;
  if (const double square = -d / a; std::fabs(square) < 1e300)
    ends.add(square > 0 ? std::sqrt(square) : 0, square > 0 ? 0 : std::sqrt(-square));
  // Rounding must not take it out of the hull.
  const double most = max(columns.low.radius - h, columns.high.radius - columns.high.h);
  Strip sum{0, 0};
  graded_nodes(y1, y2, ends, [&](double y, double weight) {
    const double root = std::sqrt(g * max(0, d + a * y * y)), sum_of_both = along + root;
    const double reach =
        b > 0 && sum_of_both > 0 ? (b * b + g * (c - y * y)) / sum_of_both : (along - root) / a;
    const double depth = clamp(reach - h, 0, most);
    sum.zeroth += weight * depth;
    sum.first += weight * depth * y;
  });
  return sum;
}

// The y up to which columns leave through the low end, or from which on through the high one: `slope` less dh
// times the root of the end's own square, which is `square` at y = 0, has the sign of depth's derivative.
double change_at(const Columns& columns, double square, double slope) {
  const double root = std::sqrt(max(0, square)), change = slope / columns.dh;
  return change < root ? std::sqrt((root - change) * (root + change)) : 0;
}

double low_until(const Columns& columns, double x, double b) {
  const double square = columns.low.square_at(x);
  if (b > 0) return change_at(columns, square, b);
  return columns.a > 0 ? std::sqrt(max(0, square)) : 1e300;  // in the shade of a wider one, or by itself
}

Strip strip_to(const Section& section, const Columns& columns, double x, double signed_y) {
  const double y = std::fabs(signed_y);
  Strip strip{0, 0};
  if (columns.sphere) {
    strip = through_sphere(columns.low, x, 0, y);
  } else {
    const double b = columns.b_at(x), end = columns.a + b;
    const double first = min(y, low_until(columns, x, b));
    const double last =
        columns.flat || !(end > 0) ? y : clamp(change_at(columns, columns.high.square_at(x), end), first, y);
    strip = columns.flat ? through_base(section, x, first) : through_sphere(columns.low, x, 0, first);
    strip = strip + through_side(columns, x, first, last) + through_sphere(columns.high, x, last, y);
  }
  if (signed_y < 0) strip.zeroth = -strip.zeroth;
  return strip;
}

/// c + 2 b t + a t^2 along a piece.
struct AlongPiece {
  double a, b, c;
};
AlongPiece operator-(AlongPiece p, AlongPiece q) { return {p.a - q.a, p.b - q.b, p.c - q.c}; }
AlongPiece operator*(double s, AlongPiece p) { return {s * p.a, s * p.b, s * p.c}; }
AlongPiece square_of(double at_start, double slope) {
  return {slope * slope, at_start * slope, at_start * at_start};
}

// Roots of f, off the real axis too; of real ones those at which a line of that slope and value at the start
// is `sign` times positive, or 0.
void add_roots(const AlongPiece& f, double sign, double at_start, double slope, Singularities& kinks) {
  const double square = f.b * f.b - f.a * f.c;
  if (!(square >= 0)) return kinks.add(-f.b / f.a, std::sqrt(-square) / std::fabs(f.a));
  const double q = -(f.b + std::copysign(std::sqrt(square), f.b));
  for (const double root : {q / f.a, f.c / q}) {
    if (sign * (at_start + slope * root) >= 0) kinks.add(root);
  }
}

// Where the way out changes, and where a sphere or the side stands upright.
Singularities kinks_of(const Columns& columns, const Piece& piece, const Zone& zone) {
  Singularities kinks;
  kinks.crowded = true;
  const double dx = piece.to_x - piece.from_x, dy = piece.to_y - piece.from_y;
  AlongPiece y2 = square_of(piece.from_y, dy);
  if (piece.kind != Piece::edge) {
    const double x = piece.from_x - zone.x0;
    y2 = {-zone.gamma * dx * dx, dx * (zone.beta - zone.gamma * x), eta_squared(zone, piece.from_x)};
  }
  const auto reach_of = [&](const ColumnEnd& end) {
    return AlongPiece{0, 0, end.radius * end.radius} - square_of(piece.from_x - end.x, dx);
  };
  const AlongPiece low = reach_of(columns.low);
  const double slope = dx * columns.dx, b = columns.b_at(piece.from_x), dh2 = columns.dh * columns.dh;
  const auto add_end = [&](const AlongPiece& reach, double derivative, double sign) {
    const AlongPiece change = square_of(derivative, slope);
    add_roots(reach - y2, sign, derivative, slope, kinks);
    kinks.add(-derivative / slope);
    add_roots(dh2 * reach - change, 1, derivative, slope, kinks);
    add_roots(dh2 * (reach - y2) - change, 1, derivative, slope, kinks);
  };
  add_end(low, b, -1);
  add_roots(square_of(b, slope) - columns.a * (low - y2), 1, b, slope, kinks);
  if (!columns.sphere && !columns.flat) add_end(reach_of(columns.high), b + columns.a, 1);
  return kinks;
}

}  // namespace

PressureMoments column_moments(const Section& section, const Boundary& boundary) {
  PressureMoments sum;
  const Columns columns(section);
  const auto kinks = [&](const Piece& piece, const Zone& zone) { return kinks_of(columns, piece, zone); };
  boundary_nodes(section, boundary, kinks, [&](double x, double y, double weight) {
    const Strip strip = strip_to(section, columns, x, y);
    sum.volume -= weight * strip.zeroth;
    sum.first.x -= weight * x * strip.zeroth;
    sum.first.y -= weight * strip.first;
  });
  const double r = max(section.radius1, section.radius2);
  sum.error = kColumnError * r * r * r;
  return sum;
}

}  // namespace lumbrical
