// What rests on the ground, by itself and under a hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "largest.h"
#include "lumbrical/shapes.h"
#include "pads.h"
#include "random.h"

namespace lumbrical {
namespace {

using test::largest;
using test::Session;

constexpr Material kSkin{0.8, 0.6, 0, 1000};

double lowest_vertex(const Mesh& mesh, const Pose& pose) {
  double lowest = 1e300;
  for (const Vec3 v : mesh.vertices) lowest = std::min(lowest, transform(pose, v).z);
  return lowest;
}

// [m] How deep what is dropped there lies in the end.
double depth_at_rest(const Mesh& mesh, const Pose& dropped) {
  Scene scene = test::pad_scene();
  scene.ground.emplace();
  scene.objects.push_back(test::body_of("it", mesh, 0.2, dropped, {}));
  Session run(scene);
  for (int i = 0; i < 4000; ++i) run.step(test::frame_of({{{0, 0, 10}}}));
  return -lowest_vertex(mesh, run.state.objects[0].pose);
}

TEST(Ground, RoundThingsLieOnItHoweverTheyFall) {
  test::Random random(7);
  const Mesh ball = make_sphere(0.04, 12), mug = make_mug({});
  for (int i = 0; i < 6; ++i) {
    const Pose dropped{{0, 0, 0.1}, random.rotation()};
    EXPECT_LT(depth_at_rest(ball, dropped), 0.035 * 0.08) << i;
    EXPECT_LT(depth_at_rest(mug, dropped), 0.001) << i;
  }
}

TEST(Ground, FlatThingsLieOnTheirFaces) {
  for (const Vec3 size : {Vec3{0.1, 0.06, 0.001}, {0.008, 0.008, 0.17}, {0.05, 0.05, 0.05}})
    EXPECT_NEAR(depth_at_rest(make_box(size, 3), {{0, 0, size.z / 2 + 0.01}, {}}), 0, 1e-4) << size.z;
}

TEST(Ground, IsAsHardUnderALightThingThatAFingerPresses) {
  for (const double mass : {0.001, 0.05, 0.5}) {
    Scene scene = test::pad_scene();
    scene.ground.emplace();
    const Mesh box = make_box({0.04, 0.04, 0.02}, 2);
    scene.objects.push_back(test::body_of("box", box, mass, {{0, 0, 0.01}, {}}, kSkin));
    Session run(scene);
    for (int i = 0; i < 1500; ++i) {
      const double gap = 0.001 - 0.004 * min(1, i / 500.0);
      run.step(test::frame_of({{{0, 0, 0.02 + test::kPadRadius + gap}, {0, 0, 1}}}));
    }
    EXPECT_GT(run.output.segment[2].force.z, 3) << mass;
    EXPECT_NEAR(run.state.objects[0].pose.position.z, 0.01, 1e-4) << mass;
  }
}

// [N] The largest step in a tick of a fingertip that, with another, has pinched a cube on the ground and
// pressed it down.
double trembling_on_ground(double mass, double rate) {
  constexpr double kCube = 0.05;  // [m]
  Scene scene = test::pad_scene();
  scene.settings.rate = rate;
  scene.ground.emplace();
  scene.objects.push_back(
      test::body_of("box", make_box({kCube, kCube, kCube}, 3), mass, {{0, 0, kCube / 2}, {}}, kSkin));
  Session run(scene);
  double most = 0;
  for (int i = 0; i < 1.2 * rate; ++i) {
    const double closed = min(1, i / (0.3 * rate)), lowered = clamp(i / (0.3 * rate) - 1, 0, 1);
    const double reach = kCube / 2 + test::kPadRadius + 0.002 - 0.0045 * closed, z = 0.03 - 0.004 * lowered;
    const Vec3 before = run.output.segment[2].force;
    run.step(test::frame_of({{{0.006, reach, z}, {0, 1, 0}}, {{-0.006, -reach, z}, {0, -1, 0}}}));
    if (i > rate) most = largest(most, norm(run.output.segment[2].force - before));
  }
  EXPECT_GT(norm(run.output.segment[2].force), 0.5);
  return most;
}

TEST(Ground, LightThingsThatAHandHoldsOnItComeToRest) {
  for (const double rate : {200.0, 500.0, 1000.0}) {
    for (const double mass : {0.002, 0.01, 0.05, 0.2})
      EXPECT_LT(trembling_on_ground(mass, rate), 0.01) << rate << ", " << mass;
  }
}

// [m/s] The fastest that a body dropped from `height` [m] ever is, whichever way it tumbles.
double top_speed(const Mesh& mesh, double mass, double rate, double height) {
  test::Random random(5);
  double top = 0;
  for (int i = 0; i < 4; ++i) {
    Scene scene = test::pad_scene();
    scene.settings.rate = rate;
    scene.ground.emplace();
    scene.objects.push_back(test::body_of("it", mesh, mass, {{0, 0, height}, random.rotation()}, kSkin));
    Session run(scene);
    for (int n = 0; n < rate; ++n) {
      run.step(test::frame_of({{{0, 0, 10}}}));
      top = largest(top, norm(run.state.objects[0].velocity));
    }
  }
  return top;
}

TEST(Ground, ThingsThatFallOnItGainNoSpeedHoweverLightTheyAre) {
  constexpr double kHeight = 0.05, kFallen = 0.99;  // [m], [m/s] at the ground
  const Mesh card = make_box({0.008, 0.005, 0.0005}, 1), cube = make_box({0.005, 0.005, 0.005}, 1),
             pencil = make_box({0.08, 0.003, 0.003}, 1);
  for (const double rate : {200.0, 500.0, 1000.0, 4000.0}) {
    for (const double mass : {1e-5, 1e-4, 1e-3}) {
      for (const Mesh* mesh : {&card, &cube, &pencil})
        EXPECT_LT(top_speed(*mesh, mass, rate, kHeight), 1.1 * kFallen) << rate << ", " << mass;
    }
  }
}

TEST(Ground, LightThingsStayUnderAFingerThatPressesThem) {
  constexpr double kSize = 0.005;
  for (const double rate : {200.0, 500.0, 1000.0}) {
    for (const double mass : {1e-5, 1e-4, 5e-4}) {
      Scene scene = test::pad_scene();
      scene.settings.rate = rate;
      scene.ground.emplace();
      scene.objects.push_back(
          test::body_of("ball", make_sphere(kSize / 2, 6), mass, {{0, 0, kSize / 2}, {}}, kSkin));
      Session run(scene);
      for (int i = 0; i < 1.5 * rate; ++i) {
        const double pressed = 0.003 * min(1, i / (0.5 * rate)),
                     slid = 0.002 * clamp(i / (0.5 * rate) - 1, 0, 1);
        run.step(test::frame_of({{{slid, 0, kSize + test::kPadRadius + 0.001 - pressed}, {0, 0, 1}}}));
      }
      EXPECT_GT(run.output.segment[2].force.z, 0.3) << rate << ", " << mass;
      EXPECT_LT(norm(run.state.objects[0].pose.position), 0.01) << rate << ", " << mass;
    }
  }
}

}  // namespace
}  // namespace lumbrical
