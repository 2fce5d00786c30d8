// The column law's integral: the paper's depth, along -n to the primitive's own surface, integrated over the
// area.
//
// As in pressure_field.cpp the inner integral over y is in closed form; the column leaves through sphere 1
// where x < c sqrt(R^2 - y^2), through sphere 2 where x - x2 > c sqrt(R^2 - y^2), through the side between.
// For a cone, whose column depth has no such form, the inner integral is a Gauss rule (about six digits).
#include <cmath>

#include "base/elementary.h"
#include "section/boundary_integral.h"
#include "section/depth.h"
#include "section/pressure.h"
#include "section/stated_errors.h"

namespace lumbrical {
namespace {

struct Strip {
  double zeroth, first;  // int_0^y d dy' and int_0^y y' d dy'
};

Strip operator-(Strip a, Strip b) { return {a.zeroth - b.zeroth, a.first - b.first}; }
Strip operator+(Strip a, Strip b) { return {a.zeroth + b.zeroth, a.first + b.first}; }

// int_0^y of sqrt(square - y'^2) and of y' times it.
Strip arc_strip(double square, double y) {
  const double w = std::sqrt(max(0, square - y * y)), r = std::sqrt(max(0, square));
  // (r^3 - w^3) / 3 with r - w = y^2 / (r + w).
  const double cubes = r + w > 0 ? y * y / (r + w) * (r * r + r * w + w * w) / 3 : 0;
  return {0.5 * (y * w + max(0, square) * arc_tan2(y, w)), cubes};
}

Strip through_sphere(const Section& section, double dx, double h, double y) {
  const Strip arc = arc_strip((section.radius1 - dx) * (section.radius1 + dx), y);
  return {arc.zeroth - h * y, arc.first - 0.5 * h * y * y};
}

Strip through_first_end(const Section& section, double x, double y) {
  if (section.shape == Shape::round) return through_sphere(section, x, section.h1, y);
  const double base = section.c > 0 ? (section.s * x - section.c * section.h1) / section.c : 0;
  return {base * y, 0.5 * base * y * y};
}

// Between y1 and y2; an axis nearly along the normal would divide rounding by its sine, so there depth is
// summed up in the form s Y - c (x - c Y) / s - h1, whose terms are small.
Strip through_side(const Section& section, double x, double y1, double y2) {
  if (!(y1 < y2)) return {0, 0};
  const double s = section.s, c = section.c, r = section.radius1;
  if (s > 0.05) {
    const double e = c * x + s * section.h1;
    const Strip arc = arc_strip(r * r, y2) - arc_strip(r * r, y1);
    return {(arc.zeroth - e * (y2 - y1)) / s, (arc.first - 0.5 * e * (y2 - y1) * (y2 + y1)) / s};
  }
  Strip sum{0, 0};
  for (const GaussNode& node : kGauss8) {
    const double y = y1 + (y2 - y1) * node.at, side = std::sqrt(max(0, (r - y) * (r + y)));
    const double depth = s * side - (s > 0 ? c * (x - c * side) / s : 0) - section.h1;
    sum.zeroth += (y2 - y1) * node.weight * depth;
    sum.first += (y2 - y1) * node.weight * depth * y;
  }
  return sum;
}

// The y up to which columns at distance x from an end's foot leave through that end.
double change_at(const Section& section, double x) {
  const double r = section.radius1;
  if (x <= 0) return r;
  const double scaled = section.c > 0 ? x / section.c : 1e300;
  return scaled < r ? std::sqrt((r - scaled) * (r + scaled)) : 0;
}

Strip strip_by_rule(const Section& section, double x, double y) {
  Strip sum{0, 0};
  for (const GaussNode& node : kGauss16) {
    const double at = y * node.at, depth = max(0, depth_at(section, {x, at}));
    sum.zeroth += y * node.weight * depth;
    sum.first += y * node.weight * depth * at;
  }
  return sum;
}

Strip strip_to(const Section& section, double x, double signed_y) {
  const double y = std::fabs(signed_y);
  Strip strip{0, 0};
  if (section.radius1 != section.radius2) {
    strip = strip_by_rule(section, x, y);
  } else if (section.length == 0) {
    strip = through_sphere(section, x, section.h1, y);
  } else {
    const double first = change_at(section, x);
    const double last = section.shape == Shape::flat ? section.radius1 : change_at(section, x - section.x2);
    strip =
        through_first_end(section, x, min(y, first)) + through_side(section, x, first, clamp(y, first, last));
    if (y > last) {
      const double x2 = x - section.x2;
      strip = strip +
              (through_sphere(section, x2, section.h2, y) - through_sphere(section, x2, section.h2, last));
    }
  }
  if (signed_y < 0) strip.zeroth = -strip.zeroth;
  return strip;
}

void add_roots(double a, double b, double c, Singularities& kinks) {
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0) || a == 0) return;
  kinks.add((-b - std::sqrt(discriminant)) / a);
  kinks.add((-b + std::sqrt(discriminant)) / a);
}

// Where the way out changes, and the equators of the end spheres.
Singularities kinks_of(const Section& section, const Piece& piece) {
  Singularities kinks;
  const double y = piece.from_y, dx = piece.to_x - piece.from_x, dy = piece.to_y - y, r = section.radius1;
  for (const double end : {0.0, section.x2}) {
    const double x = piece.from_x - end, cc = section.c * section.c;
    kinks.add(-x / dx);
    kinks.add((section.c * r - x) / dx);
    if (piece.kind != Piece::edge) continue;
    add_roots(dx * dx + cc * dy * dy, x * dx + cc * y * dy, x * x + cc * (y * y - r * r), kinks);
    add_roots(dx * dx + dy * dy, x * dx + y * dy, x * x + y * y - r * r, kinks);
  }
  if (piece.kind == Piece::edge && dy != 0) {
    kinks.add((r - y) / dy);
    kinks.add((-r - y) / dy);
  }
  return kinks;
}

}  // namespace

PressureMoments column_moments(const Section& section, const Boundary& boundary) {
  PressureMoments sum;
  for (int i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[static_cast<std::size_t>(i)];
    if (piece.kind == Piece::none || piece.from_x == piece.to_x) continue;
    piece_nodes(piece, section.zone[piece.zone], kinks_of(section, piece),
                [&](double x, double y, double weight) {
                  const Strip strip = strip_to(section, x, y);
                  sum.volume -= weight * strip.zeroth;
                  sum.first.x -= weight * x * strip.zeroth;
                  sum.first.y -= weight * strip.first;
                });
  }
  const double r = section.radius1;
  sum.error = (section.radius1 == section.radius2 ? kColumnError : kColumnConeError) * r * r * r;
  return sum;
}

}  // namespace lumbrical
