// A few cells of bench/delay_sweep: whatever the bus does, no shake and next to no energy into the hand, and
// still something is felt; without the protections there is enough of both.
#include "delayed_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "delay_cells.h"
#include "device_fixture.h"
#include "lumbrical/tick.h"

namespace lumbrical {
namespace {

using namespace bench;

struct Sweep {
  DeviceProfile profile;
  Model model;
  Sweep() {
    const std::string path = std::string(LUMBRICAL_SOURCE_DIR) + "/examples/devices/exoskeleton.json";
    EXPECT_TRUE(load_patient_profile(path, profile).ok());
    EXPECT_TRUE(build_play(Play::grasp, 2e7, model).ok());
  }
  LoopFelt run(const Bus& bus, const LoopOptions& options, double seconds) const {
    DelayedLoop loop;
    loop.bus = bus;
    loop.human = kHands[0].hold;
    loop.friction = 0;
    loop.options = options;
    return run_delayed(model, mug_grasp(model, seconds), profile, loop);
  }
};

Motion beginning_of(Play play, double seconds, const Model& model) {
  Motion motion = play_motion(play, model);
  const auto late = std::find_if(motion.samples.begin(), motion.samples.end(),
                                 [seconds](const auto& sample) { return sample.time > seconds; });
  motion.samples.erase(late, motion.samples.end());
  return motion;
}

void expect_quiet(const LoopFelt& felt) {
  EXPECT_EQ(felt.shakes, 0u);
  EXPECT_LT(felt.given, 1e-3);
  EXPECT_GT(felt.torque, 5e-3) << "something is felt";
}

TEST(DelayedLoop, DoesNotShakeAndGivesNoEnergyWhateverTheBusDoes) {
  const Sweep sweep;
  expect_quiet(sweep.run({Delays::jittering, 0.015, 1000}, {}, 10));
}

// Forces that come back after a gap while others are still being let go of would dip and rise again.
TEST(DelayedLoop, DoesNotShakeWhenTheBusBecomesSlowAtABlow) {
  const Sweep sweep;
  DelayedLoop loop;
  loop.bus = {Delays::stepping, 0.015, 200};
  loop.human = kHands[2].hold;
  loop.friction = 0;
  expect_quiet(run_delayed(sweep.model, mug_grasp(sweep.model, 10), sweep.profile, loop));
}

// A scene, hand and motion the control was not tuned on; while the forces start softly the arm already moves:
// what it seems to give must not be counted for more than acts.
TEST(DelayedLoop, GivesNoEnergyWhileTheArmPressesTheHandOntoSomething) {
  Sweep sweep;
  ASSERT_TRUE(build_play(Play::press, 2e7, sweep.model).ok());
  Motion motion = play_motion(Play::press, sweep.model);
  motion.samples.resize(150);
  DelayedLoop loop;
  loop.bus = {Delays::constant, 0, 1000};
  loop.human = kHands[0].hold;
  loop.friction = 0;
  const LoopFelt felt = run_delayed(sweep.model, motion, sweep.profile, loop);
  EXPECT_LT(felt.given, 0.5e-3);
  EXPECT_GT(felt.torque, 5e-3) << "something is felt";
}

// A limp hand's finger is pushed open to its device's stop.
TEST(DelayedLoop, GivesNoEnergyToALimpHandThatIsPressedOpenToItsEnd) {
  Sweep sweep;
  ASSERT_TRUE(build_play(Play::press, 2e7, sweep.model).ok());
  const Motion motion = beginning_of(Play::press, 3, sweep.model);
  DelayedLoop loop;
  loop.bus = {Delays::constant, 0.005, 1000};
  loop.human = kHands[2].hold;
  loop.friction = 0;
  expect_quiet(run_delayed(sweep.model, motion, sweep.profile, loop));
}

// Its angles are older than its answers, which no measuring of the bus tells.
TEST(DelayedLoop, DoesNotShakeWithSensorsSlowerThanTheBusWhereTheProfileSaysSo) {
  Sweep sweep;
  for (JointDynamics& joint : sweep.profile.dynamics) joint.friction = joint.encoder_step = 0;
  ASSERT_TRUE(build_play(Play::taps, 2e7, sweep.model).ok());
  const Motion motion = beginning_of(Play::taps, 2, sweep.model);
  DelayedLoop loop;
  loop.bus = {Delays::constant, 0.001, 1000};
  loop.human = {1, 0.002};
  loop.friction = 0;
  loop.sensing = 0.02;
  EXPECT_GT(run_delayed(sweep.model, motion, sweep.profile, loop).shakes, 10u) << "unsaid";
  for (Sensor& sensor : sweep.profile.sensors) sensor.delay = loop.sensing;
  expect_quiet(run_delayed(sweep.model, motion, sweep.profile, loop));
}

// A line of 115200 baud takes 18 ms. What the device's own loop could bear is not what models can that are as
// old as such exchanges.
TEST(DelayedLoop, IsFeltThroughLocalModelsOnSlowBusesAndDoesNotShake) {
  Sweep sweep;
  DeviceProfile serial;
  const std::string path = std::string(LUMBRICAL_SOURCE_DIR) + "/examples/devices/exoskeleton_serial.json";
  ASSERT_TRUE(load_patient_profile(path, serial).ok());
  DelayedLoop loop;
  loop.human = kHands[0].hold;
  loop.bus = {Delays::constant, 0.018, 200};
  expect_quiet(run_delayed(sweep.model, mug_grasp(sweep.model, 4), serial, loop));
  ASSERT_TRUE(build_play(Play::press, 2e7, sweep.model).ok());
  loop.bus = {Delays::constant, 0.05, 200};
  const LoopFelt felt = run_delayed(sweep.model, play_motion(Play::press, sweep.model), serial, loop);
  EXPECT_EQ(felt.shakes, 0u);
  EXPECT_LT(felt.given, 5e-3);
  EXPECT_GT(felt.torque, 1e-3);
}

/// A hand that holds the mug still, with the loop's command tick by tick.
struct HeldMug {
  const Sweep sweep;
  const DeviceFrame held = resample(mug_grasp(sweep.model, 10), 4);
  HapticLoop loop;
  State state;
  Scratch scratch = make_scratch(sweep.model);
  std::int64_t now = 0;

  HeldMug(const DeviceProfile& profile, bool feedback) {
    LoopOptions options;
    options.feedback = feedback;
    options.limiter = options.account = false;  // they let nothing through before exchanges are measured
    loop = start_loop(profile, options);
    certify_loop(loop);
  }
  DeviceCommand step(std::uint32_t invalid = 0) {
    DeviceFeedback said;
    said.asked = now;
    said.time = now += 1'000'000;
    said.angle = held.angle;
    said.valid = ((1u << kAngleCount) - 1) & ~invalid;
    take_feedback(said, loop);
    DeviceFrame frame = held;
    frame.angle[5] -= loop.options.feedback ? 0.3f : 0;  // the motion's
    put_angles(loop, now, frame);
    const ActuatorFrame output = tick(sweep.model, state, scratch, frame);
    return command_forces(sweep.model, scratch, frame, output, now, loop);
  }
};

// The tick has the motion's angle where the device's is not believed; round that a local model would make
// another torque of the device's own angle, at once and up to twice as large.
TEST(DelayedLoop, GivesADeviceNoLocalModelRoundAnAngleThatIsNotItsOwn) {
  for (const bool feedback : {true, false}) {
    HeldMug mug(test::shipped_profile("exoskeleton_serial"), feedback);
    DeviceCommand command;
    for (int i = 0; i < 500; ++i) command = mug.step();
    EXPECT_GT(command.wanted[3], 0.02);
    EXPECT_EQ(command.stiffness[3] > 0, feedback);
    command = mug.step(1u << 5);
    EXPECT_GT(command.wanted[3], 0.02) << "it fades";
    EXPECT_EQ(command.stiffness[3], 0) << "it is not what the motion's angle makes of it";
    EXPECT_EQ(command.radius[3], 0);
    EXPECT_EQ(command.stiffness[6] > 0, feedback) << "the others' angles are believed";
  }
}

// What a limit has cut neither comes back as the joint closes nor is taken off as it begins to open.
TEST(DelayedLoop, LetsNoLocalModelGoBeyondAnActuatorsLimits) {
  DeviceProfile profile = test::shipped_profile("exoskeleton_serial");
  double limited = 0;
  for (const double upper : {0.3, 0.1, 0.03, 0.02}) {
    for (Actuator& actuator : profile.actuators) actuator.upper = std::min(actuator.upper, upper);
    HeldMug mug(profile, true);
    DeviceCommand command;
    for (int i = 0; i < 500; ++i) command = mug.step();
    for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
      const double reached = command.wanted[i] + command.stiffness[i] * command.radius[i];
      EXPECT_LT(reached, profile.actuators[i].upper + 1e-12) << upper << ' ' << i;
      if (command.wanted[i] == profile.actuators[i].upper) limited += command.stiffness[i];
    }
  }
  EXPECT_GT(limited, 0) << "no limit was met";
}

// What is lost is time without a command, which the certificate has to know of.
TEST(DelayedLoop, IsFeltAndDoesNotShakeWhereEverySecondRequestIsLost) {
  const Sweep sweep;
  expect_quiet(sweep.run({Delays::constant, 0.0005, 1000, 2}, {}, 10));
}

// Three hundred ticks pass before a command's reply comes.
TEST(DelayedLoop, DoesNotShakeWhereTicksAreFarFasterThanTheBus) {
  Sweep sweep;
  Settings settings = sweep.model.settings;
  settings.rate = 10000;
  Model fast;
  ASSERT_TRUE(change_settings(sweep.model, settings, 1, fast).ok());
  DelayedLoop loop;
  loop.bus = {Delays::stepping, 0.03, 1000};
  loop.human = kHands[0].hold;
  loop.friction = 0;
  expect_quiet(run_delayed(fast, mug_grasp(fast, 2), sweep.profile, loop));
}

// An invalid wrist stands anywhere: that it seems to have gone there, and come back, is no work of the arm.
TEST(DelayedLoop, CountsNoWorkOfAnArmThatIsNotTracked) {
  const Sweep sweep;
  State state;
  Scratch scratch = make_scratch(sweep.model);
  HapticLoop loop = start_loop(sweep.profile, {});
  const DeviceFrame held = resample(mug_grasp(sweep.model, 10), 4);
  const auto feel = [&](const DeviceFrame& frame) {
    const ActuatorFrame output = tick(sweep.model, state, scratch, frame);
    static_cast<void>(command_forces(sweep.model, scratch, frame, output, 0, loop));
    double force = 0;
    for (const Wrench& wrench : output.segment) force += norm(wrench.force);
    return force;
  };
  for (int i = 0; i < 100; ++i) {
    const double force = feel(held);
    EXPECT_TRUE(i < 50 || force > 1) << i;
  }
  const auto before = loop.arm;
  DeviceFrame lost = held;
  lost.base = {{0.5, 0.5, 0.5}, {}};
  lost.flags |= kTrackingLost;
  EXPECT_GT(feel(lost), 1) << "forces fade, they don't end";
  EXPECT_GT(feel(held), 1);
  EXPECT_EQ(loop.arm, before);
  DeviceFrame moved = held;
  moved.base.position.z += 0.001;
  feel(moved);
  EXPECT_NE(loop.arm, before) << "but that of one that is";
}

// A bus that becomes fifty times slower from one exchange to the next: what the certificate then allows is a
// small part of what acts.
TEST(DelayedLoop, LetsGoOfATorqueWithoutAKickWhenTheBusBecomesSlow) {
  const Sweep sweep;
  const DeviceFrame frame = resample(mug_grasp(sweep.model, 10), 4);
  State state;
  Scratch scratch = make_scratch(sweep.model);
  LoopOptions options;
  options.feedback = false;
  HapticLoop loop = start_loop(sweep.profile, options);
  std::int64_t now = 0;
  SentCommand sent;
  const auto exchange = [&](std::int64_t time) {  // [ns] it takes; a tick before and one behind it
    const ActuatorFrame output = tick(sweep.model, state, scratch, frame);
    const DeviceCommand command = command_forces(sweep.model, scratch, frame, output, now, loop);
    ++sent.cycle;
    sent.tick = command.tick;
    sent.sent = now;
    sent.acknowledged = now += time;
    sent.loop_delay = 2 * time;
    note_exchange(sent, loop);
    double squares = 0;
    for (const double value : command.wanted) squares += value * value;
    return std::sqrt(squares);
  };
  for (int i = 0; i < 3; ++i) exchange(1'000'000);
  certify_loop(loop);
  double before = 0;
  for (int i = 0; i < 3000; ++i) before = exchange(1'000'000);
  ASSERT_GT(before, 0.05);
  double least = before;
  for (int i = 0; i < 40; ++i) {
    const double torque = exchange(50'000'000);
    EXPECT_GT(torque, 0.69 * least) << i;
    least = torque;
  }
  EXPECT_LT(least, 0.2 * before) << "but it does let go";
}

// Opens and closes once.
double swing(int tick) { return 0.7 + 0.6 * std::cos(0.00628 * tick); }

// A free hand whose joints have these angles, with the same commands acting all the while; in the middle
// there is no tick for some seconds, in which the device is silent or not.
HapticLoop move_freely(const Sweep& sweep, const DeviceProfile& profile, double command,
                       const std::function<double(int)>& angle = swing, int pause = 0, bool silent = false) {
  HapticLoop loop = start_loop(profile, {});
  State state;
  Scratch scratch = make_scratch(sweep.model);
  DeviceFrame frame = resample(mug_grasp(sweep.model, 10), 0);
  frame.base.position.x += 1;
  certify_loop(loop);
  std::int64_t held_since = 0;
  for (int i = 0; i <= 1000; ++i) {
    DeviceFeedback said;
    said.asked = i * 1'000'000 + (i > 500 ? pause : 0) * 1'000'000'000ll;
    said.time = said.asked + 500'000;
    if (i == 501 && silent) held_since = said.time;
    said.held_since = held_since;
    said.valid = (1u << kAngleCount) - 1;
    said.angle.fill(static_cast<float>(angle(i)));
    said.acted.fill(command);
    take_feedback(said, loop);
    put_angles(loop, said.time, frame);
    const ActuatorFrame output = tick(sweep.model, state, scratch, frame);
    command_forces(sweep.model, scratch, frame, output, said.time, loop);
  }
  return loop;
}

// A wire's preload pulls whether something is touched or not: the way a free hand makes under it is no touch.
TEST(DelayedLoop, CountsNoEnergyOfWiresThatOnlyHoldTheirPreload) {
  const HapticLoop loop = move_freely({}, test::shipped_profile("wire_glove"), 0.8);
  for (const EnergyAccount& account : loop.account) {
    EXPECT_EQ(account.generated, 0);
    EXPECT_EQ(account.energy, 0) << "nothing that could pay for a touch, either";
  }
}

// A cable that is out, and fingers that open meanwhile: the device has let go, whatever it was told last.
TEST(DelayedLoop, CountsNoEnergyOverATimeInWhichTheDeviceIsSilent) {
  const Sweep sweep;
  const auto opens = [](int tick) { return tick > 500 ? 0.3 : 0.9; };
  const HapticLoop loop = move_freely(sweep, sweep.profile, 0.3, opens, 1, true);
  for (const EnergyAccount& account : loop.account) EXPECT_EQ(account.generated, 0);
}

// Ticks that are farther apart than that, and a device that holds its command all the while.
TEST(DelayedLoop, CountsTheEnergyOfTicksThatAreFarApart) {
  const Sweep sweep;
  const auto opens = [](int tick) { return tick > 500 ? 0.3 : 0.9; };
  const HapticLoop loop = move_freely(sweep, sweep.profile, 0.3, opens, 1);
  for (const EnergyAccount& account : loop.account)
    EXPECT_NEAR(account.generated, 3 * 0.3 * 0.6, 0.05) << "but for what damping took";
}

DeviceProfile brakes_with(double arm) {
  DeviceProfile profile = test::shipped_profile("exoskeleton");
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    profile.actuators[i].drive = Drive::brake;
    profile.actuators[i].lower = 0;
    profile.actuators[i].arm[i] = arm;
  }
  return profile;
}

// Joints that stand still between two of their encoders' steps go nowhere.
TEST(DelayedLoop, CountsNoEnergyOfBrakesThatHoldAJointStill) {
  const DeviceProfile profile = brakes_with(1);
  const double step = profile.dynamics[0].encoder_step;
  ASSERT_GT(step, 0);
  const HapticLoop loop = move_freely({}, profile, 0.1, [step](int tick) { return 0.7 + tick % 2 * step; });
  for (const EnergyAccount& account : loop.account) EXPECT_LT(account.energy, 1e-9);
}

// Whichever way a joint goes, and its arm is written down.
TEST(DelayedLoop, CountsWhatBrakesTakeAsTaken) {
  for (const double arm : {1.0, -1.0}) {
    const HapticLoop loop = move_freely({}, brakes_with(arm), 0.1);
    for (const EnergyAccount& account : loop.account) {
      EXPECT_EQ(account.generated, 0) << arm;
      EXPECT_GT(account.energy, 3 * 0.1 * 2.3) << arm;
    }
  }
}

TEST(DelayedLoop, ShakesAndGivesEnergyWithoutProtectionAndTheAccountsAloneBoundIt) {
  LoopOptions none, accounts;
  none.limiter = none.account = none.follow = none.gaps = false;
  accounts.limiter = false;
  const Sweep sweep;
  const LoopFelt felt = sweep.run({Delays::jittering, 0.05, 1000}, none, 4);
  EXPECT_GT(felt.given, 10e-3);
  EXPECT_GT(felt.shakes, 10u);
  EXPECT_LT(sweep.run({Delays::jittering, 0.05, 1000}, accounts, 4).given, 0.05 * felt.given);
}

TEST(DelayedLoop, GivesTheSameBitsEveryTime) {
  const Sweep sweep;
  const Bus bus = {Delays::growing, 0.015, 1000};
  DelayedLoop loop;
  loop.bus = bus;
  const Motion motion = mug_grasp(sweep.model, 0.5);
  const LoopFelt first = run_delayed(sweep.model, motion, sweep.profile, loop);
  const LoopFelt second = run_delayed(sweep.model, motion, sweep.profile, loop);
  EXPECT_EQ(first.torque, second.torque);
  EXPECT_EQ(first.taken, second.taken);
}

}  // namespace
}  // namespace lumbrical
