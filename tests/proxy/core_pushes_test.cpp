// What segments feel of a push near a joint: shares that no slide makes step, and that no joint's torque
// knows of.
#include "proxy/core_pushes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "largest.h"
#include "lumbrical/motion.h"
#include "proxied_session.h"
#include "proxy/proxy_hand.h"
#include "random.h"
#include "stages/hand_pose.h"
#include "stages/joint_torques.h"

namespace lumbrical {
namespace {

using test::largest;

constexpr std::size_t kFirst = 3;  // of the index finger's segments
constexpr double kPush = 10;       // [N]

/// The index finger alone and its wrist, bent, its middle joint at a place. Its back is below.
Joints index_finger(Vec3 place, double bend) {
  std::array<double, kAngleCount> angles{};
  angles[5] = -0.5 * bend;
  angles[6] = bend;
  angles[7] = 0.1;
  Joints finger;
  const Quat back_down{0.05 * std::sqrt(0.5), 0.05 * std::sqrt(0.5), std::sqrt(0.5), -std::sqrt(0.5)};
  forward_kinematics(default_hand(Side::right), {{}, normalized(back_down)}, angles, finger.pose);
  const Vec3 shift = place - finger.position(kIndexIntermediate);
  for (Pose& pose : finger.pose) pose.position += shift;
  for (const int joint :
       {int{kWrist}, int{kIndexProximal}, int{kIndexIntermediate}, int{kIndexDistal}, int{kIndexTip}})
    finger.valid |= 1u << joint;
  return finger;
}

/// [N], [N m] Of each of the finger's segments; torques about its middle joint.
struct Felt {
  std::array<Vec3, 3> force, torque;
};
Felt felt(const Joints& finger, std::size_t segment, double along) {
  const auto [base, tip] = kPhalanxJoints[segment];
  Gap gap;
  gap.segment = static_cast<std::uint8_t>(segment);
  gap.point = finger.position(base) + along * (finger.position(tip) - finger.position(base));
  gap.normal = {0.6, 0, 0.8};
  gap.push = kPush;
  gap.stiffness = 1000;
  PushList pushing;
  list_pushes(default_hand(Side::right), finger, std::vector<Gap>{gap}, pushing);
  Felt sum;
  double stiffness = 0;
  for (const Gap& push : pushing) {
    EXPECT_GT(push.push, 0);
    const Vec3 force = push.push * push.normal;
    sum.force[push.segment - kFirst] += force;
    sum.torque[push.segment - kFirst] += cross(push.point - finger.position(kIndexIntermediate), force);
    stiffness += push.stiffness;
  }
  EXPECT_NEAR(stiffness, 1000, 1e-9);
  return sum;
}

TEST(CorePushes, AreSharedSoThatNoJointsTorqueChanges) {
  const Joints finger = index_finger({0.1, 0.2, 0.3}, 0.7);
  const Vec3 force = kPush * Vec3{0.6, 0, 0.8};
  for (std::size_t segment = kFirst; segment < kFirst + 3; ++segment) {
    const auto [base, tip] = kPhalanxJoints[segment];
    for (double along = 0; along <= 1; along += 1.0 / 64) {
      const Felt parts = felt(finger, segment, along);
      // The forces beyond each joint of the finger have the moment about it that the whole push has, if it is
      // beyond.
      for (std::size_t joint = 0; joint < 3; ++joint) {
        const Vec3 pivot = finger.position(kPhalanxJoints[kFirst + joint].base);
        Vec3 moment;
        for (std::size_t i = joint; i < 3; ++i)
          moment += parts.torque[i] + cross(finger.position(kIndexIntermediate) - pivot, parts.force[i]);
        const Vec3 point = finger.position(base) + along * (finger.position(tip) - finger.position(base));
        const Vec3 whole = kFirst + joint <= segment ? cross(point - pivot, force) : Vec3{};
        EXPECT_NEAR(norm(moment - whole), 0, 1e-14) << segment << " at " << along << " about " << joint;
      }
      EXPECT_NEAR(norm(parts.force[0] + parts.force[1] + parts.force[2] - force), 0, 1e-13);
    }
  }
}

TEST(CorePushes, AtAJointAreTheSameWhicheverSegmentsGapItIs) {
  const Joints finger = index_finger({0.1, 0.2, 0.3}, 0.7);
  for (std::size_t segment = kFirst; segment < kFirst + 2; ++segment) {
    const Felt inner = felt(finger, segment, 1), outer = felt(finger, segment + 1, 0);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(norm(inner.force[i] - outer.force[i]), 0, 1e-12) << segment << ", " << i;
      EXPECT_NEAR(norm(inner.torque[i] - outer.torque[i]), 0, 1e-12) << segment << ", " << i;
    }
    EXPECT_NEAR(norm(inner.force[segment - kFirst]), 0.5 * kPush, 1e-12);
  }
}

// By some 5 um at a time, a thousandth of a core's radius, from the first joint to the fingertip.
TEST(CorePushes, ChangeWithThePlaceAndNeverStep) {
  const Joints finger = index_finger({0.1, 0.2, 0.3}, 0.7);
  Felt before = felt(finger, kFirst, 0);
  for (std::size_t segment = kFirst; segment < kFirst + 3; ++segment) {
    for (double along = 0; along <= 1; along += 1.0 / 8192) {
      const Felt now = felt(finger, segment, along);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LT(norm(now.force[i] - before.force[i]), 2e-3 * kPush) << segment << " at " << along;
        EXPECT_LT(norm(now.torque[i] - before.torque[i]), 2e-5 * kPush) << segment << " at " << along;
      }
      before = now;
    }
  }
}

DeviceFrame frame_of(const Joints& joints) {
  DeviceFrame frame;
  frame.valid = joints.valid;
  for (std::size_t i = 0; i < kJointCount; ++i) frame.joint[i] = to_joint_pose(joints.pose[i]);
  return frame;
}

// A finger, pressed by 12 mm, drawn over the edge of a box by 0.1 mm a tick so that a joint passes the edge:
// the finger's force hardly changes, nor may that of its segments.
TEST(CorePushes, PassFromSegmentToSegmentAsAJointSlidesOverAnEdge) {
  Mesh box = make_box({0.2, 0.1, 0.1}, 7);
  const double cosine = std::sqrt(0.5);  // of an eighth of a turn
  place_mesh({{0, 0, -0.1 * cosine}, normalized({1 + cosine, cosine, 0, 0})}, box);
  Scene scene = test::proxy_scene(std::move(box));
  scene.hand.radius = default_hand(Side::right).radius;
  for (const double bend : {-0.2, 0.0, 0.2}) {
    test::Session run(scene);
    HandForces before;
    double most = 0, of_segment = 0, of_finger = 0;
    for (int i = 0; i < 440; ++i) {
      const double pressed = 1e-4 * min(i, 120), slid = 1e-4 * max(0, i - 200);
      const Vec3 place{0.0013, slid - 0.012, scene.hand.radius[kIndexIntermediate] - pressed};
      const HandForces now = test::feel(run, frame_of(index_finger(place, bend)));
      Vec3 sum, sum_before;
      for (std::size_t s = kFirst; i > 200 && s < kFirst + 3; ++s) {
        of_segment = largest(of_segment, norm(now.segment[s].force - before.segment[s].force));
        sum += now.segment[s].force;
        sum_before += before.segment[s].force;
      }
      of_finger = largest(of_finger, norm(sum - sum_before));
      most = largest(most, norm(sum));
      before = now;
    }
    EXPECT_GT(most, 15) << bend;
    EXPECT_LT(of_segment, of_finger + 0.25) << bend;
  }
}

// ---- What segments hand on ----

/// The index finger's pushes in one tick, and what its segments feel of them.
struct HandedOn {
  Primitives hand;
  ProxyState kept;
  HandForces felt;

  explicit HandedOn(const Joints& finger) {
    place_hand(default_hand(Side::right), {}, finger, {}, hand);
    place_axes(hand);
  }
  /// [N] On a segment, at its middle.
  void feel(std::size_t segment, Vec3 push, bool anew = false) {
    Gap gap;
    const auto [base, tip] = kPhalanxJoints[segment];
    gap.segment = static_cast<std::uint8_t>(segment);
    gap.point = 0.5 * (hand.joints.position(base) + hand.joints.position(tip));
    gap.push = norm(push);
    gap.normal = push / norm(push);
    PushList pushing;
    pushing.push_back(gap);
    felt = {};
    add_pushes(pushing, hand, felt);
    const auto torques = felt.joint_torque;
    hand_on(pushing, hand, 1000, anew, kept, felt);
    sum_joint_torques(hand, felt);
    for (std::size_t i = 0; i < kSegmentCount; ++i)
      EXPECT_NEAR(norm(felt.joint_torque[i] - torques[i]), 0, 1e-14) << i;
    EXPECT_NEAR(norm(total() - push), 0, 1e-13);
  }
  [[nodiscard]] Vec3 total() const {
    Vec3 sum;
    for (const Wrench& wrench : felt.segment) sum += wrench.force;
    return sum;
  }
  [[nodiscard]] Vec3 on(std::size_t segment) const { return felt.segment[segment].force; }
};

constexpr Vec3 kUpwards{0, 0, kPush};

TEST(CorePushes, ThatHopBetweenSegmentsAreHandedOnInTimeAtTheSameJointTorques) {
  HandedOn finger(index_finger({0.1, 0.2, 0.3}, 0.7));
  finger.feel(kFirst + 2, kUpwards);
  Vec3 before = finger.on(kFirst);
  double most = 0;
  for (int i = 0; i < 200; ++i) {
    finger.feel(kFirst, kUpwards);
    most = largest(most, norm(finger.on(kFirst) - before));
    before = finger.on(kFirst);
  }
  EXPECT_LT(most, 0.051 * kPush);
  EXPECT_NEAR(norm(before - kUpwards), 0, 1e-3 * kPush);
}

TEST(CorePushes, OfWhatComesAndGoesAreFeltWhereTheyAreAtOnce) {
  HandedOn finger(index_finger({0.1, 0.2, 0.3}, 0.7));
  finger.feel(kFirst + 2, kUpwards);
  EXPECT_NEAR(norm(finger.on(kFirst + 2) - kUpwards), 0, 1e-13) << "from nothing";
  finger.feel(kFirst + 2, 0.2 * kUpwards);
  EXPECT_NEAR(norm(finger.on(kFirst + 2) - 0.2 * kUpwards), 0, 1e-13) << "most of it gone";
  finger.feel(kFirst, -kUpwards);
  EXPECT_NEAR(norm(finger.on(kFirst) + kUpwards), 0, 1e-13) << "from the other side";
}

TEST(CorePushes, OfAnotherHandAreHandedOnAtOnce) {
  HandedOn finger(index_finger({0.1, 0.2, 0.3}, 0.7));
  finger.feel(kFirst + 2, kUpwards);
  finger.feel(kFirst, kUpwards, true);
  EXPECT_EQ(finger.on(kFirst).z, kPush);
  EXPECT_EQ(norm(finger.on(kFirst + 1)) + norm(finger.on(kFirst + 2)), 0);
}

TEST(CorePushes, AreHandedToNoSegmentThatTrackingHasLostButOnByTheOthers) {
  HandedOn finger(index_finger({0.1, 0.2, 0.3}, 0.7));
  finger.hand.present[kFirst + 2] = false;
  finger.feel(kFirst + 1, kUpwards);
  finger.feel(kFirst, kUpwards);
  EXPECT_NEAR(finger.on(kFirst + 1).z, 0.95 * kPush, 1e-9);
  EXPECT_EQ(norm(finger.on(kFirst + 2)), 0);
}

TEST(CorePushes, ThatPadsLetLittleOfThroughLeaveNoMoreBehind) {
  HandedOn finger(index_finger({0.1, 0.2, 0.3}, 0.7));
  finger.feel(kFirst + 2, kUpwards);
  Gap gap;
  gap.segment = kFirst;
  gap.normal = {0, 0, 1};
  gap.push = kPush;
  PushList pushing;
  pushing.push_back(gap);
  HandForces damped;
  damped.segment[kFirst].force = 0.3 * kUpwards;
  hand_on(pushing, finger.hand, 1000, false, finger.kept, damped);
  EXPECT_NEAR(damped.segment[kFirst].force.z, 0, 1e-12);
  EXPECT_NEAR(damped.segment[kFirst + 2].force.z, 0.3 * kPush, 1e-12);
}

}  // namespace
}  // namespace lumbrical
