// The kernels of samples against direct integration: the exact parts of a cell, and every lattice over random
// patches.
#include <gtest/gtest.h>

#include <cmath>

#include "base/gauss.h"
#include "lumbrical/shapes.h"
#include "mesh_world.h"
#include "random.h"

#define LUMBRICAL_ISA scalar
#include "samples/sample_table.h"

namespace lumbrical::test {
namespace {

using scalar::LatticeMoments;

// ---- Linear functions ----

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

// Area, and its moments, of the part where f > 0, as means over the triangle.
Means moments_of_part(double a, double b, double c) {
  std::vector<Corner> polygon = positive_polygon(a, b, c);
  for (Corner& corner : polygon) corner.f = 1;
  return means_of(polygon);
}

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

TEST(Lattice, ShareWhereALinearFunctionIsPositiveIsExact) {
  Random random(9);
  for_corner_values([&](float a, float b, float c) {
    if (a * b * c == 0) return;
    const std::array<float, 3> f = {static_cast<float>(random.between(0, 1)),
                                    static_cast<float>(random.between(0, 1)),
                                    static_cast<float>(random.between(0, 1))};
    const float whole = f[0] + f[1] + f[2];
    const Means means = means_of_positive(a, b, c);
    // Of f, linear: its mean over the part is its value at the part's centroid.
    const Means of_part = moments_of_part(a, b, c);
    const double expected =
        3 * (f[0] * of_part.sum + (f[1] - f[0]) * of_part.u + (f[2] - f[0]) * of_part.v) / whole;
    EXPECT_NEAR(of_part.sum, means.share, 1e-12);
    EXPECT_NEAR(scalar::share_where_positive(a, b, c, f[0], f[1], f[2], whole), expected, 3e-6)
        << a << " " << b << " " << c;
  });
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
    for (const std::size_t steps : {1, 2, 3, 4, 5, 6, 8, 14}) {
      const LatticeMoments<float> m = scalar::lattice_moments<float>(
          steps, [](float u) { return u; }, [&](float u, float v) { return static_cast<float>(f(u, v)); });
      EXPECT_NEAR(m.sum, mean, 5e-6) << steps;
    }
  }
}

// ---- Kernels ----

constexpr double kRadius = 0.008;

// Sixteen patches, of which any may be used.
struct Patches16 {
  std::array<PatchShape, PatchBlock::kWidth> shapes{};
  std::array<ListedPatch, PatchBlock::kWidth> listed{};
  std::array<std::array<Vec3, 3>, PatchBlock::kWidth> corners{};
  // Of the bodies whose tiles they are listed for; unlike tests' frames, whose origin is W's.
  std::array<SplitPoint, 2> origins{};
  [[nodiscard]] PatchList list() const {
    return {shapes.data(), listed.data(), listed.size(), origins.data()};
  }
  [[nodiscard]] PatchList list(Vec3 origin) {
    origins[0] = split_point(origin);
    return list();
  }
};
Patches16 patches_near(Random& random, Vec3 middle, double spread, double size) {
  Patches16 patches;
  for (std::uint32_t lane = 0; lane < PatchBlock::kWidth; ++lane) {
    patches.listed[lane] = {lane, 0};
    auto& [a, b, c] = patches.corners[lane];
    a = middle + random.in_box(spread);
    b = a + size * random.direction();
    c = a + size * random.direction();
    PatchShape& shape = patches.shapes[lane];
    shape.corner = split_point(a);
    put(b - a, shape.edge[0]);
    put(c - a, shape.edge[1]);
  }
  return patches;
}

BodySums sums_of_zero() {
  BodySums sums;
  sums.force_quantum = std::ldexp(1.0, -70);
  sums.moment_quantum = std::ldexp(1.0, -76);
  return sums;
}

// Of a body's force and moment, in its frame.
struct Felt {
  Vec3 force, moment;
};
Felt felt(const BodySums& sums) {
  double total[6] = {};
  for (std::size_t k = 0; k < 6; ++k) {
    for (const double lane : sums.lane[k]) total[k] += 0.5 * lane;
  }
  return {{total[0], total[1], total[2]}, {total[3], total[4], total[5]}};
}

// A frame in double precision, as its single precision is.
struct Frame {
  Vec3 origin, axis[3];
  [[nodiscard]] Vec3 into(Vec3 p) const {
    const Vec3 from = p - origin;
    return {dot(axis[0], from), dot(axis[1], from), dot(axis[2], from)};
  }
};

// Integrals of share(p) max(phi(p), 0) n over the patches: at centroids of 60^2 cells each.
template <class Phi, class Share>
Felt integral(const Patches16& patches, const Frame& frame, const Phi& phi, const Share& share) {
  constexpr int kCells = 60;
  Felt sum;
  for (const auto& [wa, wb, wc] : patches.corners) {
    const Vec3 a = frame.into(wa), b = frame.into(wb), c = frame.into(wc);
    const Vec3 normal = (0.5 / (kCells * kCells)) * cross(b - a, c - a);
    const auto add = [&](double u, double v) {
      const Vec3 p = a + (u / kCells) * (b - a) + (v / kCells) * (c - a);
      const double depth = phi(p);
      if (!(depth > 0)) return;
      const Vec3 force = (depth * share(p)) * normal;
      sum.force += force;
      sum.moment += cross(p, force);
    };
    for (int i = 0; i < kCells; ++i) {
      for (int j = 0; i + j < kCells; ++j) {
        add(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 1 < kCells) add(i + 2.0 / 3, j + 2.0 / 3);
      }
    }
  }
  return sum;
}

TileFrame tile_of(const Frame& frame, double length, double end_radius) {
  TileFrame tile{};
  put(frame.origin, tile.origin);
  for (std::size_t k = 0; k < 3; ++k) put(frame.axis[k], tile.axis[k]);
  const double sine = (kRadius - end_radius) / length, cosine2 = 1 - sine * sine;
  tile.length = static_cast<float>(length);
  tile.radius = static_cast<float>(kRadius);
  tile.end_radius = static_cast<float>(end_radius);
  tile.sine = static_cast<float>(sine);
  tile.cosine = static_cast<float>(std::sqrt(cosine2));
  tile.tangent2 = static_cast<float>(sine * sine / cosine2);
  tile.cosine2 = static_cast<float>(cosine2);
  return tile;
}
Frame frame_along(Vec3 origin, Vec3 x) {
  const Vec3 y = unit_or(cross(x, std::fabs(x.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}), {});
  return {origin, {x, y, cross(x, y)}};
}

FingerBody finger_of(std::initializer_list<TileFrame> tiles, const JointSides& sides = {}) {
  FingerBody finger;
  finger.tile_count = tiles.size();
  std::copy(tiles.begin(), tiles.end(), finger.tile);
  finger.joint[0] = sides;
  return finger;
}

// The depth in the hull of two spheres: the deepest of the spheres between them, by search along the axis.
double depth_in_hull(double length, double radius, double end_radius, Vec3 p) {
  const auto depth = [&](double t) {
    const double along = p.x - t * length;
    return radius + t * (end_radius - radius) - std::sqrt(along * along + p.y * p.y + p.z * p.z);
  };
  double low = 0, high = 1;  // concave in t
  for (int i = 0; i < 40; ++i) {
    const double one = low + (high - low) / 3, other = high - (high - low) / 3;
    (depth(one) < depth(other) ? low : high) = depth(one) < depth(other) ? one : other;
  }
  return depth(0.5 * (low + high));
}

void expect_near(const Felt& one, const Felt& other, double force, const char* what) {
  EXPECT_LE(norm(one.force - other.force), force) << what << ": of " << norm(other.force);
  EXPECT_LE(norm(one.moment - other.moment), 2 * kRadius * force) << what << ": of " << norm(other.moment);
}

const auto kWhole = [](Vec3) { return 1.0; };

// Its field is that of a hull of two spheres, near, beside and beyond it.
TEST(SampleKernels, ATilesFieldIsTheDepthInTheHullOfTwoSpheres) {
  Random random(13);
  for (int round = 0; round < 2000; ++round) {
    const double length = random.between(0.4, 4) * kRadius, end = random.between(0.65, 1) * kRadius;
    const TileFrame tile = tile_of(frame_along({}, {1, 0, 0}), length, end);
    const Vec3 p = random.in_box(1.5 * kRadius) + Vec3{random.between(0, 1) * length, 0, 0};
    const float depth =
        scalar::tile_field<float>(scalar::numbers_of<float>(tile),
                                  {static_cast<float>(p.x), static_cast<float>(p.y * p.y + p.z * p.z)});
    EXPECT_NEAR(depth, depth_in_hull(length, kRadius, end, p), 3e-7 * (kRadius + length));
  }
}

// The error of a lattice: small against what the patches might hold, and less with every refinement.
TEST(SampleKernels, LatticesOfATileApproachItsIntegral) {
  Random random(17);
  double error[2] = {};
  for (int round = 0; round < 12; ++round) {
    const double length = random.between(0.6, 4) * kRadius, end = random.between(0.7, 1) * kRadius;
    const Frame frame = frame_along(random.in_box(0.05), random.direction());
    const FingerBody finger = finger_of({tile_of(frame, length, end)});
    const Vec3 middle = frame.origin + random.between(-0.3, 1.3) * length * frame.axis[0];
    const double size = 0.6 * kRadius;
    const Patches16 patches = patches_near(random, middle, 0.7 * kRadius, size);
    const Felt right = integral(
        patches, frame, [&](Vec3 p) { return depth_in_hull(length, kRadius, end, p); }, kWhole);
    const std::size_t steps[2] = {4, 8};
    for (std::size_t k = 0; k < 2; ++k) {
      BodySums sums = sums_of_zero();
      scalar::kSampleKernels.tile_lattice(patches.list(), &finger, TilePart::whole, steps[k], {&sums, 1});
      error[k] += norm(felt(sums).force - right.force);
      expect_near(felt(sums), right, (k == 0 ? 1e-3 : 2e-4) * size * size * kRadius, "tile");
    }
  }
  EXPECT_LT(error[1], 0.5 * error[0]);
}

// Kernels for a part of a tile find what the whole tile's does, where only that part is near.
TEST(SampleKernels, PartsOfATileFindWhatTheWholeTileDoes) {
  Random random(37);
  for (int round = 0; round < 60; ++round) {
    const double length = 4 * kRadius, end = random.between(0.7, 1) * kRadius, size = 0.6 * kRadius;
    const Frame frame = frame_along(random.in_box(0.05), random.direction());
    const FingerBody finger = finger_of({tile_of(frame, length, end)});
    const int part = round % 3;  // near end, side, far end
    const double along = part == 0 ? -1.2 * kRadius : part == 1 ? 0.5 * length : length + 1.2 * kRadius;
    const double aside = part == 1 ? 0.7 * kRadius : 0.2 * kRadius;
    Patches16 patches = patches_near(random, frame.origin + along * frame.axis[0] + aside * frame.axis[1],
                                     0.3 * kRadius, size);
    BodySums whole = sums_of_zero(), its = sums_of_zero();
    scalar::kSampleKernels.tile_lattice(patches.list(), &finger, TilePart::whole, 5, {&whole, 1});
    for (ListedPatch& patch : patches.listed) patch.tile = part == 2 ? ListedPatch::kFarEnd : 0;
    scalar::kSampleKernels.tile_lattice(patches.list(), &finger, part == 1 ? TilePart::side : TilePart::end,
                                        5, {&its, 1});
    EXPECT_GT(norm(felt(whole).force), 0);
    expect_near(felt(its), felt(whole), 3e-6 * size * size * kRadius, "part");
  }
}

// A row may hold patches of several tiles; each of those feels what it would feel alone, to the last bit.
TEST(SampleKernels, ARowOfSeveralTilesFeelsWhatEachFeelsAlone) {
  Random random(41);
  const auto make_finger = [&] {
    const Frame one = frame_along(random.in_box(0.01), random.direction());
    const Frame other = frame_along(one.origin + 2 * kRadius * one.axis[0], random.direction());
    return finger_of({tile_of(one, 2 * kRadius, 0.8 * kRadius), tile_of(other, 2 * kRadius, 0.7 * kRadius)},
                     {1, static_cast<float>(2 * kRadius), 1, 0});
  };
  const FingerBody fingers[] = {make_finger(), make_finger()};
  Patches16 patches = patches_near(random, {}, 0.01, 0.01);
  patches.origins[1] = split_point({0.002, -0.001, 0.0005});
  const std::uint32_t tiles[] = {0, 1, Bodies::kTilesApart, Bodies::kTilesApart + 1};
  for (std::size_t i = 0; i < patches.listed.size(); ++i) patches.listed[i].tile = tiles[i / 4];
  std::vector<BodySums> together(8, sums_of_zero()), alone(8, sums_of_zero());
  const auto run = [&](const PatchList& list, std::vector<BodySums>& sums) {
    for (const TilePart part : {TilePart::whole, TilePart::side, TilePart::end})
      scalar::kSampleKernels.tile_lattice(list, fingers, part, 3, {sums.data(), ~std::uint64_t{0}});
  };
  run(patches.list(), together);
  for (std::size_t i = 0; i < 4; ++i) {
    PatchList list = patches.list();
    list.patches += 4 * i;
    list.count = 4;
    run(list, alone);
  }
  for (const std::uint32_t tile : tiles) {
    EXPECT_GT(norm(felt(together[tile]).force), 0);
    EXPECT_EQ(norm(felt(together[tile]).force - felt(alone[tile]).force), 0);
    EXPECT_EQ(norm(felt(together[tile]).moment - felt(alone[tile]).moment), 0);
  }
}

// ---- The palm ----

PalmBody palm_of(const Frame& frame, double half_x, double half_y) {
  PalmBody palm{};
  palm.corner_count = 4;
  palm.origin = frame.origin;
  palm.radius = static_cast<float>(kRadius);
  const double x[] = {-half_x, half_x, half_x, -half_x}, y[] = {-half_y, -half_y, half_y, half_y};
  const float out_x[] = {0, 1, 0, -1}, out_y[] = {-1, 0, 1, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    palm.edge[k] = {static_cast<float>(x[k]), static_cast<float>(y[k]), out_x[k], out_y[k],
                    static_cast<float>(2 * (k % 2 == 0 ? half_x : half_y))};
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double axis[] = {frame.axis[k].x, frame.axis[k].y, frame.axis[k].z};
    for (std::size_t i = 0; i < 3; ++i) palm.axis[k][i] = static_cast<float>(axis[i]);
  }
  return palm;
}

TEST(SampleKernels, LatticesOfThePalmApproachItsIntegral) {
  Random random(19);
  for (int round = 0; round < 12; ++round) {
    const double half_x = random.between(0.5, 3) * kRadius, half_y = random.between(0.5, 3) * kRadius;
    const Frame frame = frame_along(random.in_box(0.05), random.direction());
    const PalmBody palm = palm_of(frame, half_x, half_y);
    const auto depth = [&](Vec3 p) {  // of a rectangle's surroundings
      const double x = std::max(std::fabs(p.x) - half_x, 0.0), y = std::max(std::fabs(p.y) - half_y, 0.0);
      return kRadius - std::sqrt(x * x + y * y + p.z * p.z);
    };
    const double u = random.between(-1.2, 1.2) * half_x, v = random.between(-1.2, 1.2) * half_y;
    const Vec3 middle = frame.origin + u * frame.axis[0] + v * frame.axis[1] + kRadius * frame.axis[2];
    const double size = 0.6 * kRadius;
    Patches16 patches = patches_near(random, middle, 0.5 * kRadius, size);
    const Felt right = integral(patches, frame, depth, kWhole);
    const std::size_t steps[2] = {4, 8};
    for (std::size_t k = 0; k < 2; ++k) {
      BodySums sums = sums_of_zero();
      scalar::kSampleKernels.palm_lattice(patches.list(frame.origin), palm, steps[k], sums);
      expect_near(felt(sums), right, (k == 0 ? 1e-3 : 2e-4) * size * size * kRadius, "palm");
    }
  }
}

// Above the polygon and on one side of it the palm's depth is linear, and so is what the kernel knows.
TEST(SampleKernels, OneSideOfThePalmIsExact) {
  Random random(23);
  for (int round = 0; round < 12; ++round) {
    const Frame frame = frame_along(random.in_box(0.05), random.direction());
    const PalmBody palm = palm_of(frame, 6 * kRadius, 6 * kRadius);
    const double side = round % 2 == 0 ? 1 : -1, size = 0.4 * kRadius;
    const Vec3 middle = frame.origin + side * kRadius * frame.axis[2];
    Patches16 patches = patches_near(random, middle, 0.3 * kRadius, size);
    const Felt right = integral(
        patches, frame, [](Vec3 p) { return kRadius - std::fabs(p.z); }, kWhole);
    BodySums sums = sums_of_zero();
    scalar::kSampleKernels.palm_side(patches.list(frame.origin), palm, sums);
    expect_near(felt(sums), right, 1e-4 * size * size * kRadius, "side");  // of the integration
  }
}

// ---- Joints ----

// Two tiles in a row, one straight on from the other: what they share is their union, each has its half, and
// one that is not wanted is left alone.
TEST(SampleKernels, TilesThatFollowEachOtherShareOutTheirUnion) {
  Random random(29);
  for (int round = 0; round < 8; ++round) {
    const double length = random.between(1, 3) * kRadius;
    const Vec3 axis = random.direction(), joint = random.in_box(0.05);
    const Frame inner = frame_along(joint - length * axis, axis), outer = frame_along(joint, axis);
    const FingerBody finger = finger_of({tile_of(inner, length, kRadius), tile_of(outer, length, kRadius)},
                                        {-1, static_cast<float>(length), 1, 0});
    const double size = 0.5 * kRadius;
    const Patches16 patches = patches_near(random, joint, 0.6 * kRadius, size);
    BodySums sums[2] = {sums_of_zero(), sums_of_zero()}, one[2] = {sums_of_zero(), sums_of_zero()};
    scalar::kSampleKernels.joint_lattice(patches.list(), &finger, 8, {sums, 3});
    scalar::kSampleKernels.joint_lattice(patches.list(), &finger, 8, {one, 2});
    const auto depth = [&](Vec3 p) { return depth_in_hull(2 * length, kRadius, kRadius, p); };
    const Felt right = integral(patches, inner, depth, kWhole);
    const Felt beyond = integral(patches, inner, depth, [&](Vec3 p) { return p.x > length ? 1.0 : 0.0; });
    const Felt a = felt(sums[0]), b = felt(sums[1]);
    EXPECT_LE(norm(a.force + b.force - right.force), 2e-4 * size * size * kRadius);
    EXPECT_LE(norm(b.force - beyond.force), 1e-2 * size * size * kRadius);  // ramps are a cell wide
    EXPECT_EQ(norm(felt(one[0]).force), 0);
    EXPECT_EQ(norm(felt(one[1]).force - b.force), 0);
  }
}

}  // namespace
}  // namespace lumbrical::test
