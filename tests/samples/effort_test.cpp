// A bound on what samples may spend in a tick: kept, told, and the same for every way to search.
#include <gtest/gtest.h>

#include "mesh_world.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/effort.h"
#include "samples/sampled_forces.h"
#include "tick/field_lists.h"

namespace lumbrical::test {
namespace {

Scene draped_scene() { return sampled_scene(default_hand(Side::right), pressed_scene(kWidthA, 69).objects); }

ActuatorFrame felt(Scene scene, std::uint32_t effort, const DeviceFrame& frame,
                   const Execution& execution = {}) {
  scene.settings.effort = effort;
  return FeelingHand(scene, 1e-4, execution)(frame);
}

double difference(const ActuatorFrame& a, const ActuatorFrame& b) {
  return norm(total_force(a) - total_force(b));
}

TEST(Effort, ABoundThatIsNotNearlyReachedChangesNothing) {
  const Scene scene = draped_scene();
  const DeviceFrame frame = pressed_frame(scene.hand, 0.002, 0);
  const ActuatorFrame free = felt(scene, 0, frame);
  ASSERT_GT(free.evaluations, 1000u);
  const ActuatorFrame bound = felt(scene, static_cast<std::uint32_t>(free.evaluations * 3 / 2), frame);
  EXPECT_EQ(hash_fields(free), hash_fields(bound));
  EXPECT_EQ(bound.flags & kCoarsened, 0u);
}

// From a touch of the thumb's root alone, felt by finer lattices, down to one cell a patch.
TEST(Effort, ATighterBoundIsKeptFlaggedAndTellsALargerError) {
  const Scene scene = draped_scene();
  const DeviceFrame frame = pressed_frame(scene.hand, -0.028, 0);
  const ActuatorFrame free = felt(scene, 0, frame);
  const std::uint64_t least = felt(scene, 1, frame).evaluations;
  ActuatorFrame before = free;
  int coarser = 0;
  for (double share = 0.9; share > 0.02; share *= 0.8) {
    const auto effort = static_cast<std::uint32_t>(share * static_cast<double>(free.evaluations));
    const ActuatorFrame bound = felt(scene, effort, frame);
    SCOPED_TRACE(effort);
    EXPECT_NE(bound.flags & kCoarsened, 0u);
    EXPECT_LE(bound.evaluations, std::max<std::uint64_t>(effort, least));
    EXPECT_GE(bound.error_estimate, before.error_estimate);
    EXPECT_LE(difference(bound, free), bound.error_estimate);
    coarser += bound.error_estimate > before.error_estimate ? 1 : 0;
    before = bound;
  }
  EXPECT_GE(coarser, 2);
}

// On a box that a hand is pressed onto; one cell a patch would be off by up to a hundredth.
TEST(Effort, NothingStepsWhereTheBoundIsReached) {
  Scene scene = sampled_scene(default_hand(Side::right), {{"box", make_box({0.06, 0.06, 0.06}, 1)}});
  FeelingHand free(scene, 1e-4);
  scene.settings.effort = 2000;
  FeelingHand bound(scene, 1e-4);
  Vec3 before;
  double largest_step = 0, largest_force = 0;
  for (int i = 0; i < 600; ++i) {
    DeviceFrame frame = pressed_frame(scene.hand, 0, 0);
    const Vec3 tip = posed_joints(scene.hand, frame)[kMiddleTip].position;
    frame.base.position += Vec3{0, 0.02, 0.038 - 2e-5 * i} - tip;
    const Vec3 force = total_force(free(frame)), off = total_force(bound(frame)) - force;
    largest_force = std::max(largest_force, norm(force));
    if (i > 0) largest_step = std::max(largest_step, norm(off - before));
    before = off;
  }
  EXPECT_GT(largest_force, 10);
  EXPECT_LT(largest_step, 5e-4 * largest_force);
}

// Objects that rub are felt each by itself, and all of them together within the bound, but for what each
// takes at least.
TEST(Effort, IsSharedByTheWorldAndObjectsApart) {
  Scene scene = draped_scene();
  const SceneObject drape = scene.objects[0];
  for (int i = 0; i < 3; ++i) {
    scene.objects.push_back(drape);
    scene.objects.back().material = {0.5, 0.5, 0, 1000};
  }
  const DeviceFrame frame = pressed_frame(scene.hand, 0.002, 0);
  const std::uint64_t all = felt(scene, 0, frame).evaluations, least = felt(scene, 1, frame).evaluations;
  ASSERT_LT(least, all * 3 / 4);
  for (const std::uint64_t percent : {90, 60, 30}) {
    const std::uint64_t effort = all * percent / 100;
    const ActuatorFrame bound = felt(scene, static_cast<std::uint32_t>(effort), frame);
    EXPECT_NE(bound.flags & kCoarsened, 0u) << percent;
    EXPECT_LT(bound.evaluations, all) << percent;
    EXPECT_LE(bound.evaluations, std::max(effort, least) + least * 3 / 4) << percent;
  }
}

// Differences of forces would else be those of lattices: the Jacobian's, and the palm's stiffness.
TEST(Effort, BindsNoHandThatIsFeltAsFinelyAsBefore) {
  Scene scene = draped_scene();
  const DeviceFrame frame = pressed_frame(scene.hand, 0.002, 0);
  FeelingHand free(scene, 1e-4);
  free(frame);
  const SampledForces& before = free.scratch().samples->forces;
  scene.settings.effort = 1;
  FeelingHand bound(scene, 1e-4);
  EXPECT_TRUE(bound(frame).flags & kCoarsened);
  SampledForces again;
  ASSERT_TRUE(sample_forces(bound.model(), *bound.scratch().primitives, kAllSegments,
                            *bound.scratch().samples, again, fineness_of(before)));
  EXPECT_EQ(hash_fields(again), hash_fields(before));
}

// They are no coarser for it.
TEST(Effort, OfOneCellAPatchCountsRulesAndBlocksToo) {
  Scene scene = sampled_scene(default_hand(Side::right), pressed_scene(kWidthA, 200).objects);
  scene.settings.effort = 1;
  FeelingHand hand(scene, 1e-4);
  const ActuatorFrame felt = hand(pressed_frame(scene.hand, 0.006, 0));
  EXPECT_NE(felt.flags & kCoarsened, 0u);
  const NearPatches& near = hand.scratch().samples->near;
  std::size_t points = 2 * near.count();
  for (std::size_t k = 0; k < kPatchClasses; ++k)
    points += 14 * near.of_kinds(kind::kInside, kind::kInside + 2, k).size();
  EXPECT_GT(points, 3 * near.count());
  EXPECT_GE(felt.evaluations, points);
}

TEST(Effort, OfOneCellAPatchTellsTheErrorOfThoseThatBodiesShare) {
  Settings settings;
  settings.precision.fill(1e-4);
  const PatchRules rules = patch_rules(default_hand(Side::right), settings);
  NearPatches fist;
  fist.overlaps.together.resize(1);
  std::fill(fist.overlaps.together_begin.begin() + kPatchSizes, fist.overlaps.together_begin.end(), 1u);
  ASSERT_TRUE(fist.has(kPatchSizes - 1));
  EXPECT_GT(one_cell_error_factor(rules, fist, 1), 16 * one_cell_error_factor(rules, NearPatches{}, 1));
}

TEST(Effort, IsDecidedAlikeByBruteForce) {
  const Scene scene = draped_scene();
  Execution brute;
  brute.broadphase = Broadphase::brute;
  for (const double depth : {0.0002, 0.002}) {
    const DeviceFrame frame = pressed_frame(scene.hand, depth, 0);
    for (const std::uint32_t effort : {1000u, 10000u, 30000u, 100000u})
      EXPECT_EQ(hash_fields(felt(scene, effort, frame)), hash_fields(felt(scene, effort, frame, brute)))
          << effort;
  }
}

}  // namespace
}  // namespace lumbrical::test
