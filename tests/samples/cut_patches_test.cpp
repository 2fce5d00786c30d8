// Triangles too large to be cut with their model: felt as if they had been, whatever was cut before.
#include "samples/cut_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "index/patch_cuts.h"
#include "lumbrical/shapes.h"
#include "model/primitive.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

// Side by side along y, each of two triangles.
Mesh make_strips(double length, double width, std::uint32_t count) {
  Mesh mesh;
  for (std::uint32_t i = 0; i <= count; ++i) {
    const double x = width * (i - 0.5 * count);
    for (const double y : {-0.47 * length, 0.53 * length}) mesh.vertices.push_back({x, y, 0});
  }
  for (std::uint32_t i = 0; i < 2 * count; i += 2) {
    mesh.triangles.push_back({i, i + 2, i + 3});
    mesh.triangles.push_back({i, i + 3, i + 1});
  }
  return mesh;
}

Scene floor_scene(const Mesh& floor, FeltOnce once = FeltOnce::by_samples) {
  Scene scene = sampled_scene(default_hand(Side::right),
                              {{"floor", floor}, {"field", make_height_field(0.3, 40, 0.003, 0.05)}});
  scene.settings.felt_once = once;
  return scene;
}

DeviceFrame moved(DeviceFrame frame, Vec3 by) {
  frame.base.position = frame.base.position + by;
  return frame;
}

using Numbers = std::array<float, 12>;
Numbers numbers_of(const PatchShape& shape) {
  Numbers numbers;
  std::copy_n(shape.corner.high, numbers.size(), numbers.begin());
  return numbers;
}

// All patches of some triangles whose centroids a hand's phalanges hold.
std::vector<Numbers> patches_within(const Model& model, const Primitives& hand) {
  const double step = model.patches->rules.step;
  std::vector<Numbers> within;
  for (const std::uint32_t triangle : model.patches->large) {
    const Corners at = corners_of(model.triangles, triangle);
    std::vector<PatchPath> paths;
    cut_triangle(at, step, paths);
    for (const PatchPath& path : paths) {
      const Corners patch = part_at(at, step, path);
      const Vec3 middle = (patch.a + patch.b + patch.c) / 3.0;
      const auto holds = [&](const Primitive& capsule) {
        const Vec3 axis = capsule.end2 - capsule.end1;
        const double t = clamp(dot(middle - capsule.end1, axis) / dot(axis, axis), 0, 1);
        return norm(middle - capsule.end1 - t * axis) < min(capsule.radius1, capsule.radius2);
      };
      if (std::none_of(hand.capsule.begin(), hand.capsule.end(), holds)) continue;
      PatchBlock block;
      std::array<PatchShape, PatchBlock::kWidth> shapes;
      put_block({&patch, 1}, step, {}, block, shapes.data());
      within.push_back(numbers_of(shapes[0]));
    }
  }
  return within;
}

TEST(CutPatches, AreThoseThatTheTriangleWouldHaveBeenCutIntoWithTheModel) {
  for (const Mesh& mesh : {make_plane(6, 1), make_strips(30, 0.004, 60)}) {
    const Scene scene = sampled_scene(default_hand(Side::right), {{"floor", mesh}});
    FeelingHand samples(scene, 1e-4);
    samples(pressed_frame(scene.hand, 0.003, 0.3));
    const Patches& patches = *samples.model().patches;
    ASSERT_FALSE(patches.large.empty());
    const CutPatches& cuts = samples.scratch().samples->search.cuts;
    std::vector<Numbers> cut;
    for (const std::uint32_t block : cuts.near) {
      for (std::size_t lane = 0; lane < PatchBlock::kWidth; ++lane) {
        if (cuts.block[block].radius[lane] >= 0)
          cut.push_back(numbers_of(cuts.shape[block * PatchBlock::kWidth + lane]));
      }
    }
    std::sort(cut.begin(), cut.end());
    EXPECT_EQ(std::adjacent_find(cut.begin(), cut.end()), cut.end()) << "twice";
    std::vector<Numbers> within = patches_within(samples.model(), *samples.scratch().primitives);
    std::sort(within.begin(), within.end());
    EXPECT_GT(within.size(), 50u);
    EXPECT_TRUE(std::includes(cut.begin(), cut.end(), within.begin(), within.end()));
  }
}

// All of them are the same floor as far as a hand can tell. It is felt once too.
TEST(CutPatches, AreFeltToTheirPrecision) {
  const Mesh meshes[] = {make_plane(10, 1), make_plane(3000, 1), make_plane(12, 20),
                         make_strips(300, 0.004, 100)};
  FeelingHand exact(floor_scene(make_plane(1, 1), FeltOnce::always), 0);
  std::vector<FeelingHand> samples;
  for (const Mesh& mesh : meshes) {
    samples.emplace_back(floor_scene(mesh), 1e-4);
    ASSERT_FALSE(samples.back().model().patches->large.empty());
  }
  for (int i = 0; i < 4; ++i) {
    const DeviceFrame frame = pressed_frame(exact.model().hand, 0.0005 + 1e-3 * i, 0.2 * i);
    const ActuatorFrame right = exact(frame);
    ASSERT_GT(force_size(right), 0.1);
    for (FeelingHand& floor : samples)
      EXPECT_LT(norm(total_force(floor(frame)) - total_force(right)), 1e-4 * force_size(right)) << i;
  }
}

TEST(CutPatches, GiveTheSameWhateverWasCutBefore) {
  const Scene scene = floor_scene(make_plane(10, 1));
  FeelingHand used(scene, 1e-4), fresh(scene, 1e-4);
  Random random(3);
  for (int i = 0; i < 120; ++i) {
    const double reach = i % 40 < 30 ? 0.002 : 4;  // [m] of the way from one to the next
    const DeviceFrame frame =
        moved(pressed_frame(scene.hand, 0.003, 0.01 * i),
              {reach * random.between(-1, 1), reach * random.between(-1, 1), i % 10 == 9 ? 0.1 : 0});
    const ActuatorFrame felt = used(frame);
    fresh.forget();
    const ActuatorFrame anew = fresh(frame);
    EXPECT_EQ(force_size(felt) > 0, i % 10 != 9) << i;
    for (std::size_t k = 0; k < kSegmentCount; ++k) {
      EXPECT_EQ(felt.segment[k].force, anew.segment[k].force) << i;
      EXPECT_EQ(felt.segment[k].torque, anew.segment[k].torque) << i;
    }
  }
  EXPECT_GT(used.scratch().samples->search.cuts.count, fresh.scratch().samples->search.cuts.count);
}

// Objects apart take turns in one Scratch.
TEST(CutPatches, AreKeptWhereOtherObjectsHaveNone) {
  Scene scene =
      sampled_scene(default_hand(Side::right), {{"floor", make_plane(10, 1)}, {"plate", make_plane(0.1, 4)}});
  for (SceneObject& object : scene.objects)
    object.material.static_friction = object.material.kinetic_friction = 0.5;
  const Model model = model_at(scene, 1e-4);
  ASSERT_EQ(model.apart.size(), 2u);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  const auto place = [&](double x) {
    tick(model, state, scratch, moved(pressed_frame(scene.hand, 0.003, 0.2), {x, 0, 0}));
    const CutPatches& cuts = scratch.apart->samples->search.cuts;
    EXPECT_EQ(cuts.build, model.apart[0].shape->build);
    return cuts.about.phalanx[0].end1.x;
  };
  const double first = place(0);
  EXPECT_EQ(place(0.003), first);
  EXPECT_NE(place(0.02), first);
}

void expect_felt_as_a_floor(const Mesh& large) {
  FeelingHand samples(floor_scene(large), 1e-4), small(floor_scene(make_plane(1, 1)), 1e-4);
  for (const double depth : {0.001, 0.004}) {
    const DeviceFrame frame = pressed_frame(samples.model().hand, depth, 0.2);
    for (int turn = 0; turn < 2; ++turn) {
      const ActuatorFrame felt = samples(frame), right = small(frame);
      EXPECT_LT(norm(total_force(felt) - total_force(right)), 2e-4 * force_size(right));
    }
  }
}

// Cells whose way down has more halves than are counted are cut anew each time.
TEST(CutPatches, OfTrianglesAsLargeAsThereMayBeAreFelt) {
  expect_felt_as_a_floor(make_strips(1.8e8, 1.8e8, 1));
}

// How many patches each would come to is not found out by cutting it: that would take minutes.
TEST(CutPatches, OfAThousandLanesOfAHundredKilometresAreFelt) {
  expect_felt_as_a_floor(make_strips(1e5, 1, 1000));
}

TEST(CutPatches, WithTooLittleRoomAreNotFeltAndSaySo) {
  Scene scene = floor_scene(make_plane(10, 1));
  scene.settings.max_candidates = 400;
  FeelingHand samples(scene, 1e-4);
  for (int turn = 0; turn < 2; ++turn) {
    const ActuatorFrame felt = samples(pressed_frame(scene.hand, 0.003, 0.2));
    EXPECT_NE(felt.flags & kCandidateOverflow, 0u);
    EXPECT_EQ(force_size(felt), 0);
    EXPECT_EQ(samples(moved(pressed_frame(scene.hand, 0.003, 0.2), {0, 0, 0.1})).flags & kCandidateOverflow,
              0u);
  }
}

// Where a hand lies flat those of the way it may go are too many, but not where its fingertips alone are on
// the floor.
TEST(CutPatches, AreCutAheadAgainOnceThereIsRoom) {
  Model model = model_at(floor_scene(make_plane(10, 1)), 1e-4);
  const DeviceFrame on_floor = pressed_frame(model.hand, 0.003, 0.2);
  Scratch scratch;
  const auto spare_at = [&](Vec3 by) {
    State state;
    const ActuatorFrame felt = tick(model, state, scratch, moved(on_floor, by));
    return (felt.flags & kCandidateOverflow) != 0 ? -1 : scratch.samples->search.cuts.spare;
  };
  double spare = -1;
  for (model.settings.max_candidates = 400; spare < 0; model.settings.max_candidates += 40) {
    scratch = make_scratch(model);
    spare = spare_at({});
    if (spare == 0) break;
  }
  ASSERT_EQ(spare, 0);
  EXPECT_EQ(spare_at({0.0001, 0, 0}), 0);
  spare_at({0, -5.06, 0});
  EXPECT_GT(spare_at({0, -5.061, 0}), 0);
  EXPECT_EQ(spare_at({}), 0);
}

// That decides which patches are a block, and in which order the force is summed that levels go by.
TEST(CutPatches, AreLookedForInTheSameTreeWhateverLeavesAreAskedFor) {
  const Scene scene = floor_scene(make_strips(30, 0.004, 60));
  const Model plain = model_at(scene, 1e-4);
  Execution execution;
  execution.leaf_size = 3;
  execution.tree_levels = 1;
  const SphereTree &tree = plain.patches->large_tree,
                   other = model_at(scene, 1e-4, execution).patches->large_tree;
  ASSERT_GT(tree.head.leaf_count, 1u);
  EXPECT_EQ(other.head.leaf_count, tree.head.leaf_count);
  EXPECT_EQ(other.head.blocks_per_leaf, tree.head.blocks_per_leaf);
  EXPECT_EQ(other.head.level_count, tree.head.level_count);
}

// What has been cut gives way to what is near.
TEST(CutPatches, AreForgottenWhereThereIsNoRoomForMore) {
  const Scene scene = floor_scene(make_plane(10, 1));
  FeelingHand samples(scene, 1e-4);
  std::uint32_t most = 0, last = 0;
  bool forgot = false;
  for (int i = 0; i < 300; ++i) {
    const double x = 4.0 * (i % 17) / 17 - 2, y = 4.0 * (i / 17) / 17 - 2;
    const ActuatorFrame felt = samples(moved(pressed_frame(scene.hand, 0.003, 0.2), {x, y, 0}));
    EXPECT_GT(force_size(felt), 0.1);
    EXPECT_EQ(felt.flags & kCandidateOverflow, 0u);
    const std::uint32_t count = samples.scratch().samples->search.cuts.count;
    forgot = forgot || count < last;
    most = std::max(most, count);
    last = count;
  }
  EXPECT_TRUE(forgot);
  EXPECT_LE(most, scene.settings.max_candidates / 16);
}

}  // namespace
}  // namespace lumbrical::test
