// Angles that can't be: told apart from all that a hand in a device really does.
#include "device/feedback_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "device_fixture.h"
#include "lumbrical/device_simulation.h"

namespace lumbrical {
namespace {

constexpr std::int64_t kMillisecond = 1000000;
constexpr std::size_t kIndex = 5;  // flexion of the index' first joint: angle 5, joint 3, actuator 3

class FeedbackCheck : public ::testing::Test {
 protected:
  FeedbackCheck() {
    for (const Sensor& sensor : profile.sensors) all |= 1u << sensor.angle;
    feedback.valid = all;
  }
  // One exchange of a millisecond.
  std::uint32_t look() {
    feedback.asked = feedback.time;
    feedback.time += kMillisecond;
    feedback.valid = all;
    check_feedback(profile, feedback, memory);
    return feedback.flags;
  }
  // So many milliseconds on the way to an angle.
  void go(double angle, int time) {
    const float from = feedback.angle[kIndex], way = static_cast<float>(angle) - from;
    for (int i = 1; i <= time; ++i) {
      feedback.angle[kIndex] = from + way * static_cast<float>(i) / static_cast<float>(time);
      ASSERT_EQ(look(), 0u);
    }
  }
  // What is said in so many milliseconds in which the torque grows to 0.26 N m from nothing, to open or (-1)
  // to close.
  std::uint32_t push(int time, int sense = 1) {
    std::uint32_t said = 0;
    for (int i = 0; i <= time; ++i) {
      feedback.acted[3] = sense * 0.26 * i / time;
      said |= look();
    }
    return said;
  }
  Sensor& sensor_of_index() {
    return *std::find_if(profile.sensors.begin(), profile.sensors.end(),
                         [](const Sensor& sensor) { return sensor.angle == static_cast<int>(kIndex); });
  }
  bool believed() const { return (feedback.valid >> kIndex & 1u) != 0; }
  DeviceProfile profile = test::shipped_profile("exoskeleton");
  std::uint32_t all = 0;
  DeviceFeedback feedback{.time = 1000 * kMillisecond};
  FeedbackMemory memory{};
};

// A finger could have been there long before: but force at another place has to come from nothing.
TEST_F(FeedbackCheck, AJumpIsNotBelievedBeforeForcesHaveFadedAndTheHandHasSettled) {
  EXPECT_EQ(look(), 0u);
  feedback.angle[kIndex] = 1;
  int doubted = 0;
  while (look() != 0 && doubted < 1000) {
    EXPECT_EQ(feedback.flags, kAngleJumped);
    EXPECT_FALSE(believed());
    EXPECT_EQ(feedback.valid, all & ~(1u << kIndex)) << "the others are";
    EXPECT_EQ(feedback.angle[kIndex], 0) << "the last one believed";
    feedback.angle[kIndex] = 1;
    ++doubted;
  }
  EXPECT_NEAR(doubted, 1000 * kSettling, 2);
  feedback.angle[kIndex] = std::nextafter(1.0f, 2.0f);
  EXPECT_EQ(look(), 0u);
}

TEST_F(FeedbackCheck, AFingerAsFastAsCanBeIsBelievedHoweverUnevenlyRepliesCome) {
  for (const auto& [speed, slowest] : {std::pair(kFastestJoint, 3.0), std::pair(kFastFinger, 20.0)}) {
    test::Random random(5);
    memory = {};
    std::int64_t sampled = feedback.time;
    double angle = 0;
    for (int i = 0; i < 10000; ++i) {
      feedback.asked = feedback.time;
      const double to = random.between(0, 0.5 * slowest), from = random.between(0, 0.5 * slowest);
      const std::int64_t there = feedback.asked + static_cast<std::int64_t>(to * kMillisecond);
      const double sense = angle > 1.5 ? -1 : angle < 0 ? 1 : random.between(-1, 1);
      angle += sense * speed * static_cast<double>(there - sampled) * 1e-9;
      sampled = there;
      feedback.angle[kIndex] = static_cast<float>(angle);
      feedback.time = there + static_cast<std::int64_t>(from * kMillisecond);
      feedback.valid = all;
      check_feedback(profile, feedback, memory);
      ASSERT_EQ(feedback.flags, 0u) << i;
    }
  }
}

// At 50 rad/s as much would be possible within two of them.
TEST_F(FeedbackCheck, AnAngleJumpsAlsoOnABusOfTwentyMilliseconds) {
  const auto look_slowly = [this](double angle) {
    feedback.asked = feedback.time;
    feedback.time += 20 * kMillisecond;
    feedback.angle[kIndex] = static_cast<float>(angle);
    feedback.valid = all;
    check_feedback(profile, feedback, memory);
    return feedback.flags;
  };
  ASSERT_EQ(look_slowly(0), 0u);
  EXPECT_EQ(look_slowly(1), kAngleJumped);
  EXPECT_EQ(look_slowly(0.2), 0u) << "near what was believed";
  for (int i = 0; i < 5; ++i) EXPECT_EQ(look_slowly(1.2), kAngleJumped) << i;
  EXPECT_EQ(look_slowly(1.2), 0u) << "it has slipped, and forces have faded";
}

TEST_F(FeedbackCheck, AnAngleThatGoesOnJumpingIsNotBelieved) {
  ASSERT_EQ(look(), 0u);
  for (int i = 0; i < 1000; ++i) {
    feedback.angle[kIndex] = i % 2 == 0 ? 1.0f : 2.0f;
    ASSERT_EQ(look(), kAngleJumped) << i;
  }
  feedback.angle[kIndex] = 0.1f;
  EXPECT_EQ(look(), 0u);
}

TEST_F(FeedbackCheck, AnAngleThatTorquesDoNotMoveIsStuckUntilItMoves) {
  feedback.angle[kIndex] = 0.7f;
  int first = 0;
  for (int i = 1; i <= 600; ++i) {
    feedback.acted[3] = 0.3 * std::sin(0.01 * i);
    if (look() != 0 && first == 0) first = i;
  }
  EXPECT_EQ(feedback.flags, kAngleStuck);
  EXPECT_FALSE(believed());
  EXPECT_GE(first, 250);
  EXPECT_LE(first, 350);
  feedback.acted[3] = 0;
  for (int i = 0; i < 2000; ++i) look();
  EXPECT_EQ(feedback.flags, kAngleStuck) << "torques end with the doubt";
  feedback.angle[kIndex] = 0.7005f;
  EXPECT_EQ(look(), 0u);
  EXPECT_TRUE(believed());
}

// What it says in between is no move.
TEST_F(FeedbackCheck, AnAngleThatIsStuckStaysSoOverOneThatCannotBe) {
  feedback.angle[kIndex] = 0.7f;
  for (int i = 0; i < 300; ++i) look();
  ASSERT_EQ(push(300), kAngleStuck);
  feedback.acted[3] = 0;
  for (int i = 0; i < 1000; ++i) look();
  feedback.valid = all & ~(1u << kIndex);
  check_feedback(profile, feedback, memory);
  EXPECT_EQ(feedback.flags, kAngleOutOfRange);
  feedback.angle[kIndex] = 3;
  EXPECT_EQ(look(), kAngleJumped);
  feedback.angle[kIndex] = 0.7f;
  EXPECT_EQ(look(), kAngleStuck);
  feedback.angle[kIndex] = 0.7005f;
  EXPECT_EQ(look(), 0u);
}

// A cable that is out for long: by what let go in the meantime the finger may have been moved and moved back.
TEST_F(FeedbackCheck, AnAngleThatIsTheSameAfterALongSilenceIsNotStuck) {
  feedback.angle[kIndex] = 0.7f;
  feedback.acted[3] = 0.3;
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(look(), 0u);
  feedback.time += 2000 * kMillisecond;
  feedback.acted[3] = 0;
  EXPECT_EQ(look(), 0u);
  EXPECT_EQ(push(500), kAngleStuck) << "from now on it is looked at again";
}

TEST_F(FeedbackCheck, AnAngleAtRestUnderASteadyTorqueIsNotStuck) {
  feedback.angle[kIndex] = 0.7f;
  for (int i = 0; i < 5000; ++i) {
    feedback.acted[3] = 0.2 + 0.004 * std::sin(0.1 * i);
    ASSERT_EQ(look(), 0u);
  }
}

// A finger may be held for long, and its joint's friction moves with the torque.
TEST_F(FeedbackCheck, AnAngleAtRestUnderATorqueThatGrowsSlowlyIsNotStuck) {
  go(1, 100);
  go(0.7, 100);
  EXPECT_EQ(push(10000), 0u);
  EXPECT_EQ(push(500), kAngleStuck);
}

// A straight finger pressed onto a table: nothing can open it farther.
TEST_F(FeedbackCheck, AnAngleAtItsStopIsNotStuckThoughATorquePushesItOn) {
  go(1, 100);
  go(0, 100);
  EXPECT_EQ(push(500), 0u);
  go(1, 100);
  EXPECT_EQ(push(500), kAngleStuck) << "it can be opened";
  memory = {};
  go(0.7, 100);
  EXPECT_EQ(push(500), kAngleStuck) << "its stop may be elsewhere";
}

// A profile whose range ends at the stop: the finger need not have moved for it to be known.
TEST_F(FeedbackCheck, AnAngleAtTheEndOfItsRangeIsNotStuckSinceTheStartThoughATorquePushesItOn) {
  Sensor& sensor = sensor_of_index();
  sensor.lower = -0.1;
  feedback.angle[kIndex] = -0.1f;
  EXPECT_EQ(push(500), 0u);
  feedback.angle[kIndex] = -0.0997f;
  EXPECT_EQ(push(500), 0u) << "a step of its encoder away";
  feedback.acted[3] = 0;
  memory = {};
  sensor.upper = 1.2;
  feedback.angle[kIndex] = 1.2f;
  EXPECT_EQ(push(500, -1), 0u);
}

TEST_F(FeedbackCheck, AnAngleWithinItsRangeOrPushedOffItsEndIsStuckAllTheSame) {
  Sensor& sensor = sensor_of_index();
  sensor.lower = -0.1;
  sensor.upper = 1.2;
  for (const auto& [angle, sense] : {std::pair(-0.1f, -1), {-0.08f, 1}, {0.5f, 1}, {1.18f, -1}, {1.2f, 1}}) {
    memory = {};
    feedback.angle[kIndex] = angle;
    EXPECT_EQ(push(500, sense), kAngleStuck) << angle;
  }
}

TEST_F(FeedbackCheck, ABrakeMovesNothing) {
  for (Actuator& actuator : profile.actuators) actuator.drive = Drive::brake;
  for (int i = 0; i < 1000; ++i) {
    feedback.acted.fill(0.3 * std::sin(0.05 * i));
    ASSERT_EQ(look(), 0u);
  }
}

TEST_F(FeedbackCheck, WhatIsOutOfRangeIsFlaggedAndDoesNotCountAsKnown) {
  feedback.angle[kIndex] = 0.1f;
  EXPECT_EQ(look(), 0u);
  feedback.valid = all & ~(1u << kIndex);  // as the registers' reader leaves it
  check_feedback(profile, feedback, memory);
  EXPECT_EQ(feedback.flags, kAngleOutOfRange);
}

TEST_F(FeedbackCheck, NothingIsDoubtedInASimulatedHandWhateverTorquesDoToIt) {
  for (const double stiffness : {0.05, 0.5, 5.0}) {
    SimulationOptions options;
    options.human.stiffness = stiffness;
    SimulatedDevice device(profile, options);
    test::Random random(17);
    memory = {};
    ActuatorArray command{};
    for (int i = 0; i < 5000; ++i) {
      for (std::size_t k = 0; k < 15; ++k) {
        const double wanted = command[k] + random.between(-0.02, 0.02);
        command[k] = std::clamp(wanted, profile.actuators[k].lower, profile.actuators[k].upper);
        std::array<std::uint16_t, 1> word = {static_cast<std::uint16_t>(std::lround(command[k] / 1e-4))};
        ASSERT_EQ(device.write(1, static_cast<std::uint16_t>(2 + k), word), 0);
      }
      std::array<std::uint16_t, 2> control = {1, static_cast<std::uint16_t>(i)};
      ASSERT_EQ(device.write(1, 0, control), 0);
      device.advance(1e-3);
      feedback.acted = command;
      for (std::size_t j = 0; j < kPhalanxCount; ++j) {
        feedback.angle[flexion_angle(j)] =
            static_cast<float>(read_encoder(profile.dynamics[j], device.joints()[j].angle));
      }
      ASSERT_EQ(look(), 0u) << "stiffness " << stiffness << ", " << i << " ms";
    }
  }
}

}  // namespace
}  // namespace lumbrical
