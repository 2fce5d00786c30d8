// Patches beside the palm ask those of its edges only that may be the nearest.
#define LUMBRICAL_ISA scalar
#include "samples/palm_kernels.h"

#include <gtest/gtest.h>

#include "lumbrical/shapes.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

using scalar::PalmNearby;
using scalar::PatchInFrame;

PatchInFrame<float> in_frame_of(const PalmBody& palm, const PatchShape& patch) {
  const auto turned = [&](Vec3 v) {
    return scalar::Wide3<float>{static_cast<float>(dot(vec3_of(palm.axis[0]), v)),
                                static_cast<float>(dot(vec3_of(palm.axis[1]), v)),
                                static_cast<float>(dot(vec3_of(palm.axis[2]), v))};
  };
  const Vec3 corner = vec3_of(patch.corner.high) + vec3_of(patch.corner.low);
  return {turned(corner - palm.origin), turned(vec3_of(patch.edge[0])), turned(vec3_of(patch.edge[1]))};
}

TEST(PalmNearby, FeelsWhatTheWholePalmFeels) {
  constexpr int kSteps = 6;
  int found = 0, asked = 0, all = 0;
  for (const int cells : {3, 12, 60}) {
    const Scene scene = sampled_scene(default_hand(Side::right),
                                      {{"field", make_plane(0.3, static_cast<std::uint32_t>(cells), 1, 3)}});
    const Model model = model_at(scene, 1e-4);
    Scratch scratch = make_scratch(model);
    Random random(37);
    for (int i = 0; i < 200; ++i) {
      const DeviceFrame frame =
          dropped_hand(scene.hand, random, -0.3, 0.1, 0.4, random.between(0.005, 0.03), 0.03);
      State state;
      tick(model, state, scratch, frame);
      const SampleMemory& memory = *scratch.samples;
      const PalmBody& palm = memory.bodies.palm;
      for (std::size_t patch_class = 0; patch_class < kPatchClasses; ++patch_class) {
        for (const ListedPatch& at : memory.near.of_kinds(kind::kPalm, kind::kPalm, patch_class)) {
          const PatchInFrame<float> patch = in_frame_of(palm, model.patches->shape[at.place]);
          const PalmNearby<float> nearby(palm, patch);
          ++found;
          asked += static_cast<int>(nearby.count);
          all += static_cast<int>(palm.corner_count);
          for (int j = 0; j <= kSteps; ++j) {
            for (int k = 0; j + k <= kSteps; ++k) {
              const auto p = patch.at(static_cast<float>(j) / kSteps, static_cast<float>(k) / kSteps);
              ASSERT_EQ(nearby.field(p), scalar::palm_field(palm, p));
            }
          }
        }
      }
    }
  }
  EXPECT_GT(found, 5000);
  EXPECT_LT(asked, 0.6 * all);
}

}  // namespace
}  // namespace lumbrical::test
