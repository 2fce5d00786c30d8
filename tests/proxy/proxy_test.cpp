// The proxy: never through, never a jump, and the hand itself where nothing is in the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "frame_joints.h"
#include "largest.h"
#include "model/primitive.h"
#include "pads.h"
#include "pressed_hand.h"
#include "proxied_session.h"
#include "proxy/proxy_hand.h"
#include "random.h"

namespace lumbrical {
namespace {

using test::feel;
using test::fingertip_at;
using test::kPadRadius;
using test::kProxyStiffness;
using test::largest;
using test::posed_joints;
using test::proxy_at;
using test::proxy_scene;
using test::Session;

TEST(Proxy, IsTheHandToTheBitWhereNoCoreIsInTheWay) {
  Scene with = test::mug_scene(Law::field), without = with;
  with.settings.proxy_stiffness = kProxyStiffness;
  Session proxied(with), plain(without);
  std::uint32_t contacts = 0;
  for (const DeviceFrame& frame : test::grasp_frames(with.hand, 300)) {
    feel(proxied, frame);
    feel(plain, frame);
    ASSERT_NE(proxied.state.proxy->valid, 0) << "there is none";
    ASSERT_EQ(proxied.scratch.stage_hash, plain.scratch.stage_hash);
    contacts += plain.output.contact_count;
  }
  EXPECT_GT(contacts, 1000u);
}

// At 3 m/s and 200 Hz a finger goes 15 mm a tick: it has slipped off nothing.
TEST(Proxy, IsTheHandToTheBitHoweverFastItSlides) {
  Scene with = proxy_scene(make_box({1, 1, 0.02}, 5));
  with.settings.rate = 200;
  Scene without = with;
  without.settings.proxy_stiffness = 0;
  Session proxied(with), plain(without);
  for (int i = 0; i < 50; ++i) {
    const DeviceFrame frame = fingertip_at({0.015 * i - 0.4, 0.02, 0.008 + kPadRadius});
    feel(proxied, frame);
    feel(plain, frame);
    ASSERT_NE(proxied.state.proxy->valid, 0);
    ASSERT_EQ(proxied.scratch.stage_hash, plain.scratch.stage_hash) << i;
  }
  EXPECT_GT(norm(test::hand_force(plain.output)), 1);
}

TEST(Proxy, DoesNotBeginWithinASurfaceButOnceTheHandIsOutOfIt) {
  Session run(proxy_scene(make_box({0.1, 0.1, 0.1}, 5)));
  feel(run, fingertip_at({0, 0, 0.05}));
  EXPECT_EQ(run.state.proxy->valid, 0);
  EXPECT_LT(norm(test::hand_force(run.output)), 11);  // the field's alone
  feel(run, fingertip_at({0, 0, 0.056}));
  EXPECT_GT(run.state.proxy->valid, 0);
}

// Deep in a solid no core is near its surface. On the way out it is met from behind: nothing holds the finger
// in, and outside it has a proxy.
TEST(Proxy, DoesNotHoldInAHandThatBeganDeepWithinASolid) {
  for (const Winding winding : {Winding::as_is, Winding::automatic}) {
    for (const bool moves : {false, true}) {
      Scene scene = proxy_scene(make_box({0.2, 0.2, 0.1}, 7)), plain_scene = scene;
      scene.objects[0].winding = winding;
      plain_scene.settings.proxy_stiffness = 0;
      if (moves) scene.objects[0].mechanism.mobility = Mobility::given;
      Session run(scene), plain(plain_scene);
      const std::vector<ObjectFrame> given(1);
      int known = 0;
      for (int i = 0; i <= 800; ++i) {
        const DeviceFrame frame = fingertip_at({0.002, 0.001, 0.0001 * i});
        run.feel(frame, std::span(given).first(moves ? 1 : 0));
        feel(plain, frame);
        known += run.state.proxy->valid > 0 ? 1 : 0;
        EXPECT_TRUE(run.scratch.proxy->pushing.empty()) << i;
        EXPECT_NEAR(norm(test::hand_force(run.output) - test::hand_force(plain.output)), 0, 1e-9) << i;
      }
      EXPECT_GT(run.state.proxy->valid, 0);
      EXPECT_LT(known, 720) << "none near the surface";
    }
  }
}

// ---- Slow presses ----

struct Press {
  std::string name;
  Mesh mesh;
  Vec3 start;           // of the fingertip's centre, skin at the surface
  Vec3 down{0, 0, -1};  // unit
  Vec3 away{0, 0, 1};   // the finger
};
void PrintTo(const Press& press, std::ostream* to) { *to << press.name; }

std::vector<Press> presses() {
  const double r = kPadRadius, half = std::sqrt(0.5);
  const Mesh solid = make_box({0.1, 0.1, 0.1}, 7);
  const Vec3 edge{half, 0, half}, across{half, 0, -half};
  return {
      {"sheet of 0.1 mm", make_box({0.1, 0.1, 1e-4}, 7), {0.003, 0.001, 0.5e-4 + r}},
      {"plate of 1 mm", make_box({0.1, 0.1, 0.001}, 7), {0.003, 0.001, 0.0005 + r}},
      {"wall of 4 mm", make_box({0.1, 0.1, 0.004}, 7), {0.003, 0.001, 0.002 + r}},
      {"open sheet", make_plane(0.1, 7, 0.5), {0.003, 0.001, r}},
      {"solid", solid, {0.003, 0.001, 0.05 + r}},
      {"solid by the finger's side", solid, {0.003, -0.01, 0.05 + r}, {0, 0, -1}, {0, 1, 0}},
      {"edge by the finger's side", solid, Vec3{0.05, 0.003, 0.05} + r * edge - 0.01 * across, -edge, across},
  };
}

class SlowPress : public testing::TestWithParam<Press> {};

// By 10 um a tick to 16 mm, a fingertip's thickness, and back out.
TEST_P(SlowPress, NeverFallsNeverJumpsAndComesBackTheSameWay) {
  const Press& press = GetParam();
  Session run(proxy_scene(press.mesh));
  const int deepest = 1600;
  const auto force_at = [&](int step) {
    const Vec3 tip = press.start + (1e-5 * step) * press.down;
    return -dot(test::hand_force(feel(run, fingertip_at(tip, press.away))), press.down);
  };
  std::vector<double> in;
  for (int i = 0; i <= deepest; ++i) in.push_back(force_at(i));
  const double most = in.back();
  EXPECT_GT(most, 10);
  for (std::size_t i = 1; i < in.size(); ++i) {
    EXPECT_GE(in[i], in[i - 1] - 1e-3 * in[i - 1] - 1e-4) << i;
    EXPECT_LT(in[i] - in[i - 1], 0.01 * in[i] + 0.031) << i;  // 10 um of the spring are up to 30 mN
  }
  for (int i = deepest; i >= 0; --i)
    EXPECT_NEAR(force_at(i), in[static_cast<std::size_t>(i)], 0.01 * most) << i;
}
INSTANTIATE_TEST_SUITE_P(Proxy, SlowPress, testing::ValuesIn(presses()), [](const auto& one) {
  std::string name = one.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
  return name;
});

// An edge on a fingertip's end is no place to stay: it is felt as far as it holds, and then the finger is
// beside it.
TEST(Proxy, SlipsOffEdgesAndCornersWithoutAStep) {
  const double half = std::sqrt(0.5), third = std::sqrt(1.0 / 3);
  const Vec3 aside{half, -half, 0};
  for (const Vec3 out : {Vec3{half, 0, half}, Vec3{third, third, third}}) {
    Session run(proxy_scene(make_box({0.1, 0.1, 0.1}, 7)));
    const Vec3 top = Vec3{0.05, out.y > 0 ? 0.05 : 0.003, 0.05} + 1e-6 * aside;
    double before = 0, most = 0, farthest = 0;
    for (int i = 0; i <= 1600; ++i) {
      const Vec3 tip = top + (kPadRadius - 1e-5 * i) * out;
      const double force = dot(test::hand_force(feel(run, fingertip_at(tip, out))), out);
      EXPECT_NEAR(force, before, 0.4) << i;
      before = force;
      most = largest(most, force);
      const Vec3 at = proxy_at(run, kPhalanxJoints[2].tip);
      const double outside = norm(at - Vec3{min(at.x, 0.05), min(at.y, 0.05), min(at.z, 0.05)});
      EXPECT_GT(outside, 0.5 * kPadRadius - 2e-4) << i;
      farthest = largest(farthest, norm(at - tip));
    }
    EXPECT_GT(most, 10);
    EXPECT_GT(farthest, 0.005);
  }
}

TEST(Proxy, KeepsACoreAsFarFromAWallAsTheForceLets) {
  Session run(proxy_scene(make_box({0.1, 0.1, 0.002}, 5)));
  for (int i = 0; i <= 20; ++i) feel(run, fingertip_at({0, 0, 0.001 + kPadRadius - 0.001 * i}));
  const double force = test::hand_force(run.output).z;
  EXPECT_NEAR(proxy_at(run, kPhalanxJoints[2].tip).z, 0.001 + 0.5 * kPadRadius, 1.1e-5 * force);
}

// ---- Slides ----

// Single precision, as mesh files have it.
Mesh rounded(Mesh mesh) {
  for (Vec3& p : mesh.vertices)
    p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  return mesh;
}

TEST(Proxy, SlidesWithoutForceOverCornersAndEdgesOfAFlatFace) {
  const Pose tilted{{0.3, -0.2, 0.7}, normalized({0.5, 0.3, -0.6, 0.2})};
  for (const Vec3 away : {Vec3{0, 0, 1}, Vec3{0.6, 0, 0.8}, Vec3{1, 0, 0}}) {
    for (const std::uint32_t cells : {1u, 32u, 256u}) {
      Mesh mesh = make_plane(0.256, cells, 0);
      place_mesh(tilted, mesh);
      Session run(proxy_scene(rounded(std::move(mesh))));
      const auto force_at = [&](Vec3 tip) {
        DeviceFrame frame = fingertip_at(tip, away);
        frame.base = tilted;
        return rotate(conjugate(tilted.orientation), test::hand_force(feel(run, frame)));
      };
      Vec3 tip{-0.03, 0.001, kPadRadius};
      for (; tip.z > -0.006; tip.z -= 1e-4) force_at(tip);
      double along = 0;
      for (; tip.x < 0.03; tip += {1e-3, 3e-4, 0}) {
        const Vec3 force = force_at(tip);
        along = largest(along, norm(Vec3{force.x, force.y, 0}));
        EXPECT_GT(force.z, 15);
      }
      EXPECT_LT(along, 0.01) << away.x << " over squares of " << 0.256 / cells;
    }
  }
}

// ---- Strikes ----

// Does anything of the hand lie below z = 0, the sheet's middle?
bool is_through(const Session& run) {
  const Joints hand{run.state.proxy->joint, static_cast<std::uint32_t>(run.state.proxy->valid)};
  bool through = false;
  for (const auto& [base, tip] : kPhalanxJoints) {
    for (const int joint : {base, tip})
      through = through || (hand.has(joint) && !(hand.position(joint).z > 0));
  }
  const Palm& palm = run.model.hand.palm;
  for (const Vec3 corner : palm.polygon) {
    const Vec3 below{0, 0.5 * palm.thickness - palm.height, 0};
    through = through || !(transform(hand.pose[kPalm], corner + below).z > 0);
  }
  return through;
}

TEST(Proxy, LetsNoFingertipThroughASheetHoweverFast) {
  test::Random random(11);
  int deep = 0;
  for (const double thickness : {0.0, 1e-4, 1e-3}) {
    const Mesh sheet = thickness > 0 ? make_box({0.2, 0.2, thickness}, 9) : make_plane(0.2, 9, 0.7);
    Session run(proxy_scene(sheet));
    for (int strike = 0; strike < 100; ++strike) {
      const Vec3 away{random.between(-1, 1), random.between(-1, 1), random.between(0.1, 1)};
      const Vec3 finger = unit_or(away, {0, 0, 1});
      Vec3 tip{random.between(-0.05, 0.05), random.between(-0.05, 0.05), random.between(0.01, 0.02)};
      Vec3 speed{random.between(-1, 1), random.between(-1, 1), random.between(-3, -0.5)};  // [m/s]
      DeviceFrame lost;
      lost.flags = kTrackingLost;
      feel(run, lost);  // each strike begins anew
      for (int i = 0; i < 30; ++i) {
        feel(run, fingertip_at(tip, finger));
        ASSERT_NE(run.state.proxy->valid, 0) << thickness << " strike " << strike << " tick " << i;
        ASSERT_FALSE(is_through(run)) << thickness << " strike " << strike << " tick " << i;
        tip += 1e-3 * speed;
      }
      deep += tip.z < -0.01;
    }
  }
  EXPECT_GT(deep, 100);
}

TEST(Proxy, LetsNoPartOfAWholeHandThroughASheet) {
  Scene scene = proxy_scene(make_plane(0.6, 20, 0.7));
  scene.hand = default_hand(Side::right);
  Session run(scene);
  test::Random random(5);
  int through = 0;  // of what is tracked
  for (int strike = 0; strike < 40; ++strike) {
    DeviceFrame frame;
    frame.flags = kTrackingLost;
    feel(run, frame);
    frame.flags = 0;
    frame.kind = InputKind::joint_angles;
    for (float& angle : frame.angle) angle = static_cast<float>(random.between(-0.2, 1.2));
    const Vec3 turn = random.direction();
    const double angle = random.between(0, 1.5);
    frame.base.orientation = normalized({1, angle * turn.x, angle * turn.y, angle * turn.z});
    frame.base.position = {random.between(-0.05, 0.05), random.between(-0.05, 0.05), 0.25};
    const Vec3 speed{random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(-3, -1)};
    for (int i = 0; i < 300 && frame.base.position.z > -0.25; ++i) {
      feel(run, frame);
      ASSERT_NE(run.state.proxy->valid, 0) << strike << " tick " << i;
      ASSERT_FALSE(is_through(run)) << strike << " tick " << i;
      frame.base.position += 1e-3 * speed;
      frame.angle[static_cast<std::size_t>(i) % kAngleCount] += 0.05f;
    }
    through += frame.base.position.z < 0 && test::hand_force(run.output).z > 10;
  }
  EXPECT_GT(through, 30);
}

// A tick's steps are fewer on a dense mesh: the way is the same, in more ticks.
TEST(Proxy, GetsIntoADenseMeshInSeveralTicksAndAsFarAsIntoACoarseOne) {
  const auto strike = [](std::uint32_t cells, int ticks) {
    Scene scene = proxy_scene(make_plane(0.4, cells, 0.7));
    scene.hand = default_hand(Side::right);
    Session run(scene);
    DeviceFrame frame = test::pressed_frame(scene.hand, -0.08, 0);
    feel(run, frame);
    frame.base.position.z -= 0.1;
    for (int i = 0; i < ticks; ++i) {
      feel(run, frame);
      EXPECT_FALSE(is_through(run)) << cells << " tick " << i;
    }
    return std::pair(proxy_at(run, kWrist).z, test::hand_force(run.output).z);
  };
  const auto [coarse, coarse_force] = strike(10, 20);
  const auto [dense, dense_force] = strike(400, 20);
  EXPECT_NEAR(dense, coarse, 5e-4);
  EXPECT_GT(coarse_force, 1);
  EXPECT_NEAR(dense_force, coarse_force, 0.05 * coarse_force);
  EXPECT_GT(strike(400, 2).first, strike(10, 2).first + 0.005);
}

Scene wall_scene() {
  Scene scene = proxy_scene(make_box({0.4, 0.4, 0.02}, 10));
  scene.hand = default_hand(Side::right);
  return scene;
}
// A whole hand, lowered onto it by a millimetre a tick until it would be through.
DeviceFrame pressed_onto_wall(Session& run) {
  DeviceFrame frame = test::pressed_frame(run.model.hand, -0.08, 0);
  for (int i = 0; i < 120; ++i) {
    frame.base.position.z -= 0.001;
    feel(run, frame);
  }
  return frame;
}

TEST(Proxy, BendsTheFingersOfAHandThatIsPressedOntoAWall) {
  Session run(wall_scene());
  const DeviceFrame frame = pressed_onto_wall(run);
  const double below = frame.base.position.z;
  for (int joint = kIndexProximal; joint <= kLittleTip; ++joint)
    EXPECT_GT(proxy_at(run, joint).z, 0.01) << joint_name(joint);
  EXPECT_LT(below, 0.01);
  EXPECT_GT(test::hand_force(run.output).z, 20);
}

// What rounding takes off its rotations must not add up: fingers would grow, and pass the wall in the end.
TEST(Proxy, HoldsAHandThatIsPressedOntoAWallForAsLongAsItStays) {
  Session run(wall_scene());
  const DeviceFrame frame = pressed_onto_wall(run);
  for (int i = 0; i < 200; ++i) feel(run, frame);
  const HandForces first = run.output;
  for (int i = 0; i < 12000; ++i) feel(run, frame);
  for (std::size_t s = 0; s < kSegmentCount; ++s)
    EXPECT_NEAR(norm(run.output.segment[s].force - first.segment[s].force), 0, 1e-5)
        << segment_name(static_cast<int>(s));
  const std::array<Pose, kJointCount> hand = posed_joints(run.model.hand, frame);
  for (const auto& [base, tip] : kPhalanxJoints) {
    EXPECT_NEAR(norm(proxy_at(run, tip) - proxy_at(run, base)),
                norm(hand[tip].position - hand[base].position), 1e-12)
        << joint_name(tip);
  }
}

TEST(Proxy, WhatItFeelsOfAnObjectIsWhatTheObjectFeels) {
  Scene scene = proxy_scene(make_plane(0.01, 1));
  scene.objects.clear();
  scene.gravity = {};
  scene.objects.push_back(
      test::body_of("plate", make_box({0.06, 0.06, 0.001}, 4), 0.2, {}, {0.5, 0.5, 0, 1000}));
  Session run(scene);
  double worst = 0, most = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 before = run.state.objects[0].velocity;
    const ObjectOutput out = run.step(fingertip_at({0.002, 0.001, 0.009 - 4e-4 * i}));
    const Vec3 force = 200.0 * (run.state.objects[0].velocity - before);
    worst = largest(worst, norm(force - out.wrench.force));
    worst = largest(worst, norm(test::hand_force(run.output) + out.wrench.force));
    most = largest(most, norm(force));
  }
  EXPECT_LT(worst, 1e-10);
  EXPECT_GT(most, 1);
}

// The palm presses a mug by its field alone, fingers hold it by their cores: what those push with reaches the
// palm through the mug, and all of it together is nothing.
TEST(Proxy, IsNotMovedByWhatTheHandSqueezesWithinItself) {
  for (const double radius : {0.026, 0.031, 0.034}) {  // of the grasp; the mug's is 0.037
    Scene scene = test::mug_scene(Law::field);
    scene.settings.precision.fill(1e-3);
    scene.settings.proxy_stiffness = kProxyStiffness;
    scene.settings.max_force = 200;
    scene.objects[0] = test::body_of("mug", make_mug({}), 0.2, {}, {0.8, 0.6, 0, 1000});
    scene.ground.emplace();
    Session run(scene);
    const Motion grasp = make_grasp(scene.hand, radius, MugShape{}.height, 3);
    double farthest = 0, fastest = 0, pushed = 0;
    for (int i = 0; i < 1800; ++i) {  // closed and stroking
      const DeviceFrame frame = resample(grasp, i / 1000.0);
      feel(run, frame);
      ASSERT_NE(run.state.proxy->valid, 0) << i;
      farthest = largest(farthest, norm(proxy_at(run, kWrist) - frame.base.position));
      fastest = largest(fastest, i > 700 ? norm(run.state.objects[0].velocity) : 0);
      for (const Gap& gap : run.scratch.proxy->pushing) pushed = largest(pushed, gap.push);
    }
    EXPECT_GT(pushed, 3) << radius;
    EXPECT_LT(farthest, 0.012) << radius;
    EXPECT_LT(fastest, 0.8) << radius;
  }
}

// Fingers' cores and, now and then, the palm's own hold a free box: with a palm that answers all or nothing
// of what the fingers push with, the wrist gave way in turns.
TEST(Proxy, ComesToRestWithAFreeBoxAgainstThePalm) {
  Mesh box = make_box({0.0321, 0.07, 0.0778}, 1);
  place_mesh({{-0.00515, -0.00154, 0.0389}, {0.98659, 0, 0, 0.16327}}, box);
  Scene scene = test::mug_scene(Law::field);
  scene.settings.precision.fill(1e-3);
  scene.settings.proxy_stiffness = 1000;
  scene.settings.max_force = 50;
  scene.objects[0] = test::body_of("box", std::move(box), 0.54, {}, {0.8, 0.6, 0, 1000});
  scene.ground.emplace();
  Session run(scene);
  const Motion grasp = make_grasp(scene.hand, 0.0233, 0.074, 3);
  double most = 0, change = 0;
  HandForces before;
  for (int i = 0; i < 2400; ++i) {
    feel(run, resample(grasp, min(i, 1140) / 1000.0));  // squeezed, and still from then on
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
      const Vec3 force = run.scratch.forces.segment[s].force;
      most = largest(most, norm(force));
      if (i > 2200) change = largest(change, norm(force - before.segment[s].force));
    }
    before = run.scratch.forces;
  }
  EXPECT_GT(most, 20);
  EXPECT_LT(change, 0.01);
}

}  // namespace
}  // namespace lumbrical
