// The loop as a library, without a thread: a hand on a plate, and a device that is a function in this
// process.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "device_fixture.h"
#include "lumbrical/loop.h"
#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"

namespace lumbrical {
namespace {

constexpr float kAngle = 0.3f;  // [rad] that every joint is at

struct HeldDevice {
  ActuatorArray value{};
  bool on = false, there = true, held = true;
  int exchanges = 0;
};

class HeldWire final : public DeviceWire {
 public:
  HeldWire(HeldDevice& device, const DeviceProfile& profile) : device_(device), profile_(profile) {}
  Status open() override { return device_.there ? Status() : Status::error("not there"); }
  void close() override {}
  WireResult exchange(const WireCommand& command, WireAnswer& answer) override {
    if (!device_.there) return {WireOutcome::broken, "gone"};
    ++device_.exchanges;
    device_.value = command.output.command;
    device_.on = command.output.device_on;
    answer.status.has_dead_man = true;
    answer.status.dead_man = device_.held;
    for (const Sensor& sensor : profile_.sensors) {
      answer.angle[static_cast<std::size_t>(sensor.angle)] = kAngle;
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
  void open(bool stop_on_loss = false) {
    LoopSettings settings;
    settings.stop_on_loss = stop_on_loss;
    ASSERT_TRUE(loop.open(profile, std::make_unique<HeldWire>(device, profile), settings).ok());
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
  ASSERT_TRUE(loop.open(profile, std::make_unique<HeldWire>(device, profile), settings).ok());
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

TEST_F(DeviceLoopTest, ALostDeviceEndsTheSessionWhereThatWasAskedFor) {
  profile.safety.answer_timeout = 0.02;
  open(true);
  ASSERT_TRUE(steps_until([&] { return told() > 0; }));
  device.there = false;
  EXPECT_TRUE(steps_until([&] { return !step(); }));
  EXPECT_FALSE(loop.close()) << "no one has acknowledged safe values";
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
