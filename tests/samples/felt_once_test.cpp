// What several fingers, or fingers and palm, hold together is felt once (FeltOnce): against the definition,
// the deepest body at each point, by brute quadrature; and where two bodies are in the same place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "fists.h"
#include "largest.h"
#include "lumbrical/jacobian.h"
#include "model/primitive.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/felt_once_reference.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

struct Held {
  std::string name;
  Mesh mesh;
  DeviceFrame frame;
  double shared;  // of the hand's force, at least, that several bodies would feel
};
std::vector<Held> what_hands_hold(const Hand& hand) {
  std::vector<Held> all;
  const DeviceFrame flat = pressed_frame(hand, 0.003, 0.2);
  all.push_back({"a flat hand on a plane", make_plane(0.3, 60, 1, 3), flat, 0.01});
  all.push_back({"a flat hand on two triangles", make_plane(0.3, 1), flat, 0.01});
  all.push_back({"a flat hand on an irregular plane", make_plane(0.3, 24, 1, 5), flat, 0.01});
  all.push_back({"fingers side by side", make_plane(0.3, 60, 1, 3), flat, 0.01});
  for (std::size_t i = 4; i < kAngleCount; i += 4) all.back().frame.angle[i] = i == 8 ? 0.0f : -0.3f;
  all.push_back({"a flat hand deep in a fine plane", make_plane(0.2, 250, 1, 3),
                 pressed_frame(hand, 0.006, 0.2), 0.01});
  // Its sides nearly cancel, and what is taken off them has to as well.
  all.push_back(
      {"a thin tray", make_box({0.09, 0.09, 0.002}, 6), resample(make_grasp(hand, 0.045, 0.01, 6), 3), 0});
  all.push_back(
      {"a grasp", make_box({0.04, 0.04, 0.08}, 12), resample(make_grasp(hand, 0.02, 0.08, 6), 3), 0.003});
  return all;
}

double torque_difference(const HandForces& one, const HandForces& other) {
  double most = 0, size = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    most = largest(most, norm(one.segment[i].torque - other.segment[i].torque));
    size += norm(other.segment[i].torque);
  }
  return most / size;
}

TEST(FeltOnce, IsWhatTheDeepestBodyFeelsOnEveryRung) {
  const Hand hand = default_hand(Side::right);
  std::size_t with_palm = 0, of_two = 0, of_any = 0;  // patches that go through each kernel
  for (const Held& held : what_hands_hold(hand)) {
    Scene scene = sampled_scene(hand, {{"mesh", held.mesh}});
    scene.settings.felt_once = FeltOnce::always;
    const double stiffness = scene.settings.stiffness;
    const Model exact = model_at(scene, 0);
    Scratch scratch = make_scratch(exact);
    State state;
    const ActuatorFrame felt = tick(exact, state, scratch, held.frame);
    const Reference reference = reference_of(exact, *scratch.primitives);
    EXPECT_GT(body_difference(reference.by_all, reference.once).hand, held.shared) << held.name;
    const Difference off = body_difference(by_bodies(felt, stiffness), reference.once);
    EXPECT_LT(off.hand, 5e-5) << held.name;  // the reference's own error
    EXPECT_LT(off.body, 5e-5) << held.name;
    for (const double precision : {1e-3, 1e-4, 1e-5}) {
      FeelingHand samples(scene, precision);
      const ActuatorFrame by_samples = samples(held.frame);
      const Overlaps& overlaps = samples.scratch().samples->near.overlaps;
      for (std::size_t k = 0; k < kPatchClasses; ++k) {
        with_palm += overlaps.together_of(1, k).size();
        of_two += overlaps.together_of(2, k).size();
        of_any += overlaps.count_by_parts(k);
      }
      const Difference error = body_difference(by_bodies(by_samples, stiffness), by_bodies(felt, stiffness));
      EXPECT_LT(error.hand, precision + 3e-5) << held.name << " at " << precision;
      EXPECT_LT(error.body, 3 * precision + 3e-5) << held.name << " at " << precision;
      EXPECT_LT(torque_difference(by_samples, felt), 6 * precision + 3e-5)
          << held.name << " at " << precision;
    }
  }
  EXPECT_GT(with_palm, 1000u);
  EXPECT_GT(of_two, 100u);
  EXPECT_GT(of_any, 100u);
}

// Of each segment, as a share of all.
double worst_segment(const HandForces& one, const HandForces& other) {
  double most = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    most = largest(most, norm(one.segment[i].force - other.segment[i].force));
  return most / force_size(other);
}

// A fist about a fine sphere: where the index finger's skin meets the thumb's, it runs along the thumb's
// joint.
TEST(FeltOnce, NeighboursKeepTheirSharesWhereAnotherFingerLiesAlongTheirJoint) {
  const Hand hand = default_hand(Side::right);
  Scene scene = sampled_scene(hand, {{"sphere", make_sphere(0.0873, 85)}});
  scene.settings.felt_once = FeltOnce::always;
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  frame.angle = {0.0926f, 1.4856f, 1.3719f,  1.3497f, 0.0059f, 1.3748f, 1.5671f,  1.4423f, -0.0809f, 1.5153f,
                 1.5622f, 1.4723f, -0.0348f, 1.4306f, 1.5140f, 1.5125f, -0.0595f, 1.5566f, 1.5411f,  1.5502f};
  frame.base.position = {-0.0939, -0.066009, -0.034648};
  frame.base.orientation = normalized({-0.47114, 0.38258, 0.70927, -0.35859});
  FeelingHand exact(scene, 0);
  const ActuatorFrame felt = exact(frame);
  for (const double precision : {1e-4, 1e-5}) {
    FeelingHand samples(scene, precision);
    EXPECT_LT(worst_segment(samples(frame), felt), 3 * precision) << precision;
  }
}

// Fists, bent beyond an adult's limits, about a ball of triangles so fine that parts take blocks of them as
// ones: of two neighbouring tiles one may share space with such a part, and the other not.
TEST(FeltOnce, NeighboursOfWhichOneMeetsAPartLeaveToItTheBlocksThatItTakes) {
  const Hand hand = loosened(default_hand(Side::right));
  Scene scene = sampled_scene(hand, {{"ball", make_sphere(0.02, 60)}});
  scene.settings.felt_once = FeltOnce::always;
  FeelingHand exact(scene, 0), samples(scene, 1e-4);
  Random random(7);
  std::size_t felt_poses = 0;
  for (int pose = 0; pose < 40; ++pose) {
    const DeviceFrame frame = fist_frame(hand, random, 0.02);
    const ActuatorFrame by_samples = samples(frame);
    if (force_size(by_samples) < 5) continue;
    const ActuatorFrame felt = exact(frame);
    ++felt_poses;
    EXPECT_LT(norm(total_force(by_samples) - total_force(felt)), 1.5e-4 * force_size(felt)) << pose;
    EXPECT_LT(worst_segment(by_samples, felt), 3e-4) << pose;
  }
  EXPECT_GT(felt_poses, 30u);
}

// Of thick fingers and a thick palm up to three meet in a cell, and planes that go through the palm's middle
// meet the ridge of its field.
TEST(FeltOnce, ThickFingersAndThePalmShareOutWhatTheyHoldTogether) {
  Hand hand = default_hand(Side::right);
  for (double& radius : hand.radius) radius *= 2.4;
  Scene scene = sampled_scene(hand, {{"plane", make_plane(0.6, 1)}});
  scene.settings.felt_once = FeltOnce::always;
  FeelingHand exact(scene, 0), samples(scene, 1e-4);
  Random random(3);
  std::size_t felt_poses = 0;
  for (int pose = 0; pose < 120; ++pose) {
    DeviceFrame frame;
    frame.kind = InputKind::joint_angles;
    for (std::size_t k = 0; k < kAngleCount; ++k)
      frame.angle[k] = static_cast<float>(k % 4 != 0 ? random.between(-0.2, 1.2) : 0);
    frame.base.orientation = random.rotation();
    frame.base.position = {random.between(-0.02, 0.02), random.between(-0.02, 0.02),
                           random.between(-0.04, 0.04)};
    const ActuatorFrame felt = exact(frame), by_samples = samples(frame);
    const double size = force_size(felt);
    if (size < 1) continue;
    ++felt_poses;
    EXPECT_LT(norm(total_force(by_samples) - total_force(felt)), 7e-5 * size) << pose;
    EXPECT_LT(worst_segment(by_samples, felt), 3e-4) << pose;
  }
  EXPECT_GT(felt_poses, 60u);
}

/// What each part of a hand gets of patches that any parts share, on a lattice of five steps.
std::vector<double> shares(const Scratch& scratch, const Model& model, SharedPatches shared) {
  const SampleMemory& memory = *scratch.samples;
  const Patches& patches = *model.patches;
  std::vector<BodySums> sums(Bodies::kMostParts);
  for (BodySums& of_part : sums) of_part.force_quantum = of_part.moment_quantum = 0x1p-60;
  const PatchList list{patches.shape.data(),
                       shared.patches.data(),
                       shared.patches.size(),
                       memory.bodies.origin.data(),
                       5,
                       static_cast<std::uint32_t>(patches.shape.size()),
                       memory.search.cuts.shape.data()};
  sample_kernels(model.execution.isa)
      .parts_lattice(list, memory.bodies, shared.parts, {sums.data(), ~std::uint64_t{0}});
  std::vector<double> all;
  for (const BodySums& of_part : sums) {
    for (const auto& lanes : of_part.lane) all.push_back(sum_of(lanes));
  }
  return all;
}

TEST(FeltOnce, PatchesOfAFistThatDifferentPartsShareAreFeltInOneRowAsOneByOne) {
  Hand hand = default_hand(Side::right);
  for (double& radius : hand.radius) radius *= 1.6;
  Scene scene = sampled_scene(hand, {{"mesh", make_plane(0.3, 90, 1, 3)}});
  scene.settings.felt_once = FeltOnce::always;
  FeelingHand samples(scene, 1e-4);
  Random random(7);
  std::size_t rows_of_several = 0;
  for (int pose = 0; pose < 12; ++pose) {
    DeviceFrame frame = dropped_hand(hand, random, 0.8, 1.7, 0, 0, 0.01);
    frame.base = {{}, random.rotation()};
    frame.base.position = -posed_joints(hand, frame)[kMiddleIntermediate].position;  // in the plane
    samples(frame);
    const Overlaps& overlaps = samples.scratch().samples->near.overlaps;
    for (std::size_t k = 0; k < kPatchClasses; ++k) {
      const SharedPatches all = overlaps.by_parts_of(k);
      std::vector<double> one_by_one(shares(samples.scratch(), samples.model(), {}).size());
      for (std::size_t i = 0; i < all.patches.size(); ++i) {
        const auto own =
            shares(samples.scratch(), samples.model(), {all.patches.subspan(i, 1), all.parts + i});
        for (std::size_t j = 0; j < own.size(); ++j) one_by_one[j] += own[j];
        rows_of_several += i > 0 && all.parts[i] != all.parts[i - 1];
      }
      EXPECT_EQ(shares(samples.scratch(), samples.model(), all), one_by_one) << pose << " " << k;
    }
  }
  EXPECT_GT(rows_of_several, 50u);
}

// What the records of a hand's contacts come to together, per segment.
HandForces sum_of(std::span<const Contact> contacts, const Scratch& scratch, double stiffness) {
  HandForces sum;
  for (const Contact& contact : contacts) {
    const auto segment = static_cast<std::size_t>(contact_segment(scratch, contact));
    const Vec3 force = stiffness * contact.volume * contact.normal;
    sum.segment[segment].force += force;
    sum.segment[segment].torque += cross(contact.centre - scratch.primitives->base_joint[segment], force);
  }
  return sum;
}

// The largest distance of a coordinate of a contact's centroid or centre beyond its triangle's box [m].
double beyond_triangle(const Model& model, const Contact& contact) {
  const auto [a, b, c] = corners_of(model.triangles, contact.triangle);
  double most = 0;
  for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    const auto [lowest, highest] = std::minmax({a.*axis, b.*axis, c.*axis});
    for (const Vec3& p : {contact.centroid, contact.centre})
      most = largest(most, largest(p.*axis - highest, lowest - p.*axis));
  }
  return most;
}

// Parts of a needle are halved along it only.
TEST(FeltOnce, IsTheSameOnNeedlesAsOnOtherTriangles) {
  const Hand hand = default_hand(Side::right);
  Mesh needles;
  constexpr std::uint32_t kStrips = 300;
  for (std::uint32_t i = 0; i <= kStrips; ++i) {
    const double y = 0.3 * (i / double(kStrips) - 0.5);
    needles.vertices.push_back({-0.15, y, 0});
    needles.vertices.push_back({0.15, y, 0});
  }
  for (std::uint32_t i = 0; i < 2 * kStrips; i += 2) {
    needles.triangles.push_back({i, i + 1, i + 3});
    needles.triangles.push_back({i, i + 3, i + 2});
  }
  const DeviceFrame frame = pressed_frame(hand, 0.003, 0.2);
  const auto feel = [&](const Mesh& mesh, FeltOnce felt_once) {
    Scene scene = sampled_scene(hand, {{"mesh", mesh}});
    scene.settings.felt_once = felt_once;
    return by_bodies(FeelingHand(scene, 0)(frame), scene.settings.stiffness);
  };
  const Mesh coarse = make_plane(0.3, 2);
  const BodyForces expected = feel(coarse, FeltOnce::always);
  EXPECT_GT(body_difference(feel(coarse, FeltOnce::never), expected).hand, 0.01);
  EXPECT_LT(body_difference(feel(needles, FeltOnce::always), expected).body, 2e-6);
}

// A fist anyhow round the x-axis, which goes through one of its fingers.
DeviceFrame fist_round_x_axis(const Hand& hand, Random& random) {
  DeviceFrame fist;
  fist.kind = InputKind::joint_angles;
  for (std::size_t i = 0; i < kAngleCount; ++i)
    fist.angle[i] = i % 4 == 0 ? 0.0f : static_cast<float>(random.between(0.6, 1.5));
  fist.base.orientation = random.rotation();
  const std::array<Pose, kJointCount> pose = posed_joints(hand, fist);
  fist.base.position = Vec3{0, 0.005, 0} - pose[kIndexProximal + 5 * random.below(4) + 1].position;
  return fist;
}

// Their sides nearly cancel, and what is taken off them has to as well.
TEST(FeltOnce, ThinRodsOfLongTrianglesAreRightToAMillionthOfWhatIsLeftOfTheirSides) {
  const Hand hand = default_hand(Side::right);
  Scene scene = sampled_scene(hand, {{"rod", make_box({0.3, 0.0003, 0.0003}, 1)}});
  FeelingHand twice(scene, 0);
  scene.settings.felt_once = FeltOnce::always;
  FeelingHand once(scene, 0);
  Random random(1);
  int shared = 0;
  for (int i = 0; i < 60; ++i) {
    const DeviceFrame fist = fist_round_x_axis(hand, random);
    const ActuatorFrame felt = once(fist);
    if (norm(total_force(twice(fist)) - total_force(felt)) < 0.1 * force_size(felt)) continue;
    ++shared;
    const BodyForces expected = reference_by_rays(once.model(), *once.scratch().primitives);
    const Difference off = body_difference(by_bodies(felt, scene.settings.stiffness), expected);
    EXPECT_LT(off.hand, 2e-6) << i;
    EXPECT_LT(off.body, 2e-6) << i;
  }
  EXPECT_GT(shared, 3);
}

TEST(FeltOnce, ContactRecordsAddUpToWhatIsFelt) {
  const Hand hand = default_hand(Side::right);
  std::size_t left_to_others = 0;
  for (const Held& held : what_hands_hold(hand)) {
    Scene scene = sampled_scene(hand, {{"mesh", held.mesh}});
    const double stiffness = scene.settings.stiffness;
    for (const double precision : {0.0, 1e-4, 1e-5}) {
      scene.settings.felt_once = precision > 0 ? FeltOnce::by_samples : FeltOnce::always;
      const Model model = model_at(scene, precision);
      Scratch scratch = make_scratch(model);
      State state;
      const HandForces felt = tick(model, state, scratch, held.frame);
      const auto contacts = find_contacts(model, scratch);
      const HandForces sum = sum_of(contacts, scratch, stiffness);
      const double most = precision > 0 ? precision + 1e-5 : 1e-13;
      const Difference off = body_difference(by_bodies(sum, stiffness), by_bodies(felt, stiffness));
      EXPECT_LT(off.hand, most) << held.name << " at " << precision;
      EXPECT_LT(off.body, 3 * most) << held.name << " at " << precision;
      EXPECT_LT(torque_difference(sum, felt), 6 * most) << held.name << " at " << precision;
      for (const Contact& contact : contacts) {
        EXPECT_GE(contact.volume, 0);
        EXPECT_LT(beyond_triangle(model, contact), 1e-9) << held.name << " at " << precision;
        left_to_others += contact.volume == 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(left_to_others, 10u);  // as a whole
}

// The middle finger where the index is: the first of the two has it all.
TEST(FeltOnce, TwoFingersInOnePlaceFeelWhatOneFeels) {
  Hand hand = default_hand(Side::right);
  for (std::size_t k = 0; k < 5; ++k) hand.radius[kMiddleMetacarpal + k] = hand.radius[kIndexMetacarpal + k];
  hand.palm.polygon.clear();
  Scene scene = sampled_scene(hand, {{"mesh", make_plane(0.3, 60, 1, 3)}});
  DeviceFrame both = as_joint_poses(hand, pressed_frame(hand, 0.003, 0.2));
  for (std::size_t k = 0; k < 5; ++k) both.joint[kMiddleMetacarpal + k] = both.joint[kIndexMetacarpal + k];
  DeviceFrame one = both;
  for (std::uint32_t k = 0; k < 5; ++k) one.valid &= ~(1u << (kMiddleMetacarpal + k));
  for (const double precision : {0.0, 1e-4, 1e-5}) {
    scene.settings.felt_once = FeltOnce::never;
    FeelingHand twice(scene, precision);
    scene.settings.felt_once = FeltOnce::always;
    FeelingHand once(scene, precision);
    const Vec3 by_both = total_force(once(both)), by_one = total_force(once(one));
    EXPECT_GT(norm(total_force(twice(both))), 1.1 * norm(by_one));
    EXPECT_LT(norm(by_both - by_one), (precision > 0 ? precision : 1e-6) * norm(by_one)) << precision;
  }
}

TEST(FeltOnce, ByDefaultSamplesFeelOnceAndExactSegmentsByThemselves) {
  const Hand hand = default_hand(Side::right);
  const DeviceFrame flat = pressed_frame(hand, 0.003, 0.2);
  Scene scene = sampled_scene(hand, {{"mesh", make_plane(0.3, 60, 1, 3)}});
  const auto felt = [&](double precision, FeltOnce once) {
    scene.settings.felt_once = once;
    return FeelingHand(scene, precision)(flat);
  };
  const auto is_same = [](const HandForces& one, const HandForces& other) {
    return std::equal(
        one.segment.begin(), one.segment.end(), other.segment.begin(),
        [](const Wrench& a, const Wrench& b) { return a.force == b.force && a.torque == b.torque; });
  };
  EXPECT_EQ(Settings{}.felt_once, FeltOnce::by_samples);
  EXPECT_TRUE(is_same(felt(1e-4, FeltOnce::by_samples), felt(1e-4, FeltOnce::always)));
  EXPECT_TRUE(is_same(felt(0, FeltOnce::by_samples), felt(0, FeltOnce::never)));
  EXPECT_GT(norm(total_force(felt(1e-4, FeltOnce::never)) - total_force(felt(1e-4, FeltOnce::by_samples))),
            0.1);
  // Any laws and rungs may stand beside each other: it is for those that are felt by samples.
  scene.settings.law[2] = Law::column;
  scene.settings.law[kPalmSegment] = Law::max_depth;
  scene.settings.felt_once = FeltOnce::by_samples;
  EXPECT_GT(total_force(FeelingHand(scene, 1e-4)(flat)).z, 1);
}

TEST(FeltOnce, JacobiansAreThoseOfWhatIsFelt) {
  const Hand hand = default_hand(Side::right);
  Scene scene = sampled_scene(hand, {{"mesh", make_plane(0.3, 60, 1, 3)}});
  scene.settings.felt_once = FeltOnce::always;
  const Model model = model_at(scene, 1e-4);
  Scratch scratch = make_scratch(model);
  const DeviceFrame flat = as_joint_poses(hand, pressed_frame(hand, 0.003, 0.2));
  State state;
  tick(model, state, scratch, flat);
  std::array<SegmentJacobian, kSegmentCount> jacobians;
  segment_jacobians(model, scratch, jacobians);
  const Fineness fineness = scratch.samples->forces.fineness;
  // The palm by itself 10 um down: its polygon goes with its joint, fingers stay.
  constexpr double kStep = 1e-5;
  std::array<Vec3, 2> force;
  for (const double side : {-1.0, 1.0}) {
    Primitives moved = *scratch.primitives;
    for (Vec3& corner : moved.palm.corner) corner.z += side * kStep;
    SampledForces felt;
    ASSERT_TRUE(sample_forces(model, moved, kAllSegments, *scratch.samples, felt, &fineness));
    force[side > 0 ? 1 : 0] = scene.settings.stiffness * felt.segment[kPalmSegment].force;
  }
  // Records of contacts leave something to others too, but nothing that samples feel hangs on them.
  find_contacts(model, scratch);
  std::array<SegmentJacobian, kSegmentCount> after;
  segment_jacobians(model, scratch, after);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    EXPECT_TRUE(after[i].known);
    EXPECT_EQ(after[i].value, jacobians[i].value);
  }

  const Vec3 change = (force[1] - force[0]) / (2 * kStep);
  ASSERT_TRUE(jacobians[kPalmSegment].known);
  const auto& value = jacobians[kPalmSegment].value;
  EXPECT_LT(change.z, -100);
  EXPECT_NEAR(value[2][2], change.z, 1e-3 * norm(change));
  EXPECT_NEAR(value[0][2], change.x, 1e-3 * norm(change));
  EXPECT_NEAR(value[1][2], change.y, 1e-3 * norm(change));

  const Model exact = model_at(scene, 0);
  Scratch of_exact = make_scratch(exact);
  tick(exact, state, of_exact, flat);
  segment_jacobians(exact, of_exact, jacobians);
  EXPECT_FALSE(jacobians[kPalmSegment].known);  // borders between bodies move in a way that nobody knows
}

TEST(FeltOnce, NeedsTheFieldLawAndOneRungForAll) {
  Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", make_plane(0.3, 4)}});
  scene.settings.felt_once = FeltOnce::always;
  const auto error_of = [&] {
    Model model;
    return build_model(scene, {}, model).message();
  };
  EXPECT_EQ(error_of(), "");
  scene.settings.precision[4] = 0;
  EXPECT_NE(error_of().find("settings.felt_once"), std::string::npos);
  scene.settings.precision.fill(0);
  EXPECT_EQ(error_of(), "");
  scene.settings.law[2] = Law::column;
  EXPECT_NE(error_of().find("settings.felt_once"), std::string::npos);
}

}  // namespace
}  // namespace lumbrical::test
