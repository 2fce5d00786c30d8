// The ladder of precision: the tick stays within the bound it states, and every instruction set gives the
// same bits on every rung.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "session.h"

namespace lumbrical::test {
namespace {

// A hand of capsules, so that both ways of integrating are used (the palm's fingers keep their radii).
Scene hand_of_capsules(double tolerance) {
  Scene scene = mug_scene(Law::field);
  for (double& radius : scene.hand.radius) radius = 0.008;
  scene.settings.tolerance = tolerance;
  return scene;
}

std::uint64_t bits_of_run(const Scene& scene, Isa isa, const std::vector<DeviceFrame>& frames) {
  Execution execution;
  execution.isa = isa;
  return hash_run(model_of(scene, execution), frames);
}

TEST(Precision, EveryInstructionSetGivesTheSameBits) {
  for (const double tolerance : {0.0, 1e-4}) {
    for (const Scene& scene : {mug_scene(Law::field), hand_of_capsules(tolerance)}) {
      const auto frames = grasp_frames(scene.hand, 30);
      const std::uint64_t expected = bits_of_run(scene, Isa::scalar, frames);
      for (const Isa isa : {Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
        if (!available(isa)) continue;
        EXPECT_EQ(bits_of_run(scene, isa, frames), expected) << isa_name(isa) << ", tolerance " << tolerance;
      }
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
