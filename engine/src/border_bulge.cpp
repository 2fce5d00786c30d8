// Between a border and its chord the field is integrated along the chord, with nodes crowded towards where
// border or field are not smooth, and across it from the chord to the border, a root at every node.
#include "border_bulge.h"

#include <array>

#include "field.h"
#include "gauss.h"
#include "root.h"

namespace lumbrical {
namespace {

// A border farther from its chord than this share of the chord is split.
constexpr double kFlat = 0.15;

// A chord shorter than this share of the joint's radius is the border itself: what lies between has an area
// of a twelfth of its cube or less.
constexpr double kShort = 1e-5;

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
  double side, falling;  // falling: +-1, times `side` times the quadratic falls towards the rival
  NearBorder(const Rival& rival, const Chord& chord)
      : x(rival.border.x, chord),
        y(rival.border.y, chord),
        z(rival.border.height, chord),
        side(rival.border.side),
        falling(rival.is_first ? -rival.border.side : rival.border.side) {}
  // The root next to the chord; false where there is none, or the rival is not above it.
  bool height_at(double s, double& height) const {
    const double p = x.at(s), q = y.at(s), r = z.at(s);
    const double a = x.across * x.across + y.across * y.across - z.across * z.across;
    const double b = p * x.across + q * y.across - r * z.across, c = p * p + q * q - r * r;
    const double square = b * b - a * c, sign = b < 0 ? -1 : 1;
    const double denominator = b + sign * std::sqrt(max(0, square));
    if (!(square >= 0) || denominator == 0 || sign != falling) return false;
    height = -c / denominator;
    return side * (r + height * z.across) >= 0;
  }
};

// The border as a height over its chord.
struct Border {
  const Rival& rival;
  const Chord& chord;
  double slope = 0;   // of precedence across the chord, < 0
  double height = 0;  // found last, the first guess for the next
  bool good = true;   // every root was found
  NearBorder near;

  Border(const Rival& r, const Chord& c) : rival(r), chord(c), near(r, c) {
    if (rival.near || is_short()) return;
    const double step = 0.01 * chord.length, middle = 0.5 * chord.length;
    slope = (at(middle, step) - at(middle, -step)) / (2 * step);
    good = slope < 0;
  }
  [[nodiscard]] bool is_short() const { return chord.length < kShort * rival.first.radius; }
  [[nodiscard]] double at(double s, double y) const { return precedence(rival, chord.at(s, y)); }
  // A Newton step with the last slope, then secant steps, whose error is about the product of the last two.
  double height_at(double s) {
    if (!good || is_short()) return 0;
    if (rival.near) {
      good = near.height_at(s, height) && std::fabs(height) <= chord.length;
      return good ? height : 0;
    }
    const double limit = chord.length, radius = rival.first.radius;
    double y0 = height, g0 = at(s, y0), y = y0 - g0 / slope, close = 1e-15 * radius;
    for (int i = 0; i < 20 && std::fabs(y) <= limit; ++i) {
      const double step = y - y0;
      if (!(std::fabs(step) > close)) return height = y;
      const double g = at(s, y), change = g - g0;
      if (!(change / step < 0)) break;  // not falling towards the rival
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
};

// Where on [0, 1] an integrand is not smooth: it breaks at some points, where other pieces of border or field
// begin, and changes fast beside others, within their distance from the line.
struct Roughness {
  static constexpr int kMaxCount = 16;
  struct Near {
    double at, distance;
  };
  int break_count = 0, near_count = 0;
  std::array<double, kMaxCount> breaks;
  std::array<Near, kMaxCount> near;
  void add_break(double at) {
    if (break_count < kMaxCount) breaks[static_cast<std::size_t>(break_count++)] = at;
  }
  void add_near(double at, double distance) {
    if (!(distance > 1e-7)) return add_break(at);  // a corner: smooth on both sides
    if (near_count < kMaxCount) near[static_cast<std::size_t>(near_count++)] = {at, distance};
  }
};

// Calls f(t, weight) at nodes between `from` and `to`.
template <class F>
void crowded_nodes(double from, double to, const Roughness& rough, F&& f) {
  const double length = to - from;
  const auto split_at = [&](double t) {
    crowded_nodes(from, t, rough, f);
    crowded_nodes(t, to, rough, f);
  };
  for (int i = 0; i < rough.break_count; ++i) {
    const double at = rough.breaks[static_cast<std::size_t>(i)];
    if (at > from + 1e-9 && at < to - 1e-9) return split_at(at);
  }
  double nearest = 1e300;
  for (int i = 0; i < rough.near_count; ++i) {
    const Roughness::Near& point = rough.near[static_cast<std::size_t>(i)];
    const double gap = max(0, max(from - point.at, point.at - to));
    nearest = min(nearest, std::sqrt(gap * gap + point.distance * point.distance));
  }
  const auto apply = [&](const auto& rule) {
    for (const GaussNode& node : rule) f(from + length * node.at, length * node.weight);
  };
  // n nodes on a length l at a distance d from such a point leave about (2 d / l + sqrt(4 d^2 / l^2 + 1))^(-2
  // n).
  if (length < 0.08 * nearest) return apply(kGauss4);
  if (length < 0.3 * nearest) return apply(kGauss6);
  if (length < 0.5 * nearest) return apply(kGauss8);
  if (length < 1.5 * nearest || length < 1e-7) return apply(kGauss16);
  split_at(0.5 * (from + to));
}

// The distance squared from such a point is a t^2 + 2 b t + c.
void add_nearest(double a, double b, double c, Roughness& rough) {
  if (a > 0) rough.add_near(-b / a, std::sqrt(max(0, c / a - b / a * (b / a))));
}

constexpr int kProbes = 5;

// Where along the border the field has its maximum, of which only the sign is asked: parabolas through the
// best of three points, ended where it is positive or no longer grows.
double find_inside(const Section& section, Border& border) {
  const double length = border.chord.length;
  const auto field = [&](double s) { return field_at(section, border.point(s)); };
  std::array<double, 3> s{0.25 * length, 0.5 * length, 0.75 * length}, f{};
  for (std::size_t i = 0; i < 3; ++i) {
    f[i] = field(s[i]);
    if (f[i] > 0) return s[i];
  }
  for (int step = 0; step < 12 && border.good; ++step) {
    const double a = (s[1] - s[0]) * (f[1] - f[2]), b = (s[1] - s[2]) * (f[1] - f[0]);
    if (!(std::fabs(a - b) > 0)) return -1;
    double best = s[1] - 0.5 * ((s[1] - s[0]) * a - (s[1] - s[2]) * b) / (a - b);
    best = clamp(best, 0, length);
    const double value = field(best);
    if (value > 0) return best;
    const std::size_t worst = f[0] < f[1] ? (f[0] < f[2] ? 0 : 2) : (f[1] < f[2] ? 1 : 2);
    if (!(value > f[worst]) || std::fabs(best - s[0]) < 1e-7 * length ||
        std::fabs(best - s[1]) < 1e-7 * length || std::fabs(best - s[2]) < 1e-7 * length)
      return -1;
    s[worst] = best;
    f[worst] = value;
  }
  return -1;
}

// Where a function of s changes its sign something breaks.
template <class F>
void add_changes(F&& f, double length, Roughness& rough) {
  double s0 = 0, f0 = f(0.0);
  for (int i = 1; i < kProbes; ++i) {
    const double s1 = length * i / (kProbes - 1), f1 = f(s1);
    if ((f0 > 0) != (f1 > 0)) rough.add_break(find_root(f, s0, f0, s1, f1, 1e-10 * length) / length);
    s0 = s1;
    f0 = f1;
  }
}

// The height at abscissa s of the strip between chord and border that is nearest to `height`.
double nearest_height(double s, double height, Border& border) {
  if (!(s > 0 && s < border.chord.length)) return 0;
  const double top = border.height_at(s);
  return clamp(height, min(0, top), max(0, top));
}

// Beside a point near the strip everything changes within its distance.
void add_point(Vec3 centre, Border& border, Roughness& rough) {
  const Chord& chord = border.chord;
  const Point2 from = Point2{centre.x, centre.y} - chord.from;
  const double s = dot(from, chord.along), height = dot(from, chord.across);
  const double gap = nearest_height(s, height, border) - height;
  rough.add_near(s / chord.length, std::sqrt(gap * gap + centre.z * centre.z) / chord.length);
}

// The same beside the axis of a cone: along the chord, and at the height at which it pierces the plane.
void add_axis(const Cone& cone, Border& border, Roughness& rough) {
  const Chord& chord = border.chord;
  const Vec3 step = cross(chord.length * Vec3{chord.along.x, chord.along.y, 0}, cone.axis);
  const auto add_along = [&](double height) {
    const Point2 p = chord.at(0, height);
    const Vec3 start = cross(Vec3{p.x, p.y, 0} - cone.joint, cone.axis);
    add_nearest(dot(step, step), dot(start, step), dot(start, start), rough);
  };
  add_along(0);
  if (!(std::fabs(cone.axis.z) > 1e-9)) return;
  const double t = -cone.joint.z / cone.axis.z;
  const Point2 pierced = Point2{cone.joint.x + t * cone.axis.x, cone.joint.y + t * cone.axis.y} - chord.from;
  const double height = nearest_height(dot(pierced, chord.along), dot(pierced, chord.across), border);
  if (height != 0) add_along(height);
}

Roughness roughness_of(Border& border) {
  const Chord& chord = border.chord;
  const Rival& rival = border.rival;
  Roughness rough;
  const auto along = [&](const Cone& cone, Point2 p, double from) {
    return sight_of(cone, p).along - from * cone.cosine * cone.length;
  };
  for (const double from : {0.0, 1.0}) {
    if (rival.own().kind != Cone::hull || (rival.joined && rival.near && from > 0)) continue;
    add_changes([&](double s) { return along(rival.own(), chord.at(s, 0), from); }, chord.length, rough);
  }
  for (const Cone* cone : {&rival.first, &rival.second}) {
    if (!rival.near) add_point(cone->joint + cone->length * cone->axis, border, rough);
    if (cone->kind != Cone::hull) continue;
    for (const double from : {0.0, 1.0}) {
      // Between joined tiles the border itself is smooth where the joint's sphere takes over.
      if (rival.joined && (from > 0 ? rival.near : cone != &rival.own())) continue;
      add_changes([&](double s) { return along(*cone, border.point(s), from); }, chord.length, rough);
    }
    add_axis(*cone, border, rough);
  }
  // A curve as high as this over its chord turns back on itself so far beyond its ends, if it goes on as it
  // is.
  double peak = 0;
  for (int i = 1; i + 1 < kProbes; ++i) {
    peak = max(peak, std::fabs(border.height_at(chord.length * i / (kProbes - 1))));
  }
  const double beyond = max(0.05, 0.125 * chord.length / max(peak, 1e-6 * chord.length) - 0.5);
  rough.add_near(-beyond, 0.01);
  rough.add_near(1 + beyond, 0.01);
  add_point(rival.first.joint, border, rough);
  if (!rival.joined) add_point(rival.second.joint, border, rough);
  return rough;
}

struct Across {
  const Section& section;
  const Slant& slant;
  const Rival& rival;
  const Chord& chord;
};

void add_node(const Across& across, int zone, double s, double y, double weight, Bulge& bulge) {
  const Point2 p = across.chord.at(s, y);
  const double share = weight * field_of(across.section, across.slant, zone, p);
  bulge.volume += share;
  bulge.first = bulge.first + share * p;
}

template <std::size_t N>
void add_nodes(const Across& across, const GaussNode (&rule)[N], double s, double height, double weight,
               Bulge& bulge) {
  const int zone = zone_of(across.section, across.slant, across.chord.at(s, 0.5 * height)).zone;
  for (const GaussNode& node : rule) {
    add_node(across, zone, s, height * node.at, weight * node.weight * height, bulge);
  }
}

// A strip that comes near to the axis, or over which another sphere becomes the nearest.
void add_graded(const Across& across, double s, double height, double weight, Bulge& bulge) {
  const Cone& own = across.rival.own();
  const auto along = [&](double t) { return sight_of(own, across.chord.at(s, t * height)).along; };
  Roughness rough;
  for (const double from : {0.0, own.cosine * own.length}) {
    if (own.kind != Cone::hull) break;
    const auto beyond = [&](double t) { return along(t) - from; };
    const double start = beyond(0), end = beyond(1);
    if ((start > 0) != (end > 0)) rough.add_break(find_root(beyond, 0, start, 1, end, 1e-12));
  }
  const Point2 foot = across.chord.at(s, 0);
  const Vec3 first = Vec3{foot.x, foot.y, 0} - own.joint, second = first - own.length * own.axis;
  const Vec3 step = height * Vec3{across.chord.across.x, across.chord.across.y, 0};
  const Vec3 turned = cross(step, own.axis), from_axis = cross(first, own.axis);
  add_nearest(dot(turned, turned), dot(from_axis, turned), dot(from_axis, from_axis), rough);
  add_nearest(dot(step, step), dot(first, step), dot(first, first), rough);
  add_nearest(dot(step, step), dot(second, step), dot(second, second), rough);
  crowded_nodes(0, 1, rough, [&](double t, double share) {
    const int zone = zone_of(across.section, across.slant, across.chord.at(s, t * height)).zone;
    add_node(across, zone, s, t * height, share * weight * height, bulge);
  });
}

// From the chord to the border at abscissa s.
void add_strip(const Across& across, double s, double height, double weight, Bulge& bulge) {
  const Cone& own = across.rival.own();
  const Sight start = sight_of(own, across.chord.at(s, 0)), end = sight_of(own, across.chord.at(s, height));
  const int part = part_of(own, start);
  if (part != part_of(own, end)) return add_graded(across, s, height, weight, bulge);
  const auto distance = [&](const Sight& sight) {
    return part == 0 ? sight.distance : part == 1 ? sight.radial : norm(sight.from - own.length * own.axis);
  };
  // n nodes on a length l at a distance d from the axis leave about (2 d / l + sqrt(4 d^2 / l^2 + 1))^(-2 n).
  const double width = std::fabs(height), nearest = min(distance(start), distance(end)) - 0.5 * width;
  if (width < 0.12 * nearest) return add_nodes(across, kGauss4, s, height, weight, bulge);
  if (width < 0.3 * nearest) return add_nodes(across, kGauss6, s, height, weight, bulge);
  if (width < 0.6 * nearest) return add_nodes(across, kGauss8, s, height, weight, bulge);
  add_graded(across, s, height, weight, bulge);
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

Course follow_border(const Section& section, const Rival& rival, Chord& chord) {
  Border border(rival, chord);
  double peak = 0;
  for (int i = 1; i + 1 < kProbes; ++i) {
    peak = max(peak, std::fabs(border.height_at(chord.length * i / (kProbes - 1))));
  }
  if (!border.good || peak > kFlat * chord.length) return Course::unclear;
  const auto field = [&](double s) { return field_at(section, border.point(s)); };
  const double begin = field(0), end = field(chord.length);
  double from = 0, to = chord.length;
  if (begin < 0 || end < 0) {
    const double inside = begin > 0 ? 0 : end > 0 ? chord.length : find_inside(section, border);
    if (!border.good) return Course::unclear;
    if (inside < 0) return Course::outside;
    const double value = field(inside), tolerance = 1e-13 * rival.first.radius;
    if (begin < 0) from = find_root(field, 0, begin, inside, value, tolerance);
    if (end < 0) to = find_root(field, inside, value, chord.length, end, tolerance);
  }
  for (int i = 1; i + 1 < kProbes; ++i) {
    if (field(from + (to - from) * i / (kProbes - 1)) < -1e-12 * rival.first.radius) return Course::unclear;
  }
  const Point2 first = border.point(from), last = border.point(to);
  if (!border.good) return Course::unclear;
  if (!(to - from > 1e-12 * rival.first.radius)) return Course::outside;
  chord = chord_between(first, last);
  return Course::inside;
}

bool integrate_bulge(const Section& section, const Rival& rival, const Chord& chord, Bulge& bulge) {
  Border border(rival, chord);
  bulge = {};
  if (!border.good || border.is_short()) return border.good;
  const Slant slant = slant_of(section);
  const Across across{section, slant, rival, chord};
  const Roughness rough = roughness_of(border);
  crowded_nodes(0, 1, rough, [&](double t, double weight) {
    const double s = chord.length * t, y = border.height_at(s), area = weight * chord.length * y;
    bulge.area += area;
    bulge.area_first = bulge.area_first + area * chord.at(s, 0.5 * y);
    add_strip(across, s, y, weight * chord.length, bulge);
  });
  return border.good;
}

}  // namespace lumbrical
