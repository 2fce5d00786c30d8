// Hard cases of a whole finger in a tick, with their physical values: straight, folded and degenerate
// fingers, meshes with rubbish in them, places far from the origin.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments.h"

namespace lumbrical {
namespace {

constexpr double kPi = std::numbers::pi;

// Radius, height over the plane and half width of the section of a lying phalanx: 5, 3, 4, all exact.
constexpr double kR = 5.0 / 1024, kH = 3.0 / 1024, kRho = 4.0 / 1024;

// What a disc cuts out of the field of a sphere, and a strip out of that of a lying cylinder, per length.
double sphere_field() { return kPi * (kR - kH) * (kR - kH) * (kR + 2 * kH) / 3; }
double lying_field() { return kRho * kR - kH * kH * std::asinh(kRho / kH); }

// A finger of three phalanges whose lengths are powers of two, so that joints are exact in single precision.
bench::PosedFinger exact_finger(double first, double second, double third) {
  return {{Vec3{}, {first, 0, 0}, {first + second, 0, 0}, {first + second + third, 0, 0}},
          std::vector<double>(4, kR)};
}

Vec3 force_of(const bench::PosedFinger& finger, Law law, std::uint32_t* flags = nullptr) {
  bench::Rig rig = bench::make_rig(bench::graded_plane(0.3, 0.3, 0.006, 7), finger, law);
  const bench::Felt felt = bench::feel(rig, {{-0.06, 0.003, kH}, {}});
  if (flags != nullptr) *flags = felt.flags;
  return felt.force;
}

TEST(HardTick, AStraightFingerIsOneCapsule) {
  const double length = 0.125;
  const double disc = kPi * kRho * kRho;
  for (const auto& finger :
       {exact_finger(0.0625, 0.03125, 0.03125), exact_finger(0.03125, 0.03125, 0.0625)}) {
    const double field = 2e7 * (length * lying_field() + sphere_field());
    EXPECT_NEAR(force_of(finger, Law::field).z / field, 1, 1e-11);
    const double segment = kR * kR * std::acos(kH / kR) - kH * kRho;
    const double cap = kPi * (kR - kH) * (kR - kH) * (2 * kR + kH) / 3;
    EXPECT_NEAR(force_of(finger, Law::column).z / (2e7 * (length * segment + cap)), 1, 1e-11);
    // The paper's laws: no less than its area times the mean depth, no more than times the largest.
    const double area = 2 * kRho * length + disc;
    EXPECT_LT(force_of(finger, Law::max_depth).z, 2e7 * area * (kR - kH) * (1 + 1e-12));
    EXPECT_GT(force_of(finger, Law::max_depth).z, 2e7 * (length * segment + cap));
  }
}

TEST(HardTick, APhalanxOfNoLengthIsFlaggedAndChangesNothing) {
  for (const Law law : {Law::field, Law::column}) {
    std::uint32_t flags = 0;
    const Vec3 whole = force_of(exact_finger(0.0625, 0.03125, 0.03125), law);
    for (const auto& finger :
         {exact_finger(0.125, 0, 0), exact_finger(0, 0.125, 0), exact_finger(0.0625, 0, 0.0625)}) {
      EXPECT_LT(norm(force_of(finger, law, &flags) - whole), 1e-11 * whole.z) << law_name(law);
      EXPECT_EQ(flags & kSegmentDegenerate, std::uint32_t{kSegmentDegenerate});
    }
  }
}

TEST(HardTick, AFingerFoldedUponItselfIsFeltOnce) {
  // The second of two phalanges runs back along the first, all within it.
  const bench::PosedFinger folded{{Vec3{}, {0.0625, 0, 0}, {0.03125, 0, 0}}, std::vector<double>(3, kR)};
  const double field = 2e7 * (0.0625 * lying_field() + sphere_field());
  EXPECT_NEAR(force_of(folded, Law::field).z / field, 1, 1e-11);
}

TEST(HardTick, FarFromTheOriginTheWholeTickFeelsTheSameBits) {
  const bench::PosedFinger finger{{Vec3{}, {0.03125, 0, -0.001953125}, {0.0546875, 0.0078125, 0}},
                                  {kR, kR, 0.75 * kR}};
  const Mesh near{{{-0.125, -0.125, 0}, {0.125, -0.125, 0}, {0.125, 0.125, 0.0009765625}, {-0.125, 0.125, 0}},
                  {{0, 1, 2}, {0, 2, 3}}};
  for (const Law law : bench::kLaws) {
    bench::Rig here = bench::make_rig(near, finger, law);
    const Vec3 place{0.0078125, -0.00390625, kH};
    const bench::Felt expected = bench::feel(here, {place, {}});
    ASSERT_GT(expected.contacts, 1u);
    for (const double offset : {1.0, 1024.0, 1048576.0}) {
      const Vec3 away{offset, -2 * offset, 0.5 * offset};
      Mesh mesh = near;
      for (Vec3& p : mesh.vertices) p += away;
      bench::Rig there = bench::make_rig(mesh, finger, law);
      const bench::Felt felt = bench::feel(there, {place + away, {}});
      EXPECT_EQ(felt.contacts, expected.contacts) << offset;
      // The paper's depth follows points of W through the finger, and centres of pressure are kept in W:
      // there they have the resolution of doubles.
      if (law == Law::field || law == Law::column) {
        EXPECT_EQ(felt.force, expected.force) << law_name(law) << ' ' << offset;
      } else {
        EXPECT_LT(norm(felt.force - expected.force), 1e-15 * offset / kH * norm(expected.force))
            << law_name(law) << ' ' << offset;
      }
      EXPECT_LT(norm(felt.torque - expected.torque), 1e-15 * offset * norm(expected.force) + 1e-12)
          << law_name(law) << ' ' << offset;
    }
  }
}

TEST(HardTick, DenormalAndDegenerateTrianglesOfAMeshChangeNothing) {
  Mesh mesh = bench::graded_plane(0.3, 0.3, 0.006, 7);
  const Vec3 clean = force_of(exact_finger(0.0625, 0.03125, 0.03125), Law::field);
  for (const double size : {0.0, 5e-324, 1e-310, 1e-200}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {Vec3{0, 0, 0}, Vec3{size, 0, 0}, Vec3{0, size, 0}});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  bench::Rig rig = bench::make_rig(mesh, exact_finger(0.0625, 0.03125, 0.03125), Law::field);
  EXPECT_LT(norm(bench::feel(rig, {{-0.06, 0.003, kH}, {}}).force - clean), 1e-14 * clean.z);
}

}  // namespace
}  // namespace lumbrical
