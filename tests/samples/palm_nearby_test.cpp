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
  std::size_t found = 0, asked = 0, all = 0;
  const auto look_at = [&](const PatchShape& shape, const PalmBody& palm) {
    const PatchInFrame<float> patch = in_frame_of(palm, shape);
    const PalmNearby<float> nearby(palm, patch);
    ++found;
    asked += nearby.count;
    all += palm.corner_count;
    for (int j = 0; j <= kSteps; ++j) {
      for (int k = 0; j + k <= kSteps; ++k) {
        const auto p = patch.at(static_cast<float>(j) / kSteps, static_cast<float>(k) / kSteps);
        ASSERT_EQ(nearby.field(p), scalar::palm_field(palm, p));
      }
    }
  };
  for_hands_on_planes(
      37,
      [](const Hand& hand, Random& random) {
        return dropped_hand(hand, random, -0.3, 0.1, 0.4, random.between(0.005, 0.03), 0.03);
      },
      [&](const Patches& patches, const SampleMemory& memory) {
        for (std::size_t patch_class = 0; patch_class < kPatchClasses; ++patch_class) {
          for (const ListedPatch& at : memory.near.of_kinds(kind::kPalm, kind::kPalm, patch_class))
            look_at(patches.shape[at.place], memory.bodies.palm);
        }
      });
  EXPECT_GT(found, 5000u);
  EXPECT_LT(10 * asked, 6 * all);
}

}  // namespace
}  // namespace lumbrical::test
