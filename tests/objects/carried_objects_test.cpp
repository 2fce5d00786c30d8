// Objects that a hand carries, and what is set moving all of a sudden: within a tick hand and object both
// move on, and no finger pulls or rubs harder than friction holds.
#include <gtest/gtest.h>

#include <cmath>

#include "largest.h"
#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "pads.h"

namespace lumbrical {
namespace {

using test::largest;
using test::Session;

constexpr std::size_t kFirst = 2, kSecond = 5;  // segments of the two fingertips
constexpr double kSide = 0.05;                  // [m] of the cube they grip

// Between two fingertips 1 mm deep, without weight.
Scene gripped_scene(Vec3 place) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  const Mesh cube = make_box({kSide, kSide, kSide}, 3);
  scene.objects.push_back(test::body_of("box", cube, 0.05, {place, {}}, {0.5, 0.5, 0, 1000}));
  return scene;
}
DeviceFrame grip_at(Vec3 place) {
  const double reach = kSide / 2 + test::kPadRadius - 0.001;
  return test::frame_of({{place + Vec3{reach, 0, 0}, {1, 0, 0}}, {place - Vec3{reach, 0, 0}, {-1, 0, 0}}});
}

/// The force on the first finger, and how far it steps in a tick.
struct Felt {
  Vec3 last;
  double roughest = 0;
  void note(Vec3 force, bool smooth) {
    if (smooth) roughest = largest(roughest, norm(force - last));
    last = force;
  }
};

// Faster and faster for half a second, then on.
Felt carry(Vec3 way, double speed) {
  Session run(gripped_scene({}));
  Felt felt;
  double gone = 0;
  for (int i = 0; i < 1000; ++i) {
    gone += 1e-3 * speed * min(1, i / 500.0);
    DeviceFrame frame = grip_at({});
    frame.base.position = gone * way;
    run.step(frame);
    felt.note(run.output.segment[kFirst].force, i > 0);
  }
  const Vec3 away = run.state.objects[0].pose.position - gone * way;
  EXPECT_LT(norm(away), 0.0013 * speed + 1e-9) << "it is carried, and is where the hand is at the tick's end";
  return felt;
}

TEST(CarriedObject, IsHeldAsHardAtAnySpeed) {
  const Felt at_rest = carry({1, 0, 0}, 0);
  EXPECT_GT(at_rest.last.x, 0.4);
  for (const Vec3 way : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0.6, 0.8}}) {
    for (const double speed : {0.1, 0.6, 1.2}) {
      const Felt carried = carry(way, speed);
      EXPECT_LT(norm(carried.last - at_rest.last), 1e-3 * at_rest.last.x) << speed;
      EXPECT_LT(carried.roughest, 0.025 * speed) << speed << ": friction must not buzz";  // [N] in a tick
    }
  }
}

TEST(CarriedObject, IsSwungRoundByHalfItsCentripetalForceInEachFinger) {
  constexpr double kArm = 0.1, kTurning = 8;  // [m], [rad/s]
  Session run(gripped_scene({0, kArm, 0}));
  double angle = 0;
  Felt felt;
  Vec3 sum;
  for (int i = 0; i < 1000; ++i) {
    angle += 1e-3 * kTurning * min(1, i / 400.0);
    DeviceFrame frame = grip_at({0, kArm, 0});
    frame.base.orientation = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
    run.step(frame);
    felt.note(rotate(conjugate(frame.base.orientation), run.output.segment[kFirst].force), i > 500);
    if (i >= 800) sum += felt.last / 200.0;
  }
  EXPECT_NEAR(sum.y, 0.5 * 0.05 * kTurning * kTurning * kArm, 0.005);  // outwards on the finger
  EXPECT_LT(felt.roughest, 0.005);
}

// A tracker that finds the hand somewhere else has not thrown it there.
TEST(CarriedObject, IsNotThrownByAHandThatJumps) {
  Session run(gripped_scene({}));
  for (int i = 0; i < 50; ++i) run.step(grip_at({0, 0, 0.5}));
  Vec3 force;
  for (int i = 0; i < 50; ++i) {
    run.step(grip_at({}));
    if (i == 0) force = run.output.segment[kFirst].force;
  }
  EXPECT_LT(norm(run.state.objects[0].velocity), 1e-9);
  EXPECT_NEAR(norm(force), norm(run.output.segment[kFirst].force), 1e-6);
}

// A plate on a slider along `axis`, as long as nobody turns the handle.
Scene latched_scene(Vec3 axis, const Material& material) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.objects.push_back(test::body_of("plate", make_box({0.1, 0.1, 0.02}, 4), 0.005, {}, material));
  Mechanism& plate = scene.objects[0].mechanism;
  plate.mobility = Mobility::slider;
  plate.axis = axis;
  plate.lower = 0;
  plate.latch = {1, 0.3};
  scene.objects.push_back(test::body_of("handle", make_box({0.02, 0.02, 0.02}, 2), 0.1, {{0, 1, 0}, {}}, {}));
  scene.objects[1].mechanism.mobility = Mobility::hinge;
  return scene;
}

TEST(SuddenMotion, OfWhatOneFingerPushesAwayDoesNotPullAnother) {
  Session run(latched_scene({0, 0, -1}, {}));
  const double top = 0.01 + test::kPadRadius;
  const DeviceFrame frame =
      test::frame_of({{{-0.03, 0, top - 0.003}, {0, 0, 1}}, {{0.03, 0, top - 0.0001}, {0, 0, 1}}});
  for (int i = 0; i < 5; ++i) run.step(frame);
  ASSERT_GT(run.output.segment[kFirst].force.z, 3);
  ASSERT_GT(run.output.segment[kSecond].force.z, 1e-3);
  run.state.objects[1].coordinate = 0.5;  // the latch opens
  for (int i = 0; i < 10; ++i) {
    run.step(frame);
    EXPECT_GT(run.output.segment[kSecond].force.z, -2e-4) << i;
  }
  EXPECT_GT(run.state.objects[0].coordinate, 0.002);
}

TEST(SuddenMotion, IsRubbedByNoMoreThanFrictionHolds) {
  constexpr double kFriction = 0.5;
  Session run(latched_scene({1, 0, 0}, {kFriction, kFriction, 0, 1000}));
  const double top = 0.01 + test::kPadRadius, side = 0.05 + test::kPadRadius;
  const DeviceFrame frame =
      test::frame_of({{{-side + 0.003, 0, 0}, {-1, 0, 0}}, {{0.03, 0, top - 0.0001}, {0, 0, 1}}});
  for (int i = 0; i < 5; ++i) run.step(frame);
  run.state.objects[1].coordinate = 0.5;
  for (int i = 0; i < 10; ++i) {
    run.step(frame);
    const Vec3 rubbed = run.output.segment[kSecond].force;
    EXPECT_LT(std::fabs(rubbed.x), 1.2 * kFriction * rubbed.z) << i;
  }
  EXPECT_GT(run.state.objects[0].coordinate, 0.002);
}

TEST(SuddenMotion, EndsWhereStrongDampingIsAllThatHoldsALightThing) {
  for (const double damping : {30.0, 100.0, 1000.0}) {
    Scene scene = test::pad_scene();
    scene.gravity = {};
    scene.settings.pad.damping = damping;
    scene.objects.push_back(test::body_of("key", make_box({0.04, 0.04, 0.01}, 3), 0.005, {}, {}));
    scene.objects[0].mechanism.mobility = Mobility::slider;
    Session run(scene);
    const double reach = 0.005 + test::kPadRadius;
    Felt felt;
    for (int i = 0; i < 1000; ++i) {  // one finger comes down in 50 ms, one waits below
      const double down = 0.002 * min(1, i / 50.0);
      run.step(test::frame_of({{{0, 0, reach - down}, {0, 0, 1}}, {{0, 0, -reach + 0.001}, {0, 0, -1}}}));
      felt.note(run.output.segment[kFirst].force, i > 500);
    }
    EXPECT_GT(felt.last.z, 0.5) << damping;
    EXPECT_LT(felt.roughest, 1e-3) << damping;
  }
}

// A palm alone that comes down at 0.1 m/s, tilted, so that its rim is the first to touch what is too heavy to
// give way.
DeviceFrame tilted_palm(const Hand& hand, double height) {
  const Quat down{std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // faces -z
  return test::palm_alone_at(hand, {{0, 0, height}, down * normalized({1, 0, 0, 0.15})});
}

// A mug of 1 to 5 g in a whole hand that stands still, tapped once: in a tick of 2 ms sliding friction alone
// would turn it round.
TEST(SuddenMotion, OfALightThingInAGripComesToRest) {
  for (const double mass : {0.001, 0.005}) {
    for (const double tap : {0.2, -1.0}) {
      Scene scene;
      scene.hand = default_hand(Side::right);
      scene.gravity = {};
      scene.settings.rate = 500;
      scene.settings.max_force = 1e5;
      MugShape shape;
      shape.segments = 24;
      scene.objects.push_back(test::body_of("mug", make_mug(shape), mass, {}, {0.8, 0.6, 0, 1000}));
      const Motion grasp = make_grasp(scene.hand, shape.radius, shape.height, 6, 0.1);
      Session run(scene);
      for (int i = 0; i < 750; ++i) run.step(resample(grasp, i / 500.0));
      run.state.objects[0].velocity += Vec3{tap, 0.3 * tap, 0};
      double largest_step = 0;
      for (int i = 0; i < 500; ++i) {
        const ActuatorFrame before = run.output;
        run.step(resample(grasp, 1.5));
        for (std::size_t k = 0; i >= 400 && k < kSegmentCount; ++k)
          largest_step = largest(largest_step, norm(run.output.segment[k].force - before.segment[k].force));
      }
      EXPECT_GT(norm(run.output.segment[kFirst].force), 1);
      EXPECT_LT(largest_step, 0.01) << mass << ", " << tap;
    }
  }
}

// After the grip has been closed for half a second.
double trembling(double mass, double rate, const Material& skin) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.settings.rate = rate;
  const Pose leaning{{}, normalized({1, 0.02, 0.03, 0.01})};
  scene.objects.push_back(test::body_of("box", make_box({kSide, kSide, kSide}, 4), mass, leaning, skin));
  Session run(scene);
  double most = 0;
  for (int i = 0; i < 0.8 * rate; ++i) {
    const double y = kSide / 2 + test::kPadRadius + 0.002 - 0.0045 * min(1, i / (0.3 * rate));
    const Vec3 before = run.output.segment[kFirst].force;
    run.step(test::frame_of({{{0.01, y, 0}, {0, 1, 0}}, {{0.01, -y, 0}, {0, -1, 0}}}));
    if (i > 0.7 * rate) most = largest(most, norm(run.output.segment[kFirst].force - before));
  }
  return most;
}

TEST(SuddenMotion, OfALightThingComesToRestHoweverStiffSkinIs) {
  for (const double shear : {1e4, 1e5}) {
    for (const double mass : {0.001, 0.002, 0.005, 0.02}) {
      for (const double rate : {500.0, 1000.0})
        EXPECT_LT(trembling(mass, rate, {0.8, 0.6, 0, shear}), 0.001) << shear << " " << mass << " " << rate;
    }
  }
}

TEST(SuddenMotion, OfAPalmBeginsATouchAsSoftlyAsOnWhatStandsStill) {
  Scene moving = test::pad_scene();
  moving.hand = default_hand(Side::right);
  moving.gravity = {};
  const Mesh block = make_box({0.4, 0.4, 0.1}, 8);
  moving.objects.push_back(test::body_of("block", block, 1000, {}, {}));
  Scene standing = moving;
  standing.objects[0].mechanism = {};
  Session run(moving), still(standing);
  double most = 0;
  for (int i = 0; i < 400; ++i) {
    const DeviceFrame frame = tilted_palm(moving.hand, 0.09 - 1e-4 * i);
    run.step(frame);
    still.output = tick(still.model, still.state, still.scratch, frame);
    const double force = norm(still.output.segment[kPalmSegment].force);
    EXPECT_LE(norm(run.output.segment[kPalmSegment].force), 2.000001 * force + 1e-9) << i;
    most = largest(most, force);
  }
  EXPECT_GT(most, 1);
}

}  // namespace
}  // namespace lumbrical
