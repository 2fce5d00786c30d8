// The hand model and its forward kinematics.
#include <limits>
#include <string>

#include "hand_poses.h"

namespace lumbrical::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

// A hand whose fingers are all straight chains along -z from the wrist, with wide limits.
Hand plain_hand(Side side) {
  Hand hand = default_hand(side);
  for (Finger& finger : hand.finger) {
    finger.base = Pose{};
    finger.bone_length = {0.06, 0.04, 0.03, 0.02};
    finger.limit.fill({-kPi, kPi});
  }
  hand.finger[0].bone_length[0] = 0;
  return hand;
}

TEST(Names, AreThoseOfTheJointsAndSegments) {
  EXPECT_EQ(joint_name(kPalm), "palm");
  EXPECT_EQ(joint_name(kThumbMetacarpal), "thumb metacarpal");
  EXPECT_EQ(joint_name(kIndexIntermediate), "index intermediate");
  EXPECT_EQ(joint_name(kLittleTip), "little tip");
  EXPECT_EQ(segment_name(0), "thumb metacarpal");
  EXPECT_EQ(segment_name(3), "index proximal");
  EXPECT_EQ(segment_name(14), "little distal");
  EXPECT_EQ(segment_name(kPalmSegment), "palm");
  EXPECT_EQ(finger_name(3), "ring");
}

TEST(Names, OfWhatDoesNotExistSaySo) {
  EXPECT_EQ(joint_name(-1), "no joint");
  EXPECT_EQ(joint_name(kJointCount), "no joint");
  EXPECT_EQ(segment_name(kSegmentCount), "no segment");
  EXPECT_EQ(finger_name(kFingerCount), "no finger");
}

TEST(QuatFromAxes, TurnsTheUnitVectorsIntoTheAxes) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    Quat q = random.pose(1).orientation;
    if (i % 4 == 1)
      q = normalized({1e-9 * q.w, q.x, q.y, q.z});  // half turns, where the trace is at its least
    if (i % 4 == 2) q = normalized({0, q.x, 1e-12 * q.y, 0});
    const Vec3 x = rotate(q, {1, 0, 0}), y = rotate(q, {0, 1, 0}), z = rotate(q, {0, 0, 1});
    const Quat found = quat_from_axes(x, y, z);
    EXPECT_NEAR(dot(found, found), 1, 1e-14);
    expect_near(rotate(found, {1, 0, 0}), x, 1e-14);
    expect_near(rotate(found, {0, 1, 0}), y, 1e-14);
    expect_near(rotate(found, {0, 0, 1}), z, 1e-14);
  }
}

TEST(QuatFromAxes, IsAUnitQuaternionEvenForNonsense) {
  for (const Vec3 v : {Vec3{}, Vec3{1, 1, 1}, Vec3{kNotANumber, 0, 0}, Vec3{1e300, 1e300, 0}}) {
    const Quat q = quat_from_axes(v, v, v);
    EXPECT_NEAR(dot(q, q), 1, 1e-12);
  }
}

TEST(DefaultHand, PassesTheCheckOfHandsAtEverySize) {
  for (const Side side : {Side::left, Side::right}) {
    for (const double length : {0.12, 0.17, 0.19, 0.23}) {
      const Status status = check_hand(default_hand(side, length));
      EXPECT_TRUE(status.ok()) << status.message();
    }
  }
}

TEST(DefaultHand, HasTheLengthAskedFor) {
  for (const double length : {0.15, 0.19, 0.22}) {
    const Hand hand = default_hand(Side::right, length);
    const Poses poses = pose_hand(hand, Pose{}, Angles{});
    EXPECT_NEAR(norm(poses[kMiddleTip].position - poses[kWrist].position), length, 1e-12);
    EXPECT_NEAR(hand.radius[kIndexTip], 0.0066 * length / 0.19, 1e-12);
  }
}

TEST(DefaultHand, OfTheLeftMirrorsTheRightBitForBit) {
  Random random(2);
  const Hand right = default_hand(Side::right), left = default_hand(Side::left);
  EXPECT_EQ(right.radius, left.radius);
  for (int i = 0; i < 200; ++i) {
    const Angles angles = random_angles(random, right);
    const Poses r = pose_hand(right, Pose{}, angles), l = pose_hand(left, Pose{}, angles);
    for (int j = 0; j < kJointCount; ++j) {
      const Vec3 p = r[j].position;
      const Quat q = r[j].orientation;
      ASSERT_EQ(l[j].position, (Vec3{-p.x, p.y, p.z})) << joint_name(j);
      ASSERT_EQ(l[j].orientation, (Quat{q.w, q.x, -q.y, -q.z})) << joint_name(j);
    }
  }
}

TEST(DefaultHand, MirroredTwiceIsTheSame) {
  const Hand hand = default_hand(Side::right);
  const Hand twice = mirrored_hand(mirrored_hand(hand));
  EXPECT_EQ(twice.side, hand.side);
  EXPECT_EQ(twice.palm_joint, hand.palm_joint);
  EXPECT_EQ(twice.palm.polygon, hand.palm.polygon);
  for (int f = 0; f < kFingerCount; ++f) EXPECT_EQ(twice.finger[f].base, hand.finger[f].base);
}

TEST(DefaultHand, HasItsThumbOnTheThumbSide) {
  EXPECT_LT(pose_hand(default_hand(Side::right), Pose{}, Angles{})[kThumbTip].position.x, -0.05);
  EXPECT_GT(pose_hand(default_hand(Side::left), Pose{}, Angles{})[kThumbTip].position.x, 0.05);
}

TEST(DefaultHand, CanBringItsThumbToEveryFingertip) {
  const Hand hand = default_hand(Side::right);
  std::array<std::vector<Vec3>, kFingerCount> tips;
  constexpr int kSteps = 8;
  for (int code = 0; code < kSteps * kSteps * kSteps * kSteps; ++code) {
    Angles angles{};
    for (int i = 0, digits = code; i < 4; ++i, digits /= kSteps) {
      const double t = static_cast<double>(digits % kSteps) / (kSteps - 1);
      for (int f = 0; f < kFingerCount; ++f) {
        const AngleLimit limit = hand.finger[f].limit[i];
        angles[4 * f + i] = limit.lower + t * (limit.upper - limit.lower);
      }
    }
    const Poses poses = pose_hand(hand, Pose{}, angles);
    for (int f = 0; f < kFingerCount; ++f) {
      // Of a finger, only what its flexion reaches without spreading.
      if (f == 0 || code % kSteps == 3) tips[f].push_back(poses[kPhalanxJoints[3 * f + 2].tip].position);
    }
  }
  for (int f = 1; f < kFingerCount; ++f) {
    double least = 1;
    for (const Vec3 thumb : tips[0]) {
      for (const Vec3 finger : tips[f]) least = std::min(least, norm(thumb - finger));
    }
    EXPECT_LT(least, 0.010) << finger_name(f) << ": the two tips' radii add to 14 mm";
  }
}

TEST(DefaultHand, HasAPalmAsWideAsItsKnuckles) {
  const Hand hand = default_hand(Side::right);
  double low = 1, high = -1;
  for (const Vec3 corner : hand.palm.polygon) {
    EXPECT_EQ(corner.y, 0);
    low = std::min(low, corner.x);
    high = std::max(high, corner.x);
  }
  EXPECT_GT(high - low + hand.palm.thickness, 0.06);
  EXPECT_LT(high - low + hand.palm.thickness, 0.09);
}

TEST(ForwardKinematics, GoesStraightAheadAtZero) {
  const Poses poses = pose_hand(plain_hand(Side::right), Pose{}, Angles{});
  EXPECT_EQ(poses[kIndexMetacarpal].position, (Vec3{0, 0, 0}));
  expect_near(poses[kIndexProximal].position, {0, 0, -0.06}, 1e-15);
  expect_near(poses[kIndexIntermediate].position, {0, 0, -0.10}, 1e-15);
  expect_near(poses[kIndexDistal].position, {0, 0, -0.13}, 1e-15);
  expect_near(poses[kIndexTip].position, {0, 0, -0.15}, 1e-15);
  EXPECT_EQ(poses[kThumbMetacarpal].position, (Vec3{0, 0, 0}));
  expect_near(poses[kThumbTip].position, {0, 0, -0.09}, 1e-15);
}

TEST(ForwardKinematics, FlexesTowardsThePalm) {
  Angles angles{};
  angles[4 + 2] = kPi / 2;  // index, middle joint
  for (const Side side : {Side::left, Side::right}) {
    const Poses poses = pose_hand(plain_hand(side), Pose{}, angles);
    expect_near(poses[kIndexIntermediate].position, {0, 0, -0.10}, 1e-15);
    expect_near(poses[kIndexDistal].position, {0, -0.03, -0.10}, 1e-15);
    expect_near(poses[kIndexTip].position, {0, -0.05, -0.10}, 1e-15);
    EXPECT_EQ(poses[kIndexTip].orientation, poses[kIndexDistal].orientation);
    expect_near(rotate(poses[kIndexTip].orientation, {0, 1, 0}), {0, 0, -1}, 1e-15);
  }
}

TEST(ForwardKinematics, AddsUpTheFlexionOfTheJoints) {
  Angles angles{};
  angles[4 * 4 + 1] = kPi / 2;  // little finger: base, then middle joint
  angles[4 * 4 + 2] = kPi / 2;
  const Poses poses = pose_hand(plain_hand(Side::right), Pose{}, angles);
  expect_near(poses[kLittleIntermediate].position, {0, -0.04, -0.06}, 1e-15);
  expect_near(poses[kLittleDistal].position, {0, -0.04, -0.03}, 1e-15);
  expect_near(poses[kLittleTip].position, {0, -0.04, -0.01}, 1e-15);
}

TEST(ForwardKinematics, AbductsAwayFromTheMiddleFingerOnBothHands) {
  Angles angles{};
  for (int f = 0; f < kFingerCount; ++f) angles[4 * f] = 0.3;
  const Poses right = pose_hand(plain_hand(Side::right), Pose{}, angles);
  const Poses left = pose_hand(plain_hand(Side::left), Pose{}, angles);
  const double reach = 0.09 * std::sin(0.3);
  for (const int tip : {kIndexTip, kMiddleTip, kRingTip, kLittleTip}) {
    const double sign =
        tip == kIndexTip ? -1 : 1;  // a right hand's index is on its left; the middle goes to the ring
    EXPECT_NEAR(right[tip].position.x, sign * reach, 1e-15) << joint_name(tip);
    EXPECT_NEAR(left[tip].position.x, -sign * reach, 1e-15) << joint_name(tip);
  }
  // The real thumb lifts off the palm, to the palmar side.
  const Hand hand = default_hand(Side::right);
  Angles lifted{};
  lifted[0] = 0.5;
  const Poses before = pose_hand(hand, Pose{}, Angles{}), after = pose_hand(hand, Pose{}, lifted);
  EXPECT_LT(after[kThumbTip].position.y, before[kThumbTip].position.y - 0.02);
  EXPECT_GT(norm(after[kThumbTip].position - after[kIndexProximal].position),
            norm(before[kThumbTip].position - before[kIndexProximal].position));
}

TEST(ForwardKinematics, KeepsTheLengthOfEveryBone) {
  Random random(3);
  const Hand hand = default_hand(Side::left, 0.2);
  for (int i = 0; i < 200; ++i) {
    const Poses poses = pose_hand(hand, random.pose(1), random_angles(random, hand));
    for (int s = 0; s < kPhalanxCount; ++s) {
      const auto [base, tip] = kPhalanxJoints[s];
      const double length = norm(poses[tip].position - poses[base].position);
      ASSERT_NEAR(length, hand.finger[s / 3].bone_length[1 + s % 3], 1e-14) << segment_name(s);
    }
    for (const Pose& pose : poses) ASSERT_NEAR(dot(pose.orientation, pose.orientation), 1, 1e-13);
  }
}

TEST(ForwardKinematics, FollowsTheWristRigidly) {
  Random random(4);
  const Hand hand = default_hand(Side::right);
  for (int i = 0; i < 100; ++i) {
    const Pose wrist = random.pose(1), move = random.pose(1);
    const Angles angles = random_angles(random, hand);
    const Poses here = pose_hand(hand, wrist, angles), there = pose_hand(hand, move * wrist, angles);
    for (int j = 0; j < kJointCount; ++j) {
      const Pose expected = move * here[j];
      expect_near(there[j].position, expected.position, 1e-14);
      ASSERT_LT(turn_between(there[j].orientation, expected.orientation), 1e-7);
    }
  }
}

TEST(ForwardKinematics, ClampsAnglesToTheLimitsAndCountsThem) {
  const Hand hand = default_hand(Side::right);
  Angles beyond{}, at_limit{};
  beyond[4 + 1] = at_limit[4 + 1] = hand.finger[1].limit[1].upper;
  beyond[4 + 1] += 0.5;
  beyond[8 + 2] = -0.3;  // below the middle joint's 0
  Poses clamped;
  EXPECT_EQ(forward_kinematics(hand, Pose{}, beyond, clamped), 2);
  const Poses expected = pose_hand(hand, Pose{}, at_limit);
  EXPECT_EQ(clamped[kIndexTip], expected[kIndexTip]);
  EXPECT_EQ(clamped[kMiddleTip], expected[kMiddleTip]);
}

void expect_refused(const Hand& hand, const std::string& field) {
  const Status status = check_hand(hand);
  EXPECT_FALSE(status.ok()) << field;
  EXPECT_NE(status.message().find(field), std::string::npos) << status.message();
}

TEST(CheckHand, NamesTheFieldThatIsWrong) {
  const Hand good = default_hand(Side::right);
  Hand hand = good;
  hand.radius[kRingTip] = 0;
  expect_refused(hand, "radius of ring tip");
  for (const double radius : {5e-324, 2e252}) {  // no lattice has such steps
    hand = good;
    hand.radius[kIndexProximal] = radius;
    expect_refused(hand, "radius of index proximal");
  }
  hand = good;
  hand.radius[kPalm] = kNotANumber;
  expect_refused(hand, "radius of palm");
  hand = good;
  hand.finger[2].bone_length[1] = -0.01;
  expect_refused(hand, "middle finger: bone_length");
  hand = good;
  hand.finger[4].limit[2] = {1, 0};
  expect_refused(hand, "little finger: limit");
  hand = good;
  hand.finger[0].base.orientation = {0, 0, 0, 0};
  expect_refused(hand, "thumb finger: base");
  hand = good;
  hand.palm_joint.position.x = kNotANumber;
  expect_refused(hand, "palm_joint");
  hand = good;
  hand.palm.thickness = 0;
  expect_refused(hand, "palm.thickness");
  // Finite, but what is calculated from them would not be.
  for (const double far : {1001.0, 1e200, kNotANumber}) {
    hand = good;
    hand.finger[3].bone_length[2] = far;
    expect_refused(hand, "ring finger: bone_length");
    hand = good;
    hand.finger[1].base.position.z = -far;
    expect_refused(hand, "index finger: base");
    hand = good;
    hand.palm_joint.position.y = far;
    expect_refused(hand, "palm_joint");
    hand = good;
    hand.palm.height = -far;
    expect_refused(hand, "palm.height");
  }
}

TEST(CheckHand, RefusesPalmsThatAreNotFlatConvexPolygons) {
  Hand hand = default_hand(Side::right);
  const auto refuses = [&hand](std::vector<Vec3> polygon, const std::string& why) {
    hand.palm.polygon = std::move(polygon);
    expect_refused(hand, why);
  };
  refuses({{0, 0, 0}, {1, 0, 0}}, "2 corners");
  refuses(std::vector<Vec3>(17), "17 corners");
  refuses({{0, 0, 0}, {1, 0, 0}, {1, 0.1, 1}}, "not flat");
  refuses({{0, 0, 0}, {1, 0, 0}, {kNotANumber, 0, 1}}, "not within 1000 m");
  refuses({{0, 0, 0}, {1e200, 0, 0}, {0, 0, 1e200}}, "not within 1000 m");  // their products are no numbers
  refuses({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, "not convex");
  refuses({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 1}}, "not convex");
  refuses({{0, 0, 0}, {2, 0, 0}, {0.5, 0, 0.5}, {0, 0, 2}}, "not convex");
  std::vector<Vec3> star;  // turns the same way at every corner, twice round
  for (int i = 0; i < 5; ++i) star.push_back({std::cos(0.8 * kPi * i), 0, std::sin(0.8 * kPi * i)});
  refuses(star, "not convex");
}

TEST(CheckHand, TakesConvexPalmsOfEitherSenseAndNone) {
  Hand hand = default_hand(Side::right);
  hand.palm.polygon = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  EXPECT_TRUE(check_hand(hand).ok());
  std::reverse(hand.palm.polygon.begin(), hand.palm.polygon.end());
  EXPECT_TRUE(check_hand(hand).ok());
  hand.palm.polygon.clear();
  EXPECT_TRUE(check_hand(hand).ok());
}

}  // namespace
}  // namespace lumbrical::test
