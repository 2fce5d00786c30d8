// Pads that harden, give way and are damped (docs/pads.md).
#include <gtest/gtest.h>

#include <cmath>

#include "largest.h"
#include "lumbrical/jacobian.h"
#include "pads.h"
#include "pose_hand.h"
#include "pressed_hand.h"
#include "stages/pad_damping.h"
#include "stages/segment_speeds.h"

namespace lumbrical {
namespace {

using test::kPadRadius;
using test::largest;
using test::Session;

constexpr double kStiffness = 2e7;
constexpr Pad kHardening{{{{0.2, 3}, {0.5, 8}}}, 0};
constexpr Pad kCapped{{{{0.3, -0.5}, {0.6, -0.5}}}, 0};

Scene plane_scene(const Pad& pad, double precision = 0) {
  Scene scene = test::pad_scene();
  scene.settings.precision.fill(precision);
  scene.settings.pad = pad;
  scene.objects.push_back({"plane", make_plane(0.1, 40, 0.3, 2)});
  return scene;
}

DeviceFrame upright(double deep, Vec3 at = {}) {
  return test::frame_of({{at + Vec3{0, 0, kPadRadius - deep}, {0, 0, 1}}});
}

// A sphere of radius R whose centre is h over a plane (docs/mechanics.md).
double sphere_force(double radius, double h) {
  if (h >= radius) return 0;
  const double cube = radius * radius * radius;
  return kStiffness * 3.141592653589793 * (cube / 3 - radius * h * h + 2.0 / 3 * h * h * h);
}

double layered_force(const Pad& pad, double h) {
  double force = sphere_force(kPadRadius, h);
  for (const PadLayer& layer : pad.layer)
    force += layer.stiffness * sphere_force((1 - layer.from) * kPadRadius, h);
  return force;
}

TEST(Pad, PressesAsTheSumOfItsLayersClosedForms) {
  for (const Pad& pad : {kHardening, kCapped}) {
    for (const double precision : {0.0, 1e-4}) {
      Session run(plane_scene(pad, precision));
      for (const double deep : {0.0005, 0.001, 0.002, 0.003, 0.005, 0.0075}) {
        run.feel(upright(deep, {0.0013, 0.0007, 0}));
        const double expected = layered_force(pad, kPadRadius - deep);
        EXPECT_NEAR(run.output.segment[2].force.z, expected, (precision > 0 ? 2e-3 : 1e-6) * expected)
            << deep << ' ' << precision;
      }
    }
  }
}

TEST(Pad, WithoutLayersOrDampingChangesNoBit) {
  Scene plain = test::mug_scene(Law::field), with = plain, damped = plain;
  with.settings.pad = {{{{0.4, 0}, {0.2, 0}}}, 0};  // a layer without stiffness is none
  damped.settings.pad.damping = 20;
  const auto hash_of = [](const Scene& scene) {
    return test::hash_run(test::model_of(scene), test::grasp_frames(scene.hand, 50));
  };
  EXPECT_EQ(hash_of(plain), hash_of(with));
  EXPECT_NE(hash_of(plain), hash_of(damped)) << "nothing was felt";
}

// Down onto a box, over its edge and down beside it, and back through the air.
TEST(Pad, TakesNoWorkRoundAClosedPath) {
  for (const Pad& pad : {kHardening, kCapped}) {
    Scene scene = test::pad_scene();
    scene.settings.pad = pad;
    scene.objects.push_back({"box", make_box({0.06, 0.06, 0.06}, 3)});
    Session run(scene);
    const std::array<Vec3, 5> corner = {Vec3{0.01, 0, 0.05}, Vec3{0.015, 0.002, 0.034},
                                        Vec3{0.0335, 0.001, 0.0335}, Vec3{0.034, -0.001, 0.015},
                                        Vec3{0.05, 0, 0.05}};
    double work = 0, turned_over = 0;
    Vec3 last_force, last_at;
    bool first = true;
    for (std::size_t side = 0; side < corner.size(); ++side) {
      for (int i = 0; i <= 1000; ++i) {
        const double share = i / 1000.0;
        const Vec3 at = (1 - share) * corner[side] + share * corner[(side + 1) % corner.size()];
        const DeviceFrame frame = test::frame_of({{at, {0.6, 0, 0.8}}});
        run.feel(frame);
        const auto& tip = frame.joint[kPhalanxJoints[2].tip].position;  // as the engine gets it
        const Vec3 there{tip[0], tip[1], tip[2]};
        const Vec3 force = run.output.segment[2].force;
        if (!first) {
          const double step = 0.5 * dot(force + last_force, there - last_at);
          work += step;
          turned_over += std::fabs(step);
        }
        first = false;
        last_force = force;
        last_at = there;
      }
    }
    EXPECT_GT(turned_over, 0.005);
    EXPECT_LT(std::fabs(work), 2e-5 * turned_over);
  }
}

// A large contact grows without bound with its area; a cap on its pressure keeps it to that of a thin layer.
TEST(Pad, CappedPressureKeepsAPalmFromPushingWithoutBound) {
  Scene scene = test::pressed_scene(0.3, 1);
  scene.objects = {{"plane", make_plane(0.3, 40, 0.3, 2)}};
  scene.settings.max_force = 1e6;
  scene.settings.fade_time = 0;
  scene.settings.precision.fill(0);
  Session plain(scene);
  scene.settings.pad = {{{{0.2, -1}, {}}}, 0};
  Session capped(scene);
  const auto force_of = [](const Session& run) { return norm(run.output.segment[kPalmSegment].force); };
  double last = 0, last_plain = 0;
  for (double deep = 0;; deep += 0.0005) {
    const DeviceFrame frame = test::pressed_frame(scene.hand, deep, 0);
    plain.feel(frame);
    if (force_of(plain) < last_plain) break;  // the surface has passed the core
    capped.feel(frame);
    EXPECT_GE(force_of(capped), last) << deep;
    last = force_of(capped);
    last_plain = force_of(plain);
  }
  EXPECT_GT(last, 50);
  EXPECT_LT(last, 0.5 * last_plain);
}

TEST(Pad, JacobianIsThatOfAllLayers) {
  Scene scene = plane_scene(kHardening);
  Session run(scene);
  const auto force_at = [&](double deep) {
    run.feel(upright(deep));
    return run.output.segment[2].force.z;
  };
  std::array<SegmentJacobian, kSegmentCount> jacobians;
  const double deep = 0.005, step = 0.0001;
  const double slope = (force_at(deep + step) - force_at(deep - step)) / (2 * step);
  force_at(deep);
  segment_jacobians(run.model, run.scratch, jacobians);
  ASSERT_TRUE(jacobians[2].known);
  EXPECT_NEAR(-jacobians[2].value[2][2], slope, 2e-3 * slope);
}

// ---- Damping ----

constexpr Pad kDamped{{}, 4};  // [s/m]

TEST(Pad, DampingGrowsWithTheSpeedOfPressingInAndIsNothingAtRest) {
  Scene scene = plane_scene(kDamped);
  scene.settings.rate = 1000;
  Session run(scene), plain(plane_scene({}));
  for (const double speed : {0.05, -0.05, 0.0}) {
    run.state = make_state(run.model);
    for (int i = 50; i >= 0; --i) run.feel(upright(0.003 - 0.001 * speed * i));  // [ms], ten times the mean's
    plain.feel(upright(0.003));
    EXPECT_GT(plain.output.segment[2].force.z, 1);
    EXPECT_NEAR(run.output.segment[2].force.z, (1 + 4 * speed) * plain.output.segment[2].force.z, 1e-4);
  }
  EXPECT_EQ(run.output.segment[2].force, plain.output.segment[2].force);
}

// A turn that is told a hundred times a second is as fast all the way to the next sample and then steps.
TEST(Pad, DampingDoesNotStepWhereTwoSamplesOfATurnMeet) {
  Session run(plane_scene(kDamped)), plain(plane_scene({}));
  Motion turn;
  const DeviceFrame pressed = test::frame_of({{{0, 0.1, kPadRadius - 0.0035}, {0, 0, 1}}});
  for (int i = 0; i <= 100; ++i) {
    const double time = 0.01 * i, angle = 0.02 * std::cos(40 * time);
    DeviceFrame frame = pressed;
    frame.base = {{0, -0.1, 0}, {std::sqrt(1 - 0.25 * angle * angle), 0.5 * angle, 0, 0}};
    turn.samples.push_back({time, frame});
  }
  double roughest = 0, most = 0, last = 0;
  for (int i = 0; i < 1000; ++i) {
    const DeviceFrame frame = resample(turn, 0.001 * i);
    run.feel(frame);
    plain.feel(frame);
    const double share = run.output.segment[2].force.z / plain.output.segment[2].force.z - 1;
    if (i > 0) roughest = largest(roughest, std::fabs(share - last));
    most = largest(most, std::fabs(share));
    last = share;
  }
  EXPECT_GT(most, 0.2);       // at up to 80 mm/s
  EXPECT_LT(roughest, 0.03);  // with the speed of single ticks 0.13
}

// The same where nobody resamples: at 4 kHz the samples of 90 Hz are 44 ticks apart.
TEST(Pad, DampingGoesOnWhereATrackerHoldsItsSamples) {
  constexpr double kRate = 4000, kSpeed = 0.6, kTurning = 6;
  Twist mean;
  double sum = 0, turned = 0;
  for (int i = 0; i < 880; ++i) {
    const double steps = i % 44 == 0 ? 44 : 0;
    mean = steadied(mean, {{0, 0, steps * kSpeed}, {steps * kTurning, 0, 0}}, kRate);
    EXPECT_GT(mean.velocity.z, 0) << i;
    sum += mean.velocity.z / 880;
    turned += mean.angular_velocity.x / 880;
  }
  EXPECT_NEAR(sum, 20.0 / 44, 0.02) << "no sample counts for more than 20 m/s";
  EXPECT_NEAR(turned, 200.0 / 44, 0.2);
  EXPECT_EQ(norm(steadied(mean, {{0, 0, 0.16 * kRate}, {}}, kRate).velocity), 0) << "a jump";
  EXPECT_EQ(norm(steadied(mean, {{}, {1.6 * kRate, 0, 0}}, kRate).velocity), 0) << "a jump";
}

// Of a finger through a plate, whose faces push opposite ways, next to nothing is left but a torque.
TEST(Pad, DampingIsNoFasterThanTheSkinHoweverLittleForceIsLeft) {
  const Session run(plane_scene(kDamped));
  Primitives hand;
  test::pose_hand(run.model.hand, run.model.settings, upright(0.003), hand);
  const double reach = 0.02 + kPadRadius;  // of the skin from the joint
  double last = 0;
  for (int i = -1000; i <= 1000; ++i) {
    const double turn = 0.001 * i;  // [rad/s]
    const double share =
        damping_wanted(4, hand, 2, {{0, 0, 1e-6}, {0.02, 0, 0}}, {{0, 0, -0.05}, {turn, 0, 0}});
    EXPECT_LT(std::fabs(share), 4 * (0.05 + 1.001 * reach * std::fabs(turn)));
    if (i > -1000) {
      EXPECT_NEAR(share, last, 1.001 * 4 * reach * 0.001);
    }
    last = share;
  }
  const Twist pressing{{0, 0, -0.05}, {}};
  EXPECT_NEAR(damping_wanted(4, hand, 2, {{0, 0, 2}, {0.9 * reach * 2, 0, 0}}, pressing), 0.2, 1e-12);
}

TEST(Pad, DampingOnlyTakesEnergyAndNeverPulls) {
  Session run(plane_scene(kDamped));
  double work = 0, height = 0, last_force = 0;
  for (int i = 0; i < 2000; ++i) {
    const double deep = 0.004 * std::sin(0.02 * i);  // 80 mm/s
    const DeviceFrame frame = upright(deep);
    const double z = frame.joint[kPhalanxJoints[2].tip].position[2];
    run.feel(frame);
    const double force = run.output.segment[2].force.z;
    EXPECT_GE(force, 0);
    EXPECT_LT(std::fabs(force - last_force), 0.4);  // 5.4 N in 50 ms
    if (i > 0) work += force * (z - height);        // of the pad on the finger
    height = z;
    last_force = force;
  }
  EXPECT_LT(work, -0.005);
}

TEST(Pad, DampingForgetsWhereAHandWasThatWasLost) {
  Session run(plane_scene(kDamped)), plain(plane_scene({}));
  run.feel(upright(0.002, {0.02, 0, 0.01}));
  DeviceFrame lost = upright(0.003);
  lost.flags = kTrackingLost;
  run.feel(lost);
  run.feel(upright(0.003));
  plain.feel(upright(0.003));
  EXPECT_GT(plain.output.segment[2].force.z, 1);
  EXPECT_EQ(run.output.segment[2].force, plain.output.segment[2].force);
}

TEST(Pad, DampedAndHardKeepsAKeyOfFiveGramsStableAndMomentum) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.settings.pad = {{{{0.1, 4}, {0.4, 8}}}, 10};
  SceneObject key = test::body_of("key", make_box({0.02, 0.02, 0.005}, 2), 0.005, {{0, 0, 0}, {}}, {});
  key.mechanism.damping = 0;
  scene.objects.push_back(key);
  Session run(scene);
  double worst = 0, roughest = 0, last = 0, hardest = 0, pushed = 0;
  for (int i = 0; i < 2000; ++i) {  // held between two fingertips, pressed and shaken
    const double push = 0.0015 * std::sin(0.003 * i), shift = 0.004 * std::sin(0.02 * i);
    const ObjectState before = run.state.objects[0];
    const ObjectOutput out =
        run.step(test::frame_of({{{0, 0, 0.0025 + kPadRadius - 0.002 - push + shift}, {0, 0, 1}},
                                 {{0, 0, -0.0025 - kPadRadius + 0.002 + push + shift}, {0, 0, -1}}}));
    const ObjectState& after = run.state.objects[0];
    const Vec3 force = (0.005 * scene.settings.rate) * (after.velocity - before.velocity);
    worst = largest(worst, norm(force - out.wrench.force));
    worst = largest(worst, norm(test::hand_force(run.output) + out.wrench.force));
    const double squeeze = norm(run.output.segment[2].force);
    if (i > 10) roughest = largest(roughest, std::fabs(squeeze - last));
    hardest = largest(hardest, squeeze);
    pushed = largest(pushed, norm(out.wrench.force));
    last = squeeze;
  }
  EXPECT_LT(worst, 1e-10);
  EXPECT_LT(roughest, 0.3);
  EXPECT_GT(hardest, 5);   // [N] of a fingertip
  EXPECT_GT(pushed, 0.1);  // [N] of both together
}

// ---- In and out ----

TEST(Pad, GoesWithChangedSettingsAndOtherHandsAsIfBuiltSo) {
  const Scene plain = plane_scene({}, 1e-4), hard = plane_scene(kHardening, 1e-4);
  const Model from = test::model_of(plain), built = test::model_of(hard);
  Model changed, harder, back, other;
  ASSERT_TRUE(change_settings(from, hard.settings, 1, changed).ok());
  Settings settings = hard.settings;
  settings.stiffness *= 2;
  settings.pad.layer[0].from = 0.3;
  ASSERT_TRUE(change_settings(changed, settings, 1, harder).ok());
  ASSERT_TRUE(change_settings(harder, hard.settings, 1, back).ok());
  ASSERT_TRUE(share_world(changed, mirrored_hand(hard.hand), other).ok());
  EXPECT_EQ(other.layers.size(), 2u);
  const std::vector<DeviceFrame> frames = {upright(0.001), upright(0.003), upright(0.005)};
  const std::uint64_t expected = test::hash_run(built, frames);
  EXPECT_EQ(test::hash_run(changed, frames), expected);
  EXPECT_EQ(test::hash_run(back, frames), expected);
  EXPECT_NE(test::hash_run(harder, frames), expected);
}

TEST(Pad, IsRefusedWhereItWouldPushLessTheDeeperItIs) {
  const auto error = [](const Pad& pad) {
    Model model;
    return build_model(plane_scene(pad), {}, model).message();
  };
  EXPECT_EQ(error(kHardening), "");
  EXPECT_NE(error({{{{0.3, -0.6}, {0.5, -0.6}}}, 0}).find("settings.pad.layers[1].stiffness"),
            std::string::npos);
  EXPECT_NE(error({{{{0.5, 1}, {0.3, 1}}}, 0}).find("settings.pad.layers[1].from"), std::string::npos);
  EXPECT_NE(error({{{{1.5, 1}, {}}}, 0}).find("settings.pad.layers[0].from"), std::string::npos);
  EXPECT_NE(error({{}, std::nan("")}).find("settings.pad.damping"), std::string::npos);
}

}  // namespace
}  // namespace lumbrical
