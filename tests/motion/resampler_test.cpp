// The resampler, the placing of motions, the hand that fits a motion, and the demo's grasp.
#include "lumbrical/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <random>

#include "largest.h"

namespace lumbrical {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double uniform(std::mt19937& random, double low,
               double high) {  // the same on every library, unlike the standard's
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

Quat random_rotation(std::mt19937& random) {
  return normalized(
      {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
}

DeviceFrame random_frame(std::mt19937& random, InputKind kind) {
  DeviceFrame frame;
  frame.kind = kind;
  frame.base = {{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)},
                random_rotation(random)};
  for (JointPose& joint : frame.joint) {
    for (float& coordinate : joint.position) coordinate = static_cast<float>(uniform(random, -0.2, 0.2));
    const Quat q = random_rotation(random);
    joint.orientation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
                         static_cast<float>(q.w)};
  }
  for (float& angle : frame.angle) angle = static_cast<float>(uniform(random, -0.3, 1.5));
  return frame;
}

// Samples 5 to 45 ms apart, as trackers deliver them.
Motion random_motion(unsigned seed, InputKind kind, int sample_count) {
  std::mt19937 random(seed);
  Motion motion;
  double time = 0;
  for (int i = 0; i < sample_count; ++i) {
    motion.samples.push_back({time, random_frame(random, kind)});
    time += uniform(random, 0.005, 0.045);
  }
  return motion;
}

Motion two_samples(double gap) {
  std::mt19937 random(1);
  Motion motion;
  motion.samples.push_back({0, random_frame(random, InputKind::joint_poses)});
  motion.samples.push_back({gap, random_frame(random, InputKind::joint_poses)});
  return motion;
}

bool is_between(double value, double a, double b) { return value >= min(a, b) && value <= max(a, b); }

double square(const std::array<float, 4>& q) {
  double sum = 0;
  for (const float component : q) sum += double{component} * double{component};
  return sum;
}

TEST(Resampler, GivesTheSamplesThemselvesAtTheirTimes) {
  for (const InputKind kind : {InputKind::joint_poses, InputKind::joint_angles}) {
    const Motion motion = random_motion(2, kind, 50);
    for (const MotionSample& sample : motion.samples) EXPECT_EQ(resample(motion, sample.time), sample.frame);
  }
}

TEST(Resampler, KeepsEveryCoordinateBetweenItsNeighbours) {
  const Motion motion = random_motion(3, InputKind::joint_poses, 40);
  for (std::size_t i = 0; i + 1 < motion.samples.size(); ++i) {
    const auto& [t0, a] = motion.samples[i];
    const auto& [t1, b] = motion.samples[i + 1];
    for (int step = 1; step < 20; ++step) {
      const DeviceFrame frame = resample(motion, t0 + (t1 - t0) * step / 20);
      EXPECT_EQ(frame.flags, 0u);
      EXPECT_TRUE(is_between(frame.base.position.x, a.base.position.x, b.base.position.x));
      EXPECT_NEAR(dot(frame.base.orientation, frame.base.orientation), 1, 1e-14);
      for (int j = 0; j < kJointCount; ++j) {
        for (int c = 0; c < 3; ++c) {
          ASSERT_TRUE(is_between(frame.joint[j].position[c], a.joint[j].position[c], b.joint[j].position[c]));
        }
        ASSERT_NEAR(square(frame.joint[j].orientation), 1, 1e-6);
      }
    }
  }
}

TEST(Resampler, KeepsAnglesBetweenTheirNeighbours) {
  const Motion motion = random_motion(4, InputKind::joint_angles, 40);
  for (std::size_t i = 0; i + 1 < motion.samples.size(); ++i) {
    const auto& [t0, a] = motion.samples[i];
    const auto& [t1, b] = motion.samples[i + 1];
    for (int step = 1; step < 20; ++step) {
      const DeviceFrame frame = resample(motion, t0 + (t1 - t0) * step / 20);
      EXPECT_EQ(frame.kind, InputKind::joint_angles);
      for (int k = 0; k < kAngleCount; ++k) ASSERT_TRUE(is_between(frame.angle[k], a.angle[k], b.angle[k]));
    }
  }
}

TEST(Resampler, FollowsAStraightMotionOfEvenSpeedExactlyEnough) {
  Motion motion;
  for (int i = 0; i <= 20; ++i) {
    DeviceFrame frame;
    frame.base.position = {0.1 * i, -0.2 * i, 5};
    motion.samples.push_back({0.02 * i, frame});
  }
  for (double time = 0.02; time < 0.38; time += 0.0007) {
    const Vec3 p = resample(motion, time).base.position;
    EXPECT_NEAR(p.x, 5 * time, 1e-12);
    EXPECT_NEAR(p.y, -10 * time, 1e-12);
    EXPECT_EQ(p.z, 5);
  }
}

TEST(Resampler, ChangesNeitherPlaceNorSpeedAtOnce) {
  const Motion motion = random_motion(5, InputKind::joint_poses, 30);
  constexpr double kStep = 1e-7;  // [s]
  double largest_jump = 0, largest_speed = 0;
  for (const MotionSample& sample : motion.samples) {
    const auto at = [&](double steps) { return resample(motion, sample.time + steps * kStep).base.position; };
    const Vec3 before = (at(0) - at(-1)) / kStep, after = (at(1) - at(0)) / kStep;
    largest_jump = test::largest(largest_jump, norm(after - before));
    largest_speed = test::largest(largest_speed, test::largest(norm(before), norm(after)));
  }
  EXPECT_GT(largest_speed, 10);  // the samples jump by up to 2 m in 5 ms
  EXPECT_LT(largest_jump, 0.1) << "the speed may change by acceleration (some 1e5 m/s^2) times 2e-7 s only";
}

TEST(Resampler, TurnsAlongTheShorterArc) {
  Motion motion = two_samples(0.02);
  const double s = std::sqrt(0.5);
  motion.samples[0].frame.base.orientation = {1, 0, 0, 0};
  motion.samples[1].frame.base.orientation = {-s, 0, 0, -s};  // 90 degrees about z, with the sign turned
  const Quat q = resample(motion, 0.01).base.orientation;
  EXPECT_NEAR(q.w, std::cos(std::atan(1.0) / 2), 1e-14);
  EXPECT_NEAR(q.z, std::sin(std::atan(1.0) / 2), 1e-14);
}

TEST(Resampler, HoldsAndFlagsWhatLiesBeyondTheSamples) {
  const Motion motion = two_samples(0.02);
  const auto expect_held = [&](double time, std::size_t i, std::uint32_t flags) {
    DeviceFrame expected = motion.samples[i].frame;
    expected.flags = flags;
    EXPECT_EQ(resample(motion, time), expected) << time;
  };
  const std::uint32_t lost = kExtrapolated | kTrackingLost;
  expect_held(-0.001, 0, kExtrapolated);
  expect_held(-0.2, 0, lost);
  expect_held(0.03, 1, kExtrapolated);
  expect_held(0.13, 1, lost);
  expect_held(kInfinity, 1, lost);
  expect_held(-kInfinity, 0, lost);
  expect_held(kNotANumber, 0, lost);
}

TEST(Resampler, FlagsGapsLongerThanAllowed) {
  EXPECT_EQ(resample(two_samples(0.09), 0.05).flags, 0u);
  EXPECT_EQ(resample(two_samples(0.11), 0.05).flags, std::uint32_t{kTrackingLost});
  ResamplerOptions options;
  options.max_gap = 0.5;
  EXPECT_EQ(resample(two_samples(0.11), 0.05, options).flags, 0u);
  EXPECT_EQ(resample(two_samples(0.11), 0, options).flags, 0u);
}

TEST(Resampler, TrustsNothingBetweenALostSampleAndAGoodOne) {
  Motion motion = random_motion(6, InputKind::joint_poses, 4);
  motion.samples[1].frame.flags = kTrackingLost;
  const auto flags_between = [&](std::size_t i) {
    return resample(motion, 0.5 * (motion.samples[i].time + motion.samples[i + 1].time)).flags;
  };
  EXPECT_EQ(flags_between(0), std::uint32_t{kTrackingLost});
  EXPECT_EQ(flags_between(1), std::uint32_t{kTrackingLost});
  EXPECT_EQ(flags_between(2), 0u);
}

TEST(Resampler, HasAJointValidOnlyWhereBothNeighboursHaveIt) {
  Motion motion = two_samples(0.02);
  motion.samples[0].frame.valid = 0b1101;
  motion.samples[1].frame.valid = 0b0111;
  EXPECT_EQ(resample(motion, 0.01).valid, 0b0101u);
}

TEST(Resampler, IsFiniteForEveryFiniteMotion) {
  std::mt19937 random(7);
  const std::array<double, 6> extremes = {0, -0.0, 1e-300, 1.7e308, -1.7e308, 3};
  for (int i = 0; i < 3000; ++i) {
    Motion motion;
    double time = 0;
    for (int k = 0; k < 4; ++k) {
      DeviceFrame frame;
      frame.base.position.x = extremes[random() % 6];
      frame.base.orientation = {extremes[random() % 6], extremes[random() % 6], 0, 0};
      for (JointPose& joint : frame.joint) {
        joint.position[0] =
            random() % 2 ? std::numeric_limits<float>::max() : -std::numeric_limits<float>::max();
        joint.orientation = {0, 0, 0, 0};
      }
      motion.samples.push_back({time, frame});
      time += random() % 3 ? uniform(random, 0, 1) + 1e-9 : random() % 2 ? 1e-300 + 1e-16 * time : 1e9;
    }
    const DeviceFrame frame =
        resample(motion, uniform(random, 0, 1.1) * motion.samples[1 + random() % 3].time);
    ASSERT_TRUE(is_finite(frame.base.position.x));
    const Quat q = frame.base.orientation;
    ASSERT_TRUE(is_finite(q.w) && is_finite(q.x) && is_finite(q.y) && is_finite(q.z));
    for (const JointPose& joint : frame.joint) {
      ASSERT_TRUE(is_finite(double{joint.position[0]}));
      ASSERT_TRUE(is_finite(square(joint.orientation)));
    }
  }
}

struct Fnv {
  std::uint64_t value = 14695981039346656037u;
  template <typename Bits>
  void add(Bits bits) {
    for (std::size_t i = 0; i < sizeof(Bits); ++i) {
      value = (value ^ static_cast<unsigned char>(bits >> (8 * i))) * 1099511628211u;
    }
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(float number) { add(std::bit_cast<std::uint32_t>(number)); }
};

void add_frame(const DeviceFrame& frame, Fnv& hash) {
  for (const double x : {frame.base.position.x, frame.base.position.y, frame.base.position.z}) hash.add(x);
  const Quat q = frame.base.orientation;
  for (const double x : {q.w, q.x, q.y, q.z}) hash.add(x);
  for (const JointPose& joint : frame.joint) {
    for (const float x : joint.position) hash.add(x);
    for (const float x : joint.orientation) hash.add(x);
  }
  for (const float x : frame.angle) hash.add(x);
}

TEST(Resampler, GivesTheSameBitsOnEveryMachine) {
  Fnv hash;
  for (const InputKind kind : {InputKind::joint_poses, InputKind::joint_angles}) {
    const Motion motion = random_motion(8, kind, 60);
    for (int tick = 0; tick < 1500; ++tick) add_frame(resample(motion, 0.001 * tick), hash);
  }
  EXPECT_EQ(hash.value, 17575958362350914168u);
}

TEST(Duration, IsThatOfTheSamples) {
  EXPECT_EQ(duration(Motion{}), 0);
  EXPECT_EQ(duration(two_samples(0.25)), 0.25);
}

TEST(Duration, HasTheTicksThatBeginBeforeItsEnd) {
  EXPECT_EQ(tick_count(2.01, 1000), 2010u) << "which is 2009.9999999999998 ticks";
  EXPECT_EQ(tick_count(0.0105, 1000), 11u);
  EXPECT_EQ(tick_count(0, 1000), 1u);
  for (std::uint64_t ticks = 1; ticks < 5000; ++ticks)
    EXPECT_EQ(tick_count(static_cast<double>(ticks) / 300, 300), ticks);
}

TEST(PlaceMotion, ScalesTheJointsAndThenMovesTheBase) {
  Motion motion = two_samples(0.02);
  motion.radius[kIndexTip] = 0.006;
  const Motion before = motion;
  std::mt19937 random(9);
  const MotionPlacement placement{{{1, 2, 3}, random_rotation(random)}, 0.5};
  ASSERT_TRUE(place_motion(placement, motion).ok());
  EXPECT_EQ(motion.radius[kIndexTip], 0.003);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(motion.samples[i].frame.base, placement.pose * before.samples[i].frame.base);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(motion.samples[i].frame.joint[5].position[c],
                0.5f * before.samples[i].frame.joint[5].position[c]);
    }
    EXPECT_EQ(motion.samples[i].frame.joint[5].orientation, before.samples[i].frame.joint[5].orientation);
  }
}

TEST(PlaceMotion, RefusesWhatMakesNoSenseAndLeavesTheMotion) {
  Motion motion = two_samples(0.02);
  const Motion before = motion;
  for (const double scale : {0.0, -1.0, kNotANumber, kInfinity, 1e300}) {
    EXPECT_FALSE(place_motion({Pose{}, scale}, motion).ok()) << scale;
  }
  EXPECT_FALSE(place_motion({{{kNotANumber, 0, 0}, {}}, 1}, motion).ok());
  EXPECT_FALSE(place_motion({{{}, {0, 0, 0, 0}}, 1}, motion).ok());
  EXPECT_EQ(motion.samples[1].frame, before.samples[1].frame);
  Motion angles = random_motion(10, InputKind::joint_angles, 3);
  EXPECT_FALSE(place_motion({Pose{}, 2}, angles).ok());
  EXPECT_TRUE(place_motion({Pose{{1, 0, 0}, {}}, 1}, angles).ok());
}

// One frame of joint poses of the default hand.
Motion posed_motion(Side side) {
  std::array<Pose, kJointCount> poses;
  forward_kinematics(default_hand(side), Pose{{1, 2, 3}, {}}, std::array<double, kAngleCount>{}, poses);
  DeviceFrame frame;
  for (int j = 0; j < kJointCount; ++j) {
    const auto& [p, q] = poses[j];
    frame.joint[j] = {
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
        {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)}};
  }
  Motion motion;
  motion.side = side;
  motion.samples.push_back({0, frame});
  return motion;
}

TEST(FitHand, TakesTheRadiiThatTheMotionKnows) {
  Motion motion = posed_motion(Side::right);
  motion.radius[kIndexTip] = 0.0123;
  const Hand hand = default_hand(Side::right), fitted = fit_hand(hand, motion);
  EXPECT_EQ(fitted.radius[kIndexTip], 0.0123);
  EXPECT_EQ(fitted.radius[kMiddleTip], hand.radius[kMiddleTip]);
  EXPECT_TRUE(check_hand(fitted).ok());
}

TEST(FitHand, FindsThePalmOfTheFirstFrameThatShowsIt) {
  Motion motion = posed_motion(Side::right);
  motion.samples.insert(motion.samples.begin(), 2, MotionSample{});  // all joints in one point: worthless
  motion.samples[0].frame.flags = kTrackingLost;
  motion.samples[1].frame.valid = 0;
  const Hand hand = default_hand(Side::right);
  Hand bare = hand;
  bare.palm.polygon.clear();
  const Hand fitted = fit_hand(bare, motion);
  ASSERT_EQ(fitted.palm.polygon.size(), hand.palm.polygon.size());
  for (std::size_t i = 0; i < hand.palm.polygon.size(); ++i) {
    EXPECT_LT(norm(fitted.palm.polygon[i] - hand.palm.polygon[i]), 1e-6);
  }
}

TEST(FitHand, MirrorsTheHandForAMotionOfTheOtherSide) {
  const Hand fitted = fit_hand(default_hand(Side::right), posed_motion(Side::left));
  EXPECT_EQ(fitted.side, Side::left);
  EXPECT_EQ(fitted.finger[0].base, default_hand(Side::left).finger[0].base);
  EXPECT_TRUE(check_hand(fitted).ok());
}

TEST(FitHand, AFrameThatShowsNoWholeHandChangesNothing) {
  const DeviceFrame good = posed_motion(Side::right).samples[0].frame;
  const auto refuse = [](const DeviceFrame& frame, const std::array<double, kJointCount>& radius,
                         const std::string& told) {
    const Hand before = default_hand(Side::right, 0.16);
    Hand hand = before;
    const Status status = fit_hand_to(frame, radius, hand);
    EXPECT_NE(status.message().find(told), std::string::npos) << status.message();
    EXPECT_EQ(hand.radius, before.radius) << told;
    EXPECT_EQ(hand.palm.polygon, before.palm.polygon) << told;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::array<double, kJointCount> radius{};
  radius[kIndexTip] = 0.0123;
  DeviceFrame lost = good, angles = good, partly = good, far = good, turned = good, point = good;
  lost.flags = kTrackingLost;
  angles.kind = InputKind::joint_angles;
  partly.valid &= ~(1u << kThumbTip);
  far.joint[kIndexProximal].position[1] = nan;
  turned.joint[kPalm].orientation = {};
  point.joint.fill(point.joint[kPalm]);
  for (const DeviceFrame& frame : {lost, angles, partly}) refuse(frame, radius, "not all joints are tracked");
  refuse(far, radius, "of index proximal is not finite");
  refuse(turned, radius, "of palm is not finite, or its orientation no unit quaternion");
  refuse(point, radius, "the joints of the palm span no area");
  radius[kIndexTip] = nan;
  refuse(good, radius, "radius of index tip is not finite");
  radius[kIndexTip] = 1e9;
  refuse(good, radius, "radius of index tip must lie between");
  Hand hand = default_hand(Side::right);
  hand.palm.polygon.clear();
  EXPECT_TRUE(fit_hand_to(good, {}, hand).ok());
  EXPECT_LT(norm(hand.palm.polygon[0] - default_hand(Side::right).palm.polygon[0]), 1e-6);
}

// The grasp, against the analytic cylinder.

struct Grip {
  Side side;
  double hand_length, radius, height;  // [m]
};
void PrintTo(const Grip& grip, std::ostream* out) {
  *out << (grip.side == Side::right ? "right" : "left") << "_hand_of_" << std::lround(1000 * grip.hand_length)
       << "_radius_" << std::lround(1000 * grip.radius) << "_height_" << std::lround(1000 * grip.height);
}

struct Depth {
  double deepest = -1;  // [m] of the skin inside the surface; negative outside
  double height = 0;    // [m] of the place above the ground
};

Depth depth_of(const Hand& hand, const std::array<Pose, kJointCount>& X_WJ, int segment, double radius) {
  const auto [base, tip] = kPhalanxJoints[segment];
  Depth depth;
  for (int i = 0; i <= 50; ++i) {
    const double t = i / 50.0;
    const Vec3 p = (1 - t) * X_WJ[base].position + t * X_WJ[tip].position;
    const double skin = (1 - t) * hand.radius[base] + t * hand.radius[tip];
    const double inside = radius + skin - std::sqrt(p.x * p.x + p.y * p.y);
    if (inside > depth.deepest) depth = {inside, p.z};
  }
  return depth;
}

std::array<Depth, kPhalanxCount> depths_at(const Hand& hand, const DeviceFrame& frame, double radius) {
  std::array<double, kAngleCount> angles;
  for (int i = 0; i < kAngleCount; ++i) angles[i] = double{frame.angle[i]};
  std::array<Pose, kJointCount> X_WJ;
  EXPECT_EQ(forward_kinematics(hand, frame.base, angles, X_WJ), 0) << "an angle beyond its limit";
  std::array<Depth, kPhalanxCount> depths;
  for (int s = 0; s < kPhalanxCount; ++s) depths[s] = depth_of(hand, X_WJ, s, radius);
  return depths;
}

class Grasp : public ::testing::TestWithParam<Grip> {};

TEST_P(Grasp, PressesEveryFingerIntoTheObjectAndNoneTooDeep) {
  const auto [side, hand_length, radius, height] = GetParam();
  const Hand hand = default_hand(side, hand_length);
  const Motion motion = make_grasp(hand, radius, height, 5);
  EXPECT_EQ(motion.side, side);
  for (const MotionSample& sample : motion.samples) {
    const auto depths = depths_at(hand, sample.frame, radius);
    for (int s = 0; s < kPhalanxCount; ++s) {
      ASSERT_LT(depths[s].deepest, 0.004) << segment_name(s) << " at " << sample.time << " s";
    }
    const bool holds = sample.time > 1.55 && sample.time < 3.85;
    for (int f = 0; holds && f < kFingerCount; ++f) {
      const auto presses = [object_height = height](const Depth& depth) {
        return depth.deepest > 0.0005 && depth.deepest < 0.0025 && depth.height > 0 &&
               depth.height < object_height;
      };
      ASSERT_TRUE(presses(depths[3 * f + 1]) || presses(depths[3 * f + 2]))
          << finger_name(f) << " at " << sample.time << " s";
    }
  }
}

TEST_P(Grasp, StartsAndEndsFree) {
  const auto [side, hand_length, radius, height] = GetParam();
  const Hand hand = default_hand(side, hand_length);
  const Motion motion = make_grasp(hand, radius, height, 5);
  for (const MotionSample* sample : {&motion.samples.front(), &motion.samples.back()}) {
    for (const Depth& depth : depths_at(hand, sample->frame, radius)) EXPECT_LT(depth.deepest, -0.03);
  }
}

INSTANTIATE_TEST_SUITE_P(MakeGrasp, Grasp,
                         ::testing::Values(Grip{Side::right, 0.19, 0.037, 0.095},  // the demo's mug
                                           Grip{Side::left, 0.19, 0.037, 0.095},
                                           Grip{Side::right, 0.19, 0.025, 0.12},
                                           Grip{Side::right, 0.19, 0.05, 0.12},
                                           Grip{Side::right, 0.17, 0.037, 0.12},
                                           Grip{Side::left, 0.21, 0.045, 0.14}),
                         testing::PrintToStringParamName());

TEST(MakeGrasp, IsSampledAtAHundredHertzForTheTimeAskedFor) {
  const Hand hand = default_hand(Side::right);
  const Motion motion = make_grasp(hand, 0.037, 0.095, 2.5);
  EXPECT_EQ(motion.samples.size(), 251u);
  EXPECT_EQ(motion.samples[100].time, 1);
  EXPECT_EQ(motion.format, "grasp");
  EXPECT_EQ(motion.radius, hand.radius);
  EXPECT_EQ(make_grasp(hand, 0.037, 0.095, kNotANumber).samples.size(), 11u);
  EXPECT_EQ(make_grasp(hand, 0.037, 0.095, 0).samples.size(), 11u);
}

TEST(MakeGrasp, StrokesByTwoCentimetresAndTurns) {
  const Motion motion = make_grasp(default_hand(Side::right), 0.037, 0.095, 5);
  double low = 1, high = -1, most_turn = 0;
  const Pose grasp = motion.samples[160].frame.base;
  for (std::size_t i = 160; i < 380; ++i) {
    const Pose& base = motion.samples[i].frame.base;
    low = std::min(low, base.position.z);
    high = test::largest(high, base.position.z);
    most_turn = test::largest(most_turn, 2 * std::acos(min(1, dot(base.orientation, grasp.orientation))));
  }
  EXPECT_NEAR(high - low, 0.02, 1e-4);
  EXPECT_NEAR(most_turn, 0.15, 1e-3);
}

TEST(MakeGrasp, ChangesItsSpeedsSmoothly) {
  const Motion motion = make_grasp(default_hand(Side::right), 0.037, 0.095, 5);
  double fastest = 0, largest_change = 0, fastest_turn = 0, largest_turn_change = 0;
  for (std::size_t i = 1; i + 1 < motion.samples.size(); ++i) {
    const DeviceFrame &a = motion.samples[i - 1].frame, &b = motion.samples[i].frame,
                      &c = motion.samples[i + 1].frame;
    const Vec3 before = b.base.position - a.base.position, after = c.base.position - b.base.position;
    fastest = test::largest(fastest, norm(after));
    largest_change = test::largest(largest_change, norm(after - before));
    for (int k = 0; k < kAngleCount; ++k) {
      const double turn = double{c.angle[k]} - double{b.angle[k]},
                   last = double{b.angle[k]} - double{a.angle[k]};
      fastest_turn = test::largest(fastest_turn, std::fabs(turn));
      largest_turn_change = test::largest(largest_turn_change, std::fabs(turn - last));
    }
  }
  // Of a minimum-jerk motion over n samples the speed changes by at most 3.1 / n of its peak.
  EXPECT_LT(largest_change, fastest * 3.2 / 60);
  EXPECT_LT(largest_turn_change, fastest_turn * 3.2 / 40);
}

TEST(MakeGrasp, GivesTheSameBitsOnEveryMachine) {
  Fnv hash;
  for (const MotionSample& sample : make_grasp(default_hand(Side::right), 0.037, 0.095, 5).samples) {
    add_frame(sample.frame, hash);
  }
  EXPECT_EQ(hash.value, 2098226552657452841u);
}

}  // namespace
}  // namespace lumbrical
