// A finger as a whole: tiles and spheres share out space, depth goes through all phalanges, torques load the
// right joints.
#include <gtest/gtest.h>

#include <cmath>

#include "largest.h"
#include "lumbrical/probe.h"
#include "posed_finger.h"
#include "random.h"
#include "section/finger_depth.h"

namespace lumbrical {
namespace {

constexpr double kRadius = 0.0078125;  // a float, so that device frames are exact

struct Sum {
  double area = 0, volume = 0;
};

Sum sum_of(const std::vector<Contact>& contacts) {
  Sum sum;
  for (const Contact& contact : contacts) {
    sum.area += contact.area;
    sum.volume += contact.volume;
  }
  return sum;
}

// Joints of a finger lying over the plane z = 0, bent by the given angles in the plane of z and x.
std::array<Vec3, 4> bent_finger(double height, double tilt, double first, double second) {
  std::array<Vec3, 4> joint;
  joint[0] = {0.001, 0.002, height};
  const double length[3] = {0.040, 0.025, 0.020};
  double angle = tilt;
  for (std::size_t i = 0; i < 3; ++i) {
    joint[i + 1] = joint[i] + length[i] * Vec3{std::cos(angle), 0, std::sin(angle)};
    angle -= i == 0 ? first : second;
  }
  return joint;
}

TEST(Finger, StraightFingerCountsEveryPartOnceUnderEveryLaw) {
  const Mesh plane = make_plane(0.4, 25, 1);
  for (const double height : {0.0070, 0.0060, 0.0010}) {
    const auto joints = bent_finger(height, 0, 0, 0);
    const ProbePrimitive capsule{ProbeShape::capsule, joints[0], joints[3], kRadius, kRadius};
    for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid}) {
      std::vector<ProbeContact> expected;
      ASSERT_TRUE(probe(plane, std::span(&capsule, 1), law, 1, expected).ok());
      Sum whole;
      for (const ProbeContact& contact : expected) {
        whole.area += contact.area;
        whole.volume += contact.volume;
      }
      const Sum sum =
          sum_of(test::touch(test::plain_hand(kRadius), law, plane, test::finger_frame(joints)).contacts);
      EXPECT_NEAR(sum.area / whole.area, 1, 1e-6) << law_name(law);  // joints are rounded to float
      if (law == Law::field || law == Law::column) {
        EXPECT_NEAR(sum.volume / whole.volume, 1, 1e-5) << law_name(law);
      }
    }
  }
}

// Area and field of the union of the three capsules, by counting points.
Sum count_union(const std::array<Vec3, 4>& joints) {
  Sum sum;
  const double step = 1e-4;
  for (double x = -0.03; x < 0.12; x += step) {
    for (double y = -0.012; y < 0.016; y += step) {
      double deepest = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 axis = joints[i + 1] - joints[i], from = Vec3{x, y, 0} - joints[i];
        const double t = clamp(dot(from, axis) / dot(axis, axis), 0, 1);
        deepest = std::fmax(deepest, kRadius - norm(from - t * axis));
      }
      if (deepest > 0) sum.area += step * step;
      sum.volume += step * step * deepest;
    }
  }
  return sum;
}

// Bisecting planes share out space exactly between phalanges that are long against their radius; the last
// pose, bent by 86 degrees over a phalanx of two and a half radii, shows what they miss.
TEST(Finger, BentFingerIsTheUnionOfItsTiles) {
  const Mesh plane = make_plane(0.4, 25, 1);
  for (const auto& joints : {bent_finger(0.005, -0.1, -0.4, -0.5), bent_finger(-0.004, 0.3, 0.9, 0.3),
                             bent_finger(0.006, 0.0, 1.2, -0.3), bent_finger(0.002, 0.5, 1.5, 0.2)}) {
    const Sum expected = count_union(joints);
    const Sum sum = sum_of(
        test::touch(test::plain_hand(kRadius), Law::field, plane, test::finger_frame(joints)).contacts);
    EXPECT_NEAR(sum.area / expected.area, 1, 6e-3);
    EXPECT_NEAR(sum.volume / expected.volume, 1, 1e-3);
  }
}

TEST(Finger, BendingThroughAJointChangesTheFieldForceSmoothly) {
  const Mesh plane = make_plane(0.4, 12, 1);
  // phi changes by no more than the joints move: a step by no more than that times the area.
  const double motion = 0.003 * (0.025 + 0.020) + 0.0015 * 0.020;
  double previous = -1, worst = 0, most = 0, area = 0;
  for (int i = 0; i <= 600; ++i) {
    const double bend = -0.3 + 0.003 * i;  // hyper-extended to 86 degrees, 0.17 degrees at a time
    const Sum sum = sum_of(test::touch(test::plain_hand(kRadius), Law::field, plane,
                                       test::finger_frame(bent_finger(0.006, 0.05, bend, 0.5 * bend)))
                               .contacts);
    const double volume = sum.volume;
    area = test::largest(area, sum.area);
    if (previous >= 0) worst = test::largest(worst, std::fabs(volume - previous));
    most = test::largest(most, volume);
    previous = volume;
  }
  EXPECT_GT(most, 0);
  EXPECT_LT(worst, motion * area);
}

TEST(Finger, DepthRunsThroughTheWholeFinger) {
  // Poking straight down, 20 mm deep: the plane cuts the distal phalanx, the way out is the fingertip.
  const Mesh plane = make_plane(0.2, 1);
  const double deep = 0.015625;
  const std::array<Vec3, 4> joints = {Vec3{0, 0, 0.0625 - deep + kRadius}, Vec3{0, 0, 0.04 - deep + kRadius},
                                      Vec3{0, 0, 0.02 - deep + kRadius}, Vec3{0, 0, -deep + kRadius}};
  const test::Touch poke =
      test::touch(test::plain_hand(kRadius), Law::max_depth, plane, test::finger_frame(joints));
  ASSERT_FALSE(poke.contacts.empty());
  for (const Contact& contact : poke.contacts) EXPECT_NEAR(contact.depth, deep, 1e-8);
}

// A sphere's depth is told without a look at the phalanx where both have one surface.
TEST(Finger, DepthInAnEndSphereIsThatInItsPhalanx) {
  test::Random random(11);
  int touching = 0;
  for (int i = 0; i < 20000; ++i) {
    Primitives hand;
    hand.present[0] = true;
    Primitive& capsule = hand.capsule[0];
    capsule.end1 = random.in_box(0.1);
    capsule.end2 = capsule.end1 + random.between(0.005, 0.05) * random.direction();
    capsule.radius1 = random.between(0.005, 0.012);
    capsule.radius2 = random.between(0.005, 0.012);
    const bool first = random.below(2) == 0;
    const Vec3 centre = first ? capsule.end1 : capsule.end2, other = first ? capsule.end2 : capsule.end1;
    Primitive sphere = capsule, cut_capsule = capsule;
    sphere.end1 = sphere.end2 = centre;
    sphere.radius1 = sphere.radius2 = first ? capsule.radius1 : capsule.radius2;
    sphere.phalanx = {0, -1};
    sphere.cut_count = cut_capsule.cut_count = 1;
    sphere.cut[0] = cut_capsule.cut[0] = {unit_or(other - centre, {}), centre};
    const auto corner = [&] { return centre + random.in_box(random.between(0.002, 0.03)); };
    const Vec3 a = corner(), b = corner(), c = corner();
    Section section, whole;
    if (!look_from_plane(sphere, {a, b, c}, section) || classify(section) == Overlap::none) continue;
    const double depth = finger_depth(hand, sphere, section).depth;
    if (!(depth > 1e-6)) continue;
    ++touching;
    ASSERT_TRUE(look_from_plane(cut_capsule, {a, b, c}, whole));
    EXPECT_NEAR(depth, largest_depth(whole).depth, 1e-13) << i;
  }
  EXPECT_GT(touching, 4000);
}

TEST(Finger, EachContactLoadsItsJointAndAllTowardsTheWrist) {
  // Only the fingertip touches: the force F acts below the tip, so every joint's torque is lever times force.
  const Mesh plane = make_plane(0.2, 20, 1);
  const std::array<Vec3, 4> joints = {Vec3{-0.05, 0, 0.04}, Vec3{-0.02, 0, 0.055}, Vec3{0, 0, 0.03},
                                      Vec3{0.01, 0, kRadius - 0.002}};
  for (const Law law : {Law::field, Law::max_depth}) {
    const test::Touch tip = test::touch(test::plain_hand(kRadius), law, plane, test::finger_frame(joints));
    Vec3 force;
    std::array<Vec3, 3> torque{};
    Vec3 wrist;
    for (const Contact& contact : tip.contacts) {
      const Vec3 f = (2e7 * contact.volume) * contact.normal;
      force += f;
      for (std::size_t i = 0; i < 3; ++i) torque[i] += cross(contact.centre - joints[i], f);
      wrist += cross(contact.centre - (joints[0] + Vec3{-0.08, 0, 0}), f);
    }
    EXPECT_GT(force.z, 0.1);
    EXPECT_LT(norm(tip.output.segment[5].force - force), 1e-9);
    EXPECT_EQ(norm(tip.output.segment[3].force), 0);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(norm(tip.output.joint_torque[3 + i] - torque[i]), 1e-7);
    EXPECT_LT(norm(tip.output.joint_torque[kPalmSegment] - wrist), 1e-7);
    EXPECT_EQ(norm(tip.output.joint_torque[0]), 0);  // not the thumb's
    EXPECT_LT(tip.output.joint_torque[3].y, 0);      // a push from below lifts the finger about its base
  }
}

TEST(Finger, EveryResultTurnsWithTheWorld) {
  const Mesh plane = make_plane(0.2, 9, 1);
  test::Random random(5);
  const auto joints = bent_finger(0.006, -0.1, 0.3, 0.4);
  const test::Touch here =
      test::touch(test::plain_hand(kRadius), Law::field, plane, test::finger_frame(joints));
  for (int i = 0; i < 10; ++i) {
    const Pose X = random.pose(0.3);
    Mesh turned = plane;
    for (Vec3& p : turned.vertices) p = transform(X, p);
    DeviceFrame frame = test::finger_frame(joints);
    frame.base = X * frame.base;
    const test::Touch there = test::touch(test::plain_hand(kRadius), Law::field, turned, frame);
    for (std::size_t k = 0; k < kSegmentCount; ++k) {
      EXPECT_LT(norm(there.output.segment[k].force - rotate(X.orientation, here.output.segment[k].force)),
                1e-9);
      EXPECT_LT(norm(there.output.joint_torque[k] - rotate(X.orientation, here.output.joint_torque[k])),
                1e-10);
    }
  }
}

TEST(Finger, TellsTheDepthOfAContactWhenAsked) {
  const double deep = 0.002;
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = test::plain_hand(kRadius);
  scene.objects.push_back({"plane", make_plane(0.4, 40, 1)});
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  const double height = kRadius - deep;
  tick(model, state, scratch,
       test::finger_frame({{{0, 0, height}, {0.04, 0, height}, {0.065, 0, height}, {0.085, 0, height}}}));
  ASSERT_GT(scratch.contact_count, 10u);
  double deepest = 0;
  for (std::size_t i = 0; i < scratch.contact_count; ++i) EXPECT_EQ(scratch.contacts[i].depth, 0);
  for (const Contact& contact : find_contacts(model, scratch))
    deepest = test::largest(deepest, contact.depth);
  EXPECT_NEAR(deepest, deep, 1e-9);
}

}  // namespace
}  // namespace lumbrical
