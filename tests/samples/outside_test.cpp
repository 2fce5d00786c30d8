// What classification leaves out, because the discs of patches and the boxes of blocks lie outside of a
// body: is it?
#include <gtest/gtest.h>

#include <set>

#include "largest.h"
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

// Of `field`(point of the patch).
template <class Field>
double deepest(const PatchShape& patch, const Field& field) {
  constexpr int kSteps = 12;
  double most = -1;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j)
      most = largest(most, field(point_on(patch, i / double{kSteps}, j / double{kSteps})));
  }
  return most;
}

/// What was left out of how much that a sphere about the patch would not have told apart.
struct LeftOut {
  int near = 0, dropped = 0;
};

template <class Field>
void look_at(const Model& model, const std::set<std::uint32_t>& listed, const Field& field, LeftOut& left) {
  const Patches& patches = *model.patches;
  for (std::uint32_t place = 0; place < patches.shape.size(); ++place) {
    const float radius = patches.block[place / PatchBlock::kWidth].radius[place % PatchBlock::kWidth];
    const PatchShape& patch = patches.shape[place];
    if (radius < 0 || field(point_on(patch, 1.0 / 3, 1.0 / 3)) < -double{radius}) continue;
    ++left.near;
    if (listed.count(place) > 0) continue;
    ++left.dropped;
    EXPECT_LE(deepest(patch, field), 1e-8);
  }
}

// The patches that a body has, by themselves or in blocks that it feels as wholes.
std::set<std::uint32_t> patches_of(const Patches& patches, const NearPatches& near, std::size_t body) {
  std::set<std::uint32_t> places;
  const auto is_its = [&](const ListedPatch& patch) {
    return patch.tile % ListedPatch::kFarEnd / Bodies::kTilesApart == body;
  };
  const auto add_block = [&](std::uint32_t number) {
    std::size_t level = patches.first_samples.size() - 1, count = PatchBlock::kWidth;
    while (number < patches.first_samples[level]) --level;
    for (std::size_t k = 0; k < level; ++k) count *= kBlocksInLarger;
    const std::size_t first = (number - patches.first_samples[level]) * count;
    for (std::size_t k = 0; k < count; ++k) places.insert(static_cast<std::uint32_t>(first + k));
  };
  for (std::uint32_t key = 0; key < kKeyCount; ++key) {
    const std::uint32_t what = key % kind::kCount;
    for (const ListedPatch& patch : near.of_kinds(what, what, key / kind::kCount)) {
      if (!is_its(patch)) continue;
      if (is_block(what)) {
        add_block(patch.place);
      } else {
        places.insert(patch.place);
      }
    }
  }
  return places;
}

TEST(Outside, WhatIsLeftOutMeetsNoTileAndNotThePalm) {
  LeftOut fingers, palms;
  for (const std::uint32_t cells : {8u, 40u, 90u}) {
    const Scene scene =
        sampled_scene(default_hand(Side::right), {{"field", make_height_field(0.3, cells, 0.003, 0.05)}});
    const Model model = model_at(scene, 1e-4);
    Scratch scratch = make_scratch(model);
    SampleMemory memory;
    size_samples(model, memory);
    const Bodies& bodies = memory.bodies;
    Random random(17);
    for (int i = 0; i < 60; ++i) {
      const DeviceFrame frame = dropped_hand(scene.hand, random, -0.1, random.between(0, 1.7), 0.4,
                                             random.between(-0.004, 0.015), 0.03);
      State state;
      tick(model, state, scratch, frame);
      SampledForces forces;
      ASSERT_TRUE(sample_forces(model, *scratch.primitives, kAllSegments, memory, forces));
      for (std::size_t body = 0; body < bodies.finger_count; ++body) {
        const FingerBody& finger = bodies.finger[body];
        look_at(
            model, patches_of(*model.patches, memory.near, body),
            [&](Vec3 p) {
              double most = -1;
              for (std::size_t k = 0; k < finger.tile_count; ++k)
                most = largest(most, field_of(finger.tile[k], p - finger.origin));
              return most;
            },
            fingers);
      }
      if (bodies.palm.corner_count == 0) continue;  // not near
      look_at(
          model, patches_of(*model.patches, memory.near, bodies.finger_count),
          [&](Vec3 p) {
            return double{bodies.palm.radius} - distance_to_palm(p - bodies.palm.origin, bodies.palm);
          },
          palms);
    }
  }
  for (const LeftOut& left : {fingers, palms}) {
    EXPECT_GT(left.dropped, left.near / 10);
    EXPECT_LT(left.dropped, left.near);
  }
}

// It decides how fine lattices are, so it has to be about right, and only for light touches may it tell less.
TEST(Outside, CentroidsTellTheForceNearly) {
  for (const std::uint32_t cells : {9u, 29u, 69u, 200u}) {
    const Scene scene =
        sampled_scene(default_hand(Side::right), {{"field", make_height_field(0.3, cells, 0.002, 0.04)}});
    const Model model = model_at(scene, 1e-4);
    Scratch scratch = make_scratch(model);
    SampleMemory memory;
    size_samples(model, memory);
    Random random(18);
    for (int i = 0; i < 20; ++i) {
      const DeviceFrame frame =
          dropped_hand(scene.hand, random, -0.1, 0.2, 0.1, random.between(0.002, 0.006), 0.03);
      State state;
      tick(model, state, scratch, frame);
      SampledForces forces;
      ASSERT_TRUE(sample_forces(model, *scratch.primitives, kAllSegments, memory, forces));
      double felt = 0;
      for (const Wrench& segment : forces.segment) felt += norm(segment.force);
      const double told = force_at_centroids(memory.bodies, memory.search);
      EXPECT_LE(told, 1.1 * felt + 0.1 * model.patches->rules.radius3);
      if (felt > model.patches->rules.radius3) {
        EXPECT_GE(told, 0.8 * felt);
      }
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
