// The rungs of samples give the same bits however they are computed, and sums that no order of triangles
// moves; what is too much or nothing at all is told and does no harm.
#include <gtest/gtest.h>

#include <numeric>

#include "lumbrical/jacobian.h"
#include "model/primitive.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

constexpr double kPrecisions[] = {1e-3, 1e-4, 1e-5};

// A hand on an irregular mesh: flat, bent and folded, so that every kernel has work.
std::vector<DeviceFrame> postures(const Hand& hand, std::uint64_t seed) {
  Random random(seed);
  std::vector<DeviceFrame> frames;
  for (const double high : {0.1, 0.6, 1.2, 1.7})
    frames.push_back(dropped_hand(hand, random, high - 0.4, high, 0.3, 0.006, 0.01));
  for (const double time : {0.1, 0.6}) frames.push_back(pressed_frame(hand, 0.004, time));
  return frames;
}
Scene irregular_scene() {
  return sampled_scene(default_hand(Side::right), {{"mesh", make_plane(0.3, 90, 1, 3)}});
}

std::vector<Execution> ways_to_run() {
  std::vector<Execution> ways;
  for (const Isa isa : {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
    if (!available(isa)) continue;
    for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid, Broadphase::brute}) {
      for (const std::uint32_t threads : {1u, 4u}) {
        Execution way;
        way.isa = isa;
        way.broadphase = broadphase;
        way.threads = threads;
        ways.push_back(way);
      }
    }
  }
  return ways;
}

// Returns the contacts of all ticks.
std::uint32_t expect_the_same_on_every_way(const Scene& scene, const std::vector<DeviceFrame>& frames) {
  Execution plain;
  plain.isa = Isa::scalar;
  plain.broadphase = Broadphase::brute;
  std::uint32_t contacts = 0;
  const std::uint64_t hash = hash_run(model_of(scene, plain), frames, &contacts);
  for (const Execution& way : ways_to_run()) {
    EXPECT_EQ(hash_run(model_of(scene, way), frames), hash)
        << isa_name(way.isa) << " " << broadphase_name(way.broadphase) << " " << way.threads;
  }
  return contacts;
}

TEST(SampledBits, AreTheSameForEveryInstructionSetThreadCountAndSearch) {
  Scene scene = irregular_scene();
  const std::vector<DeviceFrame> frames = postures(scene.hand, 5);
  for (const double precision : kPrecisions) {
    scene.settings.precision.fill(precision);
    EXPECT_GT(expect_the_same_on_every_way(scene, frames), 1000u);
  }
}

// Triangles so large that they are cut where they are touched, around others.
TEST(SampledBits, AreTheSameOnLargeTriangles) {
  Scene scene = sampled_scene(default_hand(Side::right),
                              {{"floor", make_plane(12, 2)}, {"mesh", make_plane(0.1, 20, 1, 3)}});
  const std::vector<DeviceFrame> frames = postures(scene.hand, 5);
  for (const FeltOnce once : {FeltOnce::never, FeltOnce::by_samples}) {
    scene.settings.felt_once = once;
    EXPECT_GT(expect_the_same_on_every_way(scene, frames), 1000u);
  }
}

// Also what several bodies hold together, exactly and by samples.
TEST(SampledBits, AreTheSameWhereThatIsFeltOnce) {
  Scene scene = irregular_scene();
  scene.settings.felt_once = FeltOnce::always;
  const std::vector<DeviceFrame> frames = postures(scene.hand, 5);
  for (const double precision : {0.0, 1e-3, 1e-4}) {
    scene.settings.precision.fill(precision);
    EXPECT_GT(expect_the_same_on_every_way(scene, frames), 1000u);
  }
}

// Fingertips finer than the rest, some segments exact, one under another law.
TEST(SampledBits, AreTheSameWhereSegmentsDiffer) {
  Scene scene = irregular_scene();
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    scene.settings.precision[i] = i == kPalmSegment ? 1e-3 : i % 3 == 2 ? 1e-5 : i < 6 ? 0 : 1e-4;
  scene.settings.law[10] = Law::column;
  expect_the_same_on_every_way(scene, postures(scene.hand, 6));
}

void expect_same_forces(const HandForces& one, const HandForces& other, double share) {
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Wrench &a = one.segment[i], &b = other.segment[i];
    EXPECT_LE(norm(a.force - b.force), share * norm(a.force)) << segment_name(static_cast<int>(i));
    EXPECT_LE(norm(a.torque - b.torque), share * norm(a.torque)) << segment_name(static_cast<int>(i));
  }
}

TEST(SampledBits, HardlyChangeWithTheOrderOfTriangles) {
  const Scene scene = irregular_scene();
  Scene shuffled = scene;
  std::vector<Triangle>& triangles = shuffled.objects[0].mesh.triangles;
  Random random(8);
  for (std::size_t i = triangles.size(); i > 1; --i) std::swap(triangles[i - 1], triangles[random.below(i)]);
  for (const double precision : kPrecisions) {
    FeelingHand one(scene, precision), other(shuffled, precision);
    for (const DeviceFrame& frame : postures(scene.hand, 7)) {
      const ActuatorFrame felt = one(frame);
      EXPECT_GT(force_size(felt), 0.1);
      expect_same_forces(felt, other(frame), 1e-9);
    }
  }
}

// Also where phalanges come and go, on a mesh so dense that whole blocks are felt as one.
TEST(SampledBits, ATickGivesTheSameAfterAnyOther) {
  const Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", make_plane(0.2, 250, 1, 3)}});
  std::vector<DeviceFrame> frames;
  for (const std::uint32_t missing : {kIndexTip, kWrist, kMiddleProximal, kWrist, kLittleDistal, kRingTip}) {
    frames.push_back(as_joint_poses(scene.hand, pressed_frame(scene.hand, 0.006, 0.1)));
    if (missing != kWrist) frames.back().valid &= ~(1u << missing);
  }
  FeelingHand used(scene, 1e-4), fresh(scene, 1e-4);
  for (const DeviceFrame& frame : frames) used(frame);
  for (const DeviceFrame& frame : frames) {
    const ActuatorFrame felt = used(frame);
    EXPECT_GT(force_size(felt), 1);
    fresh.forget();
    expect_same_forces(felt, fresh(frame), 0);
  }
}

TEST(SampledRung, WithTooLittleRoomFeelsNothingAndSaysSo) {
  Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", make_plane(0.3, 150, 1, 3)}});
  const DeviceFrame frame = pressed_frame(scene.hand, 0.004, 0);
  for (const double precision : kPrecisions) {
    scene.settings.max_candidates = 1u << 18;
    EXPECT_EQ(FeelingHand(scene, precision)(frame).flags & kCandidateOverflow, 0u);
    for (const std::uint32_t room : {1u, 17u, 200u}) {
      scene.settings.max_candidates = room;
      for (const Broadphase broadphase : {Broadphase::tree, Broadphase::brute}) {
        Execution execution;
        execution.broadphase = broadphase;
        const ActuatorFrame felt = FeelingHand(scene, precision, execution)(frame);
        EXPECT_NE(felt.flags & kCandidateOverflow, 0u) << room;
        EXPECT_EQ(force_size(felt), 0) << room;
      }
    }
  }
}

TEST(SampledRung, WithTooLittleRoomHasNoJacobian) {
  Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", make_plane(0.3, 100, 1, 3)}});
  const DeviceFrame frame = pressed_frame(scene.hand, 0.004, 0);
  FeelingHand free(scene, 1e-4);
  const ActuatorFrame felt = free(frame);
  scene.settings.max_candidates = 5;
  FeelingHand full(scene, 1e-4);
  full(frame);
  std::array<SegmentJacobian, kSegmentCount> known, unknown;
  segment_jacobians(free.model(), free.scratch(), known);
  segment_jacobians(full.model(), full.scratch(), unknown);
  std::size_t touching = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    EXPECT_TRUE(known[i].known) << i;
    EXPECT_EQ(unknown[i].value, Matrix6{}) << i;
    if (norm(felt.segment[i].force) < 0.1) continue;
    EXPECT_FALSE(unknown[i].known) << i;
    ++touching;
  }
  EXPECT_GT(touching, 8u);
}

// A triangle on its tip, off the palm by about what rounding is allowed.
TEST(SampledRung, MeetsWhatIsHardlyOffTheSkinHoweverItSearches) {
  const Scene plane = sampled_scene(default_hand(Side::right), {{"mesh", make_plane(0.3, 1)}});
  const DeviceFrame frame = pressed_frame(plane.hand, 0.004, 0);
  FeelingHand placed(plane, 1e-4);
  placed(frame);
  const SweptPolygon& palm = placed.scratch().primitives->palm;
  Vec3 middle;
  for (std::size_t k = 0; k < palm.corner_count; ++k) middle += palm.corner[k] / palm.corner_count;
  constexpr double kLength = 0.006;
  const double slack = kDistanceSlack * (palm.radius + kLength * 2 / 3);
  std::uint32_t met = 0;
  for (int i = 0; i < 20; ++i) {
    const Vec3 tip = middle + (palm.radius + 0.1 * i * slack) * palm.normal,
               base = tip + kLength * palm.normal, aside = 0.4 * kLength * palm.outward[0];
    const Scene scene =
        sampled_scene(plane.hand, {{"tip", {{tip, base + aside, base - aside}, {{0, 1, 2}}}}});
    Execution brute;
    brute.broadphase = Broadphase::brute;
    FeelingHand by_tree(scene, 1e-4), by_all(scene, 1e-4, brute);
    by_tree(frame);
    by_all(frame);
    const std::uint32_t count = by_all.scratch().samples->forces.patch_count;
    EXPECT_EQ(by_tree.scratch().samples->forces.patch_count, count) << i;
    met += count;
  }
  EXPECT_GE(met, 5u);
  EXPECT_LE(met, 15u);
}

// The least room that does for a frame.
std::uint32_t room_for(Scene scene, const DeviceFrame& frame, double precision, const Execution& execution) {
  std::uint32_t too_little = 0, enough = 1u << 18;
  while (enough - too_little > 1) {
    scene.settings.max_candidates = too_little + (enough - too_little) / 2;
    const bool fits = (FeelingHand(scene, precision, execution)(frame).flags & kCandidateOverflow) == 0;
    (fits ? enough : too_little) = scene.settings.max_candidates;
  }
  return enough;
}

TEST(SampledRung, NeedsTheSameRoomWhateverFoundThePatches) {
  const Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", make_plane(0.2, 40, 1, 3)}});
  const DeviceFrame frame = pressed_frame(scene.hand, 0.004, 0);
  Execution brute;
  brute.broadphase = Broadphase::brute;
  for (const double precision : kPrecisions) {
    const std::uint32_t room = room_for(scene, frame, precision, {});
    EXPECT_GT(room, 300u);
    EXPECT_EQ(room, room_for(scene, frame, precision, brute));
  }
}

// Points, lines, corners that are the same; between the others, so that none would go unnoticed.
TEST(SampledRung, FeelsNothingOfTrianglesWithoutArea) {
  const Scene scene = irregular_scene();
  Scene spoilt = scene;
  Mesh& mesh = spoilt.objects[0].mesh;
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : scene.objects[0].mesh.triangles) {
    triangles.push_back({a, a, a});
    triangles.push_back({a, b, c});
    triangles.push_back({a, b, a});
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(mesh.vertices[b]);
    triangles.push_back({b, middle, c});
  }
  mesh.triangles = triangles;
  for (const double precision : kPrecisions) {
    FeelingHand one(scene, precision), other(spoilt, precision);
    for (const DeviceFrame& frame : postures(scene.hand, 7))
      expect_same_forces(one(frame), other(frame), 1e-12);
  }
}

TEST(SampledRung, OfAWorldThatHasNoAreaFeelsNothing) {
  const Mesh mesh{{{0, 0, 0}, {0.1, 0, 0}, {-0.1, 0, 0}}, {{0, 1, 2}, {0, 0, 1}, {2, 2, 2}}};
  const Scene scene = sampled_scene(default_hand(Side::right), {{"lines", mesh}});
  for (const double precision : kPrecisions) {
    const ActuatorFrame felt = FeelingHand(scene, precision)(pressed_frame(scene.hand, 0.004, 0));
    EXPECT_EQ(force_size(felt), 0);
    EXPECT_EQ(felt.contact_count, 0u);
  }
}

}  // namespace
}  // namespace lumbrical::test
