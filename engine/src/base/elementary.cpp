// Argument reduction and plain power series: slower than tables, short, and easy to trust.
#include "base/elementary.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace lumbrical {
namespace {

constexpr double kHalfPi = 1.5707963267948966;
constexpr double kHalfPiTail = 6.123233995736766e-17;  // pi/2 - kHalfPi
constexpr double kLn2 = 0.6931471805599453;
constexpr double kLn2Tail = 2.3190468138462996e-17;

// pi/2 in three parts of 33, 33 and 53 bits: k times the first two is exact for |k| < 2^20.
constexpr double kHalfPi1 = 1.57079632673412561417e+00;
constexpr double kHalfPi2 = 6.07710050630396597660e-11;
constexpr double kHalfPi3 = 2.02226624879595063154e-21;

// Coefficients of the power series below, from the highest term down to the second; the first is always 1.
template <int N>
using Coefficients = std::array<double, N>;

constexpr double factorial(int n) { return n < 2 ? 1.0 : n * factorial(n - 1); }

// sin r = r + r sum_k c_k z^k and cos r = 1 + sum_k c_k z^k with z = r^2, k = N .. 1.
template <int N>
constexpr Coefficients<N> circular(int offset) {
  Coefficients<N> c{};
  for (int i = 0; i < N; ++i) {
    const int k = N - i;
    c[static_cast<std::size_t>(i)] = (k % 2 == 0 ? 1.0 : -1.0) / factorial(2 * k + offset);
  }
  return c;
}

// atanh s = s + s sum_k z^k / (2 k + 1); with alternating signs atan s.
template <int N>
constexpr Coefficients<N> odd_reciprocals(double sign) {
  Coefficients<N> c{};
  for (int i = 0; i < N; ++i) {
    const int k = N - i;
    c[static_cast<std::size_t>(i)] = (k % 2 == 0 ? 1.0 : sign) / (2 * k + 1);
  }
  return c;
}

constexpr auto kSine = circular<10>(1);
constexpr auto kCosine = circular<11>(0);
constexpr auto kArcTangent = odd_reciprocals<12>(-1);
constexpr auto kArcTangentHyperbolic = odd_reciprocals<11>(1);

// sum_k c_k z^k, k >= 1.
template <std::size_t N>
double series(const std::array<double, N>& c, double z) {
  double sum = 0;
  for (const double coefficient : c) sum = (sum + coefficient) * z;
  return sum;
}

// 2 atanh(s) for |s| <= 0.172.
double twice_atanh(double s) { return 2.0 * s + 2.0 * s * series(kArcTangentHyperbolic, s * s); }

// x less a multiple of pi/2, and which one modulo four.
struct Reduced {
  double r;
  int quadrant;
};

Reduced reduce(double x) {
  if (std::fabs(x) < 0.75) return {x, 0};  // spares the common case a quotient
  if (!(std::fabs(x) <= 1e5)) return {0, 0};
  const double k = std::floor(x / kHalfPi + 0.5);
  return {((x - k * kHalfPi1) - k * kHalfPi2) - k * kHalfPi3,
          static_cast<int>(static_cast<std::int64_t>(k) & 3)};
}

SinCos in_quadrant(int quadrant, double s, double c) {
  switch (quadrant) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

// N at a time: each step of a series waits for the last one, but not for its neighbours'.
template <std::size_t N>
void sin_cos_of(const double* x, SinCos* result) {
  Reduced from[N];
  double z[N], sine[N], cosine[N];
  for (std::size_t i = 0; i < N; ++i) {
    from[i] = reduce(x[i]);
    z[i] = from[i].r * from[i].r;
    sine[i] = 0;
    cosine[i] = kCosine[0] * z[i];
  }
  for (std::size_t k = 0; k < kSine.size(); ++k) {
    for (std::size_t i = 0; i < N; ++i) {
      sine[i] = (sine[i] + kSine[k]) * z[i];
      cosine[i] = (cosine[i] + kCosine[k + 1]) * z[i];
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    const auto [r, quadrant] = from[i];
    result[i] = in_quadrant(quadrant, r + r * sine[i], 1.0 + cosine[i]);
  }
}

}  // namespace

SinCos sin_cos(double x) {
  SinCos result;
  sin_cos_of<1>(&x, &result);
  return result;
}

void sin_cos(std::span<const double> x, std::span<SinCos> result) {
  constexpr std::size_t kWide = 20;  // a hand's angles at once
  std::size_t i = 0;
  for (; i + kWide <= x.size(); i += kWide) sin_cos_of<kWide>(&x[i], &result[i]);
  for (; i < x.size(); ++i) sin_cos_of<1>(&x[i], &result[i]);
}

double arc_tan(double x) {
  if (x != x) return 0;
  const double a = std::fabs(x);
  const double reciprocal = a > 1 ? 1 / a : a;
  // Two half-angle steps bring [0, 1] to [0, 0.2].
  const double h = reciprocal / (1 + std::sqrt(1 + reciprocal * reciprocal));
  const double q = h / (1 + std::sqrt(1 + h * h));
  const double small = 4 * (q + q * series(kArcTangent, q * q));
  const double angle = a > 1 ? (kHalfPi - small) + kHalfPiTail : small;
  return x < 0 ? -angle : angle;
}

double arc_tan2(double y, double x) {
  if (x == 0 && y == 0) return 0;
  if (std::fabs(y) > std::fabs(x)) {
    const double angle = kHalfPi - arc_tan(x / std::fabs(y));
    return y < 0 ? -angle : angle;
  }
  const double angle = arc_tan(y / x);
  if (x > 0) return angle;
  return y < 0 ? angle - 2 * kHalfPi : angle + 2 * kHalfPi;
}

double log_1p(double x) {
  if (x > -0.29 && x < 0.41) return twice_atanh(x / (2 + x));
  const double y = 1 + x;
  if (!(y > 0)) return -std::numeric_limits<double>::infinity();
  if (!(y < std::numeric_limits<double>::infinity())) return y;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(y);
  int exponent = static_cast<int>(bits >> 52) - 1023;
  double mantissa = std::bit_cast<double>((bits & 0x000fffffffffffffu) | 0x3ff0000000000000u);
  if (mantissa > 1.4142135623730951) {
    mantissa *= 0.5;
    exponent += 1;
  }
  const double tail = ((1 - y) + x) / y;  // what rounding 1 + x lost
  return exponent * kLn2 + (twice_atanh((mantissa - 1) / (mantissa + 1)) + (exponent * kLn2Tail + tail));
}

double arc_sinh(double x) {
  const double a = std::fabs(x);
  const double r = a < 1e8 ? log_1p(a + a * a / (1 + std::sqrt(1 + a * a))) : log_1p(2 * a);
  return x < 0 ? -r : r;
}

}  // namespace lumbrical
