#include "finger_reference.h"

#include <algorithm>
#include <cmath>

namespace lumbrical::test {
namespace {

struct Sums {
  std::array<double, 6> of{};  // area, its moments along both axes, volume, its moments
  Sums& operator+=(const Sums& other) {
    for (std::size_t i = 0; i < 6; ++i) of[i] += other.of[i];
    return *this;
  }
};
Sums operator*(double s, Sums sums) {
  for (double& value : sums.of) value *= s;
  return sums;
}

struct Nearest {
  double field;
  int sphere;  // 3 times the capsule, plus 0 for its first end, 1 between, 2 for its second end
};

Nearest nearest_of(const ReferenceCapsule& c, Vec3 p) {
  const Vec3 d = c.end2 - c.end1;
  const double length = norm(d), growth = c.radius2 - c.radius1;
  double t = growth > 0 ? 1 : 0;  // the larger sphere holds the smaller one
  if (length > std::fabs(growth)) {
    const double k = growth / length, q = dot(p - c.end1, d) / length;
    const double rho = norm(p - c.end1 - (q / length) * d);
    t = std::clamp((q + k * rho / std::sqrt(1 - k * k)) / length, 0.0, 1.0);
  }
  return {c.radius1 + t * growth - norm(p - (c.end1 + t * d)), t <= 0 ? 0 : t >= 1 ? 2 : 1};
}

Nearest nearest_sphere(const std::vector<ReferenceCapsule>& finger, Vec3 p) {
  Nearest best{-1e300, -1};
  for (std::size_t i = 0; i < finger.size(); ++i) {
    const Nearest here = nearest_of(finger[i], p);
    // Two phalanges have their joint's sphere in common: rounding must not choose between equals.
    if (here.field > best.field + 1e-14) best = {here.field, static_cast<int>(3 * i) + here.sphere};
  }
  if (best.field <= 0) best.sphere = -1;
  return best;
}

double difference(const Sums& a, const Sums& b) {
  double worst = 0;
  for (std::size_t i = 0; i < 6; ++i) worst = std::fmax(worst, std::fabs(a.of[i] - b.of[i]));
  return worst;
}

// Gauss-Kronrod 7-15 on [-1, 1].
constexpr double kAt[8] = {0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
                           0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
                           0.586087235467691130294144691693013, 0.405845151377397166906606412076961,
                           0.207784955007898467600689403773245, 0.0};
constexpr double kKronrod[8] = {0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
                                0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
                                0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
                                0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr double kGauss[4] = {0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
                              0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

struct Estimate {
  Sums value;
  double doubt = 0;
};

template <class F>
Estimate both_rules(F&& f, double from, double to) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  Sums fine, coarse;
  for (int i = 0; i < 8; ++i) {
    for (const double sign : {1.0, -1.0}) {
      if (i == 7 && sign < 0) continue;
      const Sums value = f(middle + sign * half * kAt[i]);
      fine += half * kKronrod[i] * value;
      if (i % 2 == 1) coarse += half * kGauss[i / 2] * value;
    }
  }
  return {fine, difference(fine, coarse)};
}

// Halves until both rules agree to `tolerance`, which is pessimistic. For smooth functions.
template <class F>
Sums integrate_smooth(F&& f, double from, double to, double tolerance, int level = 0) {
  const Estimate whole = both_rules(f, from, to);
  if (whole.doubt <= tolerance || level > 30) return whole.value;
  const double middle = 0.5 * (from + to);
  Sums sum = integrate_smooth(f, from, middle, tolerance, level + 1);
  return sum += integrate_smooth(f, middle, to, tolerance, level + 1);
}

// Halves until the halves agree with the whole as well, so that a corner between the nodes is seen.
template <class F>
Sums integrate(F&& f, double from, double to, double tolerance, const Estimate& whole, int level = 0) {
  const double middle = 0.5 * (from + to);
  const Estimate left = both_rules(f, from, middle), right = both_rules(f, middle, to);
  Sums sum = left.value;
  sum += right.value;
  if (std::fmax(whole.doubt, difference(whole.value, sum)) <= tolerance || level > 18) return sum;
  Sums halves = integrate(f, from, middle, tolerance, left, level + 1);
  return halves += integrate(f, middle, to, tolerance, right, level + 1);
}

struct Plane {
  Vec3 origin, u, v;
};

// Where a concave function is largest between low and high: golden section.
template <class F>
double peak_of(F&& f, double low, double high) {
  const double share = 0.6180339887498949;
  double a = low, b = high, c = b - share * (b - a), d = a + share * (b - a), fc = f(c), fd = f(d);
  for (int i = 0; i < 60; ++i) {
    if (fc > fd) {
      b = d;
      d = c;
      fd = fc;
      fc = f(c = b - share * (b - a));
    } else {
      a = c;
      c = d;
      fc = fd;
      fd = f(d = a + share * (b - a));
    }
  }
  return 0.5 * (a + b);
}

// The y at which one phalanx's field, which is concave, is largest on the line of one x.
double peak_on_line(const ReferenceCapsule& capsule, const Plane& plane, double x, double low, double high) {
  return peak_of(
      [&](double y) { return nearest_of(capsule, plane.origin + x * plane.u + y * plane.v).field; }, low,
      high);
}

// Integrals along y at one x, split where another sphere takes over or the finger ends.
Sums along_line(const std::vector<ReferenceCapsule>& finger, const Plane& plane, double x, double low,
                double high) {
  const auto at = [&](double y) { return nearest_sphere(finger, plane.origin + x * plane.u + y * plane.v); };
  const auto f = [&](double y) {
    const double field = std::fmax(0, at(y).field), inside = field > 0 ? 1 : 0;
    return Sums{{inside, inside * x, inside * y, field, field * x, field * y}};
  };
  Sums sum;
  double start = low;
  int sphere = at(low).sphere;
  const auto piece = [&](double to) {
    if (sphere >= 0 && to > start) sum += integrate_smooth(f, start, to, 3e-14);
  };
  std::vector<double> stops = {high};
  const int steps = 12 + static_cast<int>((high - low) / 0.03);
  for (int i = 1; i < steps; ++i) stops.push_back(low + (high - low) * i / steps);
  for (const ReferenceCapsule& capsule : finger) stops.push_back(peak_on_line(capsule, plane, x, low, high));
  std::sort(stops.begin(), stops.end());
  double previous = low;
  for (const double y : stops) {
    while (at(y).sphere != sphere) {
      double same = std::fmax(previous, start), other = y;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (same + other);
        (at(middle).sphere == sphere ? same : other) = middle;
      }
      piece(same);
      start = other;
      if (at(other).sphere == sphere) break;
      sphere = at(other).sphere;
    }
    previous = y;
  }
  piece(high);
  return sum;
}

}  // namespace

double finger_field(const std::vector<ReferenceCapsule>& finger, Vec3 p) {
  return nearest_sphere(finger, p).field;
}

FingerReference finger_reference(const std::vector<ReferenceCapsule>& posed, Vec3 a, Vec3 b, Vec3 c) {
  // In units of the first radius, from the first end.
  const double unit = posed[0].radius1;
  const Vec3 origin = posed[0].end1;
  std::vector<ReferenceCapsule> finger = posed;
  for (ReferenceCapsule& capsule : finger) {
    capsule = {(capsule.end1 - origin) / unit, (capsule.end2 - origin) / unit, capsule.radius1 / unit,
               capsule.radius2 / unit};
  }
  for (Vec3* p : {&a, &b, &c}) *p = (*p - origin) / unit;
  double radius = 0;
  Vec3 low = finger[0].end1, high = low;
  for (const ReferenceCapsule& capsule : finger) {
    radius = std::fmax(radius, std::fmax(capsule.radius1, capsule.radius2));
    for (const Vec3 p : {capsule.end1, capsule.end2}) {
      low = {std::fmin(low.x, p.x), std::fmin(low.y, p.y), std::fmin(low.z, p.z)};
      high = {std::fmax(high.x, p.x), std::fmax(high.y, p.y), std::fmax(high.z, p.z)};
    }
  }
  const Vec3 middle = 0.5 * (low + high);
  const double reach = 0.5 * norm(high - low) + radius;
  const Vec3 n = unit_or(cross(b - a, c - a), {});
  Plane plane{middle - dot(middle - a, n) * n, unit_or(b - a, {}), {}};
  plane.v = cross(n, plane.u);
  double x[3], y[3];
  const Vec3 corner[3] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    x[i] = dot(corner[i] - plane.origin, plane.u);
    y[i] = dot(corner[i] - plane.origin, plane.v);
  }
  const auto line = [&](double at) {
    double bottom = 1e300, top = -1e300;
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;
      if ((x[i] < at) == (x[k] < at)) continue;
      const double cut = y[i] + (at - x[i]) / (x[k] - x[i]) * (y[k] - y[i]);
      bottom = std::fmin(bottom, cut);
      top = std::fmax(top, cut);
    }
    bottom = std::fmax(bottom, -reach);
    top = std::fmin(top, reach);
    return bottom < top ? along_line(finger, plane, at, bottom, top) : Sums{};
  };
  std::vector<double> ends = {x[0], x[1], x[2]};
  for (int i = -16; i <= 16; ++i) ends.push_back(reach * i / 16);
  // Where the phalanges begin and end.
  for (const ReferenceCapsule& capsule : finger) {
    const auto highest = [&](double at) {
      const double top = peak_on_line(capsule, plane, at, -reach, reach);
      return nearest_of(capsule, plane.origin + at * plane.u + top * plane.v).field;
    };
    const double peak = peak_of(highest, -reach, reach);
    if (!(highest(peak) > 0)) continue;
    for (const double side : {-reach, reach}) {
      double inside = peak, outside = side;
      for (int i = 0; i < 50; ++i) {
        const double half = 0.5 * (inside + outside);
        (highest(half) > 0 ? inside : outside) = half;
      }
      ends.push_back(inside);
    }
  }
  // Where edges run into phalanges.
  for (const ReferenceCapsule& capsule : finger) {
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;
      const auto along = [&](double t) {
        return nearest_of(capsule, corner[i] + t * (corner[k] - corner[i])).field;
      };
      const double peak = peak_of(along, 0, 1);
      for (const double side : {0.0, 1.0}) {
        if (!(along(peak) > 0) || along(side) > 0) continue;
        double inside = peak, outside = side;
        for (int step = 0; step < 60; ++step) {
          const double half = 0.5 * (inside + outside);
          (along(half) > 0 ? inside : outside) = half;
        }
        ends.push_back(x[i] + inside * (x[k] - x[i]));
      }
    }
  }
  std::sort(ends.begin(), ends.end());
  Sums sum;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (ends[i] < -reach || ends[i + 1] > reach || ends[i] == ends[i + 1]) continue;
    sum += integrate(line, ends[i], ends[i + 1], 1e-12, both_rules(line, ends[i], ends[i + 1]));
  }
  FingerReference result;
  const double square = unit * unit, cube = square * unit;
  result.area = square * sum.of[0];
  result.volume = cube * sum.of[3];
  const Vec3 shift = plane.origin - a;
  result.area_first = cube * (sum.of[0] * shift + sum.of[1] * plane.u + sum.of[2] * plane.v);
  result.first = cube * unit * (sum.of[3] * shift + sum.of[4] * plane.u + sum.of[5] * plane.v);
  return result;
}

}  // namespace lumbrical::test
