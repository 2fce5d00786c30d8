// Memory that runs out while a model is built: an error that is told, and a model that stays as it was.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>

#include "lumbrical/model.h"
#include "own_allocator.h"
#include "session.h"

namespace lumbrical::test {
namespace {

std::atomic<std::int64_t> before_failure{0};

// Lets one allocation after another fail; how many there are.
std::int64_t fail_each(const std::function<Status(Model&)>& build) {
  for (std::int64_t number = 0;; ++number) {
    Model model;
    before_failure = number;
    may_allocate = [] { return before_failure-- != 0; };
    const Status status = build(model);
    may_allocate = nullptr;
    if (before_failure >= 0) return number;  // there were no more
    EXPECT_NE(status.message().find("not enough memory"), std::string::npos) << number;
    EXPECT_EQ(model.build, 0u) << number;
  }
}

TEST(ModelMemory, ThatRunsOutIsAnErrorThatIsTold) {
  Scene scene = mug_scene(Law::field);
  scene.settings.precision.fill(1e-4);
  EXPECT_GT(fail_each([&](Model& model) { return build_model(scene, {}, model); }), 50);
  const Model whole = model_of(scene);
  EXPECT_GT(fail_each([&](Model& model) { return share_world(whole, scene.hand, model); }), 0);
  Settings finer = scene.settings;
  finer.precision.fill(1e-5);
  EXPECT_GT(fail_each([&](Model& model) { return change_settings(whole, finer, 1, model); }), 5);
}

}  // namespace
}  // namespace lumbrical::test
