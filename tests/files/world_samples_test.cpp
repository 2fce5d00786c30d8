// World files by samples: their triangles are cut into patches where a hand comes near, not with the model.
#include <utility>
#include <vector>

#include "index/patches.h"
#include "lumbrical/tick.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "world_file_fixture.h"

namespace lumbrical::test {
namespace {

/// What a hand feels from tick to tick; its memory is kept or, if asked for, made anew each time.
struct Felt {
  std::vector<ActuatorFrame> output;
  std::vector<decltype(Scratch::stage_hash)> hashes;
};

Felt felt(const Scene& scene, Broadphase broadphase, const std::vector<Vec3>& way, bool anew = false) {
  Execution execution;
  execution.broadphase = broadphase;
  const Model model = built(scene, execution);
  State state;
  Scratch scratch = make_scratch(model);
  Felt felt;
  for (std::size_t i = 0; i < way.size(); ++i) {
    DeviceFrame frame = pressed_frame(scene.hand, 0.002, static_cast<double>(i) / 20);
    frame.base.position += way[i];
    if (anew) scratch = make_scratch(model);
    felt.output.push_back(tick(model, state, scratch, frame));
    felt.hashes.push_back(scratch.stage_hash);
  }
  return felt;
}

// Fields of that many cells along an edge, within `apart` [m] of the origin, with a needle and a triangle of
// no area each, a ground of triangles of 50 m under them, and the way of a hand over them that jumps from one
// to the next.
Scene islands(std::uint32_t cells, std::vector<Vec3>& way, double apart = 200) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.max_force = 1e6;
  scene.settings.fade_time = 0;
  Random random(7);
  for (int i = 0; i < 4; ++i) {
    Mesh mesh = make_height_field(0.4, cells, 0.002, 0.04);
    const auto corner = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3 p : {Vec3{-0.3, 0.01, 0}, {0.3, 0.01, 0}, {0.3, 0.011, 0}}) mesh.vertices.push_back(p);
    mesh.triangles.push_back({corner, corner + 1, corner + 2});
    mesh.triangles.push_back({corner, corner + 1, corner + 1});
    const Vec3 at = random.in_box(apart);
    for (Vec3& p : mesh.vertices) p += at;
    scene.objects.push_back({"island " + std::to_string(i), std::move(mesh)});
    for (int k = 0; k < 6; ++k) way.push_back(at + Vec3{0.002 * k, 0.003 * k, 0});
  }
  scene.objects.push_back({"ground", make_height_field(600, 12, 0.1, 30)});
  way.push_back({20, 30, 0.002});
  return scene;
}

bool same_forces(const ActuatorFrame& a, const ActuatorFrame& b) {
  bool same = true;
  for (std::size_t s = 0; s < kSegmentCount; ++s)
    same = same && a.segment[s].force == b.segment[s].force && a.segment[s].torque == b.segment[s].torque;
  return same;
}

// Blocks above the palm are taken as ones in memory, however large, and of a world file there are none: so
// the palm feels exactly here. How fine lattices are goes by a sum over blocks in single precision.
TEST(WorldSamples, AreThePatchesOfAModelInMemoryAndBruteForceFindsTheSame) {
  std::vector<Vec3> way;
  Scene scene = islands(30, way);
  scene.settings.precision[kPalmSegment] = 0;
  const Scene mapped = in_world(scene, {}, (own_folder() / "islands.world").string());
  const Felt in_memory = felt(scene, Broadphase::tree, way),
             in_file = felt(mapped, Broadphase::automatic, way);
  for (std::size_t i = 0; i < way.size(); ++i) {
    const ActuatorFrame &memory = in_memory.output[i], &file = in_file.output[i];
    ASSERT_GT(force_size(memory), 0.1) << i;
    EXPECT_EQ(file.contact_count, memory.contact_count) << i;
    for (std::size_t s = 0; s < kSegmentCount; ++s)
      EXPECT_LE(norm(file.segment[s].force - memory.segment[s].force), 1e-9 * force_size(memory)) << i;
  }
  EXPECT_EQ(felt(mapped, Broadphase::brute, way).hashes, in_file.hashes);
}

TEST(WorldSamples, KeepTheirPrecisionOnCoarseAndFineMeshes) {
  for (const auto& [cells, apart] : {std::pair{8u, 200.0}, {60u, 200.0}, {300u, 200.0}, {60u, 2e6}}) {
    std::vector<Vec3> way;
    Scene scene = islands(cells, way, apart);
    scene.settings.felt_once = FeltOnce::always;
    const std::string path = (own_folder() / "islands.world").string();
    const Felt by_samples = felt(in_world(scene, {}, path), Broadphase::automatic, way);
    scene.settings.precision.fill(0);
    const Felt exact = felt(scene, Broadphase::grid, way);
    for (std::size_t i = 0; i < way.size(); ++i) {
      const double size = force_size(exact.output[i]);
      ASSERT_GT(size, 0.1) << i;
      EXPECT_EQ(by_samples.output[i].flags, exact.output[i].flags) << i;
      EXPECT_LT(norm(total_force(by_samples.output[i]) - total_force(exact.output[i])), 1e-4 * size)
          << cells << " cells within " << apart << " m, tick " << i;
    }
  }
}

TEST(WorldSamples, GiveTheSameWhateverWasCutBefore) {
  std::vector<Vec3> way;
  const Scene scene = islands(60, way);
  const Scene mapped = in_world(scene, {}, (own_folder() / "islands.world").string());
  const Felt kept = felt(mapped, Broadphase::grid, way), anew = felt(mapped, Broadphase::grid, way, true);
  for (std::size_t i = 0; i < way.size(); ++i) EXPECT_TRUE(same_forces(kept.output[i], anew.output[i])) << i;
}

TEST(WorldSamples, OfMoreThanThereIsRoomForAreNotFeltAndSaySo) {
  std::vector<Vec3> way;
  Scene scene = islands(300, way);
  scene.settings.max_candidates = 1000;
  const Scene mapped = in_world(scene, {}, (own_folder() / "islands.world").string());
  for (const ActuatorFrame& output : felt(mapped, Broadphase::grid, {way[0], way[1]}).output) {
    EXPECT_NE(output.flags & kCandidateOverflow, 0u);
    EXPECT_EQ(force_size(output), 0);
  }
  EXPECT_EQ(felt(mapped, Broadphase::grid, {way.back()}).output[0].flags & kCandidateOverflow, 0u);
}

// Another hand, or other settings, of the same world: its triangles are cut for that one's radii.
TEST(WorldSamples, GoByTheHandAndItsPrecision) {
  std::vector<Vec3> way;
  const Scene scene = islands(60, way);
  const Model model = built(in_world(scene, {}, (own_folder() / "islands.world").string()));
  Hand thick = scene.hand;
  for (double& radius : thick.radius) radius *= 1.2;
  Model other, finer;
  ASSERT_TRUE(share_world(model, thick, other).ok());
  Settings settings = scene.settings;
  settings.precision.fill(1e-6);
  ASSERT_TRUE(change_settings(model, settings, 1, finer).ok());
  EXPECT_GT(other.patches->rules.step, model.patches->rules.step);
  DeviceFrame frame = pressed_frame(scene.hand, 0.002, 0.3);
  frame.base.position += way[0];
  const auto felt_by = [&](const Model& by) {
    State state;
    Scratch scratch = make_scratch(by);
    return force_size(tick(by, state, scratch, frame));
  };
  const double by_hand = felt_by(model), by_finer = felt_by(finer);
  EXPECT_GT(felt_by(other), 1.2 * by_hand);
  EXPECT_NE(by_finer, by_hand);
  EXPECT_NEAR(by_finer, by_hand, 1e-4 * by_hand);
}

}  // namespace
}  // namespace lumbrical::test
