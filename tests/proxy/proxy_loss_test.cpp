// Where the proxy begins, ends and goes on: losses of tracking, and what comes to lie across it.
#include <gtest/gtest.h>

#include "model/primitive.h"
#include "pressed_hand.h"
#include "proxied_session.h"

namespace lumbrical {
namespace {

using test::feel;
using test::fingertip_at;
using test::proxy_at;
using test::proxy_scene;
using test::Session;

TEST(Proxy, FollowsTheHandAgainWhereItComesOutAndStartsAnewAfterALoss) {
  Session run(proxy_scene(make_box({0.1, 0.1, 0.001}, 5)));
  const auto tip = [&] { return proxy_at(run, kPhalanxJoints[2].tip); };
  for (int i = 0; i < 30; ++i) feel(run, fingertip_at({0, 0, 0.015 - 0.001 * i}));
  EXPECT_GT(tip().z, 0.0035);
  for (int i = 30; i >= 0; --i) feel(run, fingertip_at({0, 0, 0.015 - 0.001 * i}));
  EXPECT_EQ(static_cast<float>(tip().z), 0.015f);
  for (int i = 0; i < 30; ++i) feel(run, fingertip_at({0, 0, 0.015 - 0.001 * i}));
  DeviceFrame lost;
  lost.flags = kTrackingLost;
  feel(run, lost);
  feel(run, fingertip_at({0, 0, -0.04}));  // as if it had always been there
  EXPECT_EQ(static_cast<float>(tip().z), -0.04f);
}

// Pressed 2 cm through a sheet, and another in the air.
DeviceFrame two_fingertips(int millimetres) {
  DeviceFrame frame = fingertip_at({0, 0, 0.015 - 0.001 * millimetres});
  const DeviceFrame other = test::frame_of({{{0, 0.05, 0.06}, {0, 0, 1}}, {{0, 0.03, 0.05}, {0, 0, 1}}});
  const auto [base, tip] = kPhalanxJoints[5];
  for (const auto joint : {base, tip}) {
    frame.joint[joint] = other.joint[joint];
    frame.valid |= 1u << joint;
  }
  return frame;
}

TEST(Proxy, HoldsWhileJointsAreLostAndFoundAgain) {
  for (const std::size_t lost : {std::size_t{5}, std::size_t{2}}) {  // the one in the air; the one pressed
    Session run(proxy_scene(make_plane(0.1, 9, 0.7)));
    for (int i = 0; i < 35; ++i) feel(run, two_fingertips(i));
    const double force = test::hand_force(run.output).z;
    EXPECT_GT(force, 20);
    for (int i = 0; i < 60; ++i) {
      DeviceFrame frame = two_fingertips(35);
      if (i % 12 < 6) frame.valid &= ~(1u << kPhalanxJoints[lost].tip);
      feel(run, frame);
      ASSERT_GT(proxy_at(run, kPhalanxJoints[2].tip).z, 0) << lost << " tick " << i;
      const bool is_felt = lost == 5 || i % 12 >= 6;
      EXPECT_NEAR(test::hand_force(run.output).z, is_felt ? force : 0, 0.05 * force) << lost << " tick " << i;
    }
    for (int i = 35; i >= 0; --i) {
      feel(run, two_fingertips(i));
      EXPECT_GE(test::hand_force(run.output).z, 0) << lost;
    }
    EXPECT_EQ(run.state.proxy->valid, two_fingertips(0).valid);
  }
}

// A plate that is moved from outside.
SceneObject moved_plate(Vec3 size) {
  SceneObject plate = test::object_of("moved plate", make_box(size, 2), {}, {});
  plate.mechanism.mobility = Mobility::given;
  return plate;
}

TEST(Proxy, LetsGoOfWhatCameToLieAcrossItsAxis) {
  for (const double thickness : {0.0005, 0.1}) {
    Scene scene = proxy_scene(make_box({0.1, 0.1, 0.1}, 2));
    scene.objects = {moved_plate({0.2, 0.2, thickness})};
    scene.settings.fade_time = 0.05;
    Session run(scene);
    const auto feel_at = [&](double surface, double height) {
      const ObjectFrame told{{{0, 0, surface - thickness / 2}, {}}};
      return test::hand_force(run.feel(fingertip_at({0, 0, height}, {0.6, 0, 0.8}), {&told, 1}));
    };
    for (int i = 0; i < 100; ++i) feel_at(-0.02, 0.008);
    Vec3 force;
    for (double surface = 0; surface < 0.004; surface += 1e-4) force = feel_at(surface, 0.008);
    EXPECT_GT(run.state.proxy->valid, 0);
    const Vec3 next = feel_at(0.014, 0.008);
    EXPECT_EQ(run.state.proxy->valid, 0) << thickness;
    EXPECT_LT(norm(next - force), 0.5) << "it fades";
    for (int i = 0; i < 300; ++i) force = feel_at(0.014, 0.008 + 1e-4 * i);
    EXPECT_GT(run.state.proxy->valid, 0) << thickness;
    EXPECT_NEAR(proxy_at(run, kPhalanxJoints[2].tip).z, 0.0379, 1e-6) << thickness;
    EXPECT_EQ(norm(force), 0) << thickness;
  }
}

TEST(Proxy, HoldsOnWhereOnlyALostFingerIsCrossed) {
  Scene scene = proxy_scene(make_plane(0.1, 9, 0.7));
  scene.objects.push_back(moved_plate({0.02, 0.02, 0.001}));
  Session run(scene);
  ObjectFrame told{{{0.03, 0.03, 0.08}, {}}};
  const auto feel_at = [&](const DeviceFrame& frame) {
    return test::hand_force(run.feel(frame, {&told, 1})).z;
  };
  for (int i = 0; i < 35; ++i) feel_at(two_fingertips(i));
  DeviceFrame frame = two_fingertips(35);
  frame.valid &= ~(1u << kPhalanxJoints[5].tip);
  const double force = feel_at(frame);
  EXPECT_GT(force, 20);
  const Vec3 base = proxy_at(run, kPhalanxJoints[5].base), tip = proxy_at(run, kPhalanxJoints[5].tip);
  told.pose.position = 0.5 * (base + tip);
  for (int i = 0; i < 20; ++i) EXPECT_NEAR(feel_at(frame), force, 0.05 * force) << i;
  EXPECT_EQ(run.state.proxy->valid, frame.valid);
  EXPECT_GT(proxy_at(run, kPhalanxJoints[2].tip).z, 0);
}

TEST(Proxy, DoesNotBeginAroundANeedleThroughThePalm) {
  Mesh needle;
  needle.vertices = {{-0.002, 0, -0.2}, {0.002, 0, -0.2}, {0, 0, 0.1}};
  needle.triangles = {{0, 1, 2}};
  Scene scene = proxy_scene(std::move(needle));
  scene.hand = default_hand(Side::right);
  DeviceFrame frame = test::pressed_frame(scene.hand, 0, 0);
  for (const double x : {0.0, 0.01, 0.2}) {
    Session run(scene);
    frame.base.position = {x, -0.06, 0};
    feel(run, frame);
    EXPECT_EQ(run.state.proxy->valid != 0, x == 0.2) << x;
  }
}

TEST(Proxy, WithoutAWristThereIsNone) {
  Session run(proxy_scene(make_plane(0.1, 9, 0.7)));
  DeviceFrame frame = fingertip_at({0, 0, 0.02});
  feel(run, frame);
  EXPECT_GT(run.state.proxy->valid, 0);
  frame.valid &= ~(1u << kWrist);
  feel(run, frame);
  EXPECT_EQ(run.state.proxy->valid, 0);
}

// A headset is recentred, or the player is sent elsewhere: what lay between was never in the hand's way.
TEST(Proxy, BeginsAnewWhereAHandHasJumpedTo) {
  Session run(proxy_scene(make_box({0.1, 0.1, 0.1}, 5)));
  feel(run, fingertip_at({0, 0, 0.056}));
  feel(run, fingertip_at({0, 0, 0.054}));
  ASSERT_GT(run.state.proxy->valid, 0);
  const Vec3 beyond{0, 0, -0.12};
  feel(run, fingertip_at(beyond));
  EXPECT_NE(run.output.flags & kHandJumped, 0u);
  EXPECT_NEAR(norm(proxy_at(run, kWrist) - beyond), 0.15, 1e-6) << "as far as from the tracked fingertip";
  EXPECT_EQ(norm(test::hand_force(run.output)), 0);
}

// Where it is too much is near the cores, and its next way begins there, wherever the hand has gone.
TEST(Proxy, BeginsAnewAfterATickInWhichTooMuchWasNear) {
  Scene scene = proxy_scene(make_plane(0.02, 60));
  scene.settings.max_candidates = 400;
  scene.objects.push_back({"table", make_plane(4, 1)});
  place_mesh({{2.5, 0, 0}, {}}, scene.objects[1].mesh);
  Session run(scene);
  for (int i = 0; i < 50; ++i) feel(run, fingertip_at({0, 0, 0.03 - 0.0005 * min(i, 47)}));
  EXPECT_NE(run.output.flags & kCandidateOverflow, 0u);
  for (int i = 0; i <= 25; ++i) feel(run, fingertip_at({0.1 * i, 0, 0.03}));
  for (int i = 0; i < 3; ++i) feel(run, fingertip_at({2.5, 0, 0.03}));
  EXPECT_EQ(run.output.flags & kCandidateOverflow, 0u);
  EXPECT_GT(run.state.proxy->valid, 0);
  for (int i = 1; i <= 100; ++i) feel(run, fingertip_at({2.5, 0, 0.03 - 0.0003 * i}));
  EXPECT_GT(proxy_at(run, kPhalanxJoints[2].tip).z, 0.003);
  EXPECT_GT(test::hand_force(run.output).z, 1);
}

}  // namespace
}  // namespace lumbrical
