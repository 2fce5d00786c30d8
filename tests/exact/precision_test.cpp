// Every instruction set gives the same bits, exactly and by samples.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "session.h"

namespace lumbrical::test {
namespace {

Scene hand_of_cones() { return mug_scene(Law::field); }
Scene hand_of_capsules() {
  Scene scene = mug_scene(Law::field);
  scene.hand.radius.fill(0.008);
  return scene;
}

std::uint64_t bits_of_run(const Scene& scene, Isa isa, const std::vector<DeviceFrame>& frames) {
  Execution execution;
  execution.isa = isa;
  return hash_run(model_of(scene, execution), frames);
}

TEST(Precision, EveryInstructionSetGivesTheSameBits) {
  for (const double precision : {0.0, 1e-4}) {
    for (Scene scene : {hand_of_cones(), hand_of_capsules()}) {
      scene.settings.precision.fill(precision);
      const auto frames = grasp_frames(scene.hand, 30);
      const std::uint64_t expected = bits_of_run(scene, Isa::scalar, frames);
      for (const Isa isa : {Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
        if (!available(isa)) continue;
        EXPECT_EQ(bits_of_run(scene, isa, frames), expected) << isa_name(isa) << ", precision " << precision;
      }
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
