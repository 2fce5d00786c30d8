// Between a border and its chord the field is integrated along the chord, with nodes crowded towards where
// border or field are not smooth, and across it from the chord to the border, a root at every node.
#include "borders/border_bulge.h"

#include <array>

#include "borders/root.h"
#include "section/field.h"
#include "section/stated_errors.h"
#include "simd/lane_vectors.h"

namespace lumbrical {
namespace {

// A border farther from its chord than this share of the chord is split.
constexpr double kFlat = 0.15;

// A chord shorter than this share of the joint's radius is the border itself: what lies between has an area
// of a twelfth of its cube or less.
constexpr double kShort = 1e-5;

// Of what is summed up to a root of a border; and what the root of that leaves of heights beside the apex.
constexpr double kRounding = 4e-15, kNearApex = 1e-7;

// A bulge higher than this share of its chord is integrated to all digits, lower ones to nine.
constexpr double kSmallBulge = 0.01;

// A linear function of abscissa and height over a chord.
struct OverChord {
  double start, along, across;
  OverChord(const Linear& linear, const Chord& chord)
      : start(linear.at(chord.from)),
        along(dot(linear.slope, chord.along)),
        across(dot(linear.slope, chord.across)) {}
  [[nodiscard]] double at(double s) const { return start + s * along; }
};

// A near border over its chord: x^2 + y^2 = height^2 is a quadratic a h^2 + 2 b h + c in the height h.
struct NearBorder {
  OverChord x, y, z;
  double side, falling;  // falling: +-1, times `side` times the quadratic falls towards its kin
  NearBorder(const Kin& kin, const Chord& chord)
      : x(kin.border.x, chord),
        y(kin.border.y, chord),
        z(kin.border.height, chord),
        side(kin.border.side),
        falling(kin.is_first ? -kin.border.side : kin.border.side) {}
  // The root next to the chord; false where there is none, or its kin is not above it. In a plane through
  // the apex, or all but through it, both roots meet there and only rounding tells them apart.
  bool height_at(double s, double& height) const {
    const double p = x.at(s), q = y.at(s), r = z.at(s);
    const double far = std::fabs(p) + std::fabs(q) + std::fabs(r);
    const double steep = std::fabs(x.across) + std::fabs(y.across) + std::fabs(z.across);
    const double a = x.across * x.across + y.across * y.across - z.across * z.across;
    const double b = p * x.across + q * y.across - r * z.across, c = p * p + q * q - r * r;
    const double square = b * b - a * c, most = far * steep;
    if (!(square >= -kRounding * most * most) || b * falling < -kRounding * most) return false;
    const double denominator = b + falling * std::sqrt(max(0, square));
    if (!(denominator * falling > 0) && std::fabs(c) > kRounding * far * far) return false;
    height = denominator * falling > 0 ? -c / denominator : 0;
    return side * (r + height * z.across) >= -kNearApex * (far + std::fabs(height) * steep);
  }
};

// Where lines across the chord touch the cone, so that its two roots meet: at the foot of the apex where the
// plane goes through that, there the border has a corner.
void add_touching(const NearBorder& near, double length, Singularities& kinks) {
  const auto product = [&near](double OverChord::*p, double OverChord::*q) {
    return near.x.*p * (near.x.*q) + near.y.*p * (near.y.*q) - near.z.*p * (near.z.*q);
  };
  constexpr auto kStart = &OverChord::start, kAlong = &OverChord::along, kAcross = &OverChord::across;
  const double a = product(kAcross, kAcross), b = product(kStart, kAcross), tilt = product(kAlong, kAcross);
  const double second = (tilt * tilt - a * product(kAlong, kAlong)) * length * length;
  const double first = (b * tilt - a * product(kStart, kAlong)) * length,
               zeroth = b * b - a * product(kStart, kStart);
  const double square = first * first - second * zeroth;
  if (!(square > 0)) return add_closest_approach(second, first, zeroth, kinks);
  const double sum = first < 0 ? std::sqrt(square) - first : -(first + std::sqrt(square));
  if (second != 0) kinks.add(sum / second, 0, true);
  if (sum != 0) kinks.add(zeroth / sum, 0, true);
}

constexpr int kProbes = 5;

// The border as a height over its chord.
struct Border {
  const Kin& kin;
  const Chord& chord;
  double slope = 0;   // of precedence across the chord, < 0
  double height = 0;  // found last, the first guess for the next
  bool good = true;   // every root was found
  NearBorder near;

  Border(const Kin& r, const Chord& c) : kin(r), chord(c), near(r, c) {
    if (kin.near || is_short()) return;
    const double step = 0.01 * chord.length, middle = 0.5 * chord.length;
    slope = (at(middle, step) - at(middle, -step)) / (2 * step);
    good = slope < 0;
  }
  [[nodiscard]] bool is_short() const { return chord.length < kShort * kin.first.radius; }
  [[nodiscard]] double at(double s, double y) const { return precedence(kin, chord.at(s, y)); }
  // A Newton step with the last slope, then secant steps, whose error is about the product of the last two.
  double height_at(double s) {
    if (!good || is_short()) return 0;
    if (kin.near) {
      good = near.height_at(s, height) && std::fabs(height) <= chord.length;
      return good ? height : 0;
    }
    const double limit = chord.length, radius = kin.first.radius;
    double y0 = height, g0 = at(s, y0), y = y0 - g0 / slope, close = 1e-15 * radius;
    for (int i = 0; i < 20 && std::fabs(y) <= limit; ++i) {
      const double step = y - y0;
      if (!(std::fabs(step) > close)) return height = y;
      const double g = at(s, y), change = g - g0;
      if (!(change / step < 0)) break;  // not falling towards its kin
      if (std::fabs(step) > 1e-6 * radius) slope = change / step;
      y0 = y;
      g0 = g;
      y = y - g * (step / change);
      close = 1e-10 * radius;
    }
    return height = enclosed_height(s);
  }
  // Where two tiles are all but in one place precedence may rise a little before it falls: only its sign is
  // sure.
  double enclosed_height(double s) {
    const double limit = 2 * kFlat * chord.length, below = at(s, -limit), above = at(s, limit);
    good = below > 0 && above < 0;
    if (!good) return 0;
    return find_root([&](double y) { return at(s, y); }, -limit, below, limit, above, 1e-12 * chord.length);
  }
  Point2 point(double s) { return chord.at(s, height_at(s)); }
  // How far from its chord the probes between its ends find it.
  double peak() {
    double most = 0;
    for (int i = 1; i + 1 < kProbes; ++i)
      most = max(most, std::fabs(height_at(chord.length * i / (kProbes - 1))));
    return most;
  }
};

// A point of a border, with the field of the tile there and its slope.
struct BorderPoint {
  double s;
  Point2 at, slope;
  double phi;
};

BorderPoint point_on(Border& border, double s) {
  const Point2 at = border.point(s);
  const Cone& own = border.kin.own();
  const Sight sight = sight_of(own, at);
  return {s, at, cone_slope(own, sight), cone_field(own, sight)};
}

// A bound of the field between two points of a border. It is concave in the plane, so along the straight
// between them it stays below its tangents at both, and a curve that bends one way is nowhere farther from
// that than twice as far as in its middle.
double most_between(const BorderPoint& from, const BorderPoint& to, Point2 middle) {
  const Point2 way = to.at - from.at;
  const double length = std::sqrt(dot(way, way)), rise = dot(from.slope, way), fall = -dot(to.slope, way);
  double most = max(from.phi, to.phi);
  if (rise > 0 && fall > 0) most = (from.phi * fall + to.phi * rise + rise * fall) / (rise + fall);
  return most + (length > 0 ? 2 * std::fabs(cross(way, middle - from.at)) / length : 0);
}

// Of a border both of whose ends are outside the section: an abscissa inside; -1 where there is none; -2
// where that is not to be told.
constexpr int kMostPoints = 200;
double find_inside(Border& border) {
  const double touching = 1e-12 * border.kin.first.radius;
  std::array<std::array<BorderPoint, 2>, 64> open;
  open[0] = {point_on(border, 0), point_on(border, border.chord.length)};
  std::size_t left = 1;
  for (int count = 0; left > 0; ++count) {
    const auto [from, to] = open[--left];
    const BorderPoint middle = point_on(border, 0.5 * (from.s + to.s));
    if (!border.good || count > kMostPoints || left + 2 > open.size()) return -2;
    if (middle.phi > 0) return middle.s;
    if (!(most_between(from, to, middle.at) > touching)) continue;
    open[left++] = {from, middle};
    open[left++] = {middle, to};
  }
  return -1;
}

// Where a function of s changes its sign something breaks.
template <class F>
void add_changes(F&& f, double length, Singularities& kinks) {
  double s0 = 0, f0 = f(0.0);
  for (int i = 1; i < kProbes; ++i) {
    const double s1 = length * i / (kProbes - 1), f1 = f(s1);
    if ((f0 > 0) != (f1 > 0)) kinks.add(find_root(f, s0, f0, s1, f1, 1e-10 * length) / length, 0, true);
    s0 = s1;
    f0 = f1;
  }
}

// Beside a point everything changes within its distance from the chord, as it does beside the axis of a cone.
void add_point(Vec3 point, const Chord& chord, Singularities& kinks) {
  const Point2 from = chord.from - Point2{point.x, point.y};
  add_closest_approach(chord.length * chord.length, chord.length * dot(from, chord.along),
                       dot(from, from) + point.z * point.z, kinks);
}

void add_axis(const Cone& cone, const Chord& chord, Singularities& kinks) {
  const Vec3 start = cross(Vec3{chord.from.x, chord.from.y, 0} - cone.joint, cone.axis);
  const Vec3 step = cross(chord.length * Vec3{chord.along.x, chord.along.y, 0}, cone.axis);
  add_closest_approach(dot(step, step), dot(start, step), dot(start, start), kinks);
}

// Where field or border are not smooth along the chord, as shares of it.
Singularities kinks_along(const Section& section, const Slant& slant, Border& border) {
  const Chord& chord = border.chord;
  const Kin& kin = border.kin;
  Singularities kinks = line_kinks(section, slant, chord.from, chord.at(chord.length, 0));
  kinks.refine = false;
  add_point(kin.first.joint, chord, kinks);
  if (kin.near) add_touching(border.near, chord.length, kinks);
  if (!kin.joined) add_point(kin.second.joint, chord, kinks);
  for (const Cone* cone : {&kin.first, &kin.second}) {
    if (!kin.near) {
      add_point(cone->joint + cone->length * cone->axis, chord, kinks);
      add_axis(*cone, chord, kinks);
    }
    if (cone->kind != Cone::hull) continue;
    for (const double from : {0.0, cone->cosine * cone->length}) {
      // Between joined tiles the border itself is smooth where the joint's sphere takes over.
      if (kin.joined && (from > 0 ? kin.near : cone != &kin.own())) continue;
      add_changes([&](double s) { return sight_of(*cone, border.point(s)).along - from; }, chord.length,
                  kinks);
    }
  }
  // A curve as high as this over its chord turns back on itself so far beyond its ends, if it goes on as it
  // is.
  const double peak = border.peak();
  kinks.coarse = peak < kSmallBulge * chord.length;
  const double beyond = max(0.05, 0.125 * chord.length / max(peak, 1e-6 * chord.length) - 0.5);
  kinks.add(-beyond);
  kinks.add(1 + beyond);
  return kinks;
}

}  // namespace

Chord chord_between(Point2 from, Point2 to) {
  Chord chord;
  const Point2 d = to - from;
  chord.from = from;
  chord.length = std::sqrt(dot(d, d));
  if (chord.length > 0) chord.along = (1 / chord.length) * d;
  chord.across = {chord.along.y, -chord.along.x};
  return chord;
}

Course follow_border(const Section& section, const Kin& kin, Chord& chord) {
  Border border(kin, chord);
  const double peak = border.peak();
  if (!border.good || peak > kFlat * chord.length) return Course::unclear;
  const Slant slant = slant_of(section);
  const auto field = [&](double s) {
    const Point2 p = border.point(s);
    return field_of(section, slant, p);
  };
  const double begin = field(0), end = field(chord.length);
  double from = 0, to = chord.length;
  if (begin < 0 || end < 0) {
    const double inside = begin > 0 ? 0 : end > 0 ? chord.length : find_inside(border);
    if (!border.good || inside == -2) return Course::unclear;
    if (inside < 0) return Course::outside;
    const double value = field(inside), tolerance = 1e-11 * kin.first.radius;
    if (begin < 0) from = find_root(field, 0, begin, inside, value, tolerance);
    if (end < 0) to = find_root(field, inside, value, chord.length, end, tolerance);
  }
  for (int i = 1; i + 1 < kProbes; ++i) {
    if (field(from + (to - from) * i / (kProbes - 1)) < -1e-12 * kin.first.radius) return Course::unclear;
  }
  const Point2 first = border.point(from), last = border.point(to);
  if (!border.good) return Course::unclear;
  if (!(to - from > 1e-12 * kin.first.radius)) return Course::outside;
  chord = chord_between(first, last);
  return Course::inside;
}

namespace {

CrossingTerms crossing_terms(const Section& section, const Slant& slant, const Chord& chord) {
  CrossingTerms ways;
  ways.radius1 = section.radius1;
  ways.radius2 = section.radius2;
  ways.length = section.length;
  ways.sine = slant.sine;
  ways.cosine = slant.cosine;
  ways.s = section.s;
  ways.c = section.c;
  ways.h1 = section.h1;
  ways.across_x = chord.across.x;
  ways.across_y = chord.across.y;
  return ways;
}

// The field between foot and top, means over the way, where it changes its formula on the way.
void integrate_way(const Section& section, const Slant& slant, Point2 foot, Point2 way, double& mean,
                   double& lean) {
  Singularities kinks = line_kinks(section, slant, foot, foot + way);
  kinks.refine = false;
  mean = lean = 0;
  graded_nodes(0, 1, kinks, [&](double share, double weight) {
    const Point2 p = foot + share * way;
    const double part = weight * field_of(section, slant, p);
    mean += part;
    lean += share * part;
  });
}

struct BulgeSum {
  const ExactKernels& kernels;
  const Section& section;
  const Slant& slant;
  Border& border;
  Bulge& bulge;
  CrossingTerms ways;
  std::array<double, CrossingTerms::kCapacity> weight{};  // [m], along the chord

  BulgeSum(const ExactKernels& k, const Section& s, const Slant& l, Border& b, Bulge& sum)
      : kernels(k), section(s), slant(l), border(b), bulge(sum), ways(crossing_terms(s, l, b.chord)) {}

  void add(double s, double along) {
    if (ways.count == CrossingTerms::kCapacity) flush();
    const Point2 foot = border.chord.at(s, 0);
    ways.x[ways.count] = foot.x;
    ways.y[ways.count] = foot.y;
    ways.height[ways.count] = border.height_at(s);
    weight[ways.count++] = along;
  }
  void flush() {
    for (double* row : {ways.x, ways.y, ways.height}) fill_up(row, ways.count);
    kernels.field_across(ways);
    for (std::size_t k = 0; k < ways.count; ++k) {
      const Point2 foot{ways.x[k], ways.y[k]}, way = ways.height[k] * border.chord.across;
      if (ways.smooth[k] == 0) integrate_way(section, slant, foot, way, ways.mean[k], ways.lean[k]);
      const double area = weight[k] * ways.height[k], part = area * ways.mean[k];
      bulge.area += area;
      bulge.area_first = bulge.area_first + area * (foot + 0.5 * way);
      bulge.volume += part;
      bulge.first = bulge.first + (part * foot + (area * ways.lean[k]) * way);
    }
    ways.count = 0;
  }
};

}  // namespace

bool integrate_bulge(const ExactKernels& kernels, const Section& section, const Kin& kin, const Chord& chord,
                     Bulge& bulge) {
  Border border(kin, chord);
  bulge = {};
  if (!border.good || border.is_short()) return border.good;
  const Slant slant = slant_of(section);
  BulgeSum sum(kernels, section, slant, border, bulge);
  graded_nodes(0, 1, kinks_along(section, slant, border),
               [&](double t, double weight) { sum.add(chord.length * t, chord.length * weight); });
  sum.flush();
  const double cube = section.radius1 * section.radius1 * section.radius1;
  bulge.error = min(kBulgeAloneShare * std::fabs(bulge.volume), kBulgeAloneError * cube);
  return border.good;
}

namespace {

// d phi / dn: docs/mechanics.md.
double rise_at(const Section& section, const Slant& slant, Point2 p) {
  const Zone::Part part = zone_of(section, slant, p).part;
  if (part == Zone::side) {
    const double e = section.c * p.x + section.s * section.h1, rho = std::sqrt(e * e + p.y * p.y);
    return (rho > 0 ? slant.cosine * section.s * e / rho : 0) - section.c * slant.sine;
  }
  const bool first = part == Zone::first_end;
  const double x = first ? p.x : p.x - section.x2, h = first ? section.h1 : section.h2;
  const double r = std::sqrt(x * x + p.y * p.y + h * h);
  return r > 0 ? h / r : 0;
}

}  // namespace

bool integrate_bulge_slope(const Section& section, const Kin& kin, const JointBorder& around,
                           const Chord& chord, SlopeMoments& slope) {
  Border border(kin, chord);
  if (!border.good) return false;
  const Slant slant = slant_of(section);
  const Vec3 across = chord.across.x * section.u + chord.across.y * section.v;
  graded_nodes(0, 1, kinks_along(section, slant, border), [&](double t, double weight) {
    const double s = chord.length * t, height = border.height_at(s);
    const Point2 foot = chord.at(s, 0), top = chord.at(s, height);
    Singularities kinks = line_kinks(section, slant, foot, top);
    kinks.refine = false;
    graded_nodes(0, 1, kinks, [&](double share, double inner) {
      const Point2 p = foot + share * (top - foot);
      slope.add(p, weight * chord.length * height * inner * rise_at(section, slant, p));
    });
    // The border's normal; over the chord an element of it is as long as |m x n| over the part of m across.
    const double x = kin.border.x.at(top), y = kin.border.y.at(top), far = std::sqrt(x * x + y * y);
    if (!(far > 0)) return;
    const Vec3 m = around.normal - around.side * ((x / far) * around.x + (y / far) * around.y);
    const double tilt = dot(m, section.n) / std::fabs(dot(m, across));
    const double phi = field_of(section, slant, top);
    slope.add(top, -weight * chord.length * phi * (kin.is_first ? tilt : -tilt));
  });
  return border.good;
}

}  // namespace lumbrical
