// Means and slopes of textures, held against sums over points.
#include "model/texture_means.h"

#include <gtest/gtest.h>

#include <cmath>

#include "largest.h"
#include "random.h"

namespace lumbrical {
namespace {

Texture speckles() {
  test::Random random(5);
  Texture texture{{7, 5, {}}, 0.014, -1, 3};
  for (int i = 0; i < 35; ++i)
    texture.image.grey.push_back(static_cast<std::uint16_t>(random.bits() % 65536));
  return texture;
}

// The texel under a point: rows from the top, the lower left corner at the origin.
double value_at(const Texture& texture, double u, double v) {
  const double texel = texture.period / texture.image.width;
  const auto wrap = [](double i, std::uint32_t count) {
    return static_cast<std::size_t>(i - count * std::floor(i / count));
  };
  const std::size_t column = wrap(std::floor(u / texel), texture.image.width),
                    row = texture.image.height - 1 - wrap(std::floor(v / texel), texture.image.height);
  const double grey = texture.image.grey[row * texture.image.width + column];
  return texture.black + (texture.white - texture.black) * grey / 65535;
}

template <class Weight>
double sum_of(const Texture& texture, double u, double v, double half_u, double half_v,
              const Weight& weight) {
  constexpr int kPoints = 400;
  double sum = 0;
  for (int i = 0; i < kPoints; ++i) {
    for (int k = 0; k < kPoints; ++k) {
      const double x = (2 * (i + 0.5) / kPoints - 1) * half_u, y = (2 * (k + 0.5) / kPoints - 1) * half_v;
      sum += weight(x) * value_at(texture, u + x, v + y);
    }
  }
  return sum / kPoints / kPoints;
}

TEST(TextureMeans, AreThoseOfTheTexelsUnderARectangleWhereverItLies) {
  const Texture texture = speckles();
  const TextureMeans means = texture_means(texture);
  test::Random random(6);
  for (int i = 0; i < 12; ++i) {
    const double u = random.between(-0.1, 0.1), v = random.between(-0.1, 0.1);
    const double half_u = random.between(1e-4, 0.03), half_v = random.between(1e-4, 0.03);
    const double expected = sum_of(texture, u, v, half_u, half_v, [](double) { return 1; });
    EXPECT_NEAR(mean_over(means, u, v, half_u, half_v), expected, 0.02);
  }
}

TEST(TextureMeans, SlopeIsThatOfTheMeanUnderAPatch) {
  const Texture texture = speckles();
  const TextureMeans means = texture_means(texture);
  const double radius = 0.004, half = radius * std::sqrt(0.5);
  const Vec3 point{0.0113, -0.0231, 0.5};
  const Vec3 slope = slope_under(means, point, {0, 0, 1}, radius);
  // The derivative of a mean weighted by a tent is that weighted by the tent's own: one side less the other.
  const double along =
      sum_of(texture, point.x, point.y, radius, half, [](double x) { return x > 0 ? 2 : -2; });
  EXPECT_NEAR(slope.x, along / radius, 0.01 * std::fabs(along / radius) + 1);
  EXPECT_EQ(slope.z, 0);
  EXPECT_NE(slope.y, 0);
}

TEST(TextureMeans, AreContinuousAndSteadyFarFromTheOrigin) {
  const TextureMeans means = texture_means(speckles());
  double last = mean_over(means, 0, 0.003, 0.002, 0.002), most = 0;
  for (int i = 1; i < 20000; ++i) {
    const double now = mean_over(means, 2e-6 * i, 0.003, 0.002, 0.002);
    most = test::largest(most, std::fabs(now - last));
    last = now;
  }
  EXPECT_LT(most, 4 * 2e-6 / 0.004 + 1e-9);
  EXPECT_NEAR(mean_over(means, 14e3 + 0.001, 0.003, 0.002, 0.002),
              mean_over(means, 0.001, 0.003, 0.002, 0.002), 1e-6);
}

}  // namespace
}  // namespace lumbrical
