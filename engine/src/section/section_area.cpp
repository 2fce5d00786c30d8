// Area and first moments of polygon and section by Green's theorem, in closed form for every angle.
//
// Along an arc eta^2 is a quadratic with second derivative -2 gamma. Between two of its points, delta apart
// in x and of mean height m, the curve bulges over its chord by
//   area    delta k S(t^2) / (12 Q),                k = gamma delta^2 + (eta_b - eta_a)^2
//   moment  -k (eta_b - eta_a) delta^2 W(t^2) / (48 Q^2) in x about the chord's middle,   k delta / 12 in y
// with Q^2 = m^2 + gamma delta^2 / 4 and t^2 = gamma delta^2 / (4 Q^2); t is the sine of half the arc's angle
// after scaling an ellipse (gamma > 0) to a circle. S and W are analytic at 0, so the limit gamma -> 0 (an
// axis parallel to the plane: the section is a strip) and hyperbolas (gamma < 0: the side of a cone) need no
// special case.
#include <cmath>

#include "base/elementary.h"
#include "section/bulge_series.h"
#include "section/section.h"

namespace lumbrical {
namespace {

constexpr std::size_t kTerms = 18;
constexpr double kSeriesLimit = 0.1;  // of t^2; eighteen terms leave less than 1e-17

constexpr BulgeSeries<kTerms> kSeries = bulge_series<kTerms>();

struct Bulge {
  double s, w;
};

Bulge series_bulge(double u) {
  Bulge bulge{0, 0};
  for (std::size_t k = kTerms; k-- > 0;) {
    bulge.s = bulge.s * u + kSeries.s[k];
    bulge.w = bulge.w * u + kSeries.w[k];
  }
  return bulge;
}

// u = t^2 and cosine = m / Q of half the arc's angle.
Bulge bulge_of(double u, double cosine) {
  if (std::fabs(u) < kSeriesLimit) return series_bulge(u);
  const double t = std::sqrt(std::fabs(u));
  const double s = u > 0 ? 1.5 * (arc_tan2(t, cosine) - t * cosine) / (t * t * t)
                         : 1.5 * (t * cosine - arc_sinh(t)) / (t * t * t);
  return {s, (1 - cosine * s) / u};
}

struct ChordArea {
  double area = 0, x = 0, y = 0;
};

// Integrals of Y, (x - base.x) Y and Y^2 / 2 over x along the piece, Y measured from base.y.
ChordArea under_chord(const Piece& piece, Point2 base) {
  const double delta = piece.to_x - piece.from_x, rise = piece.to_y - piece.from_y;
  const double middle = 0.5 * (piece.from_x + piece.to_x) - base.x;
  const double a = piece.from_y - base.y, b = piece.to_y - base.y;
  const double area = delta * 0.5 * (a + b);
  return {area, middle * area + delta * delta * rise / 12, delta * (a * a + a * b + b * b) / 6};
}

void add_bulge(const Piece& piece, double gamma, Point2 base, ChordArea& sum) {
  const double delta = piece.to_x - piece.from_x;
  const double a = std::fabs(piece.from_y), b = std::fabs(piece.to_y), rise = b - a;
  const double mean = 0.5 * (a + b);
  const double q2 = mean * mean + 0.25 * gamma * delta * delta;
  if (!(q2 > 0)) return;
  const double k = gamma * delta * delta + rise * rise;
  const double q = std::sqrt(q2);
  const Bulge bulge = bulge_of(0.25 * gamma * delta * delta / q2, mean / q);
  const double area = piece.side * delta * k * bulge.s / (12 * q);
  const double middle = 0.5 * (piece.from_x + piece.to_x) - base.x;
  sum.area += area;
  sum.x += middle * area - piece.side * k * rise * delta * delta * bulge.w / (48 * q2);
  sum.y += k * delta / 12 - base.y * area;
}

double extent_of(const Polygon2& polygon) {
  double extent = 0;
  for (std::size_t i = 1; i < polygon.count; ++i) {
    const Point2 d = polygon.corner[i] - polygon.corner[0];
    extent = max(extent, max(std::fabs(d.x), std::fabs(d.y)));
  }
  return extent;
}

// Where they overlap in part.
AreaMoments partial_area(const Section& section, const Boundary& boundary) {
  // Small polygons are measured from their own corner: what they share with the section's scale would drown
  // them.
  const double extent = extent_of(section.polygon);
  const bool small = extent < 0.5 * section.radius1;
  const Point2 base = small ? section.polygon.corner[0] : Point2{0, 0};
  ChordArea sum;
  for (std::size_t i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[i];
    const ChordArea chord = under_chord(piece, base);
    sum.area += chord.area;
    sum.x += chord.x;
    sum.y += chord.y;
    if (piece.kind == Piece::arc) add_bulge(piece, section.zone[piece.zone].gamma, base, sum);
  }
  const double area = -sum.area;
  // Smaller than this an area is what rounding leaves of nothing.
  const double least = 1e-15 * min(extent, section.radius1) * (small ? extent : section.radius1);
  if (!(area > least)) return {};
  return {area, {base.x - sum.x / area, base.y - sum.y / area}};
}

}  // namespace

AreaMoments polygon_area(const Polygon2& polygon) {
  const Point2 p = polygon.corner[0];
  double twice = 0;
  Point2 moment{0, 0};
  for (std::size_t i = 1; i + 1 < polygon.count; ++i) {
    const Point2 a = polygon.corner[i] - p;
    const Point2 b = polygon.corner[i + 1] - p;
    const double area = cross(a, b);
    twice += area;
    moment = moment + area * (a + b);
  }
  if (!(twice > 0)) return {};
  return {0.5 * twice, p + (1 / (3 * twice)) * moment};
}

AreaMoments common_area(const Section& section, Overlap overlap, const Boundary& boundary) {
  return overlap == Overlap::inside ? polygon_area(section.polygon) : partial_area(section, boundary);
}

}  // namespace lumbrical
