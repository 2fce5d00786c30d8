// What limits let through: each segment by itself, smoothly, joints consistent with it.
#include "stages/force_limits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pressed_hand.h"
#include "random.h"
#include "session.h"

namespace lumbrical {
namespace {

constexpr double kLimit = 20;  // [N]

ActuatorFrame settled(const Scene& scene, const DeviceFrame& frame) {
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  return tick(model, state, scratch, frame);
}

TEST(ForceLimits, LetsSmallForcesThroughAndBoundsLargeOnes) {
  for (const double force : {0.0, 1e-300, 1.0, 15.9, kUnlimitedShare * kLimit})
    EXPECT_EQ(saturated(force, kLimit), force);
  EXPECT_GT(saturated(kLimit, kLimit), 0.9 * kLimit);
  for (const double force : {17.0, 20.0, 1e3, 1e9, 1e200}) {
    EXPECT_LE(saturated(force, kLimit), kLimit);
    EXPECT_LT(saturated(force, kLimit), force);
    EXPECT_EQ(saturated(force, 0), 0);
    EXPECT_LE(saturated(force, 1e-6), 1e-6);
  }
}

TEST(ForceLimits, SaturateWithoutAStepAKinkOrAFall) {
  const double step = 1e-3;
  double slope = 1, bend = 0;
  for (double force = 10; force < 60; force += step) {
    const double rise = (saturated(force + step, kLimit) - saturated(force, kLimit)) / step;
    ASSERT_GT(rise, 0) << force;
    ASSERT_LT(rise, 1 + 1e-9) << force;
    // Slope and curvature are continuous: no more than 1.5 / 4 N, and 3 / (4 N)^2 per newton.
    ASSERT_LT(std::fabs(rise - slope), 0.4 * step) << force;
    if (force > 10) {
      ASSERT_LT(std::fabs((rise - slope) / step - bend), 0.3 * step + 1e-4) << force;
    }
    bend = (rise - slope) / step;
    slope = rise;
  }
}

// Nothing of it is left to be hashed, kept or looked for.
TEST(ForceLimits, AFadeOfOneTickLeavesNothingHeld) {
  Scene scene = test::pressed_scene(0.3, 30);
  scene.settings.fade_time = 0;
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  DeviceFrame frame = test::pressed_frame(scene.hand, 0.001, 0.3);
  ASSERT_GT(norm(tick(model, state, scratch, frame).segment[kPalmSegment].force), 0);
  frame.flags |= kTrackingLost;
  EXPECT_EQ(norm(tick(model, state, scratch, frame).segment[kPalmSegment].force), 0);
  for (const Wrench& wrench : state.held.segment) {
    EXPECT_EQ(wrench.force, Vec3{});
    EXPECT_EQ(wrench.torque, Vec3{});
  }
}

TEST(ForceLimits, EverySegmentSaturatesByItselfAlongItsOwnLine) {
  Scene scene = test::pressed_scene(0.3, 30);
  scene.settings.fade_time = 0;
  scene.settings.max_force = 1e6;
  const DeviceFrame frame = test::pressed_frame(scene.hand, 0.001, 0.3);
  const ActuatorFrame all = settled(scene, frame);
  double most = 0;
  for (const Wrench& wrench : all.segment) most = max(most, norm(wrench.force));
  scene.settings.max_force = 0.5 * most;
  const ActuatorFrame limited = settled(scene, frame);
  EXPECT_EQ(all.flags & kForceLimited, 0u);
  EXPECT_NE(limited.flags & kForceLimited, 0u);
  int untouched = 0, reduced = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const double force = norm(all.segment[i].force);
    if (force <= kUnlimitedShare * scene.settings.max_force) {
      EXPECT_EQ(limited.segment[i].force, all.segment[i].force);
      EXPECT_EQ(limited.segment[i].torque, all.segment[i].torque);
      untouched += force > 0 ? 1 : 0;
      continue;
    }
    ++reduced;
    const double share = saturated(force, scene.settings.max_force) / force;
    EXPECT_LT(share, 1);
    EXPECT_LT(norm(limited.segment[i].force - share * all.segment[i].force), 1e-12);
    EXPECT_LT(norm(limited.segment[i].torque - share * all.segment[i].torque), 1e-12);
  }
  EXPECT_GT(untouched, 3);
  EXPECT_GT(reduced, 0);
}

TEST(ForceLimits, JointsCarryTheLimitedWrenchesOfTheirSegments) {
  test::Random random(7);
  Primitives hand;
  hand.joints.valid = (1u << kJointCount) - 1;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    hand.base_joint[i] = random.in_box(0.1);
    hand.flexion_axis[i] = random.direction();
  }
  HandForces forces;
  for (Wrench& wrench : forces.segment) {
    wrench = {random.between(0, 60) * random.direction(), random.in_box(0.5)};
  }
  Settings settings;
  settings.max_force = kLimit;
  settings.fade_time = 0;
  State state;
  const ActuatorFrame limited = limit_forces(settings, hand, forces, Trust::kept, 0, state);
  EXPECT_NE(limited.flags & kForceLimited, 0u);
  for (std::size_t joint = 0; joint < kSegmentCount; ++joint) {
    Vec3 torque;
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      const bool carried = joint == kPalmSegment || (i < kPalmSegment && i / 3 == joint / 3 && i >= joint);
      if (!carried) continue;
      const auto& [force, own] = limited.segment[i];
      EXPECT_LE(norm(force), kLimit);
      torque += own + cross(hand.base_joint[i] - hand.base_joint[joint], force);
    }
    EXPECT_LT(norm(limited.joint_torque[joint] - torque), 1e-12);
    EXPECT_NEAR(limited.flexion_torque[joint], dot(torque, hand.flexion_axis[joint]), 1e-12);
  }
}

TEST(ForceLimits, AStateThatTicksLeftIsTakenAndOneThatNoneLeavesIsNot) {
  Scene scene = test::pressed_scene(0.3, 30);
  scene.settings.max_force = 2;
  scene.settings.fade_time = 0.007;
  const Model model = test::model_of(scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  for (int i = 0; i < 60; ++i) {
    DeviceFrame frame = test::pressed_frame(scene.hand, 0.001, 0.3);
    if (i % 11 > 8) frame.flags = kTrackingLost;
    tick(model, state, scratch, frame);
    EXPECT_TRUE(check_state(model, state).ok()) << i;
  }
  State shares = state, objects = state, held = state, last = state;
  shares.rise = shares.fall = 0.6;
  objects.objects.emplace_back();
  held.fall = last.rise = last.fall = 0;
  held.held.joint_torque[3].z = 1;
  last.held = {};
  last.last.segment[2].force.y = -3;  // which would be gone at once
  for (const State& wrong : {shares, objects, held, last}) EXPECT_FALSE(check_state(model, wrong).ok());
}

TEST(ForceLimits, AFingertipKeepsItsForceWhenThePalmTouchesAWall) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.settings.fade_time = 0;
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  frame.base.orientation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // palm down
  const std::array<double, kAngleCount> straight{};
  std::array<Pose, kJointCount> pose;
  forward_kinematics(scene.hand, frame.base, straight, pose);
  const auto below = [](Mesh mesh, Vec3 at, double by) {
    for (Vec3& vertex : mesh.vertices) vertex += at - Vec3{0, 0, by};
    return mesh;
  };
  const Vec3 tip = pose[kIndexTip].position, palm = pose[kPalm].position;
  scene.objects = {{"ball", below(make_sphere(0.01, 8), tip, 0.01 + scene.hand.radius[kIndexTip] - 0.003)}};
  const ActuatorFrame alone = settled(scene, frame);
  const double force = norm(alone.segment[5].force);
  EXPECT_GT(force, 0.5);
  EXPECT_LT(force, kUnlimitedShare * scene.settings.max_force);
  scene.objects.push_back({"wall", below(make_plane(0.03, 3), palm, scene.hand.palm.height - 0.006)});
  const ActuatorFrame both = settled(scene, frame);
  EXPECT_NE(both.flags & kForceLimited, 0u);
  EXPECT_GT(norm(both.segment[kPalmSegment].force), 15);
  EXPECT_EQ(both.segment[5].force, alone.segment[5].force);
  EXPECT_LT(norm(both.joint_torque[5] - alone.joint_torque[5]), 1e-15);
}

}  // namespace
}  // namespace lumbrical
