// On very fine meshes a hand that presses hard takes small blocks as ones where its skin goes through them,
// and one that presses less opens them: by how much is a force off, does it step, and is it the same on every
// way?
#include <gtest/gtest.h>

#include "lumbrical/shapes.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

constexpr double kWidth = 0.2;

// Triangles of 0.3 mm.
Scene fine_scene() {
  Scene scene =
      sampled_scene(default_hand(Side::right), {{"field", make_height_field(kWidth, 640, 0.002, 0.04)}});
  scene.settings.max_candidates = 1u << 20;
  return scene;
}

DeviceFrame pressed(const Hand& hand, double depth) {
  DeviceFrame frame = pressed_frame(hand, depth, 0.3);
  frame.base.position.y -= 0.01;
  return frame;
}

/// Tells the levels of a frame, by the passes that a tick goes through.
class LevelsOf {
 public:
  explicit LevelsOf(const Model& model) : model_(model), scratch_(make_scratch(model)) {
    size_samples(model, memory_);
  }
  LevelWeights operator()(const DeviceFrame& frame) {
    State state;
    tick(model_, state, scratch_, frame);
    SampledForces forces;
    EXPECT_TRUE(sample_forces(model_, *scratch_.primitives, kAllSegments, memory_, forces));
    return forces.level;
  }

 private:
  const Model& model_;
  Scratch scratch_;
  SampleMemory memory_;
};

// A depth at which levels of different blocks are mixed.
double mixed_depth(const Model& model) {
  LevelsOf levels_of(model);
  double low = -0.004, high = 0.008;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    const LevelWeights levels = levels_of(pressed(model.hand, middle));
    if (levels[0] > 0 && levels[0] < 1) return middle;
    (levels[0] > 0 ? high : low) = middle;
  }
  ADD_FAILURE() << "no depth calls for two levels";
  return low;
}

TEST(SkinBlocks, KeepThePrecisionUnderHardAndLightTouches) {
  const Scene scene = fine_scene();
  FeelingHand exact(scene, 0), sampled(scene, 1e-4);
  ASSERT_GT(sampled.model().patches->block_on_skin[0], 0);
  for (const double depth : {-0.003, -0.002, -0.001, 0.001, 0.003, 0.005}) {
    const DeviceFrame frame = pressed(scene.hand, depth);
    const ActuatorFrame truth = exact(frame), felt = sampled(frame);
    ASSERT_GT(force_size(truth), 0) << depth;
    EXPECT_LT(norm(total_force(felt) - total_force(truth)), 1.5e-4 * force_size(truth)) << depth;
  }
}

TEST(SkinBlocks, AreMixedWithOpenedOnesWithoutAStep) {
  const Scene scene = fine_scene();
  FeelingHand sampled(scene, 1e-4);
  const double depth = mixed_depth(sampled.model());
  constexpr double kStep = 2e-6;
  const auto force_at = [&](int i) {
    return norm(total_force(sampled(pressed(scene.hand, depth + i * kStep))));
  };
  double last = force_at(-100), here = force_at(-99);
  for (int i = -98; i <= 100; ++i) {
    const double next = force_at(i);
    EXPECT_LT(std::abs((next - here) - (here - last)), 4e-6 * here) << i;
    last = here;
    here = next;
  }
}

TEST(SkinBlocks, AreTheSameOnEveryWayToRun) {
  const Scene scene = fine_scene();
  std::vector<Execution> ways(3);
  ways[0].isa = Isa::scalar;
  ways[1].broadphase = Broadphase::brute;
  ways[2].threads = 3;
  const Model plain = model_at(scene, 1e-4);
  const double depth = mixed_depth(plain);
  std::vector<DeviceFrame> frames;
  for (const double deep : {-0.003, depth - 0.001, depth, depth + 0.002})
    frames.push_back(pressed(scene.hand, deep));
  const std::uint64_t hash = hash_run(plain, frames);
  for (const Execution& way : ways) {
    EXPECT_EQ(hash_run(model_at(scene, 1e-4, way), frames), hash)
        << isa_name(way.isa) << " " << broadphase_name(way.broadphase) << " " << way.threads;
  }
}

// They differ by such blocks only: where there are none, a mixture would be the same work twice.
TEST(SkinBlocks, WhereThereAreNoneTheTwoCoarsestLevelsAreOne) {
  const Model model =
      model_at(sampled_scene(default_hand(Side::right), pressed_scene(kWidthA, 9).objects), 1e-4);
  ASSERT_EQ(model.patches->block_on_skin[0], 0);
  LevelsOf levels_of(model);
  for (double depth = -0.001; depth < 0.005; depth += 1e-4)
    EXPECT_EQ(levels_of(pressed_frame(model.hand, depth, 0))[0], 0) << depth;
}

TEST(SkinBlocks, StayWithinABoundOnEffort) {
  Scene scene = fine_scene();
  FeelingHand free(scene, 1e-4);
  const DeviceFrame frame = pressed(scene.hand, mixed_depth(free.model()) - 0.0005);
  const ActuatorFrame unbound = free(frame);
  for (const double share : {1.0, 0.7, 0.3}) {
    scene.settings.effort = static_cast<std::uint32_t>(share * static_cast<double>(unbound.evaluations));
    const ActuatorFrame bound = FeelingHand(scene, 1e-4)(frame);
    EXPECT_EQ((bound.flags & kCoarsened) != 0, share < 1) << share;
    EXPECT_LE(bound.evaluations, scene.settings.effort) << share;
    EXPECT_LE(norm(total_force(bound) - total_force(unbound)), bound.error_estimate) << share;
  }
}

}  // namespace
}  // namespace lumbrical::test
