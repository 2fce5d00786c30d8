// The error of every rung of samples, held against the exact one: under hands that lie flat or stand on their
// fingertips, in random poses.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "exact/posed_finger.h"
#include "largest.h"
#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "mesh_world.h"
#include "pressed_hand.h"
#include "sampled_hand.h"

namespace lumbrical::test {
namespace {

struct Trial {
  std::string name;
  Scene scene;
  std::vector<DeviceFrame> frames;
  std::vector<double> precisions{1e-3, 1e-4, 1e-5};
};

constexpr int kPoses = 100;

// How far fingers are flexed [rad], how far the hand is tilted [rad] and how far aside it may be [m].
struct Posture {
  double low = -0.1, high = 0.35, tilt = 0.15, spread = 0.05;
};

// Lowers the hand until it is `depth` [m] below its first touch; false where it does not touch.
bool press_down(FeelingHand& hand, double depth, DeviceFrame& frame) {
  double above = frame.base.position.z + 0.06, below = frame.base.position.z - 0.03;
  for (int step = 0; step < 12; ++step) {
    frame.base.position.z = 0.5 * (above + below);
    (force_size(hand(frame)) < 0.01 ? above : below) = frame.base.position.z;
  }
  frame.base.position.z = below;
  const bool touches = force_size(hand(frame)) > 0;
  frame.base.position.z -= depth;
  return touches;
}

std::vector<DeviceFrame> dropped(const Scene& scene, Posture how, std::uint64_t seed) {
  Random random(seed);
  FeelingHand coarse(scene, 1e-3);
  std::vector<DeviceFrame> frames;
  while (frames.size() < kPoses) {
    DeviceFrame frame = dropped_hand(scene.hand, random, how.low, how.high, how.tilt, 0, how.spread);
    if (press_down(coarse, random.between(0.0005, 0.003), frame)) frames.push_back(frame);
  }
  return frames;
}

// Flat on a field, all fingers and the palm: sliding and at random depths.
std::vector<DeviceFrame> draped(const Hand& hand, std::uint64_t seed) {
  Random random(seed);
  std::vector<DeviceFrame> frames;
  const DeviceFrame flat = pressed_frame(hand, 0.002, 0);
  for (int i = 0; i < kPoses; ++i) {
    DeviceFrame frame = flat;
    const double turn = random.between(-0.5, 0.5);
    frame.base.orientation = normalized(turned({0, 0, 1}, turn) * flat.base.orientation);
    frame.base.position.x = random.between(-0.03, 0.03);
    frame.base.position.y += random.between(-0.02, 0.02);
    frame.base.position.z += random.between(-0.002, 0.001);
    frames.push_back(frame);
  }
  return frames;
}

Hand right_hand() { return default_hand(Side::right); }

Trial on_field(const std::string& name, std::uint32_t cells, bool flat, std::uint64_t seed) {
  Trial trial{name, sampled_scene(right_hand(), pressed_scene(kWidthA, cells).objects), {}};
  trial.frames = flat ? draped(trial.scene.hand, seed) : dropped(trial.scene, {0.25, 0.7, 0.2, 0.04}, seed);
  return trial;
}

Trial on_mesh(const std::string& name, const Hand& hand, Mesh mesh, Posture how, std::uint64_t seed) {
  Trial trial{name, sampled_scene(hand, {{"mesh", std::move(mesh)}}), {}};
  trial.frames = dropped(trial.scene, how, seed);
  return trial;
}

// Two triangles, larger than patches are cut from.
Trial on_two_triangles() { return on_mesh("two large triangles", right_hand(), make_plane(0.4, 1), {}, 12); }

// Under a fingertip only, or there would be millions.
Trial on_tiny_triangles() {
  Trial trial{
      "triangles of 0.1 mm", sampled_scene(right_hand(), {{"plane", make_plane(0.02, 200, 0.8, 4)}}), {}};
  trial.precisions = {1e-3, 1e-4};
  Random random(41);
  for (int i = 0; i < kPoses; ++i) {
    DeviceFrame frame = dropped_hand(trial.scene.hand, random, 0.2, 0.6, 0.1, 0, 0);
    const Vec3 tip = posed_joints(trial.scene.hand, frame)[kIndexTip].position;
    frame.base.position += Vec3{random.between(-0.008, 0.008) - tip.x, random.between(-0.008, 0.008) - tip.y,
                                trial.scene.hand.radius[kIndexTip] - random.between(0.001, 0.003) - tip.z};
    trial.frames.push_back(frame);
  }
  return trial;
}

Trial far_away() {
  Trial trial = on_field("10 km from the origin", 69, true, 61);
  trial.name = "10 km from the origin";
  const Vec3 away{10000.125, -9876.5, 333.0625};
  move(trial.scene.objects[0].mesh, away);
  for (DeviceFrame& frame : trial.frames) move(frame, away);
  return trial;
}

Trial without_joints() {
  Trial trial = on_field("missing joints", 69, true, 71);
  Random random(72);
  for (DeviceFrame& frame : trial.frames) {
    frame = as_joint_poses(trial.scene.hand, frame);
    frame.valid &= ~(1u << (kThumbMetacarpal + random.below(kJointCount - kThumbMetacarpal)));
  }
  return trial;
}

Trial without_palm() {
  Trial trial = on_field("no palm", 69, true, 81);
  trial.name = "no palm";
  trial.scene.hand.palm.polygon.clear();
  trial.precisions = {1e-3, 1e-4};
  return trial;
}

// Closed round something, as the built-in motion does: deep, from all sides, with bent fingers.
Trial in_grasp(const std::string& name, Mesh mesh, double radius, double height) {
  Trial trial{name, sampled_scene(right_hand(), {{"mesh", std::move(mesh)}}), {}};
  const Motion motion = make_grasp(trial.scene.hand, radius, height, 6);
  for (int i = 0; i < kPoses; ++i) trial.frames.push_back(resample(motion, 6 * (i + 0.5) / kPoses));
  trial.precisions = {1e-3, 1e-4};
  return trial;
}

Mesh raised(Mesh mesh, double height) {
  move(mesh, {0, 0, height});
  return mesh;
}

// Long and thin, along the fingers and across.
Mesh stretched(Mesh mesh, double along) {
  for (Vec3& vertex : mesh.vertices) vertex.y *= along;
  return mesh;
}

// Side by side, and so off the same way: at 1e-5 they are so by four times that.
Trial on_needles() {
  Trial trial = on_mesh("needles", right_hand(), stretched(make_plane(0.03, 40, 0.5, 8), 10), {}, 13);
  trial.precisions = {1e-3, 1e-4};
  return trial;
}

std::vector<Trial> all_trials() {
  return {on_field("drape 162", 9, true, 1),
          on_field("drape 1682", 29, true, 2),
          on_field("drape 9522", 69, true, 3),
          on_field("bent fingers 162", 9, false, 4),
          on_field("bent fingers 4802", 49, false, 5),
          on_mesh("irregular", right_hand(), make_plane(kWidthA, 60, 1, 6), {}, 6),
          on_two_triangles(),
          far_away(),
          without_joints(),
          without_palm(),
          on_tiny_triangles(),
          on_needles(),
          in_grasp("mug", make_mug({}), 0.037, 0.095),
          in_grasp("box", raised(make_box({0.07, 0.07, 0.095}, 1), 0.0475), 0.037, 0.095),
          in_grasp("sphere", raised(make_sphere(0.045, 24), 0.0475), 0.037, 0.095)};
}

// Errors of one rung over a trial's poses, as shares.
struct Errors {
  std::vector<double> hand, segment, torque;
  std::size_t touching = 0;
};
double at_share(std::vector<double>& errors, double share) {
  std::sort(errors.begin(), errors.end());
  const double last = static_cast<double>(errors.size() - 1);
  return errors[static_cast<std::size_t>(share * last)];
}

void add_errors(const HandForces& exact, const HandForces& sampled, double arm, Errors& errors) {
  const double size = force_size(exact);
  if (size < 0.5) return;  // a graze
  Vec3 difference, torque;
  double segment = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Vec3 off = sampled.segment[i].force - exact.segment[i].force;
    difference += off;
    segment = std::max(segment, norm(off));
    torque += sampled.segment[i].torque - exact.segment[i].torque;
  }
  EXPECT_TRUE(is_finite(size) && is_finite(difference) && is_finite(torque)) << "sorting would lose it";
  errors.hand.push_back(norm(difference) / size);
  errors.segment.push_back(segment / size);
  errors.torque.push_back(norm(torque) / (size * arm));
}

// Of any segment [N m].
double worst_torque(const HandForces& sampled, const HandForces& exact) {
  double worst = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    worst = largest(worst, norm(sampled.segment[i].torque - exact.segment[i].torque));
  return worst;
}

TEST(SampledRung, StaysWithinItsPrecisionOnFieldsAndPlanesFarAwayAndWithMissingParts) {
  for (const Trial& trial : all_trials()) {
    FeelingHand exact(trial.scene, 0);
    std::vector<ActuatorFrame> right;
    for (const DeviceFrame& frame : trial.frames) right.push_back(exact(frame));
    for (const double precision : trial.precisions) {
      SCOPED_TRACE(trial.name + " at " + std::to_string(precision));
      FeelingHand hand(trial.scene, precision);
      Errors errors;
      for (std::size_t i = 0; i < right.size(); ++i) {
        const ActuatorFrame felt = hand(trial.frames[i]);
        EXPECT_EQ(felt.flags & kCandidateOverflow, 0u);
        add_errors(right[i], felt, 0.05, errors);
      }
      EXPECT_GT(errors.hand.size(), right.size() / 3);
      for (auto* all : {&errors.hand, &errors.segment, &errors.torque}) std::sort(all->begin(), all->end());
      // Single precision: of 1e-5 twice that counts.
      const double allowed = std::max(precision, 2e-5);
      EXPECT_LE(at_share(errors.hand, 0.98), allowed);
      EXPECT_LE(at_share(errors.hand, 1), 5 * allowed);
      EXPECT_LE(at_share(errors.segment, 0.98), 1.5 * allowed);
      EXPECT_LE(at_share(errors.torque, 0.98), 3 * allowed);
    }
  }
}

// Where two tiles part a cell, what either feels acts on its own side of the border.
TEST(SampledRung, SegmentsOfStronglyBentFingersKeepThePrecisionInTheirTorques) {
  constexpr double kArm = 0.03;
  const Scene scene = sampled_scene(right_hand(), pressed_scene(kWidthA, 29).objects);
  const std::vector<DeviceFrame> frames = dropped(scene, {0.8, 1.7, 0.2, 0.04}, 15);
  FeelingHand exact(scene, 0), by_4_digits(scene, 1e-4), by_5_digits(scene, 1e-5);
  std::vector<double> coarse, fine;
  for (const DeviceFrame& frame : frames) {
    const ActuatorFrame right = exact(frame);
    const double size = force_size(right) * kArm;
    if (size < 0.5 * kArm) continue;
    coarse.push_back(worst_torque(by_4_digits(frame), right) / size);
    fine.push_back(worst_torque(by_5_digits(frame), right) / size);
  }
  EXPECT_GT(fine.size(), frames.size() / 2);
  EXPECT_LE(at_share(coarse, 0.98), 5e-5);
  EXPECT_LE(at_share(fine, 0.98), 1e-5);
}

// A strip across a bent finger, between its first phalanx and its last.
TEST(SampledRung, ABentFingersTipKeepsItsForceWhereItLooksAtTheFirstPhalanx) {
  const Hand hand = default_hand(Side::right);
  std::array<double, kAngleCount> angles{};
  for (std::size_t k = 1; k < 4; ++k) angles[4 + k] = k == 1 ? 0.2 : hand.finger[1].limit[k].upper;
  std::array<Pose, kJointCount> joint;
  forward_kinematics(hand, {}, angles, joint);
  DeviceFrame frame;
  frame.valid = 0;
  for (const int j : {kIndexProximal, kIndexIntermediate, kIndexDistal, kIndexTip}) {
    frame.joint[j] = to_joint_pose(joint[j]);
    frame.valid |= 1u << j;
  }
  const Vec3 tip = joint[kIndexTip].position, across = rotate(joint[kIndexTip].orientation, {1, 0, 0});
  double felt = 0;
  for (const double along : {0.6, 0.8, 1.0}) {
    const Vec3 on_first = joint[kIndexProximal].position +
                          along * (joint[kIndexIntermediate].position - joint[kIndexProximal].position);
    const Vec3 away = (tip - on_first) / norm(tip - on_first), aside = cross(away, across);
    const Vec3 skin = tip - (hand.radius[kIndexTip] - 0.0007) * away;
    for (const double width : {0.002, 0.005, 0.009}) {
      Mesh strip;
      strip.vertices = {skin - 0.1 * across - width * aside, skin - 0.1 * across + width * aside,
                        skin + 0.1 * across + width * aside};
      strip.triangles = {{0, 1, 2}};
      const Scene scene = sampled_scene(hand, {{"strip", strip}});
      const ActuatorFrame exact = FeelingHand(scene, 0)(frame), sampled = FeelingHand(scene, 1e-4)(frame);
      for (std::size_t i = 3; i < 6; ++i) {
        EXPECT_LE(norm(sampled.segment[i].force - exact.segment[i].force), 3e-4 * force_size(exact))
            << "segment " << i << ", " << along << ", " << width;
      }
      felt += norm(exact.segment[5].force);
    }
  }
  EXPECT_GT(felt, 0.1);
}

// Thin where they bend, so far that what is thick of one phalanx lies in its neighbour.
TEST(SampledRung, AFingerThatFoldsIntoItselfIsFeltAsExactly) {
  Random random(37);
  std::size_t felt = 0;
  for (int i = 0; i < 60; ++i) {
    Hand hand = plain_hand(0.008);
    std::array<Vec3, 4> joint{};
    for (std::size_t k = 0; k < 4; ++k) {
      hand.radius[kIndexProximal + k] =
          k % 2 == 0 ? random.between(0.008, 0.02) : random.between(0.004, 0.008);
      const Vec3 away = random.direction();
      if (k > 0) joint[k] = joint[k - 1] + random.between(0.022, 0.04) * away;
    }
    const Vec3 aside = random.in_box(0.01) - joint[1];
    for (Vec3& p : joint) p += aside;
    const Scene scene = sampled_scene(hand, {{"plane", make_plane(0.16, 160)}});
    const DeviceFrame frame = finger_frame(joint);
    const Vec3 exact = total_force(FeelingHand(scene, 0)(frame)),
               sampled = total_force(FeelingHand(scene, 1e-4)(frame));
    felt += norm(exact) > 1;
    EXPECT_LE(norm(sampled - exact), 1e-4 * norm(exact) + 1e-5) << i;
  }
  EXPECT_GT(felt, 50u);
}

// A phalanx of no length, or one whose larger end holds the other: a sphere, which points no way. One that is
// nearly that, behind which lies much of its neighbour.
TEST(SampledRung, AFingerOfWhichAPhalanxIsASphereOrNearlyIsFeltAsExactly) {
  struct Shape {
    std::array<double, 3> length;  // [mm]
    std::array<double, 4> radius;  // [mm]
  };
  const Shape shapes[] = {
      {{40, 0, 25}, {8, 8, 8, 8}},    {{0, 40, 25}, {8, 8, 8, 8}},    {{40, 25, 0}, {8, 8, 8, 8}},
      {{0, 0, 40}, {8, 8, 8, 8}},     {{3.9, 30, 20}, {12, 8, 8, 7}}, {{30, 3, 20}, {9, 8, 12, 9}},
      {{30, 20, 3}, {8, 8, 8, 12}},   {{30, 3, 20}, {8, 9, 11.9, 8}}, {{30, 3, 20}, {8, 11.9, 9, 8}},
      {{30, 20, 3}, {8, 8, 9, 11.9}}, {{3, 30, 20}, {11.9, 9, 8, 7}}, {{27, 4.3, 33}, {6.6, 7, 11.2, 9.7}}};
  Random random(31);
  for (const Shape& shape : shapes) {
    Hand hand = plain_hand(0.001 * shape.radius[0]);
    for (std::size_t k = 0; k < 4; ++k) hand.radius[kIndexProximal + k] = 0.001 * shape.radius[k];
    for (int i = 0; i < 6; ++i) {
      const Quat turn = random.rotation();
      const double bend = i < 2 ? 0 : random.between(0, 0.8);
      std::array<Vec3, 4> joint{Vec3{-0.03, 0, 0.004}};
      for (std::size_t k = 0; k < 3; ++k) {
        const double angle = static_cast<double>(k) * bend;
        joint[k + 1] = joint[k] + 0.001 * shape.length[k] * Vec3{std::cos(angle), std::sin(angle), 0};
      }
      Mesh plane = make_plane(0.16, 160);
      for (Vec3& p : plane.vertices) p = rotate(turn, p);
      for (Vec3& p : joint) p = rotate(turn, p);
      const Scene scene = sampled_scene(hand, {{"plane", plane}});
      const DeviceFrame frame = finger_frame(joint);
      const Vec3 exact = total_force(FeelingHand(scene, 0)(frame)),
                 sampled = total_force(FeelingHand(scene, 1e-4)(frame));
      EXPECT_GT(norm(exact), 1);
      EXPECT_LE(norm(sampled - exact), 1e-4 * norm(exact))
          << shape.length[0] << ", " << shape.length[1] << ", " << shape.length[2] << ", " << i;
    }
  }
}

// Patches go by the hand's radii: none of them may have all be cut as small as the point is.
TEST(SampledRung, FingertipsThatAreNearlyPointsAreFeltAtAHandsPrice) {
  Scene scene = sampled_scene(default_hand(Side::right), {{"plane", make_plane(0.3, 1)}});
  Random random(37);
  for (const double radius : {1e-4, 1e-6}) {
    for (const Joint tip : {kThumbTip, kIndexTip, kMiddleTip, kRingTip}) scene.hand.radius[tip] = radius;
    FeelingHand exact(scene, 0), sampled(scene, 1e-4);
    for (int i = 0; i < 10; ++i) {
      const DeviceFrame frame =
          dropped_hand(scene.hand, random, 0, 0.6, 0.2, random.between(0.003, 0.006), 0.03);
      const ActuatorFrame truth = exact(frame), felt = sampled(frame);
      ASSERT_GT(force_size(truth), 0.01);
      EXPECT_LE(norm(total_force(felt) - total_force(truth)), 1e-4 * force_size(truth)) << radius;
      EXPECT_LE(felt.evaluations, 50000u) << radius;
    }
  }
}

// A finger's segments share out space, which no two rungs can do together.
TEST(SampledRung, AFingerIsExactOfWhichAnySegmentIsOrFollowsAnotherLaw) {
  const Hand hand = default_hand(Side::right);
  for (std::size_t segment : {3u, 4u, 5u}) {
    for (const bool by_law : {false, true}) {
      Scene scene = sampled_scene(hand, {{"field", make_height_field(0.3, 40, 0.002, 0.04)}});
      scene.settings.precision.fill(0);
      if (by_law) scene.settings.law[segment] = Law::column;
      const Model exact = model_of(scene, {});
      scene.settings.precision.fill(1e-4);
      if (!by_law) scene.settings.precision[segment] = 0;
      const Model mixed = model_of(scene, {});
      Scratch of_exact = make_scratch(exact), of_mixed = make_scratch(mixed);
      double felt = 0;
      for (const DeviceFrame& frame : draped(hand, 17)) {
        State one, other;
        const ActuatorFrame wanted = tick(exact, one, of_exact, frame),
                            output = tick(mixed, other, of_mixed, frame);
        for (std::size_t i = 0; i < kSegmentCount; ++i) {
          const Vec3 off = output.segment[i].force - wanted.segment[i].force;
          EXPECT_LE(norm(off), i >= 3 && i <= 5 ? 0 : 3e-4 * force_size(wanted)) << "segment " << i;
        }
        for (std::size_t i = 3; i <= 5; ++i) felt += norm(wanted.segment[i].force);
      }
      EXPECT_GT(felt, 1);
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
