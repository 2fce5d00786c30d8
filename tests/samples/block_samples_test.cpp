// Blocks of patches as one: seven samples with vectors for weights.
#include "index/block_samples.h"

#include <gtest/gtest.h>

#include <vector>

#include "largest.h"
#include "random.h"

namespace lumbrical::test {
namespace {

/// A field of second degree.
struct Field {
  double constant;
  Vec3 slope;
  Vec3 row[3];
  double operator()(Vec3 p) const {
    return constant + dot(slope, p) + p.x * dot(row[0], p) + p.y * dot(row[1], p) + p.z * dot(row[2], p);
  }
};

Vec3 random_vector(Random& random, double size) {
  const auto number = [&] { return random.between(-size, size); };
  return {number(), number(), number()};
}

Field random_field(Random& random) {
  return {random.between(-1, 1),
          random_vector(random, 1),
          {random_vector(random, 1), random_vector(random, 1), random_vector(random, 1)}};
}

// Twice the integral of f n dA, by a rule that is exact for fields of second degree.
Vec3 force_on(const std::vector<Corners>& patches, const Field& field) {
  Vec3 force;
  for (const Corners& at : patches) {
    const double mean = (field(at.a) + field(at.b) + field(at.c) + 9 * field((at.a + at.b + at.c) / 3)) / 12;
    force += mean * cross(at.b - at.a, at.c - at.a);
  }
  return force;
}

Vec3 force_on(const BlockSamples& block, const Field& field) {
  const Vec3 centre = point_of(block.centre);
  Vec3 force = field(centre) * vec3_of(block.centre_weight);
  for (std::size_t k = 0; k < 3; ++k) {
    force += field(centre + vec3_of(block.arm[k])) * vec3_of(block.weight[0][k]);
    force += field(centre - vec3_of(block.arm[k])) * vec3_of(block.weight[1][k]);
  }
  return force;
}

double area_of(const std::vector<Corners>& patches) {
  double area = 0;
  for (const Corners& at : patches) area += norm(cross(at.b - at.a, at.c - at.a));
  return area;
}

double radius_of(const std::vector<Corners>& patches, Vec3 centre) {
  double radius = 0;
  for (const Corners& at : patches) {
    for (const Vec3 corner : {at.a, at.b, at.c}) radius = max(radius, norm(corner - centre));
  }
  return radius;
}

// Sixteen triangles; `bend` [m]: how far corners leave the plane of u and v.
std::vector<Corners> patches_at(Random& random, Vec3 from, Vec3 u, Vec3 v, double bend) {
  const Vec3 normal = unit_or(cross(u, v), {0, 0, 1});
  const auto corner = [&](double i, double j) {
    return from + (i + random.between(-0.3, 0.3)) * u + (j + random.between(-0.3, 0.3)) * v +
           random.between(-bend, bend) * normal;
  };
  std::vector<Corners> patches;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) patches.push_back({corner(i, j), corner(i + 1.5, j), corner(i, j + 1.5)});
  }
  return patches;
}

// Four blocks side by side as one, from their patches and from their own moments: the larger error, as a
// share of the field's size.
double worst_error(Random& random, double bend, const Field& field) {
  const Vec3 u = random_vector(random, 0.01), v = random_vector(random, 0.01);
  std::vector<Corners> all;
  std::vector<BlockMoments> moments;
  for (int k = 0; k < 4; ++k) {
    const Vec3 from = random.between(-5, 5) * u + random.between(-5, 5) * v;
    const std::vector<Corners> part = patches_at(random, from, u, v, bend);
    all.insert(all.end(), part.begin(), part.end());
    moments.push_back(moments_of(std::span<const Corners>(part)));
  }
  const BlockMoments own = moments_of(std::span<const Corners>(all)),
                     added = moments_of(std::span<const BlockMoments>(moments));
  double worst = 0;
  for (const BlockMoments& block : {own, added}) {
    const BlockSamples samples = samples_of(block, radius_of(all, centre_of(block)));
    worst = largest(worst, norm(force_on(samples, field) - force_on(all, field)) / area_of(all));
  }
  return worst;
}

TEST(BlockSamples, OfAPlaneIntegrateFieldsOfSecondDegreeAsTheirPatchesDo) {
  Random random(5);
  for (int i = 0; i < 200; ++i) EXPECT_LT(worst_error(random, 0, random_field(random)), 1e-6);
}

TEST(BlockSamples, OfSliversThatHaveNoAreaAreFiniteAndFeelNothing) {
  const Vec3 edge{0.01, 0.01, 0}, ones{1, 1, 1};
  const Corners sliver{{}, edge, 0.5 * edge};
  const BlockMoments block = moments_of(std::span(&sliver, 1));
  ASSERT_EQ(block.area.sum, 0);
  const BlockSamples samples = samples_of(block, 0.02);
  EXPECT_TRUE(is_finite(point_of(samples.centre)) && std::isfinite(samples.size));
  EXPECT_EQ(force_on(samples, Field{1, ones, {ones, ones, ones}}), Vec3{});
}

TEST(BlockSamples, OfWhatIsOnePointInSinglePrecisionAreFiniteAndFeelNothing) {
  const Corners point{{0.01, 0.01, 0}, {0.01, 0.01, 0}, {0.01, 0.01, 0}};
  const BlockSamples samples = samples_of(moments_of(std::span(&point, 1)), 0);
  const Vec3 ones{1, 1, 1};
  EXPECT_EQ(force_on(samples, Field{1, ones, {ones, ones, ones}}), Vec3{});
}

TEST(BlockSamples, OfBentSurfacesIntegrateLinearFieldsAsTheirPatchesDo) {
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    Field field = random_field(random);
    for (Vec3& row : field.row) row = {};
    EXPECT_LT(worst_error(random, 0.004, field), 1e-6);
  }
}

}  // namespace
}  // namespace lumbrical::test
