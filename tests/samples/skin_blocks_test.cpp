// On very fine meshes a hand that presses hard takes small blocks as ones where its skin goes through them,
// and one that presses less opens them: by how much is a force off, does it step, and is it the same on every
// way?
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "base/parallel.h"
#include "index/sphere_tree.h"
#include "lumbrical/shapes.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

constexpr double kWidth = 0.2;

// Triangles of 0.3 mm.
Scene fine_scene() {
  Scene scene =
      sampled_scene(default_hand(Side::right), {{"field", make_height_field(kWidth, 640, 0.002, 0.04)}});
  scene.settings.max_candidates = 1u << 20;
  return scene;
}

// At a coarse precision blocks of blocks are taken as ones too: triangles of 0.28 mm.
constexpr double kCoarse = 1e-3;
Scene finer_scene() {
  Scene scene =
      sampled_scene(default_hand(Side::right), {{"field", make_height_field(kWidth, 700, 0.002, 0.04)}});
  scene.settings.max_candidates = 1u << 20;
  return scene;
}

// As fine, under a part of the hand.
Scene small_scene() {
  Scene scene =
      sampled_scene(default_hand(Side::right), {{"field", make_height_field(0.08, 200, 0.002, 0.04)}});
  scene.settings.max_candidates = 1u << 18;
  return scene;
}

DeviceFrame pressed(const Hand& hand, double depth) {
  DeviceFrame frame = pressed_frame(hand, depth, 0.3);
  frame.base.position.y -= 0.01;
  return frame;
}

/// Tells the levels of a frame, by the passes that a tick goes through.
class LevelsOf {
 public:
  explicit LevelsOf(const Model& model) : model_(model), scratch_(make_scratch(model)) {
    size_samples(model, memory_);
  }
  LevelWeights operator()(const DeviceFrame& frame) {
    State state;
    tick(model_, state, scratch_, frame);
    SampledForces forces;
    EXPECT_TRUE(sample_forces(model_, *scratch_.primitives, kAllSegments, memory_, forces));
    return forces.fineness.level;
  }
  /// Blocks of blocks that the last frame took as ones on the skin.
  [[nodiscard]] std::size_t large_blocks() const {
    std::size_t count = 0;
    for (const auto& [first, last] : {std::pair{kind::kBlockInside, kind::kBlockInside + 2},
                                      std::pair{kind::kPalmBlock, kind::kPalmBlockBeside}}) {
      for (const ListedPatch& block : memory_.near.of_kinds(first, last, 1))
        count += block.place >= model_.patches->first_samples[1];
    }
    return count;
  }

 private:
  const Model& model_;
  Scratch scratch_;
  SampleMemory memory_;
};

// A depth at which a level and the next finer one are mixed.
double mixed_depth(const Model& model, std::size_t coarser = 0) {
  LevelsOf levels_of(model);
  double low = -0.04, high = 0.008;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    const LevelWeights levels = levels_of(pressed(model.hand, middle));
    double coarse = 0;
    for (std::size_t k = 0; k <= coarser; ++k) coarse += levels[k];
    if (coarse > 0 && coarse < 1) return middle;
    (coarse > 0 ? high : low) = middle;
  }
  ADD_FAILURE() << "no depth calls for two levels";
  return low;
}

TEST(SkinBlocks, KeepThePrecisionUnderHardAndLightTouches) {
  const Scene scene = fine_scene();
  FeelingHand exact(scene, 0), sampled(scene, 1e-4);
  ASSERT_GT(sampled.model().patches->rules.block_on_skin[0], 0);
  for (const double depth : {-0.003, -0.002, -0.001, 0.001, 0.003, 0.005}) {
    const DeviceFrame frame = pressed(scene.hand, depth);
    const ActuatorFrame truth = exact(frame), felt = sampled(frame);
    ASSERT_GT(force_size(truth), 0) << depth;
    EXPECT_LT(norm(total_force(felt) - total_force(truth)), 1.5e-4 * force_size(truth)) << depth;
  }
}

TEST(SkinBlocks, OfBlocksKeepThePrecisionToo) {
  const Scene scene = finer_scene();
  FeelingHand exact(scene, 0), sampled(scene, kCoarse);
  LevelsOf levels_of(sampled.model());
  int coarsest = 0;  // frames that are felt by the coarsest level alone
  for (const double depth : {-0.002, 0.001, 0.003}) {
    const DeviceFrame frame = pressed(scene.hand, depth);
    const ActuatorFrame truth = exact(frame), felt = sampled(frame);
    EXPECT_LT(norm(total_force(felt) - total_force(truth)), kCoarse * force_size(truth)) << depth;
    if (levels_of(frame)[0] != 1) continue;
    ++coarsest;
    EXPECT_GT(levels_of.large_blocks(), 100u) << depth;
  }
  EXPECT_GT(coarsest, 0);
}

// At which block after block is opened.
constexpr std::size_t kMixedLevels[] = {0, 1, 2};

void expect_no_step(const Scene& scene, double precision, double most) {
  FeelingHand sampled(scene, precision);
  for (const std::size_t level : kMixedLevels) {
    const double depth = mixed_depth(sampled.model(), level);
    constexpr double kStep = 2e-6;
    const auto force_at = [&](int i) {
      return norm(total_force(sampled(pressed(scene.hand, depth + i * kStep))));
    };
    double last = force_at(-60), here = force_at(-59);
    for (int i = -58; i <= 60; ++i) {
      const double next = force_at(i);
      EXPECT_LT(std::abs((next - here) - (here - last)), most * here) << level << " " << i;
      last = here;
      here = next;
    }
  }
}
TEST(SkinBlocks, AreMixedWithOpenedOnesWithoutAStep) {
  expect_no_step(fine_scene(), 1e-4, 4e-6);
  expect_no_step(finer_scene(), kCoarse, 4e-5);
}

Execution on(Isa isa) {
  Execution execution;
  execution.isa = isa;
  return execution;
}
Execution by(Broadphase broadphase, std::uint32_t threads) {
  Execution execution;
  execution.broadphase = broadphase;
  execution.threads = threads;
  return execution;
}

void expect_the_same(const Scene& scene, double precision, const std::vector<Execution>& ways) {
  const Model plain = model_at(scene, precision);
  std::vector<DeviceFrame> frames{pressed(scene.hand, 0.004)};
  for (const std::size_t level : kMixedLevels) {
    const double depth = mixed_depth(plain, level);
    for (const double deep : {depth - 0.0005, depth}) frames.push_back(pressed(scene.hand, deep));
  }
  const std::uint64_t hash = hash_run(plain, frames);
  for (const Execution& way : ways) {
    EXPECT_EQ(hash_run(model_at(scene, precision, way), frames), hash)
        << isa_name(way.isa) << " " << broadphase_name(way.broadphase) << " " << way.threads;
  }
}
TEST(SkinBlocks, AreTheSameOnEveryWayToRun) {
  expect_the_same(fine_scene(), 1e-4, {on(Isa::scalar), by(Broadphase::brute, 1), by(Broadphase::tree, 3)});
  expect_the_same(finer_scene(), kCoarse, {by(Broadphase::brute, 3)});
}

TEST(SkinBlocks, AreTheSameWhateverTreeIsAskedFor) {
  const Scene scene = small_scene();
  Execution flat;
  flat.tree_levels = 1;
  const std::vector<DeviceFrame> frames{pressed(scene.hand, 0.001), pressed(scene.hand, 0.004)};
  EXPECT_EQ(hash_run(model_at(scene, kCoarse, flat), frames), hash_run(model_at(scene, kCoarse), frames));
}

// What becomes of every block of a level that a finger is asked about: nothing, opened or taken as one.
enum class Fate : std::uint8_t { nothing, opened, taken };
std::vector<Fate> fates_of(const Model& model, std::size_t level, const OtherParts& others,
                           const std::vector<std::vector<std::uint32_t>>& rows) {
  const FingerBody& finger = others.bodies.finger[others.body];
  const auto blocks = samples_of_level(*model.patches, level);
  std::vector<Fate> fates(blocks.size());
  for (const std::vector<std::uint32_t>& row : rows) {
    std::array<std::uint32_t, PatchBlock::kWidth> found;
    std::transform(row.begin(), row.end(), found.begin(),
                   [&](std::uint32_t block) { return found_at(block, finger.tiles()); });
    std::array<FoundPatches, PatchBlock::kWidth> taken;
    CentroidForce force;
    const auto sorted =
        sample_kernels(model.execution.isa)
            .sort_blocks({blocks.data(), 0}, others, found.data(), row.size(), {taken.data(), force});
    for (std::size_t i = 0; i < sorted.open_count; ++i) fates[place_of(found[i])] = Fate::opened;
    for (std::size_t i = 0; i < sorted.whole_count; ++i) fates[taken[i].block] = Fate::taken;
  }
  return fates;
}

// Fingers side by side, so deep that their skins meet the field where they are nearest to each other: rivals
// of one tile must not open the blocks of another.
TEST(SkinBlocks, AreTakenAlikeWhateverIsBesideThem) {
  Scene scene = small_scene();
  scene.settings.felt_once = FeltOnce::by_samples;
  const Model model = model_at(scene, kCoarse);
  constexpr std::size_t kLevel = 1;
  const auto count = static_cast<std::uint32_t>(samples_of_level(*model.patches, kLevel).size());
  std::vector<std::vector<std::uint32_t>> alone(count), rows(piece_count(count, PatchBlock::kWidth));
  for (std::uint32_t block = 0; block < count; ++block) {
    alone[block] = {block};
    rows[block % rows.size()].push_back(block);  // from everywhere
  }
  Scratch scratch = make_scratch(model);
  for (int i = 0; i < 24; ++i) {
    const double spread = -0.1 + 0.01 * (i / 2);
    DeviceFrame frame = pressed(scene.hand, i % 2 == 0 ? 0.005 : 0.008);
    frame.base.position.y -= 0.03;
    for (std::size_t finger = 1; finger < kFingerCount; ++finger)
      frame.angle[4 * finger] = static_cast<float>(spread * (static_cast<double>(finger) - 2));
    State state;
    tick(model, state, scratch, frame);
    const Primitives& hand = *scratch.primitives;
    Bodies bodies;
    set_bodies(hand, kAllSegments, kAllSegments, model.patches->rules, bodies);
    take_blocks_on_skin(model.patches->rules.block_on_skin[0], bodies);
    Rivals rivals(hand, bodies);
    for (std::size_t body = 0; body < bodies.finger_count; ++body) {
      const OtherParts others{bodies, body, offsets_from(bodies.finger[body].origin, bodies), &rivals};
      EXPECT_TRUE(fates_of(model, kLevel, others, rows) == fates_of(model, kLevel, others, alone))
          << i << " " << body;
    }
  }
}

// Or brute force would find more than the tree.
TEST(SkinBlocks, LieInTheSpheresOfTheTreeOnEveryLevel) {
  const Model model = model_at(finer_scene(), kCoarse);
  const Patches& patches = *model.patches;
  const TreeLayout layout = layout_of(patches.tree.head);
  const SphereBlock* spheres = blocks_of(patches.tree.lines.data()) + layout.upper;
  std::size_t held[3] = {};
  for (std::size_t level = 0; level < patches.first_samples.size(); ++level) {
    const bool is_between = level % 2 != 0;  // levels of the tree, whose next sphere has to hold it
    if (is_between || level == 0) spheres -= layout.blocks[(level + 1) / 2];
    const auto blocks = samples_of_level(patches, level);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (double{blocks[i].size} > patches.rules.block_on_skin[0]) continue;
      const std::size_t sphere = is_between ? i / kBlocksInLarger : i, lane = sphere % SphereBlock::kWidth;
      const SphereBlock& of = spheres[sphere / SphereBlock::kWidth];
      const Vec3 from =
          point_of(blocks[i].centre) - (patches.tree.head.origin + Vec3{of.x[lane], of.y[lane], of.z[lane]});
      ASSERT_LE(norm(from) + double{blocks[i].radius}, double{of.r[lane]}) << level << " " << i;
      ++held[std::min<std::size_t>(level, 2)];
    }
  }
  for (const std::size_t count : held) EXPECT_GT(count, 1000u);
}

// What is felt of a block is within the rectangle of its first two arms: so none that is not met may be felt.
TEST(SkinBlocks, HoldTheirRectangles) {
  const Model model = model_at(fine_scene(), 1e-4);
  for (const BlockSamples& block : std::span(model.patches->samples.data(), model.patches->samples.size())) {
    for (const float extent : block.extent) ASSERT_GE(extent, 1);
    ASSERT_LE(norm(vec3_of(block.arm[0]) + vec3_of(block.arm[1])), double{block.radius});
  }
}

/// What is near, body by body: in which order it was found does not matter.
using Near = std::vector<std::tuple<std::size_t, std::uint32_t, std::uint32_t>>;
Near sorted(const NearPatches& near) {
  Near all;
  for (std::size_t key = 0; key < kKeyCount; ++key) {
    for (std::uint32_t i = near.begin[key]; i < near.begin[key + 1]; ++i)
      all.emplace_back(key, near.listed[i].tile, near.listed[i].place);
  }
  std::sort(all.begin(), all.end());
  return all;
}

// For searches near the hand that was placed in the scratch.
SampleMemory memory_near(const Model& model, const Scratch& scratch) {
  SampleMemory memory;
  size_samples(model, memory);
  set_bodies(*scratch.primitives, kAllSegments, kAllSegments, model.patches->rules, memory.bodies);
  return memory;
}

TEST(SkinBlocks, OfACoarserLevelAreOpenedToWhatASearchFinds) {
  const Scene scene = finer_scene();
  for (const std::uint32_t threads : {1u, 3u}) {
    Execution execution;
    execution.threads = threads;
    const Model model = model_at(scene, kCoarse, execution);
    Scratch scratch = make_scratch(model);
    State state;
    tick(model, state, scratch, pressed(scene.hand, 0.002));
    SampleMemory memory = memory_near(model, scratch);
    const auto search = [&](std::size_t level, const auto& find) {
      take_blocks_on_skin(model.patches->rules.block_on_skin[level], memory.bodies);
      EXPECT_TRUE(find(model, *scratch.primitives, memory.bodies, memory.search));
      EXPECT_TRUE(list_patches(model, memory.bodies, memory.search, memory.near));
      return sorted(memory.near);
    };
    std::vector<Near> found;
    for (std::size_t level = 0; level < 4; ++level) found.push_back(search(level, find_patches));
    EXPECT_TRUE(found[0] != found[3]);
    search(0, find_patches);
    for (std::size_t level = 1; level < 4; ++level)
      EXPECT_TRUE(search(level, open_patches) == found[level]) << level;
    search(0, find_patches);
    EXPECT_TRUE(search(3, open_patches) == found[3]);
  }
}

// A search for a finer level leaves its two lists exchanged, and objects apart take turns in one memory.
TEST(SkinBlocks, HaveListsWithRoomForModelsThatHaveNone) {
  Scene scene = sampled_scene(default_hand(Side::right), {{"plane", make_plane(0.3, 100)}});
  scene.settings.max_candidates = 1u << 20;
  Scene small = small_scene();
  small.settings.max_candidates = 1u << 16;
  const Model fine = model_at(small, 1e-4), large = model_at(scene, 1e-4);
  ASSERT_GT(fine.patches->rules.block_on_skin[0], 0);
  ASSERT_EQ(large.patches->rules.block_on_skin[0], 0);
  SampleMemory memory;
  size_samples(fine, memory);
  const std::size_t least = memory.search.searcher[0].found.size();
  size_samples(large, memory);
  const PatchSearcher& searcher = memory.search.searcher[0];
  EXPECT_GT(searcher.found.size(), least);
  EXPECT_EQ(searcher.before.size(), searcher.found.size());
}

TEST(SkinBlocks, ThatAreOpenedAddNoMoreThanThereIsRoomFor) {
  Scene scene = small_scene();
  scene.settings.max_candidates = 500;
  const Model model = model_at(scene, 1e-4);
  Scratch scratch = make_scratch(model);
  State state;
  tick(model, state, scratch, pressed(scene.hand, 0.002));
  SampleMemory memory = memory_near(model, scratch);
  PatchSearcher& searcher = memory.search.searcher[0];
  searcher.rivals.emplace(*scratch.primitives, memory.bodies);
  const std::size_t room = searcher.found.size();
  const std::vector<FoundPatches> before(2 * room, {0, 1, 0});
  searcher.found.resize(room + before.size());  // here what is too much does no harm
  CentroidForce force;
  find_for_body({model, *scratch.primitives, memory.bodies, memory.search.cuts}, 0,
                {SearchFrom::Where::before, before, {}}, searcher, force);
  EXPECT_GT(searcher.count, most_patches(model));
  EXPECT_LE(searcher.count, room);
}

// The coarser of two levels has been felt by then.
TEST(SkinBlocks, LeaveNothingFeltWhereThereIsNoRoomToOpenThem) {
  Model model = model_at(small_scene(), 1e-4);
  Scratch scratch = make_scratch(model);
  State state;
  tick(model, state, scratch, pressed(model.hand, mixed_depth(model, 2)));
  SampledForces forces;
  const auto fits = [&](std::uint32_t room) {
    model.settings.max_candidates = room;
    SampleMemory memory;
    size_samples(model, memory);
    return sample_forces(model, *scratch.primitives, kAllSegments, memory, forces);
  };
  std::uint32_t too_little = 0, enough = model.settings.max_candidates;
  while (enough - too_little > 1) {
    const std::uint32_t middle = too_little + (enough - too_little) / 2;
    (fits(middle) ? enough : too_little) = middle;
  }
  EXPECT_FALSE(fits(too_little));
  EXPECT_TRUE(forces.fineness.level[2] > 0 && forces.fineness.level[3] > 0);
  for (const Wrench& segment : forces.segment) EXPECT_EQ(norm(segment.force) + norm(segment.torque), 0);
}

// They differ by such blocks only: where there are none, a mixture would be the same work twice.
TEST(SkinBlocks, WhereThereAreNoneTheTwoCoarsestLevelsAreOne) {
  const Model model =
      model_at(sampled_scene(default_hand(Side::right), pressed_scene(kWidthA, 9).objects), 1e-4);
  ASSERT_EQ(model.patches->rules.block_on_skin[0], 0);
  LevelsOf levels_of(model);
  for (double depth = -0.001; depth < 0.005; depth += 1e-4)
    EXPECT_EQ(levels_of(pressed_frame(model.hand, depth, 0))[0], 0) << depth;
}

// Where the coarsest level's have to do, lattices may yet be as fine as they should be.
TEST(SkinBlocks, ThatAreTooLargeToStayWithinABoundAreTold) {
  Model model = model_at(small_scene(), 1e-4);
  const auto felt = [&](double depth, std::uint64_t effort) {
    model.settings.effort = static_cast<std::uint32_t>(effort);
    Scratch scratch = make_scratch(model);
    State state;
    return tick(model, state, scratch, pressed(model.hand, depth));
  };
  for (const double depth : {-0.002, 0.001}) {
    const ActuatorFrame free = felt(depth, 0);
    for (double share = 1; share > 0.5; share -= 0.05) {
      const auto most = static_cast<std::uint64_t>(share * static_cast<double>(free.evaluations));
      const ActuatorFrame bound = felt(depth, most);
      EXPECT_LE(bound.evaluations, most) << depth << " " << share;
      EXPECT_EQ((bound.flags & kCoarsened) != 0, share < 1) << depth << " " << share;
      EXPECT_EQ(bound.error_estimate > 1.5 * free.error_estimate, share < 1) << depth << " " << share;
      EXPECT_LE(norm(total_force(bound) - total_force(free)), bound.error_estimate) << depth << " " << share;
    }
  }
}

// Lattices are of one cell on all levels here, so there is hardly anything to spare.
TEST(SkinBlocks, AreToldToBeCoarserWhereABoundOnEffortCannotBeKept) {
  Scene scene = fine_scene();
  FeelingHand free(scene, 1e-4);
  const DeviceFrame frame = pressed(scene.hand, mixed_depth(free.model()) - 0.0005);
  const ActuatorFrame unbound = free(frame);
  for (const double share : {1.0, 0.7, 0.3}) {
    scene.settings.effort = static_cast<std::uint32_t>(share * static_cast<double>(unbound.evaluations));
    const ActuatorFrame bound = FeelingHand(scene, 1e-4)(frame);
    EXPECT_EQ((bound.flags & kCoarsened) != 0, share < 1) << share;
    EXPECT_LE(bound.evaluations, unbound.evaluations) << share;
    EXPECT_LE(norm(total_force(bound) - total_force(unbound)), bound.error_estimate) << share;
  }
}

}  // namespace
}  // namespace lumbrical::test
