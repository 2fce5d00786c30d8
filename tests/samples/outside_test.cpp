// Patches that finer lattices don't see, because the coarsest ones have found them out of reach: are they?
#include <gtest/gtest.h>

#include <set>

#include "lumbrical/shapes.h"
#include "patch_points.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

// phi at a point seen from the body's origin: of the sphere on the axis whose skin is farthest out there.
double field_of(const TileFrame& tile, Vec3 p) {
  const Vec3 from = p - vec3_of(tile.origin);
  const double along = dot(from, vec3_of(tile.axis[0])), square = max(dot(from, from) - along * along, 0),
               aside = std::sqrt(square);
  const double foot = clamp(along - aside * tile.sine / tile.cosine, 0, tile.length);
  const double radius =
      tile.length > 0 ? tile.radius + (tile.end_radius - tile.radius) * foot / tile.length : tile.radius;
  return radius - std::sqrt(square + (along - foot) * (along - foot));
}

double deepest(const PatchShape& patch, Vec3 origin, const TileFrame& tile) {
  constexpr int kSteps = 12;
  double most = -1;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      most = max(most, field_of(tile, point_on(patch, i / double{kSteps}, j / double{kSteps}) - origin));
    }
  }
  return most;
}

// Calls take(patch, tiles it is shared by) for all patches of lattices near fingers.
template <class Take>
void for_lattices(const NearPatches& near, const Take& take) {
  for (std::size_t patch_class = 0; patch_class < kPatchClasses; ++patch_class) {
    for (std::uint32_t k = 0; k <= kind::kFinger; ++k) {
      if (k >= kind::kInside && k < kind::kInnerJoint) continue;
      for (const ListedPatch& listed : near.of_kinds(k, k, patch_class)) take(listed, sharers_of(k));
    }
  }
}

TEST(Outside, PatchesThatFinerLatticesDoNotSeeMeetNoTile) {
  int seen = 0, dropped = 0;
  for (const std::uint32_t cells : {8u, 40u}) {
    const Scene scene = sampled_scene(default_hand(Side::right), {{"field", make_plane(0.3, cells, 1, 3)}});
    const Model model = model_at(scene, 1e-4);
    Scratch scratch = make_scratch(model);
    SampleMemory memory;
    size_samples(model, memory);
    Random random(17);
    for (int i = 0; i < 100; ++i) {
      const DeviceFrame frame = dropped_hand(scene.hand, random, -0.1, random.between(0, 1.7), 0.4,
                                             random.between(-0.004, 0.002), 0.03);
      State state;
      tick(model, state, scratch, frame);
      const Primitives& hand = *scratch.primitives;
      SampledForces forces;
      const LevelWeights finest = {0, 0, 1};
      ASSERT_TRUE(sample_forces(model, hand, kAllSegments, memory, forces, &finest));
      std::set<std::pair<std::uint32_t, std::uint32_t>> kept;
      for_lattices(memory.near, [&](const ListedPatch& patch, std::uint32_t) {
        kept.insert({patch.place, patch.tile});
      });
      ASSERT_TRUE(find_patches(model, hand, memory.bodies, memory.search, memory.near));
      for_lattices(memory.near, [&](const ListedPatch& patch, std::uint32_t sharers) {
        ++seen;
        if (kept.count({patch.place, patch.tile}) > 0) return;
        ++dropped;
        const std::uint32_t number = patch.tile % ListedPatch::kFarEnd;
        const FingerBody& finger = memory.bodies.finger[number / Bodies::kTilesApart];
        for (std::uint32_t k = 0; k < sharers; ++k) {
          const TileFrame& tile = finger.tile[number % Bodies::kTilesApart + k];
          EXPECT_LE(deepest(model.patches->shape[patch.place], finger.origin, tile), 1e-8);
        }
      });
    }
  }
  EXPECT_GT(dropped, seen / 10);
  EXPECT_LT(dropped, seen);
}

}  // namespace
}  // namespace lumbrical::test
