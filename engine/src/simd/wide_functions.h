// Elementary functions of wide numbers, for kernels.
#pragma once

#include "simd/wide.h"

namespace lumbrical::LUMBRICAL_ISA {

using wide::abs;
using wide::any;
using wide::clamp;
using wide::divide;
using wide::get;
using wide::is_not;
using wide::max;
using wide::min;
using wide::put;
using wide::select;
using wide::sqrt;

template <class V>
using NumberOf = typename wide::Lanes<V>::Number;

// The number c in the type of V.
template <class V>
inline V number(double c) {
  return V(static_cast<NumberOf<V>>(c));
}

template <class V, std::size_t N>
inline V horner(const double (&coefficient)[N], V z) {
  V sum = number<V>(coefficient[N - 1]);
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * z + number<V>(coefficient[i]);
  return sum;
}

// Near-minimax over t <= tan(pi / 8): atan t = t + t z P(z), z = t^2; error 5e-18.
inline constexpr double kArcTangent[] = {
    -0.333333333333333302,  0.199999999999955165,  -0.142857142846656808, 0.111111110151870187,
    -0.0909090457530648908, 0.0769218312537689209, -0.066645105255089366, 0.0585814090486632828,
    -0.0508540783458948426, 0.0392304477847930952, -0.0191754047111049337};
// Near-minimax over s <= (sqrt 2 - 1) / (sqrt 2 + 1): atanh s = s + s z P(z); error 4e-18.
inline constexpr double kArcTangentHyperbolic[] = {
    0.333333333333333484,  0.199999999999497216,  0.142857143130016344, 0.111111055651299385,
    0.0909144472783747302, 0.0766585530910538578, 0.0730829271244431099};
inline constexpr double kQuarterPi = 0.78539816339744830962, kHalfPi = 1.57079632679489661923;
inline constexpr double kPi = 3.14159265358979323846, kLn2 = 0.69314718055994530942;

// Angle of the point (x, y) in [-pi, pi]; 0 at the origin. Error a few ulp of pi.
template <class V>
inline V angle_of(V y, V x) {
  const V zero = number<V>(0);
  const V ax = abs(x), ay = abs(y);
  const V low = min(ax, ay), high = max(ax, ay);
  const auto steep = low > number<V>(0.41421356237309503) * high;
  const V numerator = select(steep, low - high, low);
  const V denominator = select(steep, low + high, high);
  const V t = divide(numerator, select(denominator > zero, denominator, number<V>(1)));
  const V z = t * t;
  V angle = t + t * (z * horner(kArcTangent, z));
  angle = angle + select(steep, number<V>(kQuarterPi), zero);
  angle = select(ay > ax, number<V>(kHalfPi) - angle, angle);
  angle = select(x < zero, number<V>(kPi) - angle, angle);
  return select(y < zero, zero - angle, angle);
}

// 2 atanh(difference / sum) for 0 <= difference <= sum: the logarithm of top / rest, from which powers of two
// are taken before it is divided. Where the quotient is nearer to 1 than 1e-20 the value is capped: its
// factors are that small there.
template <class V>
inline V twice_atanh(V difference, V sum) {
  const V one = number<V>(1), zero = number<V>(0);
  const V least = max(sum - difference, number<V>(1e-20) * sum);
  const V rest = select(least > zero, least, one);
  V top = sum + difference, logarithm = zero;
  constexpr double kStep[] = {18446744073709551616.0, 4294967296.0, 65536, 256, 16, 4, 2};
  constexpr double kBits[] = {64, 32, 16, 8, 4, 2, 1};
  // The larger steps are seldom anybody's, and often none is.
  const auto from = [&](double step) { return any(top >= number<V>(step) * rest); };
  for (std::size_t i = from(256) ? 0 : from(2) ? 4 : 7; i < 7; ++i) {
    const auto large = top >= number<V>(kStep[i]) * rest;
    top = select(large, top * number<V>(1 / kStep[i]), top);
    logarithm = logarithm + select(large, number<V>(kBits[i] * kLn2), zero);
  }
  const auto upper = top > number<V>(1.4142135623730951) * rest;
  top = select(upper, top * number<V>(0.5), top);
  logarithm = logarithm + select(upper, number<V>(kLn2), zero);
  const auto small = logarithm == zero;
  const V s =
      divide(select(small, difference, top - rest), select(small, select(sum > zero, sum, one), top + rest));
  const V z = s * s;
  const V tail = s + s * (z * horner(kArcTangentHyperbolic, z));
  return logarithm + (tail + tail);
}

}  // namespace lumbrical::LUMBRICAL_ISA
