// The engine's own elementary functions against the long double ones of the C library.
#include "base/elementary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "largest.h"
#include "random.h"

namespace lumbrical {
namespace {

double ulps(double value, long double exact) {
  const double rounded = std::fabs(static_cast<double>(exact));
  const double ulp = std::nextafter(rounded, std::numeric_limits<double>::infinity()) - rounded;
  return static_cast<double>(std::fabs(value - exact)) / ulp;
}

double worst(const std::function<double(double)>& error) {
  test::Random random(1);
  double result = 0;
  for (int i = 0; i < 200000; ++i) {
    const double x = random.between(-1, 1) * std::pow(10.0, random.between(-5, 5));
    result = test::largest(result, error(x));
  }
  return result;
}

TEST(Elementary, SineAndCosineAreWithinTwoUlpOfOne) {
  const auto error = [](double x) {
    const SinCos value = sin_cos(x);
    const long double exact = x;
    return test::largest(static_cast<double>(std::fabs(value.sin - std::sin(exact))),
                         static_cast<double>(std::fabs(value.cos - std::cos(exact)))) /
           std::numeric_limits<double>::epsilon();
  };
  EXPECT_LE(worst(error), 2);
}

TEST(Elementary, SinesOfManyAnglesHaveTheBitsOfSingleOnes) {
  test::Random random(3);
  for (std::size_t count = 0; count < 12; ++count) {
    std::vector<double> x(count);
    for (double& angle : x) angle = random.between(-1, 1) * std::pow(10.0, random.between(-5, 6));
    std::vector<SinCos> many(count);
    sin_cos(x, many);
    for (std::size_t i = 0; i < count; ++i) {
      const SinCos one = sin_cos(x[i]);
      EXPECT_EQ(many[i].sin, one.sin) << x[i];
      EXPECT_EQ(many[i].cos, one.cos) << x[i];
    }
  }
}

TEST(Elementary, ArcTangentIsWithinFiveUlp) {
  EXPECT_LE(worst([](double x) { return ulps(arc_tan(x), std::atan(static_cast<long double>(x))); }), 5);
}

TEST(Elementary, ArcTangentOfTwoIsRightInAllQuadrants) {
  test::Random random(2);
  double result = 0;
  for (int i = 0; i < 200000; ++i) {
    const double x = random.between(-1, 1) * std::pow(10.0, random.between(-5, 5)), y = random.between(-1, 1);
    result = test::largest(
        result, ulps(arc_tan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x))));
  }
  EXPECT_LE(result, 4);
  EXPECT_EQ(arc_tan2(0, 0), 0);
}

TEST(Elementary, LogarithmIsWithinFourUlpAlsoNearOne) {
  const auto error = [](double x) {
    const double argument = x < 0 ? x / (1 - x) : x;  // into (-1, infinity)
    return ulps(log_1p(argument), std::log1p(static_cast<long double>(argument)));
  };
  EXPECT_LE(worst(error), 4);
}

TEST(Elementary, InverseHyperbolicSineIsWithinSixUlp) {
  EXPECT_LE(worst([](double x) { return ulps(arc_sinh(x), std::asinh(static_cast<long double>(x))); }), 6);
}

TEST(Elementary, NothingTurnsIntoNaN) {
  const double infinity = std::numeric_limits<double>::infinity(),
               nan = std::numeric_limits<double>::quiet_NaN();
  for (const double x : {infinity, -infinity, nan}) {
    EXPECT_TRUE(std::isfinite(sin_cos(x).sin));
    EXPECT_TRUE(std::isfinite(arc_tan(x)));
  }
}

}  // namespace
}  // namespace lumbrical
