// Target: under the field law a finger that is led round a closed path over edges and corners does no work,
// to 1e-9 of the largest force times the path's length; what the other laws do stands beside it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments.h"

namespace lumbrical::bench {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

PosedFinger tapered() {
  PosedFinger finger = one_phalanx();
  finger.radius = {0.008, 0.006};
  return finger;
}

// How much work the laws that follow the paper's depth do, about; half and double of it are allowed.
struct Expected {
  Obstacle obstacle;
  double column, max_depth;
};
void PrintTo(const Expected& expected, std::ostream* out) {
  std::string name = obstacle_name(expected.obstacle);
  std::erase_if(name, [](char c) { return c == ' ' || c == ','; });
  *out << name;
}
constexpr Expected kExpected[] = {
    {Obstacle::edge_30, 1.5e-3, 2.9e-3},         {Obstacle::edge_90, 1.2e-2, 1.8e-2},
    {Obstacle::edge_90_turning, 1.5e-2, 1.9e-2}, {Obstacle::hook_90, 1.0e-1, 9.7e-2},
    {Obstacle::cube_corner, 1.0e-3, 1.7e-3},     {Obstacle::tetrahedron_vertex, 1.4e-2, 6.2e-3},
};

class ClosedLoop : public testing::TestWithParam<Expected> {};

TEST_P(ClosedLoop, CostsNoWorkUnderTheFieldLaw) {
  for (const PosedFinger& finger : {one_phalanx(), tapered()}) {
    const LoopWork loop = work_over(GetParam().obstacle, finger, Law::field, 1e-11, 12);
    EXPECT_GT(loop.largest_force, 0.02);
    EXPECT_LT(loop.relative_error(), 1e-10);  // of the path's quadrature
    EXPECT_LT(std::fabs(loop.relative()) + loop.relative_error(), 1e-9);
  }
}

TEST_P(ClosedLoop, CostsWorkUnderThePapersDepth) {
  const double column = work_over(GetParam().obstacle, one_phalanx(), Law::column, 1e-5, 5).relative();
  EXPECT_GT(std::fabs(column), 0.5 * GetParam().column);
  EXPECT_LT(std::fabs(column), 2 * GetParam().column);
  const double paper = work_over(GetParam().obstacle, one_phalanx(), Law::max_depth, 1e-4, 4).relative();
  EXPECT_GT(std::fabs(paper), 0.5 * GetParam().max_depth);
  EXPECT_LT(std::fabs(paper), 2 * GetParam().max_depth);
}

INSTANTIATE_TEST_SUITE_P(Obstacles, ClosedLoop, testing::ValuesIn(kExpected),
                         testing::PrintToStringParamName());

// The bound of the quadrature's error really is one: a finer quadrature moves the work by less.
TEST(ClosedLoop, ErrorOfTheQuadratureIsBounded) {
  for (const Law law : {Law::field, Law::column}) {
    const LoopWork rough = work_over(Obstacle::hook_90, one_phalanx(), law, 1e-4, 2);
    const LoopWork fine = work_over(Obstacle::hook_90, one_phalanx(), law, 1e-9, 8);
    EXPECT_GT(fine.nodes, 2 * rough.nodes);
    EXPECT_LT(std::fabs(rough.work - fine.work), rough.error + fine.error);
  }
}

// Three phalanges, bent: what shares out space between them must not cost work either.
TEST(ClosedLoop, OfABentFingerCostsNoWorkWhereItsPhalangesMeet) {
  const Mesh edge = bent_plane(90 * kDegree, 0.2, 0.006, 0.006, 61);
  // The edge runs across the middle phalanx, 2 mm deep, and the path takes it over both joints.
  const PosedFinger finger = bent_finger(40 * kDegree, 35 * kDegree);
  const Vec3 middle = 0.5 * (finger.joints[1] + finger.joints[2]);
  const double turn = 0.5 * 40 * kDegree;
  const Quat level{std::cos(turn), 0, -std::sin(turn), 0};  // the middle phalanx lies level
  ClosedPath path;
  path.start = {Vec3{0, 0, kRadius - 0.001} - rotate(level, middle), level};
  path.cosine = {0.016, 0.002, 0};
  path.sine = {0, 0, 0.003};
  path.turn = {0.1, 0, 0.2};
  Rig rig = make_rig(edge, finger, Law::field);
  const LoopWork loop = work_round(rig, path, 1e-10, 12);
  EXPECT_GT(loop.largest_force, 1);
  EXPECT_LT(loop.relative_error(), 1e-9);
  EXPECT_LT(std::fabs(loop.relative()), 1e-9);
}

// While joints bend, phalanges also press on each other where they meet; no contact force tells of that, so
// the segments' forces and torques are no gradient. What is left undone stays below a hundredth.
TEST(ClosedLoop, OfBendingJointsCostsLittle) {
  for (const bool tapered : {false, true}) {
    for (const double bend : {0.0, 40.0, 80.0}) {
      const LoopWork loop = work_of_bending(bend * kDegree, 0.9 * bend * kDegree, tapered, Law::field, 512);
      EXPECT_GT(loop.largest_force, 1);
      EXPECT_LT(std::fabs(loop.relative()), 1e-2);
    }
  }
}

}  // namespace
}  // namespace lumbrical::bench
