// Settings that change while a session runs, and memory that is not a model's own.
#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "index/patches.h"
#include "lumbrical/batch.h"
#include "lumbrical/shapes.h"
#include "pads.h"

namespace lumbrical {
namespace {

Scene plates_scene() {
  Scene scene = test::mug_scene(Law::field);
  scene.settings.precision.fill(1e-4);
  SceneObject rubbing;  // felt apart, by a model of its own
  rubbing.name = "plate";
  rubbing.mesh = make_box({0.1, 0.1, 0.01}, 4);
  rubbing.material.static_friction = rubbing.material.kinetic_friction = 0.5;
  rubbing.surface.friction_factor.assign(rubbing.mesh.triangles.size(), 0.7);
  rubbing.pose.position = {0, 0, 0.1};
  scene.objects.push_back(rubbing);
  // Triangles so large that they are cut where they are touched.
  scene.objects.push_back({"floor", make_plane(4000, 1)});
  return scene;
}

std::uint64_t hash_of(const Model& model) {
  return test::hash_run(model, test::grasp_frames(model.hand, 20));
}

TEST(SettingsChange, GivesTheBitsOfAModelThatWasBuiltWithThem) {
  const Scene scene = plates_scene();
  const Model before = test::model_of(scene);
  ASSERT_FALSE(before.patches->large.empty());
  for (int change = 0; change < 5; ++change) {
    Scene other = scene;
    if (change == 0) other.settings.stiffness *= 3;
    if (change == 1) other.settings.precision.fill(1e-3);
    if (change == 2) other.settings.precision.fill(0);
    if (change == 3) other.settings.law.fill(Law::max_depth);
    if (change == 4) other.settings.felt_once = FeltOnce::never;
    Model changed;
    ASSERT_TRUE(change_settings(before, other.settings, 2, changed).ok());
    EXPECT_EQ(changed.triangles.x.data(), before.triangles.x.data()) << "nothing is there twice";
    EXPECT_EQ(changed.patches == before.patches, change == 0 || change == 4)
        << "patches are cut anew where they differ";
    EXPECT_EQ(hash_of(changed), hash_of(test::model_of(other))) << change;
    EXPECT_NE(hash_of(changed), hash_of(before)) << change;
    ASSERT_TRUE(change_settings(changed, scene.settings, 1, changed).ok()) << "in place";
    EXPECT_EQ(hash_of(changed), hash_of(before)) << "and back";
  }
}

TEST(SettingsChange, LetsOutNoForceAboveANewLimitThoughTrackingIsLost) {
  const Scene scene = plates_scene();
  const Model before = test::model_of(scene);
  State state = make_state(before);
  Scratch scratch = make_scratch(before);
  const auto largest_force = [](const ActuatorFrame& output) {
    double most = 0;
    for (const Wrench& wrench : output.segment) most = max(most, norm(wrench.force));
    return most;
  };
  double most = 0;
  for (const DeviceFrame& frame : test::grasp_frames(scene.hand, 60)) {
    most = largest_force(tick(before, state, scratch, frame));
    if (most > 1) break;
  }
  Settings settings = scene.settings;
  settings.max_force = 0.25 * most;
  Model changed;
  ASSERT_TRUE(change_settings(before, settings, 1, changed).ok());
  scratch = make_scratch(changed);
  DeviceFrame lost;
  lost.base.position.x = std::nan("");
  double first = 0;
  for (int i = 0; i < 20; ++i) {
    const double now = largest_force(tick(changed, state, scratch, lost));
    EXPECT_LE(now, 1.00001 * settings.max_force) << i;
    first = i == 0 ? now : first;
  }
  EXPECT_GT(first, 0.5 * settings.max_force);
}

TEST(SettingsChange, TellsWhatIsSolidWhereAHandGetsAProxy) {
  const Scene scene = plates_scene();
  Settings settings = scene.settings;
  settings.proxy_stiffness = 3000;
  Model changed;
  ASSERT_TRUE(change_settings(test::model_of(scene), settings, 1, changed).ok());
  ASSERT_EQ(changed.objects.size(), 2u);
  EXPECT_TRUE(changed.objects[0].solid) << "mug";
  EXPECT_FALSE(changed.objects[1].solid) << "floor";
  EXPECT_TRUE(changed.apart[0].shape->objects[0].solid) << "plate";
}

TEST(SettingsChange, RefusesWhatABuildRefuses) {
  const Model model = test::model_of(plates_scene());
  Model changed = model;
  Settings settings = model.settings;
  settings.stiffness = -1;
  EXPECT_FALSE(change_settings(model, settings, 1, changed).ok());
  EXPECT_FALSE(change_settings(model, model.settings, 0, changed).ok());
  EXPECT_FALSE(change_settings(model, model.settings, 65, changed).ok());
  EXPECT_EQ(changed.build, model.build) << "unchanged";
}

static_assert(!std::is_copy_constructible_v<Scratch> && !std::is_copy_assignable_v<Scratch>);
static_assert(std::is_nothrow_move_constructible_v<Scratch>);

#if !defined(NDEBUG) && !defined(__SANITIZE_THREAD__)
TEST(ScratchDeathTest, ATickRefusesMemoryThatIsNotItsModels) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const Model model = test::model_of(plates_scene()), other = test::model_of(plates_scene());
  State state = make_state(model);
  Scratch empty, foreign = make_scratch(other), own = make_scratch(model);
  EXPECT_DEATH(tick(model, state, empty, {}), "make_scratch");
  EXPECT_DEATH(tick(model, state, foreign, {}), "make_scratch");
  EXPECT_DEATH(make_scratch(Model{}), "build_model");
  EXPECT_DEATH(run_jobs(1, 0, [](std::size_t) {}), "threads");
  const Model copy = model;
  tick(copy, state, own, {});
}
#endif

TEST(SettingsChange, AProxyThatIsTakenAwayIsForgottenAndBeginsAnew) {
  Scene scene = test::pad_scene();
  scene.settings.proxy_stiffness = 3000;
  scene.objects.push_back({"sheet", make_plane(0.1, 4)});
  const auto fingertip_at = [](double height) {
    DeviceFrame frame = test::frame_of({{{0, 0, height}, {0, 0, 1}}});
    frame.joint[kWrist].position = {0, 0, static_cast<float>(height + 0.15)};
    frame.valid |= 1u << kWrist;
    return frame;
  };
  const Model with = test::model_of(scene);
  State state = make_state(with);
  Scratch scratch = make_scratch(with);
  tick(with, state, scratch, fingertip_at(0.02));
  ASSERT_GT(state.proxy->valid, 0);

  Settings settings = scene.settings;
  settings.proxy_stiffness = 0;
  Model without;
  ASSERT_TRUE(change_settings(with, settings, 1, without).ok());
  scratch = make_scratch(without);
  tick(without, state, scratch, fingertip_at(-0.03));
  EXPECT_TRUE(check_state(without, state).ok());

  scratch = make_scratch(with);
  const ActuatorFrame output = tick(with, state, scratch, fingertip_at(-0.03));
  EXPECT_EQ(norm(test::hand_force(output)), 0) << "it was never above the sheet";
}

TEST(SettingsChange, PassesOverIfTheStateKnowsNoHand) {
  const Scene scene = plates_scene();
  const Model soft = test::model_of(scene);
  Settings settings = scene.settings;
  settings.stiffness *= 2;
  Model stiff;
  ASSERT_TRUE(change_settings(soft, settings, 1, stiff).ok());
  State state = make_state(soft);
  Scratch scratch = make_scratch(soft);
  const DeviceFrame frame = test::grasp_frames(scene.hand, 100)[50];
  ActuatorFrame output;
  for (int i = 0; i < 100; ++i) output = tick(soft, state, scratch, frame);
  const Vec3 before = output.segment[8].force;
  ASSERT_GT(norm(before), 0.5);
  state.joints = 0;
  scratch = make_scratch(stiff);
  output = tick(stiff, state, scratch, frame);
  EXPECT_NE(output.flags & kFading, 0u);
  EXPECT_LT(norm(output.segment[8].force - before), 0.06 * norm(before));
  for (int i = 0; i < 100; ++i) output = tick(stiff, state, scratch, frame);
  EXPECT_GT(norm(output.segment[8].force), 1.5 * norm(before));
}

}  // namespace
}  // namespace lumbrical
