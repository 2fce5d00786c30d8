// The safety state machine: every transition by hand, then every promise of safety.h over random sequences of
// every input there is, hostile numbers included.
#include "lumbrical/safety.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "device_fixture.h"

namespace lumbrical {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Loop {
  DeviceProfile profile = test::shipped_profile("exoskeleton");
  SafetyMemory memory = start_safety(profile);
  SafetyInputs inputs;
  SafetyOutput output;

  Loop() {
    inputs.connected = true;
    inputs.wanted.fill(0.1);
  }
  void step(int count = 1) {
    for (int i = 0; i < count; ++i) {
      output = step_safety(profile, inputs, memory);
      inputs.arm = inputs.disarm = inputs.reset = false;
    }
  }
  void activate() {
    step();
    inputs.arm = true;
    step(1000);
    ASSERT_EQ(memory.state, SafetyState::active);
    ASSERT_NEAR(output.command[0], 0.1, 1e-12);
  }
  int fade_steps() const { return static_cast<int>(std::ceil(profile.safety.fade / inputs.dt)) + 1; }
  void expect_fades() {
    const double before = std::fabs(output.command[0]);
    step();
    EXPECT_GT(std::fabs(output.command[0]), 0) << "smoothly, not at once";
    EXPECT_LT(std::fabs(output.command[0]), before);
    step(fade_steps() - 1);
    EXPECT_TRUE(output.at_safe_values);
  }
};

TEST(Safety, GoesFromDisconnectedToActiveOnlyStepByStep) {
  Loop loop;
  loop.inputs.connected = false;
  loop.step(3);
  EXPECT_EQ(loop.memory.state, SafetyState::disconnected);
  loop.inputs.arm = true;  // asking before there is a device is not kept for later
  loop.step();
  loop.inputs.connected = true;
  loop.step();
  EXPECT_EQ(loop.memory.state, SafetyState::idle);
  loop.step(10);
  EXPECT_EQ(loop.memory.state, SafetyState::idle);
  EXPECT_FALSE(loop.output.device_on);
  loop.inputs.arm = true;
  loop.inputs.dead_man = false;
  loop.step();
  EXPECT_EQ(loop.memory.state, SafetyState::armed);
  loop.step(10);
  EXPECT_EQ(loop.memory.state, SafetyState::armed);
  EXPECT_TRUE(loop.output.at_safe_values);
  loop.inputs.dead_man = true;
  loop.step();
  EXPECT_EQ(loop.memory.state, SafetyState::active);
  EXPECT_TRUE(loop.output.device_on);
}

TEST(Safety, StartsSoftly) {
  Loop loop;
  loop.step();
  loop.inputs.arm = true;
  loop.step(2);  // armed, active
  loop.step(249);
  EXPECT_NEAR(loop.output.command[0], 0.05, 1e-9);
  EXPECT_TRUE((loop.output.flags & kSoftStart) != 0);
  loop.step(251);
  EXPECT_NEAR(loop.output.command[0], 0.1, 1e-12);
  EXPECT_EQ(loop.output.flags, 0u);
}

TEST(Safety, ANotReadyDeviceIsNotArmed) {
  Loop loop;
  loop.inputs.device_ready = false;
  loop.step();
  loop.inputs.arm = true;
  loop.step(2);
  EXPECT_EQ(loop.memory.state, SafetyState::idle);
}

// Where an input ends for a while that forces need.
void expect_goes_on_softly_only_if_told(bool SafetyInputs::*needed, SafetyState without, SafetyFlag flag) {
  for (const bool continues : {false, true}) {
    Loop loop;
    loop.inputs.continue_after_loss = continues;
    loop.activate();
    loop.inputs.*needed = false;
    loop.expect_fades();
    EXPECT_EQ(loop.memory.state, without);
    EXPECT_EQ(loop.output.flags & flag, flag);
    EXPECT_FALSE(loop.output.device_on);
    loop.inputs.*needed = true;
    loop.step(3);
    EXPECT_EQ(loop.memory.state, continues ? SafetyState::active : SafetyState::idle);
    EXPECT_LT(loop.output.command[0], 0.002) << "and softly";
  }
}

// Its drives have let go: what they were told would come again in one step.
TEST(Safety, ADeviceThatIsNotReadyAnyMoreIsLetGoOfAndArmedAgainSoftlyOnlyIfTold) {
  expect_goes_on_softly_only_if_told(&SafetyInputs::device_ready, SafetyState::idle, kNotReady);
}

TEST(Safety, ADeviceThatIsNotReadyAnyMoreWaitsForNoDeadManSwitch) {
  Loop loop;
  loop.activate();
  loop.inputs.dead_man = false;
  loop.step(3);
  ASSERT_EQ(loop.memory.state, SafetyState::armed);
  loop.inputs.device_ready = false;
  loop.step();
  EXPECT_EQ(loop.memory.state, SafetyState::idle);
  loop.inputs.disarm = true;
  loop.step();
  loop.inputs.device_ready = loop.inputs.dead_man = true;
  loop.step(10);
  EXPECT_EQ(loop.memory.state, SafetyState::idle) << "a disarm ends an arming that waits";
}

TEST(Safety, TheDeadManSwitchFadesAndBringsBackSoftly) {
  Loop loop;
  loop.activate();
  loop.inputs.dead_man = false;
  loop.expect_fades();
  EXPECT_EQ(loop.memory.state, SafetyState::armed);
  loop.inputs.dead_man = true;
  loop.step(2);
  EXPECT_EQ(loop.memory.state, SafetyState::active);
  EXPECT_LT(loop.output.command[0], 0.001);
}

TEST(Safety, AnEmergencyStopStaysUntilItIsResetAndArmedAgain) {
  Loop loop;
  loop.activate();
  loop.inputs.stop = true;
  loop.expect_fades();
  EXPECT_EQ(loop.memory.state, SafetyState::fault);
  EXPECT_FALSE(loop.output.device_on);
  loop.inputs.reset = true;  // while it is still pressed
  loop.step(2);
  EXPECT_EQ(loop.memory.state, SafetyState::fault);
  loop.inputs.stop = false;
  loop.inputs.arm = true;  // arming is no reset
  loop.step(100);
  EXPECT_EQ(loop.memory.state, SafetyState::fault);
  EXPECT_EQ(loop.output.flags & kStopPressed, kStopPressed);
  loop.inputs.reset = true;
  loop.step();
  EXPECT_EQ(loop.memory.state, SafetyState::idle);
  loop.step(100);
  EXPECT_EQ(loop.memory.state, SafetyState::idle);
  loop.inputs.arm = true;
  loop.step(2);
  EXPECT_EQ(loop.memory.state, SafetyState::active);
}

TEST(Safety, EveryCauseOfAFaultFadesTheOutput) {
  const auto cause = [](void (*set)(SafetyInputs&), std::uint32_t flag) {
    Loop loop;
    loop.activate();
    set(loop.inputs);
    loop.expect_fades();
    EXPECT_EQ(loop.memory.state, SafetyState::fault);
    EXPECT_EQ(loop.output.flags & flag, flag);
  };
  cause([](SafetyInputs& inputs) { inputs.device_fault = true; }, kDeviceFault);
  cause([](SafetyInputs& inputs) { inputs.heartbeat_lost = true; }, kHeartbeatLost);
  cause([](SafetyInputs& inputs) { inputs.other_master = true; }, kOtherMaster);
  cause([](SafetyInputs& inputs) { inputs.tick_age = 0.2; }, kTickStopped);
  cause([](SafetyInputs& inputs) { inputs.tick_age = kNan; }, kTickStopped);
  cause([](SafetyInputs& inputs) { inputs.wanted[3] = kNan; }, kCommandNotFinite);
  cause([](SafetyInputs& inputs) { inputs.wanted[14] = -kInfinity; }, kCommandNotFinite);
}

TEST(Safety, ALateTickIsHeldThenFadesAndAFreshOneBringsItBackSoftly) {
  Loop loop;
  loop.activate();
  loop.inputs.tick_age = 0.004;  // below tick_hold
  loop.step(10);
  EXPECT_NEAR(loop.output.command[0], 0.1, 1e-12);
  loop.inputs.tick_age = 0.05;  // above it, below tick_timeout
  loop.expect_fades();
  EXPECT_EQ(loop.memory.state, SafetyState::active);
  EXPECT_EQ(loop.output.flags & kTickLate, kTickLate);
  loop.inputs.tick_age = 0;
  loop.step(static_cast<int>(kSettling / loop.inputs.dt) - 1);
  EXPECT_EQ(loop.output.command[0], 0) << "the hand settles first";
  const double rise = 0.1 * loop.inputs.dt / loop.profile.safety.soft_start;
  double before = 0;
  for (int i = 1; i <= 30; ++i) {
    loop.step();
    EXPECT_LE(loop.output.command[0] - before, rise + 1e-12);
    before = loop.output.command[0];
  }
  EXPECT_NEAR(before, 29 * rise, 1.1 * rise);
  loop.step(static_cast<int>(loop.profile.safety.soft_start / loop.inputs.dt));
  EXPECT_NEAR(loop.output.command[0], 0.1, 1e-12);
}

TEST(Safety, WhatWouldHaveFadedInAGapGoesAndComesBackSoftlyAndOnlyOnceTheHandHasSettled) {
  for (const double gap : {0.004, 0.012, 0.3}) {
    Loop loop;
    loop.activate();
    loop.inputs.gap = gap;
    loop.step();
    loop.inputs.gap = 0;
    const bool counts = gap > loop.profile.safety.tick_hold;
    const double left = counts ? std::max(0.0, 1 - gap / loop.profile.safety.fade) : 1;
    const double pace = 0.1 * loop.inputs.dt / loop.profile.safety.soft_start;
    double before = loop.output.command[0], least = before;
    EXPECT_GE(before, 0.1 - pace - 1e-12) << "no jump";
    int lowest = 0;
    for (int i = 0; i < 1500; ++i) {
      loop.step();
      const double now = loop.output.command[0];
      EXPECT_LE(std::fabs(now - before), pace + 1e-12);
      if (now < least) lowest = i;
      if (now > least + 1e-12) {
        EXPECT_GE((i - lowest) * loop.inputs.dt, kSettling - 0.002);
      }
      least = std::min(least, now);
      before = now;
    }
    EXPECT_NEAR(before, 0.1, 1e-12);
    EXPECT_NEAR(least, 0.1 * left, 2 * pace) << gap;
  }
}

// A bus that stalls again and again: forces that came back each time as far as the last would shake the hand.
TEST(Safety, EachGapBeforeAllIsBackHalvesThePaceAtWhichForcesComeBack) {
  Loop loop;
  loop.activate();
  const double pace = 0.1 * loop.inputs.dt / loop.profile.safety.soft_start;
  const auto back_in_50_steps_after_a_gap = [&loop] {
    loop.inputs.gap = 1;
    loop.step();
    loop.inputs.gap = 0;
    while (loop.memory.owed > 0 || loop.memory.settling > 0) loop.step();
    const double before = loop.output.command[0];
    loop.step(50);
    return loop.output.command[0] - before;
  };
  for (const double slower : {1.0, 2.0, 4.0, 8.0, 8.0})
    EXPECT_NEAR(back_in_50_steps_after_a_gap(), 50 * pace / slower, 1.1 * pace);
  loop.step(10000);
  EXPECT_NEAR(loop.output.command[0], 0.1, 1e-12) << "all is back";
  EXPECT_NEAR(back_in_50_steps_after_a_gap(), 50 * pace, 1.1 * pace) << "and forgotten";
}

TEST(Safety, LetsGoForLateTicksNoFasterThanTheFadeAsksAndForAFaultAsFastAsItMay) {
  for (const bool fault : {false, true}) {
    Loop loop;
    loop.activate();
    const Actuator& actuator = loop.profile.actuators[0];
    const double range = actuator.upper - actuator.lower;
    const double gentle = range / loop.profile.safety.fade * loop.inputs.dt;
    ASSERT_GT(actuator.slew * loop.inputs.dt, 2 * gentle) << "otherwise there is nothing to tell apart";
    loop.inputs.tick_age = 0.05;
    loop.inputs.stop = fault;
    loop.step();
    const double fall = 0.1 - loop.output.command[0];
    // Late ticks: so that all of it is gone after the fade.
    const double late = 0.1 * loop.inputs.dt / loop.profile.safety.fade;
    ASSERT_LE(late, gentle);
    EXPECT_NEAR(fall, fault ? actuator.slew * loop.inputs.dt : late, 1e-12);
  }
}

// A force that is gone in 3 ms is a kick, and no one is in danger.
TEST(Safety, ADisarmAndTheDeadManSwitchLetGoEvenlyWithinTheFade) {
  for (const bool disarm : {false, true}) {
    Loop loop;
    loop.activate();
    loop.inputs.dt = 0.0005;
    const double before = loop.output.command[0];
    loop.inputs.disarm = disarm;
    loop.inputs.dead_man = disarm;
    loop.step(static_cast<int>(0.4 * loop.profile.safety.fade / loop.inputs.dt));
    EXPECT_NEAR(loop.output.command[0], 0.6 * before, 1e-9);
    EXPECT_TRUE(loop.output.device_on);
    if (!disarm) loop.inputs.disarm = true;  // goes on where it is
    loop.step(static_cast<int>(0.4 * loop.profile.safety.fade / loop.inputs.dt));
    EXPECT_NEAR(loop.output.command[0], 0.2 * before, 1e-9);
    loop.step(static_cast<int>(0.2 * loop.profile.safety.fade / loop.inputs.dt) + 1);
    EXPECT_TRUE(loop.output.at_safe_values);
    EXPECT_FALSE(loop.output.device_on);
  }
}

TEST(Safety, ASwitchThatIsHeldAgainWhileForcesAreLetGoOfTakesNoneAwayFaster) {
  Loop loop;
  loop.activate();
  const double pace = 0.1 * loop.inputs.dt / loop.profile.safety.fade;
  for (int i = 0; i < 200; ++i) {
    const double before = loop.output.command[0];
    loop.inputs.dead_man = i % 20 >= 10;
    loop.step();
    EXPECT_LE(before - loop.output.command[0], pace + 1e-12) << i;
  }
  loop.inputs.dead_man = true;
  loop.step(1000);
  EXPECT_NEAR(loop.output.command[0], 0.1, 1e-12);
}

TEST(Safety, AStopWhileForcesAreLetGoOfTakesThemAsFastAsItMay) {
  Loop loop;
  loop.activate();
  loop.inputs.dead_man = false;
  loop.step(5);
  const double before = loop.output.command[0];
  loop.inputs.stop = true;
  loop.step();
  EXPECT_NEAR(before - loop.output.command[0], loop.profile.actuators[0].slew * loop.inputs.dt, 1e-12);
}

TEST(Safety, WhatAnotherLeftIsLetGoOfEvenly) {
  Loop loop;
  loop.memory.output.fill(0.1);
  begin_letting_go(loop.memory);
  for (int i = 1; i <= 25; ++i) {
    loop.inputs.connected = i > 2;
    loop.step();
    EXPECT_NEAR(loop.output.command[0], 0.1 * (1 - i * loop.inputs.dt / loop.profile.safety.fade), 1e-9);
  }
  loop.step(26);
  EXPECT_TRUE(loop.output.at_safe_values);
}

TEST(Safety, AfterALostLinkItContinuesOnlyIfTold) {
  expect_goes_on_softly_only_if_told(&SafetyInputs::connected, SafetyState::disconnected, kAnswerLost);
}

TEST(Safety, AStopDuringALostLinkIsNotForgotten) {
  Loop loop;
  loop.inputs.continue_after_loss = true;
  loop.activate();
  loop.inputs.connected = false;
  loop.step(10);
  loop.inputs.stop = true;
  loop.step();
  loop.inputs.stop = false;
  loop.inputs.connected = true;
  loop.step(10);
  EXPECT_EQ(loop.memory.state, SafetyState::fault);
  loop.inputs.reset = true;
  loop.step(10);
  EXPECT_EQ(loop.memory.state, SafetyState::idle) << "a reset never arms";
}

TEST(Safety, DisarmingIsPossibleFromEverywhere) {
  Loop loop;
  loop.activate();
  loop.inputs.disarm = true;
  loop.expect_fades();
  EXPECT_EQ(loop.memory.state, SafetyState::idle);
  EXPECT_FALSE(loop.output.device_on);
}

TEST(Safety, AStepAcrossTheSafeValueFallsFastAndRisesSlowly) {
  Loop loop;
  loop.profile.actuators[0].slew = 1;  // a step of 1 ms: 0.001 up, 0.02 down
  loop.inputs.wanted[0] = 0.3;
  loop.step();
  loop.inputs.arm = true;
  loop.step(1000);
  ASSERT_NEAR(loop.output.command[0], 0.3, 1e-12);
  loop.inputs.wanted[0] = -0.3;
  loop.step(15);
  EXPECT_NEAR(loop.output.command[0], 0, 1e-12);
  loop.step();
  EXPECT_NEAR(loop.output.command[0], -0.001, 1e-12);
}

// Numbers that a broken program may hand over.
double hostile(test::Random& random, double usual) {
  const double bad[] = {kNan, kInfinity, -kInfinity, 1e308, -1e308, 5e-324, -0.0, 0.0};
  return random.bits() % 50 == 0 ? bad[random.bits() % 8] : usual;
}

struct Promises {
  const DeviceProfile& profile;
  ActuatorArray last{};
  double time_off = 0;  // [s] since it last was active with fresh ticks

  void check(const SafetyInputs& inputs, const SafetyMemory& memory, const SafetyOutput& output) {
    const double dt = std::isfinite(inputs.dt) ? std::min(std::max(inputs.dt, 0.0), 1.0) : 0;
    const bool driven = memory.state == SafetyState::active && inputs.tick_age <= profile.safety.tick_hold;
    time_off = driven ? 0 : time_off + dt;
    for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
      const Actuator& actuator = profile.actuators[i];
      const double now = output.command[i];
      ASSERT_TRUE(std::isfinite(now));
      ASSERT_GE(now, actuator.lower);
      ASSERT_LE(now, actuator.upper);
      const double away = std::fabs(now - actuator.safe) - std::fabs(last[i] - actuator.safe);
      const double fall =
          std::max(actuator.slew, (actuator.upper - actuator.lower) / profile.safety.fade) * dt;
      ASSERT_LE(away, actuator.slew * dt * (1 + 1e-9) + 1e-12);
      ASSERT_LE(std::fabs(now - last[i]), std::max(fall, actuator.slew * dt) * (1 + 1e-9) + 1e-12);
      if (!driven) {
        ASSERT_LE(away, 1e-12) << "only towards safe unless active";
      }
      if (time_off >= profile.safety.fade * (1 + 1e-9)) {
        ASSERT_EQ(now, actuator.safe);
      }
    }
    last = output.command;
  }
};

void check_transition(SafetyState from, std::uint32_t causes_before, const SafetyInputs& inputs,
                      SafetyState to) {
  if (causes_before != 0 && to != SafetyState::fault) {
    ASSERT_TRUE(inputs.reset);
    ASSERT_TRUE(!inputs.stop);
    ASSERT_TRUE(to == SafetyState::idle || to == SafetyState::disconnected);
  }
  if (inputs.stop) {
    ASSERT_EQ(to, SafetyState::fault);
  }
  if (to == SafetyState::active) {
    ASSERT_TRUE(from == SafetyState::armed || from == SafetyState::active);
    ASSERT_TRUE(inputs.dead_man && inputs.connected && !inputs.stop && !inputs.device_fault);
    ASSERT_TRUE(inputs.device_ready);
  }
  if (to == SafetyState::armed && from != SafetyState::armed) {
    ASSERT_TRUE(from == SafetyState::idle || from == SafetyState::active);
    if (from == SafetyState::idle) {
      ASSERT_TRUE(inputs.arm || inputs.continue_after_loss);
    }
  }
}

TEST(Safety, KeepsItsPromisesUnderAnySequenceOfInputs) {
  test::Random random(8);
  std::set<std::pair<SafetyState, SafetyState>> seen;
  for (int round = 0; round < 200; ++round) {
    DeviceProfile profile = test::random_profile(random, 1 + static_cast<int>(random.bits() % 8));
    for (Actuator& actuator : profile.actuators)
      actuator.safe = random.between(actuator.lower, actuator.upper);
    profile.safety.fade = random.between(0.001, 0.2);
    profile.safety.soft_start = random.bits() % 3 == 0 ? 0 : random.between(0, 0.5);
    SafetyMemory memory = start_safety(profile);
    Promises promises{profile, memory.output};
    const std::uint64_t calm = 4 + random.bits() % 200;  // how seldom things go wrong in this round
    for (int i = 0; i < 1500; ++i) {
      SafetyInputs inputs;
      const auto seldom = [&] { return random.bits() % calm == 0; };
      inputs.dt = hostile(random, random.between(0, 0.004));
      inputs.connected = !seldom();
      inputs.device_ready = !seldom();
      inputs.device_fault = seldom();
      inputs.stop = seldom();
      inputs.dead_man = !seldom();
      inputs.heartbeat_lost = seldom();
      inputs.arm = random.bits() % 4 == 0;
      inputs.reset = random.bits() % 8 == 0;
      inputs.disarm = seldom();
      inputs.continue_after_loss = round % 2 == 0;
      inputs.tick_age = hostile(random, seldom() ? random.between(0, 0.2) : 0);
      for (double& wanted : inputs.wanted) {
        wanted = random.between(-20, 20);
        if (random.bits() % 2000 == 0) wanted = hostile(random, kNan);
      }
      const SafetyState from = memory.state;
      const std::uint32_t causes = memory.causes;
      const SafetyOutput output = step_safety(profile, inputs, memory);
      ASSERT_NO_FATAL_FAILURE(promises.check(inputs, memory, output));
      ASSERT_NO_FATAL_FAILURE(check_transition(from, causes, inputs, memory.state));
      seen.emplace(from, memory.state);
    }
  }
  EXPECT_GE(seen.size(), 19u) << "the random walk should take nearly every way there is";
}

TEST(Safety, EveryCombinationOfStateAndSwitchesLeadsWhereItShould) {
  const DeviceProfile profile = test::shipped_profile("exoskeleton");
  for (int bits = 0; bits < 1 << 12; ++bits) {
    for (int state = 0; state < 5; ++state) {
      const auto bit = [&](int k) { return (bits >> k & 1) != 0; };
      SafetyInputs inputs;
      inputs.connected = bit(0);
      inputs.device_ready = bit(1);
      inputs.device_fault = bit(2);
      inputs.stop = bit(3);
      inputs.dead_man = bit(4);
      inputs.heartbeat_lost = bit(5);
      inputs.arm = bit(6);
      inputs.disarm = bit(7);
      inputs.reset = bit(8);
      inputs.continue_after_loss = bit(9);
      inputs.tick_age = bit(10) ? 0 : 1;
      SafetyMemory memory = start_safety(profile);
      memory.state = static_cast<SafetyState>(state);
      memory.causes = memory.state == SafetyState::fault ? static_cast<std::uint32_t>(kStopPressed) : 0;
      memory.arm_again = bit(11);
      const SafetyState from = memory.state;
      const SafetyOutput output = step_safety(profile, inputs, memory);
      const bool trouble =
          inputs.stop || (inputs.connected && (inputs.device_fault || inputs.heartbeat_lost));
      const bool was_on = from == SafetyState::armed || from == SafetyState::active;
      if (trouble || (was_on && !bit(10))) {
        ASSERT_EQ(memory.state, SafetyState::fault);
      } else if (from == SafetyState::fault) {
        ASSERT_EQ(memory.state, !inputs.reset      ? SafetyState::fault
                                : inputs.connected ? SafetyState::idle
                                                   : SafetyState::disconnected);
      } else if (!inputs.connected) {
        ASSERT_EQ(memory.state, SafetyState::disconnected);
      } else if (inputs.disarm) {
        ASSERT_EQ(memory.state, SafetyState::idle);
      } else if (was_on && !inputs.device_ready) {
        ASSERT_EQ(memory.state, SafetyState::idle);
        ASSERT_EQ(memory.arm_again, inputs.continue_after_loss);
      }
      if (memory.state == SafetyState::active) {
        ASSERT_TRUE(was_on && inputs.dead_man && inputs.connected && inputs.device_ready);
      }
      if (memory.state == SafetyState::armed && from == SafetyState::idle) {
        ASSERT_TRUE(inputs.device_ready && (inputs.arm || bit(11)));
      }
      ASSERT_EQ(output.device_on, memory.state == SafetyState::armed || memory.state == SafetyState::active);
      ASSERT_EQ(memory.causes != 0, memory.state == SafetyState::fault);
    }
  }
}

}  // namespace
}  // namespace lumbrical
