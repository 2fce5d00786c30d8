// Hands and palms built from joint positions.
#include "model/hand_from_positions.h"

#include "hand_poses.h"

namespace lumbrical::test {
namespace {

// The points a tracker of 21 landmarks would deliver of these poses.
HandPoints landmarks_of(const Poses& poses, Side side) {
  HandPoints points;
  points.side = side;
  for (int j = 0; j < kJointCount; ++j) {
    const bool is_metacarpal =
        j == kIndexMetacarpal || j == kMiddleMetacarpal || j == kRingMetacarpal || j == kLittleMetacarpal;
    if (j == kPalm || is_metacarpal) continue;
    points.position[j] = poses[j].position;
    points.known |= 1u << j;
  }
  return points;
}

TEST(HandFromPositions, FindsWhatTheForwardKinematicsPosed) {
  Random random(5);
  for (const Side side : {Side::left, Side::right}) {
    const Hand hand = default_hand(side);
    for (int i = 0; i < 100; ++i) {
      const Poses truth = pose_hand(hand, random.pose(1), random_angles(random, hand));
      const Poses found = hand_from_positions(landmarks_of(truth, side));
      for (int j = 0; j < kJointCount; ++j) {
        EXPECT_LT(norm(found[j].position - truth[j].position), 0.012) << joint_name(j);
        EXPECT_NEAR(dot(found[j].orientation, found[j].orientation), 1, 1e-12);
        const double limit =
            j == kPalm || j == kWrist ? 0.25 : 0.9;  // a straight thumb that is spread is guessed worst
        EXPECT_LT(turn_between(found[j].orientation, truth[j].orientation), limit) << joint_name(j);
      }
      for (int s = 0; s < kPhalanxCount; ++s) {  // along the bone there is nothing to guess
        const auto [base, tip] = kPhalanxJoints[s];
        const Vec3 bone = unit_or(truth[tip].position - truth[base].position, {});
        expect_near(rotate(found[base].orientation, {0, 0, -1}), bone, 1e-9);
      }
    }
  }
}

TEST(HandFromPositions, MovesWithThePoints) {
  Random random(6);
  const Hand hand = default_hand(Side::right);
  for (int i = 0; i < 50; ++i) {
    const HandPoints points = landmarks_of(pose_hand(hand, Pose{}, random_angles(random, hand)), Side::right);
    const Pose move = random.pose(1);
    HandPoints moved = points;
    for (Vec3& p : moved.position) p = transform(move, p);
    const Poses here = hand_from_positions(points), there = hand_from_positions(moved);
    for (int j = 0; j < kJointCount; ++j) {
      expect_near(there[j].position, transform(move, here[j].position), 1e-12);
      EXPECT_LT(turn_between(there[j].orientation, move.orientation * here[j].orientation), 1e-6);
    }
  }
}

TEST(HandFromPositions, KeepsOneFlexionAxisPerBentFinger) {
  Angles angles{};
  for (int f = 1; f < kFingerCount; ++f) angles[4 * f + 1] = angles[4 * f + 2] = angles[4 * f + 3] = 0.6;
  const Poses truth = pose_hand(default_hand(Side::right), Pose{}, angles);
  const Poses found = hand_from_positions(landmarks_of(truth, Side::right));
  for (const int joint : {kIndexProximal, kMiddleProximal, kRingProximal, kLittleProximal}) {
    const Vec3 axis = rotate(found[joint].orientation, {1, 0, 0});
    expect_near(rotate(found[joint + 1].orientation, {1, 0, 0}), axis, 1e-2);
    expect_near(rotate(found[joint + 2].orientation, {1, 0, 0}), axis, 1e-2);
    EXPECT_GT(dot(axis, rotate(truth[joint].orientation, {1, 0, 0})), 0.99) << joint_name(joint);
  }
}

TEST(HandFromPositions, DerivesAWristWhereOnlyThePalmIsKnown) {
  const Poses truth = pose_hand(default_hand(Side::left), Pose{}, Angles{});
  HandPoints points = landmarks_of(truth, Side::left);
  points.known &= ~(1u << kWrist);
  points.position[kWrist] = {};
  points.forward = {0, 0, -1};
  points.dorsal = {0, 1, 0};
  EXPECT_LT(norm(hand_from_positions(points)[kWrist].position - truth[kWrist].position), 0.015);
  points.position[kMiddleMetacarpal] = truth[kMiddleMetacarpal].position;
  points.known |= 1u << kMiddleMetacarpal;
  EXPECT_LT(norm(hand_from_positions(points)[kWrist].position - truth[kWrist].position), 0.012);
}

TEST(HandFromPositions, IsFiniteWhateverThePointsAre) {
  Random random(7);
  for (int i = 0; i < 3000; ++i) {
    HandPoints points;
    points.side = i % 2 ? Side::left : Side::right;
    points.known = i % 3 == 0 ? 0 : static_cast<std::uint32_t>(random.bits()) & ((1u << kJointCount) - 1);
    for (Vec3& p : points.position) {
      const auto kind = random.below(4);
      p = kind == 0   ? Vec3{}
          : kind == 1 ? Vec3{0, 0, 1}
          : kind == 2 ? random.in_box(1e-320)
                      : random.in_box(1e4);
    }
    if (i % 5 == 0) points.forward = points.dorsal = {0, 1, 0};
    for (const Pose& pose : hand_from_positions(points)) {
      ASSERT_TRUE(is_finite(pose.position));
      ASSERT_NEAR(dot(pose.orientation, pose.orientation), 1, 1e-9);
    }
  }
}

TEST(FitPalmPolygon, IsConvexAndHoldsTheMetacarpals) {
  const Hand hand = default_hand(Side::right);
  const Poses poses = pose_hand(hand, Pose{{1, 2, 3}, {}}, Angles{});
  Hand fitted = hand;
  fitted.palm.polygon = fit_palm_polygon(poses, hand.radius, hand.palm.thickness);
  ASSERT_GE(fitted.palm.polygon.size(), 4u);
  const Status status = check_hand(fitted);
  EXPECT_TRUE(status.ok()) << status.message();
}

// The skin at the sides is where the knuckles' is, and no farther in front than the joints.
TEST(FitPalmPolygon, LiesHalfAThicknessInsideTheOutlineOfTheMetacarpals) {
  for (const double length : {0.19, 0.12}) {
    const Hand hand = default_hand(Side::right, length);
    const Poses poses = pose_hand(hand, inverse(hand.palm_joint), Angles{});
    const auto at = [&](int joint) { return poses[joint].position; };
    double left = 1, right = -1, front = 1;
    for (const Vec3 corner : hand.palm.polygon) {
      left = std::min(left, corner.x);
      right = std::max(right, corner.x);
      front = std::min(front, corner.z);
    }
    const double r = 0.5 * hand.palm.thickness;
    EXPECT_NEAR(left - r, at(kIndexProximal).x - hand.radius[kIndexProximal], 0.004);
    EXPECT_NEAR(right + r, at(kLittleProximal).x + hand.radius[kLittleProximal], 0.004);
    EXPECT_NEAR(front - r, at(kMiddleProximal).z, 0.004);
    EXPECT_GE(hand.palm.polygon.size(), 4u);
  }
}

// A palm so thick that nothing of the outline is that far inside.
TEST(FitPalmPolygon, KeepsACoreWhereThePalmIsThick) {
  const Hand hand = default_hand(Side::right);
  Hand thick = hand;
  thick.palm.thickness = 0.1;
  thick.palm.polygon = fit_palm_polygon(pose_hand(hand, Pose{}, Angles{}), hand.radius, thick.palm.thickness);
  EXPECT_GE(thick.palm.polygon.size(), 3u);
  EXPECT_TRUE(check_hand(thick).ok());
}

TEST(FitPalmPolygon, IsEmptyWhereAllJointsCoincide) {
  const std::array<double, kJointCount> radius{};
  EXPECT_TRUE(fit_palm_polygon(Poses{}, radius, 0.024).empty());
}

}  // namespace
}  // namespace lumbrical::test
