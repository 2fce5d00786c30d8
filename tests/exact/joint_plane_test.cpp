// Fingers whose joints lie in the plane of what they touch, or all but in it: the border of two tiles, a cone
// with its apex at the joint, then cuts the plane in two straights, or in a curve that nearly breaks there.
#include <gtest/gtest.h>

#include <cmath>

#include "largest.h"
#include "shaped_finger.h"

namespace lumbrical {
namespace {

using namespace test;

// A square from -half to half along u and v in cells x cells squares of two triangles.
Mesh plane_of(Vec3 middle, Vec3 u, Vec3 v, double half, std::uint32_t cells) {
  Mesh mesh;
  for (std::uint32_t i = 0; i <= cells; ++i) {
    for (std::uint32_t k = 0; k <= cells; ++k)
      mesh.vertices.push_back(middle + half * (2.0 * i / cells - 1) * u + half * (2.0 * k / cells - 1) * v);
  }
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t k = 0; k < cells; ++k) {
      const std::uint32_t at = i * (cells + 1) + k, next = at + cells + 1;
      mesh.triangles.push_back({at, next, next + 1});
      mesh.triangles.push_back({at, next + 1, at + 1});
    }
  }
  return mesh;
}

struct Plane {
  Vec3 middle, u, v, n;
  double half;
  std::uint32_t cells;
  [[nodiscard]] Mesh at(double height) const { return plane_of(middle + height * n, u, v, half, cells); }
};

FingerShape tapered_finger(Random& random) {
  FingerShape shape = random_finger(random);
  if (random.bits() % 2 != 0) shape.radius = {0.0103, 0.0088, 0.0076, 0.0066};
  if (random.bits() % 2 != 0) shape.length = {0.040, 0.025, 0.020};
  if (random.bits() % 3 == 0) shape.sideways = 0;
  return shape;
}

enum class Turned : std::uint8_t { anyhow, along_an_axis, across_a_bisecting_plane };

Plane plane_through_a_joint(const Primitives& hand, Turned turned, Random& random) {
  const std::size_t phalanx = 3 + random.below(2);
  const Vec3 joint =
      random.below(4) == 0 ? hand.capsule[3 + random.below(3)].end1 : hand.capsule[phalanx].end2;
  Vec3 n = random.direction();
  if (turned == Turned::along_an_axis) n = unit_or(cross(hand.direction[phalanx], n), n);
  if (turned == Turned::across_a_bisecting_plane) n = unit_or(cross(hand.border[phalanx].normal, n), n);
  const Vec3 u = unit_or(cross(n, random.direction()), {1, 0, 0}), v = cross(n, u);
  const auto aside = [&] { return random.below(3) == 0 ? 0.0 : random.between(-0.4, 0.4) * kRadius; };
  const double half[] = {0.06, 0.5, 20};
  const std::uint32_t cells[] = {1, 1, 6};
  const std::size_t kind = random.below(3);
  const double along = aside(), across = aside();
  return {joint + along * u + across * v, u, v, n, half[kind], half[kind] < 0.1 ? cells[random.below(3)] : 1};
}

// [m^3] What the sum over a plane is off by, and by how much it may step where a border all but meets a
// joint.
constexpr double kCube = kRadius * kRadius * kRadius, kOff = 1e-10 * kCube, kLeastStep = 1e-6 * kCube;

// [m^3] What contacts may state as their error at most, where so many parts would be cut that some are left,
// and as a rule.
constexpr double kMostUnsure = 1.6e-3 * kCube, kUsuallyUnsure = 3e-7 * kCube;

constexpr double kHeights[] = {-1e-6, -1e-8, -1e-9, -1e-10, -1e-11, -1e-12, 0,
                               1e-12, 1e-11, 1e-10, 1e-9,   1e-8,   1e-6};

TEST(JointInAPlane, ForceChangesNoFasterThanTheFingerMoves) {
  int usual = 0, felt_count = 0;
  for (int i = 0; i < finger_count(400); ++i) {
    Random random(static_cast<std::uint64_t>(31000 + i));
    const FingerShape shape = tapered_finger(random);
    const Primitives hand = posed(shape, random.pose(0.1));
    const Plane plane = plane_through_a_joint(hand, static_cast<Turned>(i % 3), random);
    Felt last = feel(hand, plane.at(kHeights[0]));
    double height = kHeights[0];
    for (const double next : kHeights) {
      const Felt felt = feel(hand, plane.at(next));
      const double bound = largest(felt.area, last.area) * (next - height);
      EXPECT_LE(std::fabs(felt.volume - last.volume), bound + felt.error + last.error + kLeastStep)
          << i << ' ' << next;
      EXPECT_LE(felt.error, kMostUnsure) << i << ' ' << next;
      usual += felt.error <= kUsuallyUnsure ? 1 : 0;
      ++felt_count;
      last = felt;
      height = next;
    }
  }
  EXPECT_GT(usual, 0.97 * felt_count);
}

TEST(JointInAPlane, ForceIsTheLargestFieldsIntegral) {
  for (int i = 0; i < finger_count(3); ++i) {
    Random random(static_cast<std::uint64_t>(62000 + i));
    const FingerShape shape = tapered_finger(random);
    const Primitives hand = posed(shape, random.pose(0.1));
    // A plane along an axis takes the reference hours.
    Plane plane = plane_through_a_joint(hand, Turned::anyhow, random);
    plane.cells = 1;
    const double height = kHeights[random.below(std::size(kHeights))];
    const Mesh mesh = plane.at(height);
    double expected = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      expected +=
          finger_reference(capsules_of(hand), mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]).volume;
    }
    EXPECT_NEAR(feel(hand, mesh).volume, expected, kOff) << i << ' ' << height;
  }
}

}  // namespace
}  // namespace lumbrical
