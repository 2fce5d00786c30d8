// Memory that is another model's, or nobody's, given to a build without assertions: this program compiles the
// tick once more without them.
#include <gtest/gtest.h>

#include "largest.h"
#include "lumbrical/jacobian.h"
#include "session.h"

#ifndef NDEBUG
#error "what is tested here is a build without assertions"
#endif

namespace lumbrical {
namespace {

Scene rubbing_scene() {
  Scene scene = test::mug_scene(Law::field);
  SceneObject plate;  // felt apart: State and Scratch have something of it
  plate.name = "plate";
  plate.mesh = make_box({0.1, 0.1, 0.01}, 4);
  plate.material.static_friction = plate.material.kinetic_friction = 0.5;
  plate.pose.position = {0, 0, 0.1};
  scene.objects.push_back(plate);
  return scene;
}

double strongest(const HandForces& forces) {
  double most = 0;
  for (const Wrench& wrench : forces.segment) most = test::largest(most, norm(wrench.force));
  return most;
}

// A hand that grasps the mug and has felt it for a while.
struct Grasp {
  Model model;
  State state;
  Scratch scratch;
  DeviceFrame frame;
  ActuatorFrame output;

  explicit Grasp(const Scene& scene)
      : model(test::model_of(scene)), state(make_state(model)), scratch(make_scratch(model)) {
    frame = test::grasp_frames(model.hand, 2)[1];  // half-way, where it holds
    for (int i = 0; i < 200; ++i) output = tick(model, state, scratch, frame);
  }
};

// Ticks on what is not the model's: flagged, and from what was felt to nothing without a step.
void expect_fading(Grasp& grasp, State& state, Scratch& scratch) {
  const double felt = strongest(state.last);
  const double steps = grasp.model.settings.fade_time * grasp.model.settings.rate;
  ASSERT_GT(felt, 0.1);
  double before = felt;
  for (int i = 0; i < static_cast<int>(steps) + 1; ++i) {
    const std::uint64_t number = state.tick;
    const ActuatorFrame output = tick(grasp.model, state, scratch, grasp.frame);
    EXPECT_EQ(output.flags, kMemoryForeign | kFading);
    EXPECT_EQ(output.tick, number);
    EXPECT_EQ(output.contact_count, 0u);
    const double now = strongest(output);
    EXPECT_LE(now, before);
    EXPECT_GE(now, before - 1.001 * felt / steps);
    before = now;
  }
  EXPECT_EQ(before, 0);
}

TEST(ForeignMemory, OfAnotherModelIsFlaggedAndForcesFade) {
  Grasp grasp(rubbing_scene());
  const Model other = test::model_of(test::mug_scene(Law::max_depth));
  Scratch foreign = make_scratch(other);
  expect_fading(grasp, grasp.state, foreign);
}

TEST(ForeignMemory, ThatIsEmptyIsFlaggedAndForcesFade) {
  Grasp grasp(rubbing_scene());
  Scratch empty;
  expect_fading(grasp, grasp.state, empty);
  for (const std::uint64_t hash : empty.stage_hash) EXPECT_EQ(hash, 0u);
}

TEST(ForeignMemory, OfAStateWithoutTheModelsObjectsIsFlaggedAndForcesFade) {
  Grasp grasp(rubbing_scene());
  State foreign;
  static_cast<HandState&>(foreign) = grasp.state;
  expect_fading(grasp, foreign, grasp.scratch);
}

TEST(ForeignMemory, IsForgottenOnceTheModelsOwnIsThereAgain) {
  Grasp grasp(rubbing_scene());
  Scratch empty;
  for (int i = 0; i < 3; ++i) tick(grasp.model, grasp.state, empty, grasp.frame);
  ActuatorFrame output;
  for (int i = 0; i < 500; ++i) output = tick(grasp.model, grasp.state, grasp.scratch, grasp.frame);
  EXPECT_EQ(output.flags, grasp.output.flags);
  EXPECT_NEAR(strongest(output), strongest(grasp.output), 0.01 * strongest(grasp.output));
}

TEST(ForeignMemory, HasNoContactsAndNoKnownStiffness) {
  Grasp grasp(rubbing_scene());
  const Model other = test::model_of(test::mug_scene(Law::field));
  Scratch empty, foreign = make_scratch(other);
  for (Scratch* const scratch : {&empty, &foreign}) {
    EXPECT_TRUE(find_contacts(grasp.model, *scratch).empty());
    EXPECT_TRUE(find_contacts(grasp.model, *scratch, 0).empty());
    std::array<SegmentJacobian, kSegmentCount> jacobians{};
    jacobians.fill({{}, true});
    segment_jacobians(grasp.model, *scratch, jacobians);
    for (const SegmentJacobian& jacobian : jacobians) EXPECT_FALSE(jacobian.known);
    EXPECT_EQ(placed_joints(*scratch)[kWrist].position, Vec3{});
  }
  EXPECT_FALSE(find_contacts(grasp.model, grasp.scratch).empty());
}

}  // namespace
}  // namespace lumbrical
