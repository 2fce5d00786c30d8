// A finger that slips off what held it: its proxy goes its own way, and what it feels fades.
#include <gtest/gtest.h>

#include <algorithm>

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

// The most that a segment's force changes by. [N]
double step_of(const HandForces& before, const HandForces& now) {
  double most = 0;
  for (std::size_t s = 0; s < kSegmentCount; ++s)
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
