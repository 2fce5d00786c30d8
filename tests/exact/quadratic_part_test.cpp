// The rule that exact overlaps are integrated by: polynomials exactly, and a disc's share of a triangle
// against its closed form.
#include "section/quadratic_part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lumbrical {
namespace {

using Triangle = std::array<Point2, 3>;

SixPoints<Point2> six_points(const Triangle& t) {
  return {t[0], t[1], t[2], 0.5 * (t[1] + t[2]), 0.5 * (t[2] + t[0]), 0.5 * (t[0] + t[1])};
}
double area_of(const Triangle& t) { return 0.5 * std::fabs(cross(t[1] - t[0], t[2] - t[0])); }

template <class Function>
SixPoints<double> values_of(const Triangle& triangle, const Function& f) {
  SixPoints<double> values;
  const SixPoints<Point2> place = six_points(triangle);
  for (std::size_t k = 0; k < place.size(); ++k) values[k] = f(place[k]);
  return values;
}

Triangle random_triangle(std::mt19937& random, Point2 middle, double size) {
  std::uniform_real_distribution<double> turn(0, 2 * M_PI), radius(0.5 * size, size);
  Triangle triangle;
  for (Point2& corner : triangle) {
    const double angle = turn(random), far = radius(random);
    corner = middle + far * Point2{std::cos(angle), std::sin(angle)};
  }
  return triangle;
}

// By a rule for polynomials of degree 9 on the rays from the first corner.
template <class Function>
PlaneMoments integral_of(const Triangle& t, const Function& f) {
  PlaneMoments sum;
  for (const auto [at_r, weight_r] : kGauss5) {
    for (const auto [at_t, weight_t] : kGauss5) {
      const Point2 p = t[0] + at_r * (t[1] + at_t * (t[2] - t[1]) - t[0]);
      const double part = 2 * area_of(t) * weight_r * weight_t * at_r * f(p);
      sum.volume += part;
      sum.first = sum.first + part * p;
    }
  }
  return sum;
}

// Of the unit disc between the rays from its centre to two points, of the sign of their turn.
double disc_sector(Point2 a, Point2 b) {
  const Point2 edge = b - a;
  const double half = dot(a, edge) / dot(edge, edge),
               square = half * half - (dot(a, a) - 1) / dot(edge, edge);
  const auto wedge = [](Point2 from, Point2 to) { return 0.5 * std::atan2(cross(from, to), dot(from, to)); };
  if (square <= 0) return wedge(a, b);
  const double low = std::clamp(-half - std::sqrt(square), 0.0, 1.0),
               high = std::clamp(-half + std::sqrt(square), 0.0, 1.0);
  const Point2 from = a + low * edge, to = a + high * edge;
  return wedge(a, from) + 0.5 * cross(from, to) + wedge(to, b);
}
double area_in_disc(const Triangle& t) {
  return std::fabs(disc_sector(t[0], t[1]) + disc_sector(t[1], t[2]) + disc_sector(t[2], t[0]));
}

TEST(QuadraticPart, IsExactForWhatIsPositiveThroughout) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    const Triangle triangle = random_triangle(random, {number(random), number(random)}, 1);
    const double a = number(random), b = number(random), c = number(random), d = number(random),
                 e = number(random);
    const auto f = [&](Point2 p) {
      return 30 + a * p.x + b * p.y + c * p.x * p.x + d * p.x * p.y + e * p.y * p.y;
    };
    const SixPoints<double> values = values_of(triangle, f),
                            ones = values_of(triangle, [](Point2) { return 1.0; });
    const PlaneMoments expected = integral_of(triangle, f),
                       felt = integral_where_positive(six_points(triangle), area_of(triangle),
                                                      std::array{values, ones});
    EXPECT_NEAR(felt.volume, expected.volume, 1e-13 * 40);
    EXPECT_NEAR(felt.first.x, expected.first.x, 1e-13 * 40);
    EXPECT_NEAR(felt.first.y, expected.first.y, 1e-13 * 40);
  }
}

TEST(QuadraticPart, IsNothingWhereOneOfThemIsNegative) {
  const Triangle triangle{{{0, 0}, {1, 0}, {0, 1}}};
  const SixPoints<double> ones = values_of(triangle, [](Point2) { return 1.0; }),
                          less = values_of(triangle, [](Point2 p) { return -p.x * p.x; });
  EXPECT_EQ(integral_where_positive(six_points(triangle), 0.5, std::array{ones, ones, less}).volume, 0);
}

// Triangles on a disc's border: the smaller, the straighter that is. Of a straight one nothing would be left;
// few have edges that it crosses twice.
TEST(QuadraticPart, FollowsACurvedBorder) {
  std::mt19937 random(2);
  const auto mean_error = [&](double size) {
    std::uniform_real_distribution<double> turn(0, 2 * M_PI), radius(1 - 0.5 * size, 1 + 0.5 * size);
    constexpr int kTriangles = 4000;
    double sum = 0;
    for (int i = 0; i < kTriangles; ++i) {
      const double angle = turn(random), far = radius(random);
      const Triangle triangle = random_triangle(random, far * Point2{std::cos(angle), std::sin(angle)}, size);
      const SixPoints<double> ones = values_of(triangle, [](Point2) { return 1.0; }),
                              disc = values_of(triangle, [](Point2 p) { return 1 - dot(p, p); });
      const double area =
          integral_where_positive(six_points(triangle), area_of(triangle), std::array{ones, disc}).volume;
      sum += std::fabs(area - area_in_disc(triangle));
    }
    return sum / (kTriangles * size * size);
  };
  EXPECT_LT(mean_error(0.2), 5e-5);
  EXPECT_LT(mean_error(0.1), 1e-6);
  EXPECT_LT(mean_error(0.05), 3e-7);
}

// First moments, and three conditions at a time: of a linear function over a rectangle that ends within the
// triangle. Rays to the rectangle's edges and past its corner are not told apart.
TEST(QuadraticPart, KeepsWhatAllConditionsLeave) {
  const Triangle triangle{{{0, 0}, {1, 0}, {0, 1}}};
  const auto f = [](Point2 p) { return 1 + p.x + 2 * p.y; };
  const std::array<SixPoints<double>, 3> functions{values_of(triangle, f),
                                                   values_of(triangle, [](Point2 p) { return 0.4 - p.x; }),
                                                   values_of(triangle, [](Point2 p) { return 0.3 - p.y; })};
  const PlaneMoments felt = integral_where_positive(six_points(triangle), 0.5, functions);
  const double volume = 0.4 * 0.3 + 0.5 * 0.16 * 0.3 + 0.09 * 0.4;
  EXPECT_NEAR(felt.volume, volume, 1e-2 * volume);
  // x and y of f over the rectangle 0.4 by 0.3.
  EXPECT_NEAR(felt.first.x, 0.08 * 0.3 + 0.064 / 3 * 0.3 + 0.08 * 0.09, 1e-2 * volume);
  EXPECT_NEAR(felt.first.y, 0.4 * 0.045 + 0.08 * 0.045 + 2 * 0.4 * 0.009, 1e-2 * volume);
}

}  // namespace
}  // namespace lumbrical
