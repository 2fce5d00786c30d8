// The kernels of samples against direct integration over random patches.
#include <gtest/gtest.h>

#include <cmath>

#include "base/gauss.h"
#include "lumbrical/shapes.h"
#include "mesh_world.h"
#include "random.h"

#define LUMBRICAL_ISA scalar
#include "samples/kernel_table.h"

namespace lumbrical::test {
namespace {

constexpr double kRadius = 0.008;

// Sixteen patches, of which any may be used.
struct Patches16 {
  std::array<PatchShape, PatchBlock::kWidth> shapes{};
  std::array<ListedPatch, PatchBlock::kWidth> listed{};
  std::array<std::array<Vec3, 3>, PatchBlock::kWidth> corners{};
  // Of the bodies whose tiles they are listed for; unlike tests' frames, whose origin is W's.
  std::array<SplitPoint, 2> origins{};
  [[nodiscard]] PatchList list(std::size_t steps) const {
    return {shapes.data(), listed.data(), listed.size(), origins.data(), steps};
  }
  [[nodiscard]] PatchList list(Vec3 origin, std::size_t steps = 0) {
    origins[0] = split_point(origin);
    return list(steps);
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
      scalar::kSampleKernels.tile_lattice(patches.list(steps[k]), &finger, TilePart::whole, {&sums, 1});
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
    scalar::kSampleKernels.tile_lattice(patches.list(5), &finger, TilePart::whole, {&whole, 1});
    for (ListedPatch& patch : patches.listed) patch.tile = part == 2 ? ListedPatch::kFarEnd : 0;
    scalar::kSampleKernels.tile_lattice(patches.list(5), &finger, part == 1 ? TilePart::side : TilePart::end,
                                        {&its, 1});
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
                     {1, static_cast<float>(2 * kRadius), 1, 0, 0});
  };
  const FingerBody fingers[] = {make_finger(), make_finger()};
  Patches16 patches = patches_near(random, {}, 0.01, 0.01);
  patches.origins[1] = split_point({0.002, -0.001, 0.0005});
  const std::uint32_t tiles[] = {0, 1, Bodies::kTilesApart, Bodies::kTilesApart + 1};
  for (std::size_t i = 0; i < patches.listed.size(); ++i) patches.listed[i].tile = tiles[i / 4];
  const auto run = [&](const PatchList& list, std::vector<BodySums>& sums) {
    for (const TilePart part : {TilePart::whole, TilePart::side, TilePart::end})
      scalar::kSampleKernels.tile_lattice(list, fingers, part, {sums.data(), ~std::uint64_t{0}});
  };
  for (const std::size_t steps : {3, 10}) {
    std::vector<BodySums> together(8, sums_of_zero()), alone(8, sums_of_zero());
    run(patches.list(steps), together);
    for (std::size_t i = 0; i < 16; i += i % 4 == 0 ? 1 : 3) {  // one of a tile, and the other three
      PatchList list = patches.list(steps);
      list.patches += i;
      list.count = i % 4 == 0 ? 1 : 3;
      run(list, alone);
    }
    for (const std::uint32_t tile : tiles) {
      EXPECT_GT(norm(felt(together[tile]).force), 0);
      EXPECT_EQ(norm(felt(together[tile]).force - felt(alone[tile]).force), 0);
      EXPECT_EQ(norm(felt(together[tile]).moment - felt(alone[tile]).moment), 0);
    }
  }
}

// A fine lattice goes through the quarters of a patch, side by side.
TEST(SampleKernels, AFineLatticeIsThatOfThePatchsQuarters) {
  Random random(43);
  const double size = 0.6 * kRadius;
  for (int round = 0; round < 20; ++round) {
    const Frame frame = frame_along(random.in_box(0.05), random.direction());
    const FingerBody finger = finger_of({tile_of(frame, 3 * kRadius, 0.8 * kRadius)});
    const Patches16 patches =
        patches_near(random, frame.origin + kRadius * frame.axis[0], 0.7 * kRadius, size);
    BodySums whole = sums_of_zero(), quarters = sums_of_zero();
    scalar::kSampleKernels.tile_lattice(patches.list(10), &finger, TilePart::whole, {&whole, 1});
    for (int quarter = 0; quarter < 4; ++quarter) {
      Patches16 its = patches;
      for (std::size_t i = 0; i < its.shapes.size(); ++i) {
        const auto& [a, b, c] = patches.corners[i];
        const Vec3 corner = quarter == 0 ? a : quarter == 1 ? 0.5 * (a + b) : 0.5 * (a + c);
        its.shapes[i].corner = split_point(quarter < 3 ? corner : 0.5 * (b + c));
        put((quarter < 3 ? 0.5 : -0.5) * (b - a), its.shapes[i].edge[0]);
        put((quarter < 3 ? 0.5 : -0.5) * (c - a), its.shapes[i].edge[1]);
      }
      scalar::kSampleKernels.tile_lattice(its.list(5), &finger, TilePart::whole, {&quarters, 1});
    }
    EXPECT_GT(norm(felt(whole).force), 0);
    expect_near(felt(quarters), felt(whole), 2e-6 * size * size * kRadius, "quarters");
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
      scalar::kSampleKernels.palm_lattice(patches.list(frame.origin, steps[k]), palm, sums);
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
                                        {-1, static_cast<float>(length), 1, 0, 0});
    const double size = 0.5 * kRadius;
    const Patches16 patches = patches_near(random, joint, 0.6 * kRadius, size);
    BodySums sums[2] = {sums_of_zero(), sums_of_zero()}, one[2] = {sums_of_zero(), sums_of_zero()};
    scalar::kSampleKernels.shared_lattice(patches.list(8), &finger, 2, {sums, 3});
    scalar::kSampleKernels.shared_lattice(patches.list(8), &finger, 2, {one, 2});
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
