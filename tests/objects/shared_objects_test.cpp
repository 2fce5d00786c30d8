// Two hands on one object: it moves in a step that knows how the forces of both change within it.
#include "lumbrical/shared_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "largest.h"
#include "lumbrical/shapes.h"
#include "pads.h"

namespace lumbrical {
namespace {

using test::largest;
using test::Session;

constexpr double kSide = 0.05;  // [m] of the cube they hold

Scene cube_scene(double mass, double rate) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.settings.rate = rate;
  scene.objects.push_back(
      test::body_of("box", make_box({kSide, kSide, kSide}, 4), mass, {}, {0.8, 0.6, 0, 1000}));
  return scene;
}

/// Both hands, and what they share.
struct BothHands {
  SharedObjects shared;
  Session right, left;
  std::vector<ObjectFrame> given;

  explicit BothHands(const Scene& scene) : right(given_objects(scene)), left(given_objects(scene)) {
    EXPECT_TRUE(share_objects(scene, {}, shared).ok());
    EXPECT_TRUE(share_world(right.model, mirrored_hand(scene.hand), left.model).ok());
    left.scratch = make_scratch(left.model);
    given = start_frames(right.model);
  }
  ObjectState& object() { return shared.state.objects[0]; }
  void step(const DeviceFrame& of_right, const DeviceFrame& of_left) {
    right.step(of_right, given);
    left.step(of_left, given);
    push_objects(shared, right.model, right.scratch);
    push_objects(shared, left.model, left.scratch);
    move_objects(shared, given);
  }
};

// Two fingertips, on the half of the cube that `side` is of; 1.5 mm deep where `closed` is 1, off it at 0.
DeviceFrame grip(double side, double closed) {
  const double y = kSide / 2 + test::kPadRadius + 0.003 - 0.0045 * closed, x = side * kSide / 4;
  return test::frame_of({{{x, y, 0}, {0, 1, 0}}, {{x, -y, 0}, {0, -1, 0}}});
}

/// The largest step [N] of a segment's force, of either hand, from tick to tick.
class Roughness {
 public:
  void note(const BothHands& hands, bool counts) {
    note(hands.right.output, right_, counts);
    note(hands.left.output, left_, counts);
  }
  [[nodiscard]] double most() const { return most_; }

 private:
  void note(const ActuatorFrame& output, ActuatorFrame& last, bool counts) {
    for (std::size_t k = 0; counts && k < kSegmentCount; ++k)
      most_ = largest(most_, norm(output.segment[k].force - last.segment[k].force));
    last = output;
  }
  ActuatorFrame right_, left_;
  double most_ = 0;
};

TEST(TwoHands, HoldALightThingThatComesToRestAfterATap) {
  for (const double rate : {500.0, 1000.0}) {
    for (const double mass : {0.001, 0.005, 0.05}) {
      BothHands hands(cube_scene(mass, rate));
      Roughness roughness;
      const int half_a_second = static_cast<int>(rate / 2);
      for (int i = 0; i < 2 * half_a_second; ++i) {
        const double closed = min(1, 4 * i / rate);
        if (i == half_a_second) hands.object().velocity += Vec3{0.2, 0.1, -0.1};
        hands.step(grip(1, closed), grip(-1, closed));
        roughness.note(hands, i > 2 * half_a_second - rate / 10);
      }
      EXPECT_LT(roughness.most(), 0.01) << mass << ", " << rate;
      EXPECT_LT(norm(hands.object().pose.position), 0.003) << mass << ", " << rate;
      EXPECT_GT(norm(hands.left.output.segment[2].force), 0.5) << mass << ", " << rate;
    }
  }
}

TEST(TwoHands, HandALightThingOverThatDoesNotFall) {
  constexpr double kRate = 1000;
  Scene scene = cube_scene(0.005, kRate);
  scene.gravity = {0, 0, -9.81};
  BothHands hands(scene);
  Roughness roughness;
  hands.object().pose.position = hands.given[0].pose.position = {};
  for (int i = 0; i < 1200; ++i) {
    const double passed = clamp((i - 400) / 400.0, 0, 1);  // first both hold it, then the other alone
    hands.step(grip(1, min(1, 2 - 2 * passed)), grip(-1, min(1, 2 * passed)));
    roughness.note(hands, i > 0);
  }
  EXPECT_LT(roughness.most(), 0.1);
  EXPECT_LT(norm(hands.object().pose.position), 0.002);
  EXPECT_EQ(norm(test::hand_force(hands.right.output)), 0) << "it has let go";
  EXPECT_NEAR(test::hand_force(hands.left.output).z, -0.005 * 9.81, 0.02 * 0.005 * 9.81);
}

}  // namespace
}  // namespace lumbrical
