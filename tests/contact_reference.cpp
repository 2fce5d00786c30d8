// Contact of one triangle with one primitive by nested adaptive quadrature in long double.
//
// Everything happens in a frame of the triangle's plane: z along the normal, the primitive's axis above the x
// axis. Lines of constant y cut the triangle and the primitive in intervals; the depth below a point is the
// end of another such interval, along -z. One function, `chord`, answers both. The outer integral runs over
// y, the inner one over x.
#include "contact_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace lumbrical::test {
namespace {

using Real = long double;
constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
constexpr Real kPi = std::numbers::pi_v<Real>;

struct Vector {
  Real x = 0, y = 0, z = 0;
};
Vector wide(Vec3 a) { return {a.x, a.y, a.z}; }
Vec3 narrow(Vector a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}
Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(Real s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
Real dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real norm(Vector a) { return std::sqrt(dot(a, a)); }
Vector unit(Vector a) { return (1 / norm(a)) * a; }

// ---- The primitive
// ------------------------------------------------------------------------------------------------

/// Everything relative to the centre of the first end. A sphere has no length.
struct Solid {
  bool flat = false;
  Vector axis{0, 0, 1};
  Real length = 0, radius1 = 0, radius2 = 0;
  Real slope = 0, cosine = 1;  ///< of the side against the axis: sine and cosine
};

/// The solid and the point all of its coordinates are relative to.
struct Placed {
  Solid solid;
  Vec3 origin;
};

Placed place(const ProbePrimitive& primitive) {
  Placed placed{{}, primitive.end1};
  Solid& solid = placed.solid;
  solid.flat = primitive.shape == ProbeShape::cylinder;
  solid.radius1 = primitive.radius1;
  solid.radius2 = primitive.shape == ProbeShape::capsule ? primitive.radius2 : primitive.radius1;
  if (primitive.shape == ProbeShape::sphere) return placed;
  const Vector along = wide(primitive.end2) - wide(primitive.end1);
  const Real length = norm(along);
  if (length <= std::fabs(solid.radius2 - solid.radius1)) {  // one end sphere holds the other
    if (solid.radius2 > solid.radius1) placed.origin = primitive.end2;
    solid.radius1 = solid.radius2 = std::max(solid.radius1, solid.radius2);
    return placed;
  }
  solid.length = length;
  solid.axis = unit(along);
  solid.slope = (solid.radius2 - solid.radius1) / length;
  solid.cosine = std::sqrt((1 - solid.slope) * (1 + solid.slope));
  return placed;
}

/// The part of a line inside something convex, and by which of its surfaces the line enters and leaves.
struct Interval {
  Real low = -kInfinity, high = kInfinity;
  int low_by = 0, high_by = 0;
  [[nodiscard]] bool empty() const { return !(low <= high); }
};
constexpr Interval kNothing{kInfinity, -kInfinity, 0, 0};

enum Surface : int { kEnd1 = 1, kEnd2, kSide, kSwitch1, kSwitch2, kKink1, kKink2, kNearest, kEdge };

Interval common(Interval a, Interval b) {
  if (b.low > a.low) a.low = b.low, a.low_by = b.low_by;
  if (b.high < a.high) a.high = b.high, a.high_by = b.high_by;
  return a;
}

/// The smallest interval that holds both.
Interval joined(Interval a, Interval b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  if (b.low < a.low) a.low = b.low, a.low_by = b.low_by;
  if (b.high > a.high) a.high = b.high, a.high_by = b.high_by;
  return a;
}

/// Where from + s along lies between two planes across the axis.
Interval between_planes(const Solid& solid, Vector from, Vector along, Real first, Real second) {
  const Real at = dot(from, solid.axis), rate = dot(along, solid.axis);
  if (rate == 0) return at >= first && at <= second ? Interval{} : kNothing;
  const Real to_first = (first - at) / rate, to_second = (second - at) / rate;
  return rate > 0 ? Interval{to_first, to_second, kEnd1, kEnd2} : Interval{to_second, to_first, kEnd2, kEnd1};
}

Interval in_ball(Vector from, Vector along, Real radius, int surface) {
  const Real miss = norm(cross(from, along));
  if (miss > radius) return kNothing;
  const Real half = std::sqrt((radius - miss) * (radius + miss)), middle = -dot(from, along);
  return {middle - half, middle + half, surface, surface};
}

/// Both roots of a s^2 + 2 b s + c, ordered; infinite ones where a vanishes. The discriminant b^2 - a c is
/// not < 0.
std::array<Real, 2> roots(Real a, Real b, Real c, Real discriminant) {
  // Of a line that just touches, c is rounding: no divisor to rely on. Of a line nearly along, it is a that
  // is.
  if (std::fabs(a) > 1e-4L) {
    const Real middle = -b / a, half = std::sqrt(discriminant) / std::fabs(a);
    return {middle - half, middle + half};
  }
  const Real q = -(b + std::copysign(std::sqrt(discriminant), b));
  const Real far = a != 0 ? q / a : std::copysign(kInfinity, q), near = q != 0 ? c / q : 0;
  return {std::min(far, near), std::max(far, near)};
}

/// Where the line is nearer to the axis line than the side, whose distance from it is (radius1 + slope z) /
/// cosine at the axial coordinate z; only where that is positive.
Interval within_side(const Solid& solid, Vector from, Vector along) {
  const Vector turn = cross(along, solid.axis), arm = cross(from, solid.axis);
  const Real wide0 = (solid.radius1 + solid.slope * dot(from, solid.axis)) / solid.cosine;
  const Real wide1 = solid.slope * dot(along, solid.axis) / solid.cosine;
  const Real a = dot(turn, turn) - wide1 * wide1, b = dot(turn, arm) - wide0 * wide1,
             c = dot(arm, arm) - wide0 * wide0;
  // b^2 - a c, arranged so that a line nearly along the axis keeps its digits: turn x arm is along the axis.
  const Real twist = dot(solid.axis, cross(along, from));
  const Vector apart = wide0 * turn - wide1 * arm;
  const Real discriminant = dot(apart, apart) - twist * twist;
  if (a > 0) {
    if (discriminant < 0) return kNothing;
    const auto [low, high] = roots(a, b, c, discriminant);
    return {low, high, kSide, kSide};
  }
  if (wide1 == 0) return c <= 0 ? Interval{-kInfinity, kInfinity, kSide, kSide} : kNothing;
  // Steeper than the side: inside from one root on, towards where the cone widens.
  const auto [low, high] = roots(a, b, c, std::max<Real>(discriminant, 0));
  if (a == 0) {
    const Real only = std::isinf(low) ? high : low;
    if ((b < 0) != (wide1 > 0)) return kNothing;
    return wide1 > 0 ? Interval{only, kInfinity, kSide, kSide} : Interval{-kInfinity, only, kSide, kSide};
  }
  return wide1 > 0 ? Interval{high, kInfinity, kSide, kSide} : Interval{-kInfinity, low, kSide, kSide};
}

/// The part of the line from + s along (unit) inside the solid. The hull of two spheres is the spheres and
/// what lies between the circles in which the side touches them.
Interval chord(const Solid& solid, Vector from, Vector along) {
  if (solid.flat) {
    return common(within_side(solid, from, along), between_planes(solid, from, along, 0, solid.length));
  }
  const Interval ball1 = in_ball(from, along, solid.radius1, kEnd1);
  if (solid.length == 0) return ball1;
  const Interval ball2 = in_ball(from - solid.length * solid.axis, along, solid.radius2, kEnd2);
  Interval between =
      common(within_side(solid, from, along), between_planes(solid, from, along, -solid.radius1 * solid.slope,
                                                             solid.length - solid.radius2 * solid.slope));
  return joined(joined(ball1, ball2), between);
}

/// The largest R(t) - |p - c(t)|: concave in t, so its best t is where the derivative vanishes, or an end.
Real field_at(const Solid& solid, Vector p) {
  const Real off = norm(cross(p, solid.axis)), at = dot(p, solid.axis);
  if (solid.flat) return solid.radius1 - off;
  if (solid.length == 0) return solid.radius1 - norm(p);
  const Real best = std::clamp<Real>(at + off * solid.slope / solid.cosine, 0, solid.length);
  return solid.radius1 + solid.slope * best - std::hypot(off, at - best);
}

Real depth_at(const Solid& solid, Vector p) {
  const Interval inside = chord(solid, p, {0, 0, -1});
  return inside.empty() ? -1 : inside.high;
}

// ---- Triangle and lines in the plane's frame
// ----------------------------------------------------------------------

struct Layout {
  Solid solid;                    ///< its origin is the first end: (0, 0, height)
  Real height = 0;                ///< of the first end above the plane
  std::array<Vector, 3> corners;  ///< z = 0, counter-clockwise
  Real size = 0;                  ///< of the solid
  [[nodiscard]] Vector relative(Real x, Real y) const { return {x, y, -height}; }
};

Interval triangle_interval(const Layout& scene, Real y) {
  Interval inside;
  for (int i = 0; i < 3; ++i) {
    const Vector p = scene.corners[i], q = scene.corners[(i + 1) % 3];
    const Real dx = q.x - p.x, dy = q.y - p.y;
    if (dy == 0) {
      if (dx * (y - p.y) < 0) return kNothing;
      continue;
    }
    const Real x = p.x + (y - p.y) / dy * dx;
    inside =
        common(inside, dy > 0 ? Interval{-kInfinity, x, 0, kEdge + i} : Interval{x, kInfinity, kEdge + i, 0});
  }
  return inside;
}

Interval solid_interval(const Layout& scene, Real y) {
  return chord(scene.solid, scene.relative(0, y), {1, 0, 0});
}

Interval both_intervals(const Layout& scene, Real y) {
  return common(triangle_interval(scene, y), solid_interval(scene, y));
}

struct Split {
  Real x = 0;
  int why = 0;
};

/// Where the field isn't smooth along the line: next to the axis and its ends, and where the best sphere
/// becomes that of an end.
void split_field(const Layout& scene, Real y, std::vector<Split>& splits) {
  const Solid& solid = scene.solid;
  const Vector from = scene.relative(0, y), along{1, 0, 0};
  const Vector turn = cross(along, solid.axis), arm = cross(from, solid.axis);
  if (dot(turn, turn) > 0) splits.push_back({-dot(turn, arm) / dot(turn, turn), kNearest});
  if (solid.flat) return;
  splits.push_back({0, kNearest});
  if (solid.length == 0) return;
  splits.push_back({solid.length * solid.axis.x, kNearest});
  // at + off tan = end, squared: tan^2 off^2 = (end - at)^2, with the sign of tan where it counts.
  const Real tan = solid.slope / solid.cosine, rate = dot(along, solid.axis);
  for (const int end : {0, 1}) {
    const Real gap = end * solid.length - dot(from, solid.axis);
    const Real a = tan * tan * dot(turn, turn) - rate * rate, b = tan * tan * dot(turn, arm) + rate * gap,
               c = tan * tan * dot(arm, arm) - gap * gap;
    const Real discriminant = b * b - a * c;
    if (a == 0 && b == 0) continue;
    for (const Real x : roots(a, b, c, std::max<Real>(discriminant, 0))) {
      if (tan * (gap - rate * x) >= 0) splits.push_back({x, kKink1 + end});
    }
  }
}

/// Where the way down leaves through another surface: above the circle in which side and end meet.
void split_depth(const Layout& scene, Real y, std::vector<Split>& splits) {
  const Solid& solid = scene.solid;
  if (solid.length == 0) return;
  const Vector a = solid.axis;
  const Vector across = unit({a.z, 0, -a.x});
  for (const int end : {0, 1}) {
    const Real radius = end == 0 ? solid.radius1 : solid.radius2;
    const Real at = solid.flat ? 0 : -radius * solid.slope;  // from the end's centre
    const Vector centre = (end * solid.length) * a;
    // A point of that plane with this y, relative to the end's centre; then along the plane at constant y.
    const Real y_left = y - centre.y;
    const Real span = a.x * a.x + a.z * a.z;
    const Vector start{(at - y_left * a.y) * a.x / span, y_left, (at - y_left * a.y) * a.z / span};
    const Interval meets = in_ball(start, across, radius, 0);
    if (meets.empty()) continue;
    splits.push_back({(centre + start + meets.low * across).x, kSwitch1 + end});
    splits.push_back({(centre + start + meets.high * across).x, kSwitch1 + end});
  }
}

/// The contacted part of a line and the places in it where an integrand isn't smooth, in order of x.
struct Line {
  Interval inside;
  std::vector<Split> splits;
};

Line line_at(const Layout& scene, Real y) {
  Line line{both_intervals(scene, y), {}};
  if (line.inside.empty()) return line;
  split_field(scene, y, line.splits);
  split_depth(scene, y, line.splits);
  std::erase_if(line.splits, [&](const Split& split) {
    return !(split.x > line.inside.low && split.x < line.inside.high);
  });
  std::stable_sort(line.splits.begin(), line.splits.end(),
                   [](const Split& a, const Split& b) { return a.x < b.x; });
  return line;
}

bool same_structure(const Line& a, const Line& b) {
  if (a.inside.empty() || b.inside.empty()) return a.inside.empty() == b.inside.empty();
  return a.inside.low_by == b.inside.low_by && a.inside.high_by == b.inside.high_by &&
         std::equal(a.splits.begin(), a.splits.end(), b.splits.begin(), b.splits.end(),
                    [](const Split& p, const Split& q) { return p.why == q.why; });
}

// ---- Quadrature
// ---------------------------------------------------------------------------------------------------

constexpr int kNodes = 20;
struct Rule {
  std::array<Real, kNodes> node, weight;
};

/// Gauss-Legendre on -1 .. 1, the roots of the Legendre polynomial by Newton's method.
Rule make_rule() {
  Rule rule;
  for (int i = 0; i < kNodes; ++i) {
    Real x = std::cos(kPi * (i + 0.75L) / (kNodes + 0.5L)), slope = 1;
    for (int step = 0; step < 12; ++step) {
      Real before = 1, value = x;
      for (int n = 2; n <= kNodes; ++n) {
        const Real next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = next;
      }
      slope = kNodes * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    rule.node[i] = x;
    rule.weight[i] = 2 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

template <std::size_t N>
using Values = std::array<Real, N>;

/// Sum and the errors its last refinement still showed.
template <std::size_t N>
struct Integral {
  Values<N> sum{}, error{};
  int panels_left = 200;  ///< refinement ends with them; the error tells
};

/// Gauss over part of low .. high, in the angle that makes roots at either end smooth:
/// x = middle - half cos(angle).
template <std::size_t N, class Function>
Values<N> panel(const Function& function, Real low, Real high, Real from, Real to) {
  static const Rule kRule = make_rule();
  Values<N> sum{};
  const Real middle = 0.5L * (low + high), half = 0.5L * (high - low);
  for (int i = 0; i < kNodes; ++i) {
    const Real angle = 0.5L * (from + to) + 0.5L * (to - from) * kRule.node[i];
    const Real weight = 0.5L * (to - from) * kRule.weight[i] * half * std::sin(angle);
    const Values<N> value = function(middle - half * std::cos(angle));
    for (std::size_t k = 0; k < N; ++k) sum[k] += weight * value[k];
  }
  return sum;
}

template <std::size_t N, class Function>
void refine(const Function& function, Real low, Real high, Real from, Real to, const Values<N>& coarse,
            const Values<N>& tolerance, int levels, Integral<N>& total) {
  const Real middle = 0.5L * (from + to);
  const Values<N> left = panel<N>(function, low, high, from, middle),
                  right = panel<N>(function, low, high, middle, to);
  bool good = true;
  for (std::size_t k = 0; k < N; ++k) good &= !(std::fabs(left[k] + right[k] - coarse[k]) > tolerance[k]);
  if (good || levels == 0 || --total.panels_left < 0) {
    for (std::size_t k = 0; k < N; ++k) {
      total.sum[k] += left[k] + right[k];
      total.error[k] += std::fabs(left[k] + right[k] - coarse[k]);
    }
    return;
  }
  refine(function, low, high, from, middle, left, tolerance, levels - 1, total);
  refine(function, low, high, middle, to, right, tolerance, levels - 1, total);
}

/// Integrals of field, x field, depth, x depth along the contacted part of a line.
Values<4> along_line(const Layout& scene, Real y, const Line& line) {
  const auto values = [&](Real x) -> Values<4> {
    const Vector p = scene.relative(x, y);
    const Real field = field_at(scene.solid, p), depth = depth_at(scene.solid, p);
    return {field, x * field, depth, x * depth};
  };
  std::vector<Real> ends{line.inside.low};
  for (const Split& split : line.splits) ends.push_back(split.x);
  ends.push_back(line.inside.high);
  std::vector<Values<4>> coarse;
  Values<4> whole{};
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    coarse.push_back(panel<4>(values, ends[i], ends[i + 1], 0, kPi));
    for (std::size_t k = 0; k < 4; ++k) whole[k] += coarse.back()[k];
  }
  // Of the whole line: a sliver in which the depth falls off a cliff can't be better than its rounding, and
  // needn't.
  const Real noise = 2e-18L * scene.size * (ends.back() - ends.front());
  const Real reach = std::max(std::fabs(ends.front()), std::fabs(ends.back()));
  const Real field = noise + 3e-16L * whole[0], depth = noise + 3e-16L * whole[2];
  const Values<4> tolerance{field, reach * field, depth, reach * depth};
  Integral<4> total;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (ends[i + 1] > ends[i]) refine(values, ends[i], ends[i + 1], 0, kPi, coarse[i], tolerance, 24, total);
  }
  return total.sum;
}

/// 1, x, y, field times (1, x, y), depth times (1, x, y), each integrated along the line.
Values<9> across_lines(const Layout& scene, Real y) {
  const Line line = line_at(scene, y);
  if (line.inside.empty()) return {};
  const Values<4> load = along_line(scene, y, line);
  const Real width = line.inside.high - line.inside.low, middle = 0.5L * (line.inside.high + line.inside.low);
  return {width, width * middle, width * y, load[0], load[1], y * load[0], load[2], load[3], y * load[2]};
}

// ---- The contacted range of y, and where its lines change their structure
// -------------------------------------------

struct Best {
  Real at = 0, value = 0;
};

/// Golden section search; the function must be concave. Comes as near to the ends as makes no difference, but
/// never looks at them: lines that touch the solid there are all rounding.
template <class Function>
Best maximize(const Function& function, Real low, Real high) {
  constexpr Real kRatio = 0.61803398874989484820L;
  Real p = high - kRatio * (high - low), q = low + kRatio * (high - low);
  Best best{p, function(p)};
  const auto look = [&](Real at) {
    const Real value = function(at);
    if (value > best.value) best = {at, value};
    return value;
  };
  Real at_p = best.value, at_q = look(q);
  for (int i = 0; i < 88; ++i) {
    if (at_p > at_q) {
      high = q, q = p, at_q = at_p;
      at_p = look(p = high - kRatio * (high - low));
    } else {
      low = p, p = q, at_p = at_q;
      at_q = look(q = low + kRatio * (high - low));
    }
  }
  return best;
}

/// The last place, seen from `inside`, where `holds` still holds.
template <class Holds>
Real bisect(const Holds& holds, Real inside, Real outside) {
  if (holds(outside)) return outside;
  for (int i = 0; i < 90; ++i) {
    const Real middle = 0.5L * (inside + outside);
    (holds(middle) ? inside : outside) = middle;
  }
  return inside;
}

/// The y of all lines that meet both triangle and solid. The solid is symmetric about y = 0, so its section,
/// if there is one, meets that line.
Interval contacted_range(const Layout& scene) {
  const auto cut = [&](Real y) { return !solid_interval(scene, y).empty(); };
  if (!cut(0)) return kNothing;
  const auto [first, last] = std::minmax({scene.corners[0].y, scene.corners[1].y, scene.corners[2].y});
  const Real low = std::max(first, bisect(cut, 0, -1.01L * scene.size)),
             high = std::min(last, bisect(cut, 0, 1.01L * scene.size));
  if (!(low < high)) return kNothing;
  const auto width = [&](Real y) {
    const Interval inside = both_intervals(scene, y);
    return inside.high - inside.low;
  };
  const Best widest = maximize(width, low, high);
  if (!(widest.value > 0)) return kNothing;
  const auto meets = [&](Real y) { return width(y) > 0; };
  return {bisect(meets, widest.at, low), bisect(meets, widest.at, high), 0, 0};
}

void find_changes(const Layout& scene, Real low, const Line& at_low, Real high, const Line& at_high,
                  int levels, std::vector<Real>& changes) {
  // Where rounding alone makes the structure flicker there is no end of changes; the quadrature copes.
  constexpr std::size_t kMostChanges = 60;
  if (changes.size() > kMostChanges || same_structure(at_low, at_high)) return;
  const Real middle = 0.5L * (low + high);
  if (levels == 0 || middle <= low || middle >= high) {
    changes.push_back(middle);
    return;
  }
  const Line at_middle = line_at(scene, middle);
  find_changes(scene, low, at_low, middle, at_middle, levels - 1, changes);
  find_changes(scene, middle, at_middle, high, at_high, levels - 1, changes);
}

/// Places between low and high to look at, ever denser towards both: the section of an axis nearly in the
/// plane ends within almost nothing, from a line of full length to none.
std::vector<Real> scan_of(Real low, Real high) {
  constexpr int kScan = 20;
  const Real middle = 0.5L * (low + high), half = 0.5L * (high - low);
  std::vector<Real> places;
  for (int k = 0; k < kScan; ++k) places.push_back(middle - half * std::cos(kPi * (k + 0.5L) / kScan));
  for (Real near = 1e-3L * half; near > 1e-18L * half; near *= 0.2L) {
    if (low + near > low) places.push_back(low + near);
    if (high - near < high) places.push_back(high - near);
  }
  std::sort(places.begin(), places.end());
  return places;
}

std::vector<Real> pieces_of(const Layout& scene, Interval range) {
  std::vector<Real> known{range.low, range.high, 0};
  for (const Vector& corner : scene.corners) known.push_back(corner.y);
  std::erase_if(known, [&](Real y) { return !(y >= range.low && y <= range.high); });
  std::sort(known.begin(), known.end());
  std::vector<Real> pieces = known;
  for (std::size_t i = 0; i + 1 < known.size(); ++i) {
    const std::vector<Real> places = scan_of(known[i], known[i + 1]);
    Line before = line_at(scene, places.front());
    for (std::size_t k = 1; k < places.size(); ++k) {
      Line next = line_at(scene, places[k]);
      find_changes(scene, places[k - 1], before, places[k], next, 62, pieces);
      before = std::move(next);
    }
  }
  std::sort(pieces.begin(), pieces.end());
  // What is narrower than this holds nothing.
  const Real least = 1e-17L * (range.high - range.low);
  std::vector<Real> apart{range.low};
  for (const Real y : pieces) {
    if (y > apart.back() + least) apart.push_back(y);
  }
  return apart;
}

Integral<9> integrate(const Layout& scene, const std::vector<Real>& pieces) {
  const auto lines = [&](Real y) { return across_lines(scene, y); };
  std::vector<Values<9>> coarse;
  Values<9> whole{};
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    coarse.push_back(panel<9>(lines, pieces[i], pieces[i + 1], 0, kPi));
    for (std::size_t k = 0; k < 9; ++k) whole[k] += coarse.back()[k];
  }
  Values<9> tolerance;
  for (std::size_t k = 0; k < 9; ++k) {
    const Real reach = k % 3 == 0 ? 1 : scene.size;
    tolerance[k] = 3e-15L * reach * whole[k - k % 3];
  }
  Integral<9> total;
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    refine(lines, pieces[i], pieces[i + 1], 0, kPi, coarse[i], tolerance, 24, total);
  }
  return total;
}

}  // namespace

ContactReference contact_reference(const ProbePrimitive& primitive, Vec3 a, Vec3 b, Vec3 c) {
  ContactReference result;
  const Placed placed = place(primitive);
  // The plane's frame: origin at the foot of the first end, x under the axis.
  const Vector n = unit(cross(wide(b) - wide(a), wide(c) - wide(a)));
  Vector y = cross(n, placed.solid.axis);
  if (norm(y) < 1e-15L) y = cross(n, std::fabs(n.x) < 0.6L ? Vector{1, 0, 0} : Vector{0, 1, 0});
  y = unit(y);
  y = unit(y - dot(y, n) * n);
  const Vector x = cross(y, n);
  Layout scene;
  scene.solid = placed.solid;
  scene.solid.axis = unit({dot(placed.solid.axis, x), dot(placed.solid.axis, y), dot(placed.solid.axis, n)});
  const Vector end = wide(placed.origin);
  scene.height = dot(end - wide(a), n);
  const Vector foot = end - scene.height * n;
  int i = 0;
  for (const Vec3& corner : {a, b, c}) {
    scene.corners[i++] = {dot(wide(corner) - foot, x), dot(wide(corner) - foot, y), 0};
  }
  scene.size = std::max(scene.solid.radius1, scene.solid.radius2);
  result.normal = narrow(n);

  const Interval range = contacted_range(scene);
  if (range.empty()) return result;
  const Integral<9> total = integrate(scene, pieces_of(scene, range));
  const Values<9>& sum = total.sum;
  if (!(sum[0] > 0)) return result;
  const auto point = [&](Real px, Real py) { return narrow(foot + px * x + py * y); };
  result.touches = true;
  result.area = static_cast<double>(sum[0]);
  result.centroid = point(sum[1] / sum[0], sum[2] / sum[0]);
  result.field = static_cast<double>(sum[3]);
  result.field_centre = point(sum[4] / sum[3], sum[5] / sum[3]);
  result.column = static_cast<double>(sum[6]);
  result.column_centre = point(sum[7] / sum[6], sum[8] / sum[6]);
  result.area_error = static_cast<double>(total.error[0] / sum[0]);
  result.field_error = static_cast<double>(total.error[3] / sum[3]);
  result.column_error = static_cast<double>(total.error[6] / sum[6]);
  result.at_centroid =
      static_cast<double>(depth_at(scene.solid, scene.relative(sum[1] / sum[0], sum[2] / sum[0])));
  // The way out of something convex is a concave function of the place, so two nested searches find its top.
  const auto deepest_of_line = [&](Real at) {
    const Interval inside = both_intervals(scene, at);
    if (inside.empty()) return Real{0};
    return maximize([&](Real px) { return depth_at(scene.solid, scene.relative(px, at)); }, inside.low,
                    inside.high)
        .value;
  };
  result.deepest = static_cast<double>(maximize(deepest_of_line, range.low, range.high).value);
  return result;
}

double reference_depth(const ProbePrimitive& primitive, Vec3 normal, Vec3 p) {
  const Placed placed = place(primitive);
  const Interval inside = chord(placed.solid, wide(p) - wide(placed.origin), Real{-1} * unit(wide(normal)));
  return inside.empty() ? -1 : static_cast<double>(inside.high);
}

double reference_field(const ProbePrimitive& primitive, Vec3 p) {
  const Placed placed = place(primitive);
  return static_cast<double>(field_at(placed.solid, wide(p) - wide(placed.origin)));
}

}  // namespace lumbrical::test
