// The integral of a function over that part of a triangle in which it and others are positive, each as the
// quadratic polynomial through its values at the corners and the middles of the edges. Where one border runs
// from edge to edge, a straight one costs no error; others are for who calls to halve away.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "base/gauss.h"
#include "section/section.h"

namespace lumbrical {

/// What a triangle's six points are told by: its corners, and the middles of the edges across from each.
template <class T>
using SixPoints = std::array<T, 6>;

inline constexpr std::size_t kMostConditions = 3;

/// c + b x + a x^2.
struct Quadratic {
  double c, b, a;
  [[nodiscard]] double at(double x) const { return c + x * (b + x * a); }
};

/// Numbers of [0, 1] in ascending order, 0 and 1 among them.
struct Cuts {
  std::array<double, 2 * kMostConditions + 2> at{0, 1};
  std::size_t count = 2;

  void add_roots(const Quadratic& f) {
    const auto [c, b, a] = f;
    const double square = b * b - 4 * a * c;
    if (!(square >= 0)) return;
    const double q = -0.5 * (b + std::copysign(std::sqrt(square), b));
    for (const double root : {q / a, c / q}) {
      if (root > 0 && root < 1) at[count++] = root;
    }
  }
  void sort() {
    for (std::size_t k = 1; k < count; ++k) {
      for (std::size_t i = k; i > 0 && at[i] < at[i - 1]; --i) std::swap(at[i], at[i - 1]);
    }
  }
};

/// A quadratic polynomial on the rays from a corner to the points of the edge across, at t of [0, 1]:
/// f = apex + r slope(t) + r^2 bend(t), r = 1 on the edge.
struct OnRays {
  double apex, slope[2], bend[3];

  [[nodiscard]] Quadratic along(double t) const {
    return {apex, slope[0] + t * (slope[1] - slope[0]),
            (1 - t) * (1 - t) * bend[0] + t * (1 - t) * bend[2] + t * t * bend[1]};
  }
  /// On the edge itself.
  [[nodiscard]] Quadratic across() const {
    return {apex + slope[0] + bend[0], slope[1] - slope[0] + bend[2] - 2 * bend[0],
            bend[0] - bend[2] + bend[1]};
  }
};

/// From its values at the six points.
inline OnRays on_rays(const SixPoints<double>& f, std::size_t corner) {
  const std::size_t next = (corner + 1) % 3, last = (corner + 2) % 3;
  OnRays rays{f[corner], {}, {}};
  const double at[2] = {f[next], f[last]}, half[2] = {f[3 + last], f[3 + next]};
  for (std::size_t k = 0; k < 2; ++k) {
    rays.slope[k] = 4 * half[k] - 3 * rays.apex - at[k];
    rays.bend[k] = 2 * (rays.apex - 2 * half[k] + at[k]);
  }
  rays.bend[2] =
      4 * (f[3 + corner] - rays.apex) - 2 * (rays.slope[0] + rays.slope[1]) - (rays.bend[0] + rays.bend[1]);
  return rays;
}

inline OnRays negative(const OnRays& f) {
  return {-f.apex, {-f.slope[0], -f.slope[1]}, {-f.bend[0], -f.bend[1], -f.bend[2]}};
}

/// A function's integrals of r dr and r^2 dr on a ray, over [0, 1] where all of the conditions are positive.
struct RayMoments {
  double zeroth = 0, first = 0;
};
inline RayMoments moments_on_ray(const OnRays& f, std::span<const OnRays> conditions, double t) {
  Cuts cuts;
  std::array<Quadratic, kMostConditions> of_ray;
  for (std::size_t n = 0; n < conditions.size(); ++n) cuts.add_roots(of_ray[n] = conditions[n].along(t));
  cuts.sort();
  const auto [c, b, a] = f.along(t);
  const auto zeroth = [c = c, b = b, a = a](double r) { return r * r * (c / 2 + r * (b / 3 + r * a / 4)); };
  const auto first = [c = c, b = b, a = a](double r) {
    return r * r * r * (c / 3 + r * (b / 4 + r * a / 5));
  };
  RayMoments sum;
  for (std::size_t k = 0; k + 1 < cuts.count; ++k) {
    const double low = cuts.at[k], high = cuts.at[k + 1];
    const auto is_positive = [x = 0.5 * (low + high)](const Quadratic& of) { return of.at(x) > 0; };
    if (!std::all_of(of_ray.begin(), of_ray.begin() + static_cast<std::ptrdiff_t>(conditions.size()),
                     is_positive))
      continue;
    sum.zeroth += zeroth(high) - zeroth(low);
    sum.first += first(high) - first(low);
  }
  return sum;
}

/// A triangle seen from one of its corners.
struct Fan {
  Point2 apex, from, to;
  double area;
};

/// A function's integral over a triangle where all of the conditions are positive. The rays are those to the
/// points of a line, at equal weights: it begins a share `first` down the side to `from`, ends a share `last`
/// down the other one, and is cut at `line`. What lies up to it, or the whole triangle, is integrated
/// exactly.
inline PlaneMoments integral_on_rays(const Fan& fan, const OnRays& f, std::span<const OnRays> conditions,
                                     const Cuts& line, double first = 1, double last = 1) {
  PlaneMoments sum;
  for (std::size_t k = 0; k + 1 < line.count; ++k) {
    const double begin = line.at[k], width = line.at[k + 1] - begin;
    for (const auto [at, weight] : kGauss3) {
      const double s = begin + at * width, r = first + s * (last - first), t = last * s / r;
      const double share = 2 * fan.area * width * weight * (first / r) * (last / r);
      const RayMoments ray = moments_on_ray(f, conditions, t);
      const Point2 edge = fan.from + t * (fan.to - fan.from);
      sum.volume += share * ray.zeroth;
      sum.first = sum.first + share * (ray.zeroth * fan.apex + ray.first * (edge - fan.apex));
    }
  }
  return sum;
}

/// Whether a function has the other sign at a corner than across from it.
inline bool is_odd(const SixPoints<double>& f, std::size_t corner) {
  const bool in = f[corner] > 0;
  return (f[(corner + 1) % 3] > 0) != in && (f[(corner + 2) % 3] > 0) != in && (f[3 + corner] > 0) != in;
}

/// A function's integral where another one is positive, which is 0 on a line across, round `corner`.
inline PlaneMoments integral_round_corner(const Fan& fan, const OnRays& f, OnRays other) {
  const bool inside = other.apex > 0;
  if (!inside) other = negative(other);
  const auto place = [&](double t) {
    Cuts cuts;
    cuts.add_roots(other.along(t));
    cuts.sort();
    return cuts.at[1];
  };
  const PlaneMoments round = integral_on_rays(fan, f, std::span(&other, 1), {}, place(0), place(1));
  if (inside) return round;
  const PlaneMoments whole = integral_on_rays(fan, f, {}, {});
  return {whole.volume - round.volume, whole.first - round.first};
}

/// The integral of the first of the functions [m] where all are positive, over a triangle of that area [m^2].
template <std::size_t N>
PlaneMoments integral_where_positive(const SixPoints<Point2>& place, double area,
                                     const std::array<SixPoints<double>, N>& functions) {
  static_assert(N <= kMostConditions);
  std::size_t cut = 0, cut_count = 0;
  for (std::size_t n = 0; n < N; ++n) {
    const auto is_positive = [](double value) { return value > 0; };
    const auto positive = std::count_if(functions[n].begin(), functions[n].end(), is_positive);
    if (positive == 0) return {};
    if (positive == 6) continue;
    cut = n;
    ++cut_count;
  }
  std::size_t corner = 0;
  while (cut_count == 1 && corner < 3 && !is_odd(functions[cut], corner)) ++corner;
  const bool is_round_corner = cut_count == 1 && corner < 3;
  if (!is_round_corner) corner = 0;
  const Fan fan{place[corner], place[(corner + 1) % 3], place[(corner + 2) % 3], area};
  std::array<OnRays, N> rays;
  for (std::size_t n = 0; n < N; ++n) rays[n] = on_rays(functions[n], corner);
  if (cut_count == 0) return integral_on_rays(fan, rays[0], {}, {});
  if (is_round_corner) return integral_round_corner(fan, rays[0], rays[cut]);
  Cuts edge;
  for (const OnRays& f : rays) edge.add_roots(f.across());
  edge.sort();
  return integral_on_rays(fan, rays[0], rays, edge);
}

}  // namespace lumbrical
