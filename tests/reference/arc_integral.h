// Integrals of square roots of quadratics over an interval, as the trapezoid under the chord and what the
// curve bulges over it.
//
// Put f = sqrt(Q) at both ends, w the width, Q'' = 2 a and v = -a w^2 / (f1 + f2)^2: after scaling the conic
// to a circle, sqrt(v) is the tangent of half the angle the arc spans. The circular segment then has
//   area    w k P(v) / (4 (f1 + f2)),                               k = (f2 - f1)^2 - a w^2
//   moment  -k (f2 - f1) (w / (f1 + f2))^2 W(v) / 8                  about the middle of the interval
// with P(v) = ((1 + v) arctan(sqrt v) / sqrt v - 1) / v = 2/3 - v W(v). All holds for hyperbolas (v < 0) too.
#pragma once

#include <array>
#include <cmath>
#include <limits>

namespace lumbrical::reference {

/// Integral of f - chord, and of (x - middle) times it.
template <class T>
struct Bulge {
  T area{}, moment{};
};

template <class T>
struct SegmentShape {
  T p, w;
};

/// W(v) = sum of 2 (-v)^k / ((2 k + 3) (2 k + 5)), for |v| <= 1/4.
template <class T>
T segment_series(const T& v) {
  constexpr int kTerms = std::numeric_limits<T>::digits / 2 + 2;
  static const auto coefficients = [] {
    std::array<T, kTerms> list;
    for (int k = 0; k < kTerms; ++k) list[k] = T(k % 2 == 0 ? 2 : -2) / ((2 * k + 3) * (2 * k + 5));
    return list;
  }();
  // Each term is below the one before by v: so many bits.
  const double bits = -std::log2(std::fabs(static_cast<double>(v)) + 1e-300);
  int terms = static_cast<int>(std::numeric_limits<T>::digits / bits) + 2;
  if (terms > kTerms) terms = kTerms;
  T sum{};
  for (int k = terms; k-- > 0;) sum = sum * v + coefficients[k];
  return sum;
}

template <class T>
SegmentShape<T> segment_shape(const T& v) {
  using std::atan;
  using std::log;
  using std::sqrt;
  if (v > -T(1) / 4 && v < T(1) / 4) {
    const T w = segment_series(v);
    return {T(2) / 3 - v * w, w};
  }
  const T root = sqrt(v < 0 ? T(-v) : v);
  T p{};
  if (v > 0) {
    p = ((1 + v) * atan(root) / root - 1) / v;
  } else {
    // (1 + v) log((1 + root) / (1 - root)): nothing is left of it where the hyperbola is its own asymptotes.
    const T close = 1 - root;
    p = ((close > 0 ? close * (1 + root) * log((1 + root) / close) / (2 * root) : T(0)) - 1) / v;
  }
  return {p, (T(2) / 3 - p) / v};
}

/// Of f = sqrt(l^2 + d), where l goes from l1 to l2, both of one sign, over an interval of width w > 0 —
/// divided by d, which may be of either sign or 0.
template <class T>
Bulge<T> hyperbola_bulge_over_d(const T& l1, const T& l2, const T& d, const T& w) {
  using std::sqrt;
  const T q1 = l1 * l1 + d, q2 = l2 * l2 + d;
  const T f1 = q1 > 0 ? sqrt(q1) : T(0), f2 = q2 > 0 ? sqrt(q2) : T(0), sum = f1 + f2;
  const T product = f1 * f2 + l1 * l2;
  if (!(sum > 0) || !(product > 0)) return {};
  const T ratio = (l2 - l1) / sum, v = -ratio * ratio;
  const T k_over_d = 2 * v * (1 + (l1 * l1 + l2 * l2 + d) / product);
  const SegmentShape<T> shape = segment_shape(v < -1 ? T(-1) : v);
  const T rise = ratio * (l1 + l2), slim = w / sum;
  return {slim * k_over_d * shape.p / 4, -rise * k_over_d * slim * slim * shape.w / 8};
}

/// Of f = sqrt(square - x^2) for x1 < x2 of one sign.
template <class T>
Bulge<T> circle_bulge(const T& x1, const T& x2, const T& square) {
  using std::sqrt;
  const T q1 = square - x1 * x1, q2 = square - x2 * x2;
  const T sum = (q1 > 0 ? sqrt(q1) : T(0)) + (q2 > 0 ? sqrt(q2) : T(0));
  if (!(sum > 0)) return {};
  const T w = x2 - x1, ratio = w / sum, rise = -ratio * (x1 + x2), k = w * w + rise * rise;
  const SegmentShape<T> shape = segment_shape(T(ratio * ratio));
  return {ratio * k * shape.p / 4, -rise * k * ratio * ratio * shape.w / 8};
}

}  // namespace lumbrical::reference
