// A finger that slips off what held it: its proxy goes its own way, and what it feels fades.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "largest.h"
#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "proxied_session.h"

namespace lumbrical {
namespace {

using test::feel;
using test::fingertip_at;
using test::kPadRadius;
using test::largest;
using test::proxy_at;
using test::proxy_scene;
using test::Session;

// The most that a finger's segment's force changes by. [N]
double step_of(const HandForces& before, const HandForces& now) {
  double most = 0;
  for (std::size_t s = 0; s < kPhalanxCount; ++s)
    most = largest(most, norm(now.segment[s].force - before.segment[s].force));
  return most;
}

// Hooked on the side of a box by two centimetres it is drawn up until nothing holds it: all that was held
// back comes free at once, and its force must not.
TEST(ProxySlip, LetsAForceFadeThatAFingerSlipsOff) {
  Scene scene = proxy_scene(make_box({0.1, 0.1, 0.1}, 7));
  scene.settings.fade_time = 0.02;  // 20 ticks
  Session run(scene);
  double before = 0, most = 0, fastest = 0;
  Vec3 was;
  for (int i = 0; i <= 700; ++i) {
    const double pressed = 1e-4 * min(i, 200), risen = 1e-4 * std::max(0, i - 200);
    feel(run, fingertip_at({0.05 + kPadRadius - pressed, 0.003, 0.03 + risen}));
    const double force = norm(test::hand_force(run.output));
    EXPECT_NEAR(force, before, 2) << i;
    before = force;
    most = largest(most, force);
    const Vec3 tip = proxy_at(run, kPhalanxJoints[2].tip);
    if (i > 0) fastest = largest(fastest, norm(tip - was));
    was = tip;
  }
  EXPECT_GT(most, 15);
  EXPECT_GT(fastest, 0.005);
  EXPECT_LT(before, 1e-9);
}

// A hand that closes too far round a mug of eight sides presses its thumb against the side, until it slips
// over the rim. It comes no nearer to the tracked one: its joints do, about which springs pull.
TEST(ProxySlip, LetsAForceFadeThatAThumbSlipsOffAwayFromTheHand) {
  const MugShape mug{.segments = 8};
  Scene scene = proxy_scene(make_mug(mug));
  scene.hand = default_hand(Side::right);
  scene.settings.precision.fill(1e-4);
  scene.settings.max_force = 20;
  scene.settings.fade_time = 0.02;
  Session run(scene);
  const Motion grasp = make_grasp(scene.hand, 0.03, mug.height, 4);
  double fastest = 0, behind_before = 0, away = 0;
  for (int i = 0; i <= 1900; ++i) {
    const HandForces felt = run.output;
    const Vec3 was = run.state.proxy ? proxy_at(run, kThumbDistal) : Vec3{};
    feel(run, resample(grasp, i / 1000.0));
    const Vec3 now = proxy_at(run, kThumbDistal);
    const double behind = norm(run.state.proxy->tracked[kThumbDistal] - now);
    if (i > 100) {
      EXPECT_LT(step_of(felt, run.output), 2) << i;
      fastest = largest(fastest, norm(now - was));
      away = largest(away, behind - behind_before);
    }
    behind_before = behind;
  }
  EXPECT_GT(fastest, 0.005) << "it slips";
  EXPECT_GT(away, 0.002);
}

std::array<Pose, kJointCount> joints_of(const Hand& hand, const DeviceFrame& frame) {
  std::array<double, kAngleCount> angles;
  std::copy(frame.angle.begin(), frame.angle.end(), angles.begin());
  std::array<Pose, kJointCount> joints;
  forward_kinematics(hand, frame.base, angles, joints);
  return joints;
}

// [m] The farthest that a joint of the tracked hand goes between two frames.
double way_between(const Hand& hand, const DeviceFrame& before, const DeviceFrame& now) {
  const auto was = joints_of(hand, before), is = joints_of(hand, now);
  double most = 0;
  for (std::size_t j = 0; j < kJointCount; ++j) most = largest(most, norm(is[j].position - was[j].position));
  return most;
}

// Cores of a hand that closes much too far round a mug go from face to face and from segment to segment, each
// with all that it pushes with: what is felt goes there no faster than the hand's way accounts for.
TEST(ProxySlip, LetsNoForceHopInAFirmGrip) {
  const MugShape mug{.segments = 8};
  Scene scene = proxy_scene(make_mug(mug));
  scene.hand = default_hand(Side::right);
  scene.settings.precision.fill(1e-3);
  scene.settings.max_force = 50;
  scene.settings.fade_time = 0.02;
  Session run(scene);
  const Motion grasp = make_grasp(scene.hand, 0.025, mug.height, 3);
  const double radius = *std::max_element(scene.hand.radius.begin(), scene.hand.radius.end()),
               field = 1.5708 * scene.settings.stiffness * radius * radius,
               stiffness = largest(test::kProxyStiffness, field);
  double most = 0, hopped = 0;
  DeviceFrame frame = resample(grasp, 0);
  for (int i = 1; i <= 1800; ++i) {
    const DeviceFrame before = frame;
    const HandForces felt = run.output, was = run.scratch.forces;
    frame = resample(grasp, i / 1000.0);
    feel(run, frame);
    if (i < 650) continue;  // it arrives
    const double accounted = 0.11 + 1.5 * stiffness * way_between(scene.hand, before, frame);
    EXPECT_LT(step_of(felt, run.output), accounted) << i;
    hopped = largest(hopped, step_of(was, run.scratch.forces) - accounted);
    for (const Wrench& segment : run.output.segment) most = largest(most, norm(segment.force));
  }
  EXPECT_GT(most, 20);
  EXPECT_GT(hopped, 5) << "what is felt does, and its forces do not";
}

// A plate shakes by 4 mm, 10 times a second, at a fingertip that it presses with up to 35 N.
TEST(ProxySlip, LetsNothingFadeThatAnObjectPressesWithThatShakes) {
  Scene scene = proxy_scene(make_box({0.06, 0.06, 0.02}, 4));
  scene.objects[0].mechanism.mobility = Mobility::given;
  scene.settings.fade_time = 0.02;
  Session run(scene);
  double most = 0;
  for (int i = 0; i < 600; ++i) {
    const double z = i < 200 ? 1e-4 * (i - 200) : 0.004 * std::sin(0.0628 * (i - 200));
    const std::vector<ObjectFrame> given{{{{0, 0, z}, {}}}};
    run.feel(fingertip_at({0.002, 0.001, 0.008}), given);
    EXPECT_TRUE(i < 30 || (run.output.flags & kFading) == 0) << i;
    most = largest(most, test::hand_force(run.output).z);
  }
  EXPECT_GT(most, 30);
}

// A hand that does not move feels all of what a box is caught with.
TEST(ProxySlip, LetsAStillHandFeelABoxThatFallsOnIt) {
  Scene scene = proxy_scene(make_box({0.06, 0.06, 0.06}, 4));
  scene.objects[0] = test::body_of("box", make_box({0.06, 0.06, 0.06}, 4), 0.3, {{0, 0, 0.1}, {}}, {});
  scene.settings.fade_time = 0.02;
  Session run(scene);
  Vec3 felt, done;
  for (int i = 0; i < 190; ++i) {
    done += 0.001 * run.step(fingertip_at({}, {0, 0, -1})).wrench.force;
    felt += 0.001 * test::hand_force(run.output);
  }
  EXPECT_GT(done.z, 0.3);
  EXPECT_NEAR(felt.z, -done.z, 0.02 * done.z);
}

// Pressed by more than a centimetre at 3 m/s, drawn along at 3 m/s, and taken back.
TEST(ProxySlip, LetsNothingFadeThatGoesNoFasterThanTheHand) {
  Session run(proxy_scene(make_box({1, 1, 0.02}, 5)));
  Vec3 tip{-0.2, 0.02, 0.03};
  const auto go = [&](Vec3 way, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      tip += way;
      feel(run, fingertip_at(tip));
      EXPECT_EQ(run.output.flags & kFading, 0u) << tip.x << " " << tip.z;
    }
  };
  for (int i = 0; i < 30; ++i) feel(run, fingertip_at(tip));  // all of the force is its own
  go({0, 0, -0.003}, 9);
  EXPECT_GT(proxy_at(run, kPhalanxJoints[2].tip).z, tip.z + 0.005);
  EXPECT_GT(test::hand_force(run.output).z, 10);
  go({0.003, 0, 0}, 100);
  go({0.003, 0, 0.0003}, 20);
  go({0, 0, 0.003}, 9);
  EXPECT_EQ(norm(test::hand_force(run.output)), 0);
}

}  // namespace
}  // namespace lumbrical
