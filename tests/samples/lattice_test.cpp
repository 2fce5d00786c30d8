// A cell of a lattice against direct integration: what of linear functions is above a floor, and shares of
// them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "random.h"

#define LUMBRICAL_ISA scalar
#include "samples/block_kernels.h"

namespace lumbrical::test {
namespace {

using scalar::LatticeMoments;

// Moments of max(f, 0) over the triangle (0, 0), (1, 0), (0, 1), as means: by cutting it at f = 0.
struct Means {
  double sum = 0, u = 0, v = 0, share = 0;
};
struct Corner {
  double u, v, f;
};
Corner crossing(const Corner& p, const Corner& q) {
  const double t = p.f / (p.f - q.f);
  return {p.u + t * (q.u - p.u), p.v + t * (q.v - p.v), 0};
}
std::vector<Corner> positive_polygon(double a, double b, double c) {
  const Corner corners[] = {{0, 0, a}, {1, 0, b}, {0, 1, c}};
  std::vector<Corner> polygon;
  for (std::size_t i = 0; i < 3; ++i) {
    const Corner &p = corners[i], &q = corners[(i + 1) % 3];
    if (p.f >= 0) polygon.push_back(p);
    if ((p.f > 0 && q.f < 0) || (p.f < 0 && q.f > 0)) polygon.push_back(crossing(p, q));
  }
  return polygon;
}
Means means_of(const std::vector<Corner>& polygon) {
  Means means;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Corner p[] = {polygon[0], polygon[i - 1], polygon[i]};
    const double area =
        (p[1].u - p[0].u) * (p[2].v - p[0].v) - (p[1].v - p[0].v) * (p[2].u - p[0].u);  // of the whole's
    const double f = p[0].f + p[1].f + p[2].f, u = p[0].u + p[1].u + p[2].u, v = p[0].v + p[1].v + p[2].v;
    means.share += area;
    means.sum += area * f / 3;
    means.u += area * (f * u + p[0].f * p[0].u + p[1].f * p[1].u + p[2].f * p[2].u) / 12;
    means.v += area * (f * v + p[0].f * p[0].v + p[1].f * p[1].v + p[2].f * p[2].v) / 12;
  }
  return means;
}
Means means_of_positive(double a, double b, double c) { return means_of(positive_polygon(a, b, c)); }

// Every pattern of signs and zeros, with values of any size.
template <class Take>
void for_corner_values(const Take& take) {
  Random random(3);
  for (int a = -1; a <= 1; ++a) {
    for (int b = -1; b <= 1; ++b) {
      for (int c = -1; c <= 1; ++c) {
        for (int round = 0; round < 200; ++round) {
          const auto value = [&](int sign) {
            return static_cast<float>(sign * std::exp(random.between(round < 100 ? -0.5 : -20.0, 0)));
          };
          const float fa = value(a), fb = value(b), fc = value(c);
          take(fa, fb, fc);
        }
      }
    }
  }
}

// Of a linear function over the square from -1 to 1, which falls into two triangles.
TEST(PositiveInSquare, HasMeanShareAndMomentsOfALinearFunction) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::pow(10, random.between(-6, 0)), angle = random.between(-4, 4);
    const double rise[2] = {size * std::cos(angle), size * std::sin(angle)},
                 mean = size * random.between(-2, 2);
    const auto f = [&](double s, double t) { return mean + rise[0] * s + rise[1] * t; };
    const Means lower = means_of_positive(f(-1, -1), f(1, -1), f(-1, 1)),
                upper = means_of_positive(f(1, 1), f(-1, 1), f(1, -1));
    const double sum = 0.5 * (lower.sum + upper.sum);
    // A triangle's corner is at -1 or 1, and u and v lead away from there.
    const double along[2] = {(lower.u - 0.5 * lower.sum) - (upper.u - 0.5 * upper.sum),
                             (lower.v - 0.5 * lower.sum) - (upper.v - 0.5 * upper.sum)};
    const auto in = scalar::positive_in_square(static_cast<float>(mean), static_cast<float>(rise[0]),
                                               static_cast<float>(rise[1]));
    // Where a rise is below a fiftieth of both it counts as that.
    const double least = min(std::abs(rise[0]), std::abs(rise[1]));
    const bool is_plain = least > 0.02 * (std::abs(rise[0]) + std::abs(rise[1]));
    EXPECT_NEAR(in.mean, sum, (is_plain ? 1e-5 : 1e-4) * size) << i;
    EXPECT_NEAR(in.share, 0.5 * (lower.share + upper.share), is_plain ? 2e-5 : 0.01) << i;
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_NEAR(in.along[k], along[k], (is_plain ? 5e-4 : 0.01) * size) << i;
  }
}

TEST(PositiveInSquare, OfAConstantIsTheConstant) {
  for (const float mean : {-1.0f, 0.0f, 1e-3f, 2.0f}) {
    const auto in = scalar::positive_in_square(mean, 0.0f, 0.0f);
    EXPECT_NEAR(in.mean, std::max(mean, 0.0f), 1e-30);
    EXPECT_NEAR(in.along[0], 0, 1e-30);
    EXPECT_NEAR(in.along[1], 0, 1e-30);
  }
}

TEST(Lattice, PositivePartOfALinearFunctionIsExact) {
  for_corner_values([](float a, float b, float c) {
    const Means means = means_of_positive(a, b, c);
    const auto [mean, share] = scalar::part_above(0.0f, a, b, c, (a + b + c) / 3);
    const double size = std::max({std::fabs(a), std::fabs(b), std::fabs(c)});
    EXPECT_NEAR(mean, means.sum, 3e-7 * size) << a << " " << b << " " << c;
    if (size > 0 && (a != 0 || b != 0 || c != 0)) {
      // Where the function vanishes on a whole edge or corner either share is one of a neighbouring pose.
      EXPECT_GE(share, 0) << a << " " << b << " " << c;
      EXPECT_LE(share, 1) << a << " " << b << " " << c;
      if (a * b * c != 0) {
        EXPECT_NEAR(share, means.share, 2e-6) << a << " " << b << " " << c;
      }
    }
  });
}

TEST(Lattice, MomentsOfALinearFunctionsPositivePartAreExact) {
  for_corner_values([](float a, float b, float c) {
    const Means means = means_of_positive(a, b, c);
    const LatticeMoments<float> m = scalar::linear_moments(a, b, c);
    const double size = std::max({std::fabs(a), std::fabs(b), std::fabs(c)});
    EXPECT_NEAR(m.sum, means.sum, 3e-7 * size) << a << " " << b << " " << c;
    EXPECT_NEAR(m.u, means.u, 3e-7 * size) << a << " " << b << " " << c;
    EXPECT_NEAR(m.v, means.v, 3e-7 * size) << a << " " << b << " " << c;
  });
}

TEST(Lattice, PartAboveAFloorIsThePositivePartOfWhatIsAbove) {
  for_corner_values([](float a, float b, float c) {
    const float floor = 0.3f;
    const Means means = means_of_positive(a - floor, b - floor, c - floor);
    const auto [mean, share] = scalar::part_above(floor, a, b, c, (a + b + c) / 3);
    EXPECT_NEAR(mean, means.sum, 3e-7) << a << " " << b << " " << c;
    EXPECT_NEAR(share, means.share, 1e-4) << a << " " << b << " " << c;
  });
}

// The mean of f's positive part where another linear function is positive.
double mean_where_positive(double a, double b, double c, const std::array<double, 3>& f) {
  const auto value = [&](const Corner& p) { return f[0] + p.u * (f[1] - f[0]) + p.v * (f[2] - f[0]); };
  const std::vector<Corner> polygon = positive_polygon(a, b, c);
  double mean = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Corner &p = polygon[0], &q = polygon[i - 1], &r = polygon[i];
    const double area = (q.u - p.u) * (r.v - p.v) - (q.v - p.v) * (r.u - p.u);
    mean += area * means_of_positive(value(p), value(q), value(r)).sum;
  }
  return mean;
}

TEST(Lattice, ShareOfAPartAboveAFloorIsExactWhereBothFunctionsCrossACell) {
  Random random(10);
  for_corner_values([&](float a, float b, float c) {
    if (a * b * c == 0) return;
    const float floor = 0.1f;
    std::array<float, 3> f;
    for (float& at : f) at = static_cast<float>(random.between(-1, 1));
    const float above = scalar::part_above(floor, f[0], f[1], f[2], (f[0] + f[1] + f[2]) / 3).mean;
    const double expected = mean_where_positive(a, b, c, {f[0] - floor, f[1] - floor, f[2] - floor});
    const scalar::CutCorner<float> cut(a, b, c);
    const float off = scalar::share_cut_off(cut, f[0], f[1], f[2], floor, above);
    EXPECT_NEAR(cut.positive_part(off).share * above, expected, 1e-6) << a << " " << b << " " << c;
    EXPECT_NEAR(cut.other_part(off).share * above, above - expected, 1e-6) << a << " " << b << " " << c;
  });
}

// Of a constant field; what two parts have together is the whole's.
TEST(Lattice, APartOfACellHasItsOwnCentroid) {
  for_corner_values([](float a, float b, float c) {
    if (a * b * c == 0) return;
    std::vector<Corner> polygon = positive_polygon(a, b, c);
    for (Corner& corner : polygon) corner.f = 1;
    const Means expected = means_of(polygon);
    const scalar::CutCorner<float> cut(a, b, c);
    const float off = cut.is_cut ? cut.s * cut.t : 1.0f;
    const scalar::Part<float> part = cut.positive_part(off), rest = cut.other_part(off);
    EXPECT_NEAR(part.share, expected.share, 1e-6) << a << " " << b << " " << c;
    EXPECT_NEAR(part.share / 3 + part.to_b / 12, expected.u, 1e-6) << a << " " << b << " " << c;
    EXPECT_NEAR(part.share / 3 + part.to_c / 12, expected.v, 1e-6) << a << " " << b << " " << c;
    EXPECT_EQ(rest.to_b, -part.to_b);
    EXPECT_EQ(rest.to_c, -part.to_c);
  });
}

// Functions at the corners (0, 0), (1, 0), (0, 1), and a polygon's part where one is positive.
using Values = std::array<float, 3>;
double value_at(const Values& values, double u, double v) {
  return values[0] + u * (values[1] - values[0]) + v * (values[2] - values[0]);
}
std::vector<Corner> positive_part(const std::vector<Corner>& polygon, const Values& values) {
  std::vector<Corner> part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = value_at(values, p.u, p.v), at_q = value_at(values, q.u, q.v);
    if (at_p > 0) part.push_back(p);
    if ((at_p > 0) == (at_q > 0)) continue;
    const double t = at_p / (at_p - at_q);
    part.push_back({p.u + t * (q.u - p.u), p.v + t * (q.v - p.v), p.f + t * (q.f - p.f)});
  }
  return part;
}

TEST(Lattice, ThePartOfACellWithinSeveralBordersIsExactHoweverTheyCross) {
  Random random(12);
  const auto any_values = [&] {
    Values values;
    for (float& value : values) value = static_cast<float>(random.between(-1, 1));
    return values;
  };
  std::size_t crossed = 0;
  for (int round = 0; round < 20000; ++round) {
    const Values f = round % 2 == 0 ? any_values() : Values{1, 1, 1};
    std::array<Values, 3> borders = {any_values(), any_values(), any_values()};
    if (round % 3 == 0) borders[1] = borders[0];  // side by side
    std::vector<Corner> polygon = positive_polygon(f[0], f[1], f[2]);
    std::array<scalar::AtCorners<float>, 3> at;
    for (std::size_t k = 0; k < borders.size(); ++k) {
      polygon = positive_part(polygon, borders[k]);
      at[k] = {borders[k][0], borders[k][1], borders[k][2]};
    }
    crossed += polygon.size() > 4 ? 1 : 0;
    const Means expected = means_of(polygon);
    const scalar::PartCell<float> cell(f[0], f[1], f[2], (f[0] + f[1] + f[2]) / 3);
    const scalar::Cell<float> part = scalar::cell_within(cell, at);
    EXPECT_NEAR(part.mean, expected.sum, 2e-6) << "round " << round;
    if (round % 2 == 0) continue;  // centroids are those of areas
    EXPECT_NEAR(part.mean / 3 + part.to_b / 12, expected.u, 2e-6) << "round " << round;
    EXPECT_NEAR(part.mean / 3 + part.to_c / 12, expected.v, 2e-6) << "round " << round;
  }
  EXPECT_GT(crossed, 1000u);
}

// A cell is exact for quadratic functions that are positive: they are what a bubble can tell.
TEST(Lattice, IntegratesPositiveQuadraticFunctionsExactly) {
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    double k[6];
    for (double& coefficient : k) coefficient = random.between(-1, 1);
    k[0] += 5;
    const auto f = [&](double u, double v) {
      return k[0] + k[1] * u + k[2] * v + k[3] * u * u + k[4] * u * v + k[5] * v * v;
    };
    // Means of 1, u, u^2, u v, ... over the triangle: 2 i! j! / (i + j + 2)!
    const double mean = k[0] + (k[1] + k[2]) / 3 + (k[3] + k[5]) / 6 + k[4] / 12;
    for (std::size_t steps = 1; steps <= kMostStepsAtOnce; ++steps) {
      const LatticeMoments<float> m = scalar::lattice_moments<float>(
          steps, [](float u) { return u; }, [&](float u, float v) { return static_cast<float>(f(u, v)); });
      EXPECT_NEAR(m.sum, mean, 5e-6) << steps;
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
