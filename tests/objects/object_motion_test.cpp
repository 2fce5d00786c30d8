// Objects that move: free bodies, joints, and what the hand and they do to each other.
#include <gtest/gtest.h>

#include <cmath>

#include "largest.h"
#include "lumbrical/shared_objects.h"
#include "pads.h"
#include "random.h"

namespace lumbrical {
namespace {

using test::largest;
using test::Pad;
using test::Session;

constexpr double kGravity = 9.81, kTick = 1e-3;

Mesh cube(double size, std::uint32_t cells = 2) { return make_box({size, size, size}, cells); }

// No finger anywhere.
DeviceFrame no_hand() { return test::frame_of({{{0, 0, 10}}}); }

TEST(ObjectMotion, ContactsOfAnObjectAreThoseOfTheSameMeshInTheWorld) {
  const Pose pose{{0.01, 0.02, 0.03}, normalized({1, 0.3, 0.1, 0.2})};
  Scene apart = test::pad_scene(), world = apart;
  apart.objects.push_back(test::object_of("sphere", make_sphere(0.03, 12), pose, {0.5, 0.5, 0, 1000}));
  world.objects.push_back({"sphere", make_sphere(0.03, 12)});
  place_mesh(pose, world.objects[0].mesh);
  Session own(apart), same(world);
  const DeviceFrame frame = test::frame_of({{pose.position + Vec3{0, 0, 0.035}, {0, 0, 1}}});
  own.step(frame);
  tick(same.model, same.state, same.scratch, frame);
  const std::span<const Contact> expected = find_contacts(same.model, same.scratch);
  EXPECT_TRUE(find_contacts(own.model, own.scratch).empty());
  const std::span<const Contact> found = find_contacts(own.model, own.scratch, 0);
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_GT(found.size(), 10u);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].triangle, expected[i].triangle);
    EXPECT_EQ(contact_segment(own.scratch, found[i], 0), contact_segment(same.scratch, expected[i]));
    EXPECT_NEAR(found[i].volume, expected[i].volume, 1e-18);
    EXPECT_NEAR(found[i].depth, expected[i].depth, 1e-12);
    EXPECT_LT(norm(transform(pose, found[i].centroid) - expected[i].centroid), 1e-9);
  }
}

TEST(ObjectMotion, AFreeBodyFallsAsGalileoSays) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::body_of("box", cube(0.05), 0.2, {{0, 0, 1}, {}}, {}));
  Session run(scene);
  for (int i = 0; i <= 300; ++i) run.step(no_hand());
  const double fallen = 1 - run.scratch.object_output[0].pose.position.z;
  EXPECT_NEAR(fallen, 0.5 * kGravity * 0.3 * 0.301, 1e-9);  // Euler's step is half a tick ahead
}

TEST(ObjectMotion, ABoxComesToRestOnTheGroundWithoutABounceAndStays) {
  Scene scene = test::pad_scene();
  scene.ground.emplace();
  scene.objects.push_back(test::body_of("box", cube(0.05), 0.2, {{0, 0, 0.06}, {1, 0.05, 0.02, 0}}, {}));
  Session run(scene);
  for (int i = 0; i < 1000; ++i) run.step(no_hand());
  const Pose rested = run.scratch.object_output[0].pose;
  EXPECT_NEAR(rested.position.z, 0.025, 1e-4);
  for (int i = 0; i < 5000; ++i) run.step(no_hand());
  const Pose later = run.scratch.object_output[0].pose;
  EXPECT_LT(norm(later.position - rested.position), 1e-6);
  EXPECT_LT(test::angle_of(later.orientation * conjugate(rested.orientation)), 1e-5);
}

// Where a scene has put its middle on the ground.
TEST(ObjectMotion, ABodyThatBeginsInTheGroundRisesSlowlyAndIsNotThrown) {
  for (const double depth : {0.005, 0.02, 0.1}) {
    for (const double rate : {500.0, 4000.0}) {
      Scene scene = test::pad_scene();
      scene.settings.rate = rate;
      scene.ground.emplace();
      scene.objects.push_back(test::body_of("box", make_box({0.02, 0.02, 0.2}, 2), 0.2,
                                            {{0, 0, 0.1 - depth}, {1, 0, 0.3, 0}}, {}));
      Session run(scene);
      double fastest = 0;
      for (int i = 0; i < 3 * rate; ++i) {
        run.step(no_hand());
        fastest = largest(fastest, run.state.objects[0].velocity.z);
      }
      EXPECT_LT(fastest, 0.5) << depth << ", " << rate;
      EXPECT_NEAR(run.state.objects[0].pose.position.z, 0.01, 1e-4) << depth << ", " << rate;
    }
  }
}

TEST(ObjectMotion, ABodyDoesNotRestOnVerticesThatNoTriangleNames) {
  Scene scene = test::pad_scene();
  scene.ground.emplace();
  scene.objects.push_back(test::body_of("box", make_box({0.05, 0.05, 0.05}, 2), 0.1, {{0, 0, 0.03}, {}}, {}));
  scene.objects[0].mesh.vertices.push_back({0, 0, -0.06});
  Session run(scene);
  for (int i = 0; i < 1000; ++i) run.step(no_hand());
  EXPECT_NEAR(run.state.objects[0].pose.position.z, 0.025, 1e-4);
}

TEST(ObjectMotion, ASpinningBodyNeverGainsEnergy) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.objects.push_back(test::body_of("plate", make_box({0.1, 0.06, 0.01}, 2), 0.3, {}, {}));
  Session run(scene);
  run.state.objects[0].angular_velocity = {0.3, 12, 0.2};  // about its middle axis: it tumbles
  const auto energy = [&] {
    const ObjectState& state = run.state.objects[0];
    const Vec3 w = rotate(conjugate(state.pose.orientation), state.angular_velocity);
    const auto& inertia = run.model.apart[0].mechanism.body.inertia;
    return inertia[0] * w.x * w.x + inertia[1] * w.y * w.y + inertia[2] * w.z * w.z;
  };
  const double at_first = energy();
  double most = at_first;
  for (int i = 0; i < 5000; ++i) {
    run.step(no_hand());
    most = largest(most, energy());
  }
  EXPECT_LT(most, 1.001 * at_first);
  EXPECT_GT(energy(), 0.5 * at_first);
}

TEST(ObjectMotion, WhatTheHandFeelsIsWhatTheObjectsMomentumChangesBy) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.objects.push_back(
      test::body_of("box", cube(0.05, 4), 0.2, {{0, 0, 0}, {1, 0.1, 0.05, 0.02}}, {0.8, 0.6, 0.1, 1000}));
  Session run(scene);
  test::Random random(3);
  double worst = 0, most = 0;
  for (int i = 0; i < 400; ++i) {
    const double push = 0.0008 * std::sin(0.02 * i);
    const DeviceFrame frame =
        test::frame_of({{{-0.0315 + push, 0.002 * std::sin(0.05 * i), 0.001}, {-1, 0, 0}},
                        {{0.0318, 0.001, 0.002}, {1, 0, 0}},
                        {{0.004, -0.0314, push}, {0, -1, 0}}});
    const ObjectState before = run.state.objects[0];
    const ObjectOutput out = run.step(frame);
    const ObjectState& after = run.state.objects[0];
    const Vec3 force = (0.2 / kTick) * (after.velocity - before.velocity);
    worst = largest(worst, norm(force - out.wrench.force));
    worst = largest(worst, norm(test::hand_force(run.output) + out.wrench.force));
    most = largest(most, norm(force));
    EXPECT_LT(norm(out.pose.position), 0.05);
  }
  EXPECT_LT(worst, 1e-10);
  EXPECT_GT(most, 1);  // [N]
}

TEST(ObjectMotion, AKeyOfFiveGramsIsStableUnderAStiffFinger) {
  Scene scene = test::pad_scene();
  SceneObject key = test::body_of("key", make_box({0.02, 0.02, 0.005}, 2), 0.005, {{0, 0, 0}, {}}, {});
  key.mechanism.mobility = Mobility::slider;
  key.mechanism.lower = -0.004;
  key.mechanism.upper = 0;
  key.mechanism.spring = 150;
  key.mechanism.rest = 0.002;
  scene.objects.push_back(key);
  Session run(scene);
  double last = 0, roughest = 0, most = 0, lowest = 0;
  for (int i = 0; i < 3000; ++i) {  // slowly down to the stop and up again
    const double down = 0.007 * std::sin(3.14159265 * i / 3000);
    run.step(test::frame_of({{{0, 0, 0.0025 + test::kPadRadius - down}, {0, 0, 1}}}));
    const double force = test::hand_force(run.output).z;
    roughest = largest(roughest, std::fabs(force - last));
    most = largest(most, force);
    lowest = min(lowest, run.state.objects[0].coordinate);
    last = force;
    EXPECT_GE(force, -1e-9);
    EXPECT_GE(run.state.objects[0].coordinate, -0.004);
  }
  EXPECT_LT(roughest, 0.03);  // [N] from one tick to the next
  EXPECT_GT(most, 2);         // [N]
  EXPECT_EQ(lowest, -0.004) << "the key never came to its stop";
}

TEST(ObjectMotion, AHingeTurnsAboutItsAxisOnlyAndStopsAtItsLimits) {
  Scene scene = test::pad_scene();
  SceneObject lever = test::body_of("lever", make_box({0.1, 0.02, 0.02}, 4), 0.1, {{0.05, 0, 0}, {}}, {});
  lever.mechanism.mobility = Mobility::hinge;
  lever.mechanism.axis = {0, -1, 0};  // the free end rises as it turns
  lever.mechanism.lower = -0.5;
  lever.mechanism.upper = 0.8;
  scene.objects.push_back(lever);
  Session run(scene);
  for (int i = 0; i < 2000; ++i) run.step(no_hand());
  EXPECT_EQ(run.state.objects[0].coordinate, -0.5);
  const Vec3 pivot = transform(run.state.objects[0].pose, {-0.05, 0, 0});
  EXPECT_LT(norm(pivot), 1e-15);
}

// How far its centre of mass is from moving as its turning about (0, 0, 0) lets it.
double own_speed_of_centre(const Session& run) {
  const ObjectState& state = run.state.objects[0];
  const Vec3 arm = transform(state.pose, run.model.apart[0].mechanism.body.centre);
  return norm(state.velocity - cross(state.angular_velocity, arm));
}

TEST(ObjectMotion, AHingesCentreOfMassMovesAsItTurns) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(
      test::body_of("lever", make_box({0.1, 0.02, 0.02}, 4), 0.1, {{0.05, 0, 0}, {}}, {}));
  scene.objects[0].mechanism.mobility = Mobility::hinge;
  scene.objects[0].mechanism.axis = {0, -1, 0};
  Session run(scene);
  double fastest = 0;
  for (int i = 0; i < 1000; ++i) {
    run.step(no_hand());
    EXPECT_LT(own_speed_of_centre(run), 1e-12);
    fastest = largest(fastest, norm(run.state.objects[0].velocity));
  }
  EXPECT_GT(fastest, 0.5);  // [m/s]
}

TEST(ObjectMotion, APendulumOnABallGoesRoundItsCone) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::body_of("ball", cube(0.02), 0.1, {{0.06, 0, -0.08}, {}}, {}));
  scene.objects[0].mechanism.mobility = Mobility::ball;
  Session run(scene);
  const double turning = std::sqrt(kGravity / 0.08);  // [rad/s]
  run.state.objects[0].angular_velocity = {0, 0, turning};
  for (int i = 1; i <= 2000; ++i) {
    run.step(no_hand());
    const Vec3 place = run.state.objects[0].pose.position;
    EXPECT_NEAR(place.z, -0.08, 1e-9);
    EXPECT_NEAR(place.x, 0.06 * std::cos(turning * kTick * i), 1e-4);
    EXPECT_LT(own_speed_of_centre(run), 1e-12);
  }
}

TEST(ObjectMotion, ABodyOnABallThatHangsStillHasNoSpeed) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::body_of("ball", cube(0.04, 4), 0.1, {{0, 0, -0.1}, {}}, {}));
  scene.objects[0].mechanism.mobility = Mobility::ball;
  scene.objects[0].mechanism.damping = 0.01;
  const auto press_after = [&](double turning) {
    Session run(scene);
    run.state.objects[0].angular_velocity = {0, turning, 0};
    for (int i = 0; i < 6000; ++i) run.step(no_hand());
    EXPECT_LT(norm(run.state.objects[0].angular_velocity), 1e-9);
    EXPECT_LT(norm(run.state.objects[0].velocity), 1e-9);
    const Pad below{{0, 0, -0.12 - test::kPadRadius + 0.001}, {0, 0, -1}};
    for (int i = 0; i < 10; ++i) run.step(test::frame_of({below}));
    return test::hand_force(run.output).z;
  };
  const double never_turned = press_after(0);
  EXPECT_LT(never_turned, -0.3);
  EXPECT_NEAR(press_after(8), never_turned, 1e-6);
}

TEST(ObjectMotion, ABodyOnABallGainsTheAngularMomentumThatHandAndWeightGiveIt) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::body_of("ball", cube(0.04, 4), 0.1, {{0, 0, -0.1}, {}}, {0.5, 0.4, 0, 1000}));
  scene.objects[0].mechanism.mobility = Mobility::ball;
  Session run(scene);
  const ObjectState& state = run.state.objects[0];
  const MassProperties body = run.model.apart[0].mechanism.body;
  const Vec3 weight = body.mass * scene.gravity;
  Vec3 given;
  for (int i = 0; i < 400; ++i) {  // pushed aside by 40 mm and beside its middle, left, and turning
    const Vec3 origin = state.pose.position;
    const double x = -0.028 + (i < 200 ? 1e-6 * i * i : 0);
    const Wrench hand = run.step(test::frame_of({{{x, 0.004, -0.1}, {-1, 0, 0}}})).wrench;
    given += kTick * (hand.torque + cross(origin, hand.force + weight));
  }
  const Vec3 arm = state.pose.position, spin = state.angular_velocity;
  const Vec3 gained = body.inertia[0] * spin + body.mass * cross(arm, cross(spin, arm));  // a cube's
  EXPECT_GT(norm(given), 0.004);
  EXPECT_LT(norm(gained - given), 0.005 * norm(given));
}

TEST(ObjectMotion, DryFrictionHoldsALeverAndDetentsCatchIt) {
  Scene scene = test::pad_scene();
  SceneObject knob = test::body_of("knob", make_box({0.1, 0.02, 0.02}, 4), 0.1, {{0.05, 0, 0}, {}}, {});
  knob.mechanism.mobility = Mobility::hinge;
  knob.mechanism.axis = {0, -1, 0};
  knob.mechanism.dry_friction = 0.06;  // its weight turns it with 0.049 N m
  scene.objects.push_back(knob);
  Session held(scene);
  for (int i = 0; i < 1000; ++i) held.step(no_hand());
  EXPECT_EQ(held.state.objects[0].coordinate, 0);

  scene.gravity = {};
  scene.objects[0].mechanism.dry_friction = 0;
  scene.objects[0].mechanism.damping = 0.002;
  scene.objects[0].mechanism.detent_force = 0.05;
  scene.objects[0].mechanism.detent_pitch = 0.2;
  Session caught(scene);
  caught.state.objects[0].coordinate = 0.27;
  for (int i = 0; i < 3000; ++i) caught.step(no_hand());
  EXPECT_NEAR(caught.state.objects[0].coordinate, 0.2, 1e-3);
}

TEST(ObjectMotion, DetentsCatchHoweverFarFromTheFirst) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  SceneObject knob = test::body_of("knob", make_box({0.02, 0.02, 0.02}, 4), 0.1, {}, {});
  knob.mechanism.mobility = Mobility::hinge;
  knob.mechanism.axis = {0, 0, 1};
  knob.mechanism.damping = 0.002;
  knob.mechanism.detent_force = 0.05;
  knob.mechanism.detent_pitch = 0.01;
  scene.objects.push_back(knob);
  Session caught(scene);
  caught.state.objects[0].coordinate = 900.003;  // 143 turns
  for (int i = 0; i < 3000; ++i) caught.step(no_hand());
  EXPECT_NEAR(caught.state.objects[0].coordinate, 900, 1e-4);
}

// A door that fingers may push from either side, and a handle that stands where it is put.
Scene door_scene() {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  SceneObject door = test::body_of("door", make_box({0.02, 0.3, 0.2}, 4), 0.5, {}, {});
  door.mechanism.mobility = Mobility::hinge;
  door.mechanism.pivot = {0, -0.15, 0};
  door.mechanism.axis = {0, 0, -1};
  door.mechanism.lower = 0;
  door.mechanism.damping = 0.05;
  door.mechanism.latch = {1, 0.4};
  SceneObject handle = test::body_of("handle", cube(0.02), 0.05, {{0, 1, 0}, {}}, {});
  handle.mechanism.mobility = Mobility::hinge;
  scene.objects = {door, handle};
  return scene;
}

TEST(ObjectMotion, ALatchHoldsADoorUntilItsHandleIsTurnedAndCatchesItWhenShut) {
  Session run(door_scene());
  const double& door = run.state.objects[0].coordinate;
  double &handle = run.state.objects[1].coordinate, last = 0, roughest = 0, most = 0;
  const auto push = [&](double x, double side) {
    run.step(test::frame_of({{{x - side * (0.01 + test::kPadRadius - 0.002), 0.1, 0}, {-side, 0, 0}}}));
    const double force = norm(test::hand_force(run.output));
    roughest = largest(roughest, std::fabs(force - last));
    last = force;
    most = largest(most, force);
  };
  const auto shove = [&](double from, double to, double side) {
    for (int i = 0; i <= 500; ++i) push(from + (to - from) * i / 500, side);
  };
  shove(-0.004, 0, 1);
  EXPECT_EQ(door, 0);  // latched
  EXPECT_GT(last, 1);
  handle = 0.39;
  push(0, 1);
  EXPECT_EQ(door, 0);  // not far enough
  handle = 0.41;
  shove(0, 0.03, 1);
  EXPECT_GT(door, 0.1);
  handle = 0;
  shove(0.03, 0.04, 1);
  EXPECT_GT(door, 0.13);  // what is open stays free
  last = 0;
  shove(0.08, -0.002, -1);
  EXPECT_EQ(door, 0);  // shut
  last = 0;
  shove(-0.004, 0, 1);
  EXPECT_EQ(door, 0);  // caught
  EXPECT_LT(roughest, 0.15 * most);
}

TEST(ObjectMotion, AGivenObjectIsFeltWhereItIsTold) {
  Scene scene = test::pad_scene();
  SceneObject box = test::object_of("box", cube(0.05, 3), {}, {});
  box.mechanism.mobility = Mobility::given;
  scene.objects.push_back(box);
  Session run(scene);
  const Pose X_WO{{0.3, -0.2, 0.1}, normalized({0.9, 0.1, -0.3, 0.2})};
  const ObjectFrame told{X_WO};
  const Pad pad{transform(X_WO, {0.003, 0.001, 0.025 + 0.006}), rotate(X_WO.orientation, {0, 0, 1})};
  const ObjectOutput out = run.step(test::frame_of({pad}), {&told, 1});

  Scene still = test::pad_scene();
  still.objects.push_back({"box", cube(0.05, 3)});
  const Model world = test::model_of(still);
  Scratch scratch = make_scratch(world);
  State state;
  DeviceFrame frame = test::frame_of({pad});
  frame.base = inverse(X_WO);
  const Vec3 expected = test::hand_force(tick(world, state, scratch, frame));
  EXPECT_GT(norm(expected), 1);
  EXPECT_LT(norm(rotate(X_WO.orientation, expected) - test::hand_force(run.output)), 1e-5 * norm(expected));
  EXPECT_LT(norm(out.wrench.force + test::hand_force(run.output)), 1e-12);
  EXPECT_EQ(out.pose.position, X_WO.position);
}

TEST(ObjectMotion, PosesThatAreMissingBrokenOrJumpAreToldAndForcesFade) {
  Scene scene = test::pad_scene();
  scene.settings.fade_time = 0.02;
  SceneObject box = test::object_of("box", cube(0.05, 3), {}, {});
  box.mechanism.mobility = Mobility::given;
  scene.objects.push_back(box);
  Session run(scene);
  const DeviceFrame frame = test::frame_of({{{0, 0, 0.031}, {0, 0, 1}}});
  ObjectFrame told;
  for (int i = 0; i < 50; ++i) run.step(frame, {&told, 1});
  EXPECT_EQ(run.output.flags & (kObjectMissing | kObjectImplausible), 0u);
  const double before = norm(test::hand_force(run.output));
  run.step(frame);
  EXPECT_NE(run.output.flags & kObjectMissing, 0u);
  EXPECT_NEAR(norm(test::hand_force(run.output)), before, 1e-12);

  for (const Pose bad :
       {Pose{{std::nan(""), 0, 0}, {}}, Pose{{0, 0, 0}, {0, 0, 0, 0}}, Pose{{1, 0, 0}, {}}}) {
    told.pose = bad;
    run.step(frame, {&told, 1});
    EXPECT_NE(run.output.flags & kObjectImplausible, 0u);
    EXPECT_LT(norm(test::hand_force(run.output)), before);
    EXPECT_GT(norm(test::hand_force(run.output)), 0.9 * before);  // fades, does not step
    told.pose = {};
    for (int i = 0; i < 60; ++i) run.step(frame, {&told, 1});
    EXPECT_NEAR(norm(test::hand_force(run.output)), before, 1e-12);
  }
}

// Engines at half the rate may pass a pose in every other tick, or each one twice.
TEST(ObjectMotion, APoseThatIsMissingIsFeltAsTheLastOneToldAgain) {
  Scene scene = test::pad_scene();
  scene.settings.pad.damping = 5;
  SceneObject box = test::object_of("box", cube(0.05, 3), {}, {});
  box.mechanism.mobility = Mobility::given;
  scene.objects.push_back(box);
  Session twice(scene), every_other(scene);
  const DeviceFrame frame = test::frame_of({{{0, 0, 0.031}, {0, 0, 1}}});
  ObjectFrame told;
  for (int i = 0; i < 40; ++i) {
    if (i % 2 == 0) told.pose.position.z = 1e-4 * i;
    twice.step(frame, {&told, 1});
    if (i % 2 == 0)
      every_other.step(frame, {&told, 1});
    else
      every_other.step(frame);
    EXPECT_EQ(norm(test::hand_force(every_other.output) - test::hand_force(twice.output)), 0) << i;
  }
  EXPECT_GT(norm(every_other.state.objects[0].velocity), 0.05);
}

TEST(ObjectMotion, AnObjectThatIsToldOnlyWhenItIsTouchedIsFeltByAndBy) {
  Scene scene = test::pad_scene();
  scene.settings.fade_time = 0.02;
  SceneObject box = test::object_of("box", cube(0.05, 3), {{1, 0, 0}, {}}, {});
  box.mechanism.mobility = Mobility::given;
  scene.objects.push_back(box);
  Session run(scene);
  const DeviceFrame frame = test::frame_of({{{0, 0, 0.031}, {0, 0, 1}}});
  for (int i = 0; i < 50; ++i) run.step(frame);
  const ObjectFrame told;
  std::vector<double> force;
  for (int i = 0; i < 30; ++i) {
    run.step(frame, {&told, 1});
    force.push_back(norm(test::hand_force(run.output)));
  }
  EXPECT_GT(force.back(), 1);
  EXPECT_LT(force[0], 0.051 * force.back());
  for (std::size_t i = 1; i < force.size(); ++i) EXPECT_LT(force[i] - force[i - 1], 0.051 * force.back());
}

TEST(ObjectMotion, TwoHandsPullOnOneObjectAndEveryForceHasItsCounterpart) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.objects.push_back(test::object_of("shelf", cube(0.1), {{0, 0, -1}, {}}, {0.5, 0.5, 0, 1000}));
  scene.objects.push_back(
      test::body_of("box", cube(0.05, 4), 0.2, {{0, 0, 0}, {1, 0.1, 0.05, 0.02}}, {0.8, 0.6, 0.1, 1000}));
  SharedObjects shared;
  ASSERT_TRUE(share_objects(scene, {}, shared).ok());
  Session right(given_objects(scene)), left(given_objects(scene));
  Hand other = mirrored_hand(scene.hand);
  ASSERT_TRUE(share_world(right.model, other, left.model).ok());
  left.scratch = make_scratch(left.model);
  std::vector<ObjectFrame> given = start_frames(right.model);
  double worst = 0, farthest = 0;
  Vec3 gained;  // [N] in the step before
  for (int i = 0; i < 600; ++i) {
    const double pull = 0.0006 * std::sin(0.02 * i);
    const auto hold = [&](double side, double by) {
      return test::frame_of({{{side * 0.0315 + by, 0.004 * side, 0.001}, {side, 0, 0}},
                             {{side * 0.012, 0.0316, by}, {0, 1, 0}},
                             {{side * 0.012, -0.0316, by}, {0, -1, 0}}});
    };
    right.step(hold(1, pull), given);
    left.step(hold(-1, -0.7 * pull), given);
    const Vec3 before = shared.state.objects[1].velocity;
    push_objects(shared, right.model, right.scratch);
    push_objects(shared, left.model, left.scratch);
    move_objects(shared, given);
    const Vec3 felt = test::hand_force(right.output) + test::hand_force(left.output);
    // A tick later, for a hand's tick knows nothing of the other's.
    if (i > 0) worst = largest(worst, norm(gained + felt));
    gained = (0.2 / kTick) * (shared.state.objects[1].velocity - before);
    farthest = largest(farthest, norm(given[0].pose.position));
    EXPECT_EQ((right.output.flags | left.output.flags) & kObjectImplausible, 0u);
  }
  EXPECT_LT(worst, 0.01);
  EXPECT_GT(farthest, 1e-5);
  EXPECT_LT(farthest, 0.005);
}

TEST(ObjectMotion, InstancesShareOneSearchStructure) {
  Scene scene = test::pad_scene();
  for (int i = 0; i < 5; ++i)
    scene.objects.push_back(test::body_of("box", cube(0.05), 0.2, {{0.1 * i, 0, 0}, {}}, {}));
  const Model model = test::model_of(scene);
  ASSERT_EQ(model.apart.size(), 5u);
  for (const ApartObject& object : model.apart) EXPECT_EQ(object.shape, model.apart[0].shape);
}

}  // namespace
}  // namespace lumbrical
