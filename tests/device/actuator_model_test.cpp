// The actuator model: exact where a device can do what is wanted, optimal where it can't, and honest about
// it.
#include "lumbrical/actuator_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "device_fixture.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

double error_of(const DeviceProfile& profile, const ActuatorArray& command, const JointArray& wanted) {
  double sum = 0;
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    double torque = -wanted[j];
    for (std::size_t i = 0; i < profile.actuators.size(); ++i)
      torque += profile.actuators[i].arm[j] * command[i];
    sum += torque * torque;
  }
  return sum;
}

double least_active(const Actuator& actuator) {
  return actuator.drive == Drive::wire ? actuator.preload : actuator.lower;
}

TEST(ActuatorModel, AMotorPerJointDoesExactlyWhatIsWanted) {
  const DeviceProfile profile = test::shipped_profile("exoskeleton");
  JointArray wanted{};
  for (std::size_t j = 0; j < kPhalanxCount; ++j) wanted[j] = 0.01 * static_cast<double>(j) - 0.05;
  const ActuatorSolution solution = solve_actuators(profile, wanted, {});
  for (std::size_t j = 0; j < kPhalanxCount; ++j) EXPECT_NEAR(solution.command[j], wanted[j], 1e-10);
  EXPECT_LT(solution.lost_norm, 1e-9);
  EXPECT_EQ(solution.saturated, 0u);
}

TEST(ActuatorModel, SaturationIsReportedWithWhatItCost) {
  const DeviceProfile profile = test::shipped_profile("exoskeleton");
  JointArray wanted{};
  wanted[3] = 2;   // limit 0.5
  wanted[4] = -1;  // limit -0.3
  const ActuatorSolution solution = solve_actuators(profile, wanted, {});
  EXPECT_EQ(solution.command[3], 0.5);
  EXPECT_EQ(solution.command[4], -0.3);
  EXPECT_EQ(solution.saturated, 1u << 3 | 1u << 4);
  EXPECT_NEAR(solution.lost[3], 1.5, 1e-12);
  EXPECT_NEAR(solution.lost[4], -0.7, 1e-12);
  EXPECT_NEAR(solution.lost_norm, std::hypot(1.5, 0.7), 1e-12);
}

TEST(ActuatorModel, AWireSharesItsPullByLeastSquaresAndNeverPushes) {
  const DeviceProfile glove = test::shipped_profile("wire_glove");
  JointArray wanted{};
  wanted[3] = 0.02;  // only the index' first joint: one wire can't do that alone
  const double a = 0.009, b = 0.008, c = 0.006;
  const ActuatorSolution solution = solve_actuators(glove, wanted, {});
  EXPECT_NEAR(solution.command[1], a * 0.02 / (a * a + b * b + c * c), 1e-9);
  EXPECT_EQ(solution.command[0], 0.8);  // the others hold their preload
  wanted[3] = -0.5;                     // pushing is out of the question
  EXPECT_EQ(solve_actuators(glove, wanted, {}).command[1], 0.8);
}

TEST(ActuatorModel, AllTorqueOfAFingerWithoutMotorIsLost) {
  const DeviceProfile glove = test::shipped_profile("wire_glove");
  JointArray wanted{};
  wanted[12] = 0.03;
  const ActuatorSolution solution = solve_actuators(glove, wanted, {});
  EXPECT_EQ(solution.lost[12], 0.03);
}

TEST(ActuatorModel, ABrakeResistsMotionAndNeverDrivesIt) {
  DeviceProfile profile;
  Actuator brake;
  brake.drive = Drive::brake;
  brake.upper = 10;
  brake.slew = 1;
  brake.arm[3] = 0.05;
  profile.actuators = {brake};
  JointArray wanted{}, speed{};
  wanted[3] = 0.2;  // against closing
  EXPECT_NEAR(solve_actuators(profile, wanted, speed).command[0], 4, 1e-9) << "at rest it holds";
  speed[3] = 1;
  EXPECT_NEAR(solve_actuators(profile, wanted, speed).torque[3], 0.2, 1e-9) << "closing is resisted";
  speed[3] = -1;
  const ActuatorSolution opening = solve_actuators(profile, wanted, speed);
  EXPECT_EQ(opening.command[0], 0) << "opening can't be driven";
  EXPECT_NEAR(opening.lost[3], 0.2, 1e-12);
  wanted[3] = -0.2;
  EXPECT_NEAR(solve_actuators(profile, wanted, speed).torque[3], -0.2, 1e-9);
}

TEST(ActuatorModel, NoOtherAdmissibleCommandComesCloser) {
  test::Random random(7);
  for (int round = 0; round < 300; ++round) {
    DeviceProfile profile = test::random_profile(random, 1 + static_cast<int>(random.bits() % kMaxActuators));
    for (Actuator& actuator :
         profile.actuators) {  // brakes change their sense with the motion: a test of their own
      if (actuator.drive == Drive::brake) actuator.drive = Drive::motor;
    }
    JointArray wanted{};
    for (double& torque : wanted) torque = random.between(-0.1, 0.3);
    const ActuatorSolution solution = solve_actuators(profile, wanted, {});
    const double best = error_of(profile, solution.command, wanted);
    ASSERT_NEAR(best, solution.lost_norm * solution.lost_norm, 1e-12);
    for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
      const Actuator& actuator = profile.actuators[i];
      ASSERT_GE(solution.command[i], least_active(actuator));
      ASSERT_LE(solution.command[i], actuator.upper);
    }
    for (int trial = 0; trial < 200;
         ++trial) {  // the problem is convex: nothing better near means nothing better
      ActuatorArray other = solution.command;
      const double size = trial % 2 == 0 ? 1e-3 : 1;
      for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
        other[i] = clamp(other[i] + size * random.between(-1, 1), least_active(profile.actuators[i]),
                         profile.actuators[i].upper);
      }
      ASSERT_GE(error_of(profile, other, wanted), best - 1e-10);
    }
  }
}

TEST(ActuatorModel, RedundantActuatorsShareTheLoad) {
  DeviceProfile profile;
  Actuator motor;
  motor.lower = -1;
  motor.upper = 1;
  motor.slew = 1;
  motor.arm[0] = 0.1;
  profile.actuators = {motor, motor};
  JointArray wanted{};
  wanted[0] = 0.1;
  const ActuatorSolution solution = solve_actuators(profile, wanted, {});
  EXPECT_NEAR(solution.command[0], 0.5, 1e-4);
  EXPECT_NEAR(solution.command[1], 0.5, 1e-4);
  EXPECT_LT(solution.lost_norm, 1e-9);
}

TEST(ActuatorModel, WhatIsNoNumberCountsAsNothing) {
  const DeviceProfile profile = test::shipped_profile("exoskeleton");
  JointArray wanted{}, speed{};
  wanted[2] = std::nan("");
  wanted[5] = 0.1;
  speed[1] = 1 / 0.0;
  const ActuatorSolution solution = solve_actuators(profile, wanted, speed);
  EXPECT_NEAR(solution.command[5], 0.1, 1e-10);
  for (const double command : solution.command) EXPECT_TRUE(std::isfinite(command));
}

}  // namespace
}  // namespace lumbrical
