// Patches that no skeleton comes near to get coarse lattices: are they really far from every skeleton?
#include <gtest/gtest.h>

#include "lumbrical/shapes.h"
#include "patch_points.h"
#include "sampled_hand.h"
#include "samples/near_skeleton.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

// A skeleton may be near where it comes within so many radii of a patch's centroid (kSkeletonReach of
// classify.h).
constexpr double kSphereReach = 1.25;

double distance_to_tile(Vec3 p, const TileFrame& tile) {
  const Vec3 from = vec3_of(tile.origin);
  return distance_to_segment(p, from, from + double{tile.length} * vec3_of(tile.axis[0]));
}

/// What the search made of patches of lattices, over all poses.
struct Tally {
  int near = 0, far = 0, cleared = 0;  // cleared: of those far, whose spheres say otherwise
};

// In a class without a skeleton a patch is a quarter of its sphere's radius away from any, or kClearOfPlane
// of the body's.
template <class Distance>
void look_at(const Patches& patches, std::uint32_t place, double body_radius, bool is_near,
             const Distance& distance, Tally& tally) {
  if (is_near) {
    ++tally.near;
    return;
  }
  const PatchShape& patch = patches.shape[place];
  const double radius = patches.block[place / PatchBlock::kWidth].radius[place % PatchBlock::kWidth];
  constexpr int kSteps = 16;
  double least = 1;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j)
      least = min(least, distance(point_on(patch, i / double{kSteps}, j / double{kSteps})));
  }
  ++tally.far;
  tally.cleared += distance(point_on(patch, 1.0 / 3, 1.0 / 3)) < kSphereReach * radius;
  EXPECT_GE(least, 0.98 * min((kSphereReach - 1) * radius, double{kClearOfPlane} * body_radius));
}

void look_at(const Patches& patches, const SampleMemory& memory, Tally& tally) {
  const Bodies& bodies = memory.bodies;
  for (std::size_t patch_class = 0; patch_class < kPatchClasses; ++patch_class) {
    const bool is_near = patch_class >= kPatchSizes;
    const auto look = [&](std::uint32_t first, std::uint32_t last, std::size_t sharers) {
      for (const ListedPatch& listed : memory.near.of_kinds(first, last, patch_class)) {
        const std::size_t number = listed.tile % ListedPatch::kFarEnd;
        const FingerBody& finger = bodies.finger[number / Bodies::kTilesApart];
        for (std::size_t k = 0; k < sharers; ++k) {
          const TileFrame& tile = finger.tile[number % Bodies::kTilesApart + k];
          const auto distance = [&](Vec3 p) { return distance_to_tile(p - finger.origin, tile); };
          look_at(patches, listed.place, tile.radius, is_near, distance, tally);
        }
      }
    };
    look(kind::kTile, kind::kFarEnd + 2, 1);
    look(kind::kInnerJoint, kind::kOuterJoint, 2);
    look(kind::kFinger, kind::kFinger, 3);
    const auto to_palm = [&](Vec3 p) { return distance_to_palm(p - bodies.palm.origin, bodies.palm); };
    for (const ListedPatch& listed : memory.near.of_kinds(kind::kPalm, kind::kPalm, patch_class))
      look_at(patches, listed.place, bodies.palm.radius, is_near, to_palm, tally);
  }
}

TEST(NearSkeleton, LatticesAreCoarseOnlyWhereNoSkeletonIsNear) {
  Tally tally;
  for_hands_on_planes(
      31,
      [](const Hand& hand, Random& random) {
        return dropped_hand(hand, random, -0.1, random.between(0, 1.7), 0.4, random.between(0, 0.012), 0.03);
      },
      [&](const Patches& patches, const SampleMemory& memory) { look_at(patches, memory, tally); });
  EXPECT_GT(tally.near, 1000);
  EXPECT_GT(tally.far, 10000);
  EXPECT_GT(tally.cleared, 100) << "large patches under lying fingers";
}

}  // namespace
}  // namespace lumbrical::test
