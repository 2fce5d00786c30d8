// Places that few hands hit by chance, by the exact rung: an edge that a joint's cut leaves no length, and a
// finger folded right back on itself. Lengths are exact in binary.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "pads.h"

namespace lumbrical::test {
namespace {

// [m] All lengths below are multiples of it.
constexpr double kStep = 1.0 / 128;

struct PlacedJoint {
  std::size_t joint;
  Vec3 at;
  double radius = 1;
};

ActuatorFrame felt(Scene scene, const std::vector<PlacedJoint>& joints) {
  DeviceFrame frame;
  frame.valid = 0;
  for (const PlacedJoint& placed : joints) {
    const Vec3 p = kStep * placed.at;
    frame.joint[placed.joint].position = {static_cast<float>(p.x), static_cast<float>(p.y),
                                          static_cast<float>(p.z)};
    frame.valid |= 1u << placed.joint;
    scene.hand.radius[placed.joint] = placed.radius * kStep;
  }
  return Session(scene).feel(frame);
}

SceneObject as_it_is(Mesh mesh) { return {"object", std::move(mesh), Winding::as_is}; }

Mesh triangle_of(Vec3 a, Vec3 b, Vec3 c) { return {{kStep * a, kStep * b, kStep * c}, {{0, 1, 2}}}; }

// The plane cuts the finger's end sphere in a disc whose deepest point lies in the plane that ends the
// phalanx, and in a corner of what that leaves of the triangle.
TEST(ExactCoincidences, DepthIsThatOfADiscWhoseMiddleLiesInACut) {
  const double depth = (1 - 2 / std::sqrt(5.0)) * kStep, area = 0.2 * std::numbers::pi * kStep * kStep;
  for (const double off : {0.0, 1e-9}) {
    Scene scene = pad_scene();
    scene.settings.law.fill(Law::max_depth);
    scene.objects = {as_it_is(triangle_of({off, 3, 6}, {-2, -1, -2}, {off, 3, -4}))};
    const Vec3 force = hand_force(felt(scene, {{kIndexDistal, {0, 1, -2}}, {kIndexTip, {4, 1, -2}}}));
    const double expected = scene.settings.stiffness * area * depth;
    EXPECT_NEAR(norm(force), expected, 1e-6 * expected) << off;
  }
}

// By the limit, and by samples, which know nothing of the plane between two phalanges.
TEST(ExactCoincidences, AFingerFoldedRightBackFeelsWhatOneFoldedAlmostSoFeels) {
  const Pose upright{{0, -0.5 * kStep, 0}, normalized({1, -1, 0, 0})};
  Mesh triangle = triangle_of({-20, -20, 0}, {20, -19, 0}, {3, 20, 0}),
       box = make_box({3 * kStep, 3 * kStep, 8 * kStep}, 1);
  for (Mesh* const mesh : {&triangle, &box}) {
    place_mesh(upright, *mesh);
    Scene scene = pad_scene();
    scene.objects = {as_it_is(*mesh)};
    const auto folded = [&](double off) {
      return hand_force(felt(scene, {{kIndexProximal, {0, 0, -1}, 1},
                                     {kIndexIntermediate, {0, 0, -4}, 2},
                                     {kIndexDistal, {off, 0, 0}, 2},
                                     {kIndexTip, {off, 0, 2}, 1}}));
    };
    const Vec3 force = folded(0);
    EXPECT_GT(norm(force), 10);
    EXPECT_LT(norm(force - folded(1e-6)), 1e-5 * norm(force));
    scene.settings.precision.fill(1e-5);
    EXPECT_LT(norm(force - folded(0)), 1e-4 * norm(force));
  }
}

}  // namespace
}  // namespace lumbrical::test
