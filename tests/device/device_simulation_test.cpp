// The simulated device: mechanics with known answers, a firmware that protects its wearer, the local model's
// C header.
#include "lumbrical/device_simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "device_fixture.h"
#include "lumbrical/local_model.h"

namespace lumbrical {
namespace {

TEST(SimulatedJoint, SwingsAndDecaysAsASpringMassDamper) {
  const JointDynamics dynamics{2e-5, 0.0002, 0, 0};
  const HumanJoint human{0.5, 0};
  JointState joint{0.1, 0};
  const double w = std::sqrt(0.5 / 2e-5), decay = 0.0002 / (2 * 2e-5);
  const double dt = 1e-6;
  for (int i = 0; i < 50000; ++i) step_joint(dynamics, human, 0, 0, dt, joint);
  const double t = 0.05, wd = std::sqrt(w * w - decay * decay);
  const double expected = 0.1 * std::exp(-decay * t) * (std::cos(wd * t) + decay / wd * std::sin(wd * t));
  EXPECT_NEAR(joint.angle, expected, 2e-3);
}

TEST(SimulatedJoint, FrictionStopsItDeadWithinItsBand) {
  const JointDynamics dynamics{2e-5, 0.001, 0.05, 0};
  const HumanJoint human{0.5, 0.01};
  JointState joint{0.3, 5};
  for (int i = 0; i < 20000; ++i) step_joint(dynamics, human, 0, 0, 1e-4, joint);
  EXPECT_NEAR(joint.speed, 0, 1e-9);
  EXPECT_LE(std::fabs(joint.angle), 0.05 / 0.5 + 1e-9);
}

TEST(SimulatedJoint, AnOpeningTorqueOpens) {
  JointState joint;
  for (int i = 0; i < 20000; ++i) step_joint({2e-5, 0.002, 0, 0}, {0.5, 0.01}, 0, 0.1, 1e-4, joint);
  EXPECT_NEAR(joint.angle, -0.2, 1e-6);
}

// Sends commands to a simulated exoskeleton at 1 kHz.
struct Host {
  DeviceProfile profile;
  SimulatedDevice device;
  std::uint16_t beat = 0;

  explicit Host(SimulationOptions options = {},
                DeviceProfile of_device = test::shipped_profile("exoskeleton"))
      : profile(std::move(of_device)), device(profile, std::move(options)) {}
  void send(std::uint16_t control, std::int16_t torque) {
    std::array<std::uint16_t, 17> words{};
    words[0] = control;
    words[1] = ++beat;
    for (std::size_t j = 0; j < 15; ++j) words[2 + j] = static_cast<std::uint16_t>(torque);
    ASSERT_EQ(device.write(1, 0, words), 0);
  }
  void run(int ticks, std::uint16_t control, std::int16_t torque) {
    for (int i = 0; i < ticks; ++i) {
      send(control, torque);
      device.advance(0.001);
    }
  }
};

// Whichever way its arm is written down.
TEST(SimulatedDevice, BrakesOpposeWhatMoves) {
  for (const double arm : {1.0, -1.0}) {
    DeviceProfile profile = test::shipped_profile("exoskeleton");
    profile.actuators[3].drive = Drive::brake;
    profile.actuators[3].arm[3] = arm;
    SimulationOptions options;
    options.intention = [](double time, JointArray& target) { target[3] = 0.5 * std::sin(20 * time); };
    Host host(options, profile);
    double taken = 0;
    for (int i = 0; i < 500; ++i) {
      host.run(1, 1, 500);
      taken += 0.001 * host.device.torque()[3] * host.device.joints()[3].speed;  // opening, closing
    }
    EXPECT_GT(taken, 1e-3) << arm;
  }
}

// Of others' devices, whose joints weigh nothing that their profiles would say.
TEST(SimulatedDevice, BrakesHoldALightJointStillAndGiveItNothing) {
  for (const char* const name : {"inspire_rh56", "robotiq_2f"}) {
    const DeviceProfile profile = test::shipped_profile(name);
    SimulatedDevice device(profile, {});
    const Actuator& brake = profile.actuators.back();
    const auto joint = static_cast<std::size_t>(
        std::find_if(brake.arm.begin(), brake.arm.end(), [](double arm) { return arm != 0; }) -
        brake.arm.begin());
    WornDevice worn;
    double farthest = 0;
    const double start = device.joints()[joint].angle;
    for (int i = 0; i < 4000; ++i) {
      const auto word = static_cast<std::uint16_t>(brake.upper);
      ASSERT_EQ(device.write(brake.field.unit, brake.field.address, std::span(&word, 1)), 0);
      if (profile.control.present) {
        ASSERT_EQ(device.write(profile.control.unit, profile.control.address,
                               std::span(&profile.control.active, 1)),
                  0);
      }
      device.advance(0.001);
      look(device, worn);
      farthest = std::max(farthest, std::fabs(device.joints()[joint].angle - start));
    }
    EXPECT_LT(farthest, 1e-3) << name << ": the hand that is held can do 0.45 N m, the brake more";
    EXPECT_EQ(shakes_of(worn), 0u) << name;
    EXPECT_EQ(worn.given, 0) << name;
    EXPECT_GE(worn.taken, 0) << name;
  }
}

// Beyond, no angle is believed, and forces would end.
TEST(SimulatedDevice, StopsWhereItsSensorsRangesEnd) {
  SimulationOptions options;
  options.human = {0.05, 0.001};
  Host host(options);
  const auto sensor = std::find_if(host.profile.sensors.begin(), host.profile.sensors.end(),
                                   [](const Sensor& s) { return is_flexion(s) && sensed_joint(s) == 3; });
  host.run(1000, 1, 1000);
  EXPECT_NEAR(host.device.joints()[3].angle, sensor->lower, 1e-3) << "by 0.1 N m, where 2 rad hold as much";
  EXPECT_EQ(host.device.joints()[3].speed, 0);
  std::array<std::uint16_t, 22> feedback{};
  ASSERT_EQ(host.device.read(1, 100, feedback), 0);
  EXPECT_GE(static_cast<std::int16_t>(feedback[5]) * 1e-4, sensor->lower);
  host.run(1000, 1, 0);
  EXPECT_GT(host.device.joints()[3].angle, sensor->lower + 0.1) << "and comes back";
}

TEST(SimulatedDevice, TurnsCommandsIntoTorqueOnlyWhileSwitchedOn) {
  Host host;
  host.run(20, 0, 1000);
  EXPECT_EQ(host.device.torque()[3], 0);
  host.run(20, 1, 1000);
  EXPECT_NEAR(host.device.torque()[3], 0.1, 1e-12);
  std::array<std::uint16_t, 22> feedback{};
  ASSERT_EQ(host.device.read(1, 100, feedback), 0);
  EXPECT_EQ(feedback[0], 4 + 8);  // dead-man held, ready
  EXPECT_EQ(feedback[1], host.beat);
  EXPECT_NEAR(static_cast<std::int16_t>(feedback[5]) * 1e-4, host.device.joints()[3].angle, 2e-4);
}

TEST(SimulatedDevice, FadesWhenNoOneSpeaksToIt) {
  Host host;
  host.run(50, 1, 1000);
  host.device.advance(0.09);
  EXPECT_NEAR(host.device.torque()[3], 0.1, 1e-12);
  host.device.advance(0.0125);  // the whole range, ten times as much, takes 50 ms
  EXPECT_GT(host.device.torque()[3], 0);
  EXPECT_LT(host.device.torque()[3], 0.1);
  host.device.advance(0.06);
  EXPECT_EQ(host.device.torque()[3], 0);
}

TEST(SimulatedDevice, FadesWhenTheHeartbeatStandsStill) {
  Host host;
  host.run(50, 1, 1000);
  for (int i = 0; i < 200; ++i) {
    --host.beat;
    host.send(1, 1000);
    host.device.advance(0.001);
  }
  EXPECT_EQ(host.device.torque()[3], 0);
}

TEST(SimulatedDevice, RefusesRegistersItDoesNotHave) {
  Host host;
  std::array<std::uint16_t, 4> words{};
  EXPECT_EQ(host.device.write(1, 15, words), 2);
  EXPECT_EQ(host.device.write(2, 0, words), 2);
  EXPECT_EQ(host.device.read(1, 65534, words), 2);
  EXPECT_EQ(host.device.read(1, 100, words), 0);
  EXPECT_TRUE(host.device.has_unit(1));
  EXPECT_FALSE(host.device.has_unit(2));
}

// The glove's angles have the addresses of its commands, but in a table of their own.
TEST(SimulatedDevice, HasInputRegistersBesideItsCommandsWhereTheyAreItsFeedback) {
  SimulatedDevice device(test::shipped_profile("wire_glove"), {});
  std::array<std::uint16_t, 6> words = {1, 0, 2000, 2000, 2000, 2000};
  for (int i = 0; i < 500; ++i) {
    ++words[1];
    ASSERT_EQ(device.write(1, 0, words), 0);
    device.advance(0.001);
  }
  EXPECT_TRUE(device.switched_on());
  EXPECT_NEAR(device.torque()[3], 2 * 0.009, 1e-12);
  std::array<std::uint16_t, 6> told{};
  ASSERT_EQ(device.read(1, 0, told), 0);
  EXPECT_EQ(told, words) << "who reads them back finds what was written";
  std::array<std::uint16_t, 18> feedback{};
  ASSERT_EQ(device.read_inputs(1, 0, feedback), 0);
  EXPECT_NEAR(5e-4 * feedback[3], device.joints()[3].angle, 2e-3);
  EXPECT_EQ(feedback[16], 8) << "ready";
  EXPECT_EQ(feedback[17], words[1]);
  EXPECT_EQ(device.read(1, 16, told), 2);
}

TEST(SimulatedDevice, GivesTheSameBitsEveryTime) {
  Host a, b;
  a.run(500, 1, 300);
  b.run(500, 1, 300);
  for (std::size_t j = 0; j < kPhalanxCount; ++j)
    EXPECT_EQ(a.device.joints()[j].angle, b.device.joints()[j].angle);
}

TEST(LocalModel, FollowsTheStiffnessWithinItsRadiusAndNeverPulls) {
  const lumbrical_local_model model = {0.1, 0.5, 2, 0.01};
  const lumbrical_local_limits limits = {0.3, 100, 0.02, 0.05};
  EXPECT_NEAR(lumbrical_local_torque(&model, &limits, 0.505, 0), 0.11, 1e-15);
  EXPECT_NEAR(lumbrical_local_torque(&model, &limits, 0.9, 0), 0.12, 1e-15);
  EXPECT_NEAR(lumbrical_local_torque(&model, &limits, 0.1, 0), 0.08, 1e-15);
  const lumbrical_local_model wide = {0.1, 0.5, 2, 1};
  EXPECT_EQ(lumbrical_local_torque(&wide, &limits, 0.1, 0), 0);
  EXPECT_EQ(lumbrical_local_torque(&wide, &limits, 0.9, 0), 0.3) << "limit";
  EXPECT_NEAR(lumbrical_local_torque(&model, &limits, 0.5, 0.045), 0.05, 1e-15) << "half faded";
  EXPECT_EQ(lumbrical_local_torque(&model, &limits, 0.5, 1), 0);
}

TEST(LocalModel, IsNothingWhereAnyOfItsNumbersIsNone) {
  for (std::size_t bad = 0; bad < 11; ++bad) {
    std::array<double, 10> n = {0.1, 0.5, 2, 0.01, 0.3, 100, 0.02, 0.05, 0.505, 0.01};
    if (bad < n.size()) n[bad] = std::nan("");
    const lumbrical_local_model model = {n[0], n[1], n[2], n[3]};
    const lumbrical_local_limits limits = {n[4], n[5], n[6], n[7]};
    EXPECT_NEAR(lumbrical_local_torque(&model, &limits, n[8], n[9]), bad < n.size() ? 0 : 0.11, 1e-15) << bad;
  }
}

TEST(LocalModel, IsFiniteAndWithinLimitsWhateverTheCommand) {
  test::Random random(13);
  const double bad[] = {std::nan(""), 1 / 0.0, -1 / 0.0, 1e308, 0.0};
  const lumbrical_local_limits limits = {0.3, 100, 0.02, 0.05};
  for (int i = 0; i < 20000; ++i) {
    const auto any = [&] { return random.bits() % 4 == 0 ? bad[random.bits() % 5] : random.between(-2, 2); };
    const lumbrical_local_model model = {any(), any(), any(), any()};
    const double torque = lumbrical_local_torque(&model, &limits, any(), any());
    ASSERT_TRUE(std::fabs(torque) <= 0.3) << torque;
  }
}

}  // namespace
}  // namespace lumbrical
