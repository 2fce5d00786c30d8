// The loop as a library, without a thread: a hand on a plate, and a device that is a function in this
// process.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "device_fixture.h"
#include "lumbrical/loop.h"
#include "lumbrical/motion.h"
#include "lumbrical/real_time.h"
#include "lumbrical/shapes.h"

namespace lumbrical {
namespace {

constexpr float kAngle = 0.3f;  // [rad] that every joint is at

struct HeldDevice {
  ActuatorArray value{};
  std::array<float, kAngleCount> off{};  // [rad] from kAngle
  bool on = false, there = true, held = true, ready = true;
  bool cuts = false;     // the next exchange
  double missing = 0;    // [s] that the next exchange waits for an answer in vain
  double answering = 0;  // [s] that the next answer takes once the command is there
  double greeting = 0;   // [s] before the next commands
  bool silent = false;   // takes connections and commands, and answers none
  bool echoes = false;   // each heartbeat
  bool busy = false;     // the next answer repeats the last heartbeat once more
  std::uint16_t echo = 0;
  std::function<void()> while_connecting = [] {};
  int exchanges = 0, connections = 0, unanswered = 0;
};

void sleep_for(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

class HeldWire final : public DeviceWire {
 public:
  HeldWire(HeldDevice& device, const DeviceProfile& profile) : device_(device), profile_(profile) {}
  Status open() override {
    device_.while_connecting();
    if (!device_.there) return Status::error("not there");
    ++device_.connections;
    return {};
  }
  void close() override {}
  WireResult greet() override {
    sleep_for(device_.greeting);
    return {};
  }
  WireResult exchange(const WireCommand& command, WireAnswer& answer) override {
    if (!device_.there || std::exchange(device_.cuts, false)) return {WireOutcome::broken, "gone"};
    if (device_.missing > 0) {
      sleep_for(std::exchange(device_.missing, 0));
      return {WireOutcome::missed, "no answer"};
    }
    if (device_.silent) {
      ++device_.unanswered;
      return {WireOutcome::missed, "no answer"};
    }
    ++device_.exchanges;
    device_.value = command.output.command;
    device_.on = command.output.device_on;
    sleep_for(std::exchange(device_.answering, 0));
    answer.status.ready = device_.ready;
    answer.status.echoes = device_.echoes;
    if (!std::exchange(device_.busy, false)) ++device_.echo;
    answer.status.echo = device_.echo;
    answer.status.has_dead_man = true;
    answer.status.dead_man = device_.held;
    for (const Sensor& sensor : profile_.sensors) {
      const auto a = static_cast<std::size_t>(sensor.angle);
      answer.angle[a] = kAngle + device_.off[a];
      answer.valid |= 1u << sensor.angle;
    }
    return {};
  }

 private:
  HeldDevice& device_;
  DeviceProfile profile_;
};

class DeviceLoopTest : public ::testing::Test {
 protected:
  DeviceLoopTest() {
    profile = test::shipped_profile("exoskeleton");
    profile.rate = 1000;
    profile.safety.soft_start = 0.02;
    profile.safety.tick_hold = 1;
    profile.safety.tick_timeout = 10;
    profile.safety.answer_timeout = 10;
    Scene scene;
    scene.hand = default_hand(Side::right);
    // Under the index, as the device's angles have it.
    std::array<double, kAngleCount> angles{};
    for (const Sensor& sensor : profile.sensors) angles[static_cast<std::size_t>(sensor.angle)] = kAngle;
    std::array<Pose, kJointCount> X_WJ;
    forward_kinematics(scene.hand, {}, angles, X_WJ);
    SceneObject ball;
    ball.name = "ball";
    ball.mesh = make_sphere(0.03, 12);
    place_mesh({X_WJ[kIndexTip].position + Vec3{0, -0.03, 0}, {}}, ball.mesh);
    scene.objects.push_back(std::move(ball));
    EXPECT_TRUE(build_model(scene, {}, model).ok());
    scratch = make_scratch(model);
    state = make_state(model);
    frame.kind = InputKind::joint_angles;
    frame.valid = (1u << kJointCount) - 1;
  }
  void open(bool stop_on_loss = false, bool limits = true) {
    LoopSettings settings;
    settings.stop_on_loss = stop_on_loss;
    settings.control.limiter = settings.control.account = settings.control.gaps = limits;
    ASSERT_TRUE(loop.open(model, profile, std::make_unique<HeldWire>(device, profile), settings).ok());
    ASSERT_TRUE(loop.measure(model, scratch, frame, 0.02));
    ASSERT_TRUE(loop.start(model, scratch, frame));
  }
  bool step() {
    LoopStep next;
    next.frame = frame;
    const bool goes_on = loop.step(model, state, scratch, next);
    felt = next;
    return goes_on;
  }
  // Through another link, by a loop without a sink.
  LoopStep step_through(DeviceLink& link, HapticLoop& control) {
    LoopStep next;
    next.frame = frame;
    const auto feel = [this](LoopStep& now) {
      now.output = tick(model, state, scratch, now.frame);
      return true;
    };
    step_loop(model, scratch, feel, link, control, next);
    return next;
  }
  void step_through(DeviceLink& link, HapticLoop& control, int count) {
    for (; count > 0; --count) step_through(link, control);
  }
  // A loop without limiter and accounts.
  HapticLoop plain_loop() const {
    LoopOptions options;
    options.limiter = options.account = false;
    return start_loop(profile, options);
  }
  double told() const {
    double sum = 0;
    for (std::size_t i = 0; i < profile.actuators.size(); ++i) sum += std::fabs(device.value[i]);
    return sum;
  }
  // As far as it takes on however slow a machine.
  bool steps_until(const std::function<bool()>& holds) {
    for (int i = 0; i < 20000; ++i)
      if (step(); holds()) return true;
    return false;
  }
  bool exchanges(int count) {
    const int before = device.exchanges;
    return steps_until([&] { return device.exchanges >= before + count; });
  }
  DeviceProfile profile;
  HeldDevice device;
  Model model;
  Scratch scratch;
  State state;
  DeviceFrame frame;
  DeviceLoop loop;
  LoopStep felt;
};

TEST_F(DeviceLoopTest, NothingReachesADeviceBeforeTheStartAndForcesDoAfterIt) {
  LoopSettings settings;
  ASSERT_TRUE(loop.open(model, profile, std::make_unique<HeldWire>(device, profile), settings).ok());
  ASSERT_TRUE(loop.measure(model, scratch, frame, 0.05));
  EXPECT_GT(device.exchanges, 2) << "it was spoken to";
  EXPECT_FALSE(device.on);
  EXPECT_EQ(told(), 0);
  ASSERT_TRUE(loop.start(model, scratch, frame));
  EXPECT_TRUE(steps_until([&] { return told() > 0; }));
  EXPECT_GT(felt.output.contact_count, 0u);
  EXPECT_EQ(felt.frame.angle[5], kAngle) << "the device's fingers, not the motion's";
  EXPECT_TRUE(loop.close());
  EXPECT_EQ(told(), 0);
  EXPECT_FALSE(device.on);
  EXPECT_TRUE(loop.figures.safe_at_end && loop.figures.was_active);
}

// Nothing is passive before that.
TEST_F(DeviceLoopTest, TheLeastFactorOfAFingerThatTouchesNothingIsNoneOfTheTimeBeforeTheBusWasMeasured) {
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  for (const std::size_t finger : {2, 3, 4}) EXPECT_EQ(loop.control.least_factor[finger], 1);
}

// Who would arm before its last step, by a signal say, can tell.
TEST_F(DeviceLoopTest, SaysWhetherItsOwnArmingIsBehindIt) {
  for (int times = 0; times < 2; ++times) {
    ASSERT_TRUE(loop.open(model, profile, std::make_unique<HeldWire>(device, profile), {}).ok());
    EXPECT_FALSE(loop.started());
    ASSERT_TRUE(loop.measure(model, scratch, frame, 0.02));
    EXPECT_FALSE(loop.started());
    ASSERT_TRUE(loop.start(model, scratch, frame));
    EXPECT_TRUE(loop.started());
    loop.close();
  }
}

TEST_F(DeviceLoopTest, AnEmergencyStopFadesAndOnlyAResetAndArmingBringForcesBack) {
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  loop.sink.press_stop(true);
  EXPECT_TRUE(steps_until([&] { return told() == 0 && loop.sink.state() == SafetyState::fault; }));
  loop.sink.press_stop(false);
  for (int i = 0; i < 20; ++i) step();
  EXPECT_EQ(told(), 0);
  loop.sink.request_reset();
  loop.sink.arm_when_ready();
  EXPECT_TRUE(steps_until([&] { return told() > 0; }));
}

// One broken sensor must not be blamed for what another says later.
TEST_F(DeviceLoopTest, NamesTheJointWhoseAngleIsNotBelieved) {
  open();
  std::string log;
  const auto tells = [&](const std::string& text) {
    for (const SinkEvent& event : loop.sink.events()) log += event.text + "\n";
    return log.find(text) != std::string::npos;
  };
  device.off[1] = 10;
  EXPECT_TRUE(steps_until([&] { return tells("angle of thumb metacarpal out of its range"); })) << log;
  EXPECT_TRUE(steps_until([&] {
    device.off[5] = 2 - device.off[5];
    return tells(" jumps");
  }));
  EXPECT_TRUE(tells("angle of index proximal jumps farther")) << log;
}

// A sensor that was dead from the start says the same: only a finger that has moved tells the two apart.
TEST_F(DeviceLoopTest, ToldThatAnAngleIsStuckAFingerAtItsStopKnowsWhatToDo) {
  for (Actuator& actuator : profile.actuators) {
    actuator.lower = -0.02;
    actuator.upper = 0.02;
  }
  for (JointDynamics& joint : profile.dynamics) joint.friction = 0;
  open(false, false);
  std::string log;
  EXPECT_TRUE(steps_until([&] {
    for (const SinkEvent& event : loop.sink.events()) log += event.text + "\n";
    return log.find("must move it; if it stands at its stop, bend it once by half a radian") !=
           std::string::npos;
  })) << log;
}

TEST_F(DeviceLoopTest, ADisarmEndsAnArmingThatStillWaitsForTheDevice) {
  device.ready = false;
  open();
  ASSERT_TRUE(exchanges(3));
  loop.sink.request_disarm();
  ASSERT_TRUE(exchanges(3));
  device.ready = true;
  ASSERT_TRUE(exchanges(50));
  EXPECT_EQ(loop.sink.state(), SafetyState::idle);
  EXPECT_FALSE(device.on);
  loop.sink.arm_when_ready();
  EXPECT_TRUE(steps_until([&] { return told() > 0; }));
}

TEST_F(DeviceLoopTest, AnArmingAskedForWhileForcesFlowUndoesNoLaterDisarm) {
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  loop.sink.arm_when_ready();
  ASSERT_TRUE(exchanges(3));
  loop.sink.request_disarm();
  ASSERT_TRUE(steps_until([&] { return !device.on; }));
  ASSERT_TRUE(exchanges(50));
  EXPECT_EQ(loop.sink.state(), SafetyState::idle);
  EXPECT_FALSE(device.on);
}

TEST_F(DeviceLoopTest, AnArmingAskedForWhileForcesFlowUndoesNoLaterLoss) {
  profile.safety.answer_timeout = 0.1;
  open(true);
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  loop.sink.arm_when_ready();
  ASSERT_TRUE(exchanges(3));
  device.there = false;
  ASSERT_TRUE(steps_until([&] { return loop.sink.state() == SafetyState::disconnected; }));
  device.there = true;
  ASSERT_TRUE(exchanges(50));
  EXPECT_NE(loop.sink.state(), SafetyState::active);
  EXPECT_FALSE(device.on);
}

TEST_F(DeviceLoopTest, AnArmingAskedForInAFaultThatStaysIsNotKeptForALaterReset) {
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  loop.sink.press_stop(true);
  ASSERT_TRUE(exchanges(3));
  loop.sink.request_reset();
  loop.sink.arm_when_ready();
  ASSERT_TRUE(exchanges(3));
  loop.sink.press_stop(false);
  loop.sink.request_reset();
  ASSERT_TRUE(exchanges(50));
  EXPECT_EQ(loop.sink.state(), SafetyState::idle) << "a reset never arms";
  EXPECT_FALSE(device.on);
}

// The device's own watchdog has let go in the meantime: the old force would be a pulse.
TEST_F(DeviceLoopTest, WhatActedBeforeALongSilenceIsGoneAfterIt) {
  profile.safety.answer_timeout = 0.1;
  profile.safety.fade = 0.2;
  for (Actuator& actuator : profile.actuators) actuator.slew = 0.1;
  open(false, false);  // of long delays the limiter would leave no force to come again
  const auto silences = {+[](HeldDevice& one) { one.missing = 0.3; },
                         +[](HeldDevice& one) {
                           one.cuts = true;
                           one.greeting = 0.3;
                         },
                         +[](HeldDevice&) { sleep_for(0.3); }};
  for (const auto& begin_silence : silences) {
    ASSERT_TRUE(steps_until([&] { return told() > 0.02; }));
    begin_silence(device);
    ASSERT_TRUE(exchanges(1));
    EXPECT_EQ(told(), 0);
    EXPECT_FALSE(device.on);
    step();
    EXPECT_EQ(loop.control.feedback.acted, ActuatorArray{}) << "whatever it was told before";
    device.greeting = 0;
  }
  EXPECT_TRUE(steps_until([&] { return told() > 0.02; })) << "and comes back";
}

// A drive that lets go for a moment, and answers all the while.
TEST_F(DeviceLoopTest, WhatActedBeforeADeviceWasNotReadyIsGoneWhenItIsAgainAndTookNoEnergy) {
  open(false, false);
  ASSERT_TRUE(steps_until([&] { return told() > 0.02; }));
  device.ready = false;
  ASSERT_TRUE(steps_until([&] { return told() == 0; }));
  step();
  EXPECT_EQ(told(), 0);
  EXPECT_FALSE(device.on);
  EXPECT_EQ(loop.control.feedback.acted, ActuatorArray{});
  EXPECT_EQ(loop.control.feedback.held_since, loop.control.feedback.time);
  EXPECT_EQ(loop.sink.report().lapses, 1u);
  EXPECT_EQ(loop.sink.report().losses, 0u);
  bool is_told = false;
  for (const SinkEvent& event : loop.sink.events())
    is_told = is_told || event.text == "active -> idle: the device is not ready";
  EXPECT_TRUE(is_told);
  device.ready = true;
  EXPECT_TRUE(steps_until([&] { return told() > 0; })) << "and comes back";
}

// Its watchdog counts from the last command, not from when the answer to that has come.
TEST_F(DeviceLoopTest, WhatActedBeforeALateAnswerAndALostOneIsGoneAfterThem) {
  profile.safety.answer_timeout = 0.1;
  for (Actuator& actuator : profile.actuators) actuator.slew = 0.1;
  open(false, false);
  ASSERT_TRUE(steps_until([&] { return told() > 0.02; }));
  device.answering = 0.06;
  ASSERT_TRUE(exchanges(1));
  device.missing = 0.06;
  ASSERT_TRUE(exchanges(1));
  EXPECT_EQ(told(), 0);
  EXPECT_FALSE(device.on);
}

// It may be another one, or one that was switched on again: what it has not been told yet does not act.
TEST_F(DeviceLoopTest, WhatActedOnALostConnectionFadesWhileANewOneIsMadeHoweverQuickly) {
  profile.safety.fade = 0.2;
  for (Actuator& actuator : profile.actuators) actuator.slew = 0.1;
  open(false, false);
  ASSERT_TRUE(steps_until([&] { return told() > 0.02; }));
  device.cuts = true;
  device.greeting = 0.3;  // less than it may be silent for
  ASSERT_TRUE(exchanges(1));
  EXPECT_EQ(told(), 0);
  EXPECT_FALSE(device.on);
}

// A device that sends each answer twice, say.
TEST_F(DeviceLoopTest, AConnectionThatBreaksAgainAtOnceIsMadeEverMoreSeldom) {
  open();
  ASSERT_TRUE(exchanges(3));
  const std::int64_t begun = clock_ns();
  const int before = device.connections;
  ASSERT_TRUE(steps_until([&] {
    device.cuts = device.exchanges % 2 == 0;
    return clock_ns() - begun > 500000000;
  }));
  const double passed = 1e-9 * static_cast<double>(clock_ns() - begun);
  EXPECT_LE(device.connections - before, 2 + passed / profile.first_retry);
}

TEST_F(DeviceLoopTest, AnswersThatAreLostAgainAndAgainAreToldOnceASecondWithTheirNumber) {
  open();
  const std::int64_t begun = clock_ns();
  int told_of_it = 0;
  std::string last;
  ASSERT_TRUE(steps_until([&] {
    if (device.exchanges % 3 == 0) device.missing = 1e-4;
    exchanges(1);
    for (const SinkEvent& event : loop.sink.events())
      if (event.text.find("no answer") == 0) ++told_of_it, last = event.text;
    return told_of_it == 2;
  }));
  const double passed = 1e-9 * static_cast<double>(clock_ns() - begun);
  EXPECT_GE(passed, 1);
  EXPECT_NE(last.find(" times since that was told: what is sent or answered is lost on the way"),
            std::string::npos)
      << last;
}

// To find a host by its name may take the system half a minute.
TEST_F(DeviceLoopTest, ALostConnectionIsToldBeforeANewOneIsMade) {
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  SafetyState meanwhile = loop.sink.state();
  ASSERT_EQ(meanwhile, SafetyState::active);
  device.while_connecting = [&] { meanwhile = loop.sink.state(); };
  device.cuts = true;
  ASSERT_TRUE(exchanges(1));
  EXPECT_EQ(meanwhile, SafetyState::disconnected);
}

// Its first answer may come before its program has seen another heartbeat.
TEST_F(DeviceLoopTest, ADeviceThatWasBusyForLongHasTimeAgainToRepeatTheHeartbeat) {
  profile.safety.answer_timeout = 0.1;
  device.echoes = true;
  open(false, false);
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  device.missing = 0.3;
  device.busy = true;
  ASSERT_TRUE(exchanges(3));
  EXPECT_EQ(loop.sink.report().faults, 0u);
  EXPECT_TRUE(steps_until([&] { return told() > 0; }));
}

TEST_F(DeviceLoopTest, ANewConnectionIsNoDeviceBeforeItHasAnsweredACommand) {
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  const int before = device.connections;
  device.cuts = device.silent = true;
  ASSERT_TRUE(steps_until([&] { return loop.sink.state() == SafetyState::disconnected; }));
  ASSERT_TRUE(steps_until([&] { return device.connections > before; }));
  for (device.unanswered = 0; device.unanswered < 20;) {
    step();
    EXPECT_EQ(loop.sink.state(), SafetyState::disconnected) << "however lately the old one has answered";
  }
  device.silent = false;
  EXPECT_TRUE(steps_until([&] { return loop.sink.state() == SafetyState::active; }));
}

TEST_F(DeviceLoopTest, StatesAreRecordedAsTheyAreToldAlsoWhileNothingCanBeSent) {
  open();
  std::vector<std::string> told_states, recorded_states;
  SafetyState recorded = SafetyState::disconnected;
  const auto steps_recording_until = [&](const std::function<bool()>& holds) {
    return steps_until([&] {
      for (std::uint32_t i = 0; i < felt.sent_count; ++i) {
        const SafetyState before = std::exchange(recorded, felt.sent[i].state);
        if (recorded != before)
          recorded_states.push_back(std::string(safety_state_name(before)) + " -> " +
                                    std::string(safety_state_name(recorded)));
        EXPECT_EQ(felt.sent[i].sent == 0, felt.sent[i].actuator_count == 0);
      }
      return holds();
    });
  };
  const auto records = [&](SafetyState wanted) {
    return steps_recording_until([&] { return recorded == wanted; });
  };
  ASSERT_TRUE(records(SafetyState::active));
  loop.sink.events();
  recorded_states.clear();
  device.there = false;
  EXPECT_TRUE(records(SafetyState::disconnected)) << "nothing can be sent, and all the same";
  loop.sink.press_stop(true);
  EXPECT_TRUE(records(SafetyState::fault));
  loop.sink.press_stop(false);
  loop.sink.request_reset();
  EXPECT_TRUE(records(SafetyState::disconnected));
  device.there = true;
  EXPECT_TRUE(records(SafetyState::idle));
  for (const SinkEvent& event : loop.sink.events())
    if (event.text.find(" -> ") != std::string::npos)
      told_states.push_back(event.text.substr(0, event.text.find(':')));
  EXPECT_EQ(recorded_states, told_states);
}

TEST_F(DeviceLoopTest, ALostDeviceEndsTheSessionWhereThatWasAskedFor) {
  open(true);
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  device.there = false;
  EXPECT_TRUE(steps_until([&] { return !step(); }));
  EXPECT_FALSE(loop.close()) << "no one has acknowledged safe values";
}

// The sink's thread goes on with the last command while a recording is opened and memory locked.
TEST_F(DeviceLoopTest, WhatPassesBetweenMeasuringAndTheStartIsNoDelayOfTheBus) {
  LoopSettings settings;
  settings.sink.thread = true;
  ASSERT_TRUE(loop.open(model, profile, std::make_unique<HeldWire>(device, profile), settings).ok());
  ASSERT_TRUE(loop.measure(model, scratch, frame, 0.05));
  ASSERT_TRUE(is_measured(loop.control.meter));
  sleep_for(0.8);
  ASSERT_TRUE(loop.start(model, scratch, frame));
  for (int i = 0; i < 1000; ++i) step();
  EXPECT_LT(loop.control.slowest.delay, 0.4);
  EXPECT_LT(loop.control.certificate.timing.delay, 0.4);
  EXPECT_TRUE(loop.close());
}

// Of a bus that makes many exchanges between two steps.
class BusyLink final : public DeviceLink {
 public:
  [[nodiscard]] std::int64_t now() const noexcept override { return clock_ns(); }
  bool feedback(DeviceFeedback&) noexcept override { return false; }
  bool sent(SentCommand& command) noexcept override {
    if (waiting == 0) return false;
    --waiting;
    command.cycle = ++cycle;
    command.acknowledged = 1;
    return true;
  }
  void publish(const DeviceCommand&) noexcept override {}
  int waiting = 0;
  std::uint64_t cycle = 0;
};

TEST_F(DeviceLoopTest, EveryExchangeOfAFastBusIsNotedInItsStepAndTheNewestAreKept) {
  HapticLoop control = start_loop(profile, {});
  BusyLink link;
  for (int i = 1; i <= 5; ++i) {
    link.waiting = 20;
    const LoopStep next = step_through(link, control);
    EXPECT_EQ(control.answered.cycle, 20u * static_cast<unsigned>(i));
    ASSERT_EQ(next.sent_count, kMaxSentPerTick);
    for (std::uint32_t k = 0; k < kMaxSentPerTick; ++k)
      EXPECT_EQ(next.sent[k].cycle, link.cycle - kMaxSentPerTick + 1 + k);
  }
}

// The loop that is told of exchanges by hand; all times in milliseconds.
class Exchanges {
 public:
  explicit Exchanges(HapticLoop& loop) : loop_(loop) { certify_loop(loop); }
  void note(std::int64_t asked, std::int64_t sent, std::int64_t acknowledged) {
    SentCommand exchange;
    exchange.cycle = ++cycle_;
    exchange.sent = 1000000 * sent;
    exchange.acknowledged = 1000000 * acknowledged;
    exchange.loop_delay = 1000000 * (acknowledged - asked);
    note_exchange(exchange, loop_);
  }
  double delay() const { return loop_.certificate.timing.delay; }

 private:
  HapticLoop& loop_;
  std::uint64_t cycle_ = 0;
};

TEST_F(DeviceLoopTest, TheTimeThatAProcessSleptIsNoDelayOfTheBus) {
  profile.safety.answer_timeout = 0.1;
  HapticLoop control = start_loop(profile, {});
  Exchanges bus(control);
  for (int t = 1000; t < 1010; ++t) bus.note(t - 1, t, t + 1);
  ASSERT_NEAR(bus.delay(), 0.002, 1e-9);
  bus.note(1009, 3000, 3001);  // slept between two exchanges
  bus.note(1009, 3001, 3002);  // of a tick that had slept as well
  bus.note(3001, 3002, 3003);
  EXPECT_NEAR(bus.delay(), 0.002, 1e-4);
  bus.note(3002, 3003, 5000);  // slept with the reply in the socket
  bus.note(3003, 5000, 5001);
  bus.note(5000, 5001, 5002);
  EXPECT_NEAR(bus.delay(), 0.002, 1e-4);
}

TEST_F(DeviceLoopTest, ABusWhoseAnglesAreOlderThanAnExchangeMayTakeIsMeasured) {
  profile.safety.answer_timeout = 0.1;
  HapticLoop control = start_loop(profile, {});
  Exchanges bus(control);
  for (int t = 1000; t < 2000; t += 60) bus.note(t - 60, t, t + 60);
  EXPECT_NEAR(bus.delay(), 0.12, 1e-9);
}

// In a time of its own, of one millisecond per step.
class SteadyLink final : public DeviceLink {
 public:
  explicit SteadyLink(const DeviceProfile& profile) {
    answer_.angle.fill(kAngle);
    for (const Sensor& sensor : profile.sensors) sensors_ |= 1u << sensor.angle;
  }
  [[nodiscard]] std::int64_t now() const noexcept override { return now_; }
  bool feedback(DeviceFeedback& feedback) noexcept override {
    if (std::exchange(told_at_, now_) == now_ || silent) return false;
    feedback = answer_;
    feedback.asked = feedback.time = now_;
    feedback.angle[5] += off;
    feedback.valid = doubted ? sensors_ & ~(1u << 5) : sensors_;
    feedback.flags = doubted ? static_cast<std::uint32_t>(kAngleOutOfRange) : 0;
    return true;
  }
  bool sent(SentCommand& command) noexcept override {
    command = std::exchange(under_way_, {});
    return command.acknowledged != 0;
  }
  void publish(const DeviceCommand& command) noexcept override {
    under_way_.tick = command.tick;
    under_way_.sent = now_;
    under_way_.acknowledged = now_ + 1;
    torque = 0;
    for (const double value : command.wanted) torque += std::fabs(value);
    now_ += 1000000;
  }
  bool doubted = false, silent = false;
  float off = 0;      // [rad] of the index's first joint
  double torque = 0;  // [N m] all of them

 private:
  DeviceFeedback answer_;
  SentCommand under_way_;
  std::uint32_t sensors_ = 0;
  std::int64_t now_ = 1000000, told_at_ = 0;
};

TEST_F(DeviceLoopTest, ForcesComeBackSoftlyAfterAnAngleThatCannotBeAlsoWithoutLimiterAndAccounts) {
  profile.safety.soft_start = 0.5;
  HapticLoop control = plain_loop();
  SteadyLink link(profile);
  double largest_rise = 0;
  const auto steps = [&](int count) {
    for (double before = link.torque; count > 0; --count, before = link.torque) {
      step_through(link, control);
      largest_rise = std::max(largest_rise, link.torque - before);
    }
  };
  steps(1000);
  const double whole = link.torque;
  ASSERT_GT(whole, 0);
  link.doubted = true;
  steps(1000);
  EXPECT_EQ(link.torque, 0);
  link.doubted = false;
  largest_rise = 0;
  steps(1000);
  EXPECT_NEAR(link.torque, whole, 1e-6 * whole);
  EXPECT_LE(largest_rise, 1.01 * whole * 0.001 / profile.safety.soft_start);
  EXPECT_EQ(control.gaps, 0u) << "none of these angles was late";
}

// What is let go of by a time constant is never quite gone.
TEST_F(DeviceLoopTest, ForcesComeBackAfterAnglesWereStaleAlsoWhileTheTouchGoesOn) {
  profile.safety.tick_hold = 0.02;
  HapticLoop control = plain_loop();
  SteadyLink link(profile);
  step_through(link, control, 1000);
  const double whole = link.torque;
  ASSERT_GT(whole, 0);
  link.silent = true;
  step_through(link, control, 1500);
  EXPECT_LT(link.torque, 0.01 * whole);
  EXPECT_EQ(control.gaps, 1u);
  link.silent = false;
  step_through(link, control, 1000);
  EXPECT_NEAR(link.torque, whole, 1e-6 * whole);
}

TEST_F(DeviceLoopTest, WhatTicksWantBeforeArmingCountsAsGivenToNoOne) {
  device.ready = false;
  open();
  ASSERT_TRUE(exchanges(10));
  step();
  ASSERT_GT(felt.output.flexion_torque[3], 0) << "it touches";
  EXPECT_EQ(loop.control.given.torque[1], 0);
  EXPECT_EQ(loop.control.given.level[1], 0);
  EXPECT_EQ(loop.control.largest_told, JointArray{});
  device.ready = true;
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  step();
  step();
  EXPECT_GT(loop.control.given.torque[1], 0);
  EXPECT_GT(loop.control.largest_told[3], 0);
}

// While ticks stand still the sink holds the command, then fades it, and a finger opens all the while: what
// acts when they go on tells nothing of that.
TEST_F(DeviceLoopTest, BooksTheEnergyThatEachCommandGaveWhileTicksStoodStill) {
  profile.safety.tick_hold = 0.02;
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  const EnergyAccount& account = loop.control.account[1];
  const double before = account.energy, step_back = profile.dynamics[3].encoder_step;
  double given = 0, acted = 0;
  while (device.value[3] != 0) {
    const double acts = device.value[3];
    if (std::exchange(acted, acts) != acts) {
      device.off[5] -= static_cast<float>(step_back);  // so little that damping is not counted on
      given += acts * step_back;
    }
    for (const int exchanges = device.exchanges; device.exchanges == exchanges;) loop.sink.cycle();
  }
  ASSERT_GT(given, 0);
  loop.sink.cycle();
  step();
  EXPECT_NEAR(before - account.energy, given, 1e-3 * given);
}

// Its sensors are slower than the bus.
TEST_F(DeviceLoopTest, AWayThatIsToldLateTookAllOfTheTimeSinceTheAngleChanged) {
  HapticLoop control = start_loop(profile, {});
  certify_loop(control);
  SteadyLink link(profile);
  step_through(link, control, 20);
  EXPECT_NEAR(control.still[3], 0.019, 1.1e-3);
  link.off = 0.01f;
  step_through(link, control);
  EXPECT_EQ(control.still[3], 0);
}

TEST_F(DeviceLoopTest, TellsOnceWhichSensorIsSlowerThanTheBusAndWhatToSay) {
  profile.safety.tick_hold = 1;
  open(false, false);
  int told_of_it = 0;
  std::string text;
  const auto moves = [&](int changes) {
    for (int i = 0; i < changes; ++i) {
      device.off[5] += i % 20 < 10 ? 0.006f : -0.006f;
      exchanges(4);
      for (const SinkEvent& event : loop.sink.events())
        if (event.text.find("changes once in") != std::string::npos) ++told_of_it, text = event.text;
    }
  };
  moves(100);
  EXPECT_EQ(told_of_it, 1);
  EXPECT_EQ(text.find("angle of index proximal changes once in "), 0u) << text;
  EXPECT_NE(text.find("\"delay\": "), std::string::npos) << text;
}

// A device that is asked several times a tick: from one answer to the next a joint may move by less than its
// encoder tells.
TEST_F(DeviceLoopTest, TellsSpeedOverAllSamplesBetweenTwoTicks) {
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  const std::int64_t before = loop.control.feedback.time;
  constexpr double kWay = 1e-3;
  device.off[5] += static_cast<float>(kWay);
  for (const int exchanges = device.exchanges; device.exchanges < exchanges + 4;) loop.sink.cycle();
  step();
  const double between = 1e-9 * static_cast<double>(loop.control.feedback.time - before);
  EXPECT_NEAR(loop.control.speed[3], kWay / between, 0.05 * kWay / between);
}

// More exchanges than the sink keeps for them: what is lost of these is no force's, which have faded.
TEST_F(DeviceLoopTest, TheNewestAnglesCountHoweverLongTicksStoodStill) {
  profile.safety.tick_hold = 0.02;
  open();
  for (const int before = device.exchanges; device.exchanges < before + 600; loop.sink.cycle())
    device.off[5] = 1e-3f * static_cast<float>(device.exchanges - before);
  for (int i = 0; i < 3; ++i) {
    step();
    EXPECT_EQ(loop.control.feedback.angle[5], kAngle + device.off[5]) << i;
  }
}

TEST_F(DeviceLoopTest, WithoutSensorsItIsToldThatJointAnglesGiveNoForces) {
  const auto told_at_start = [&] {
    open();
    for (int i = 0; i < 200; ++i) step();
    for (const SinkEvent& event : loop.sink.events())
      if (event.text.find("no sensors") != std::string::npos) return true;
    return false;
  };
  EXPECT_FALSE(told_at_start());
  loop.close();
  profile.sensors.clear();
  EXPECT_TRUE(told_at_start());
  EXPECT_EQ(told(), 0);
}

TEST_F(DeviceLoopTest, IsNotOpenedWhereForcesWouldFadeBetweenTwoTicksAndWarnsWhereALateOneLetsThem) {
  LoopSettings settings;
  settings.sink.thread = true;
  const auto opened = [&](double ticks) {
    profile.safety.tick_hold = ticks / model.settings.rate;
    return loop.open(model, profile, std::make_unique<HeldWire>(device, profile), settings);
  };
  const auto warned = [&] {
    for (const SinkEvent& event : loop.sink.events())
      if (event.text.find("forces fade whenever one is late") != std::string::npos) return true;
    return false;
  };
  const Status status = opened(0.5);
  EXPECT_NE(status.message().find("raise safety.tick_hold to 0.003 s"), std::string::npos)
      << status.message();
  ASSERT_TRUE(opened(1.5).ok());
  EXPECT_TRUE(warned());
  loop.close();
  ASSERT_TRUE(opened(5).ok());
  EXPECT_FALSE(warned());
  loop.close();
  settings.sink.thread = false;
  EXPECT_TRUE(opened(0.5).ok()) << "each tick is told at once";
}

// A cycle that is a little late, or an answer that is lost, would let go of everything.
TEST_F(DeviceLoopTest, WarnsWhereTheDeviceCountsAsLostAfterLessThanThreeCycles) {
  const auto warned = [&](double cycles) {
    profile.safety.answer_timeout = cycles / profile.rate;
    profile.response_timeout = 0.001;
    EXPECT_TRUE(loop.open(model, profile, std::make_unique<HeldWire>(device, profile), {}).ok());
    loop.close();
    for (const SinkEvent& event : loop.sink.events())
      if (event.text.find("lost after less than three cycles") != std::string::npos)
        return event.text.find("raise safety.answer_timeout to 0.03 s") != std::string::npos;
    return false;
  };
  profile.rate = 100;
  EXPECT_TRUE(warned(1.01));
  EXPECT_TRUE(warned(2.5));
  EXPECT_FALSE(warned(10));
}

TEST_F(DeviceLoopTest, IsNotOpenedForTheOtherHand) {
  profile.side = Side::left;
  const Status status = loop.open(model, profile, std::make_unique<HeldWire>(device, profile), {});
  EXPECT_NE(status.message().find("drives a left hand"), std::string::npos) << status.message();
  profile.side = Side::right;
  open();
  EXPECT_TRUE(steps_until([&] { return told() > 0; }));
}

TEST_F(DeviceLoopTest, IsOpenedAgainOnceClosedAndNotBefore) {
  for (int session = 0; session < 2; ++session) {
    open();
    EXPECT_FALSE(loop.open(model, profile, std::make_unique<HeldWire>(device, profile), {}).ok());
    EXPECT_TRUE(steps_until([&] { return told() > 0; })) << session;
    EXPECT_TRUE(loop.close());
    EXPECT_EQ(told(), 0);
  }
}

TEST_F(DeviceLoopTest, WhatATickDoesNotStandForReachesNoDevice) {
  open();
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  const int before = device.exchanges;
  LoopStep next;
  next.frame = frame;
  EXPECT_FALSE(loop.step(
      model, scratch, [](LoopStep&) { return false; }, next));
  EXPECT_EQ(device.exchanges, before);
}

}  // namespace
}  // namespace lumbrical
