// What stops the forces of a sink though its device answers: ticks that stall, commands and angles that can't
// be, other masters, the device's own switches, the host's emergency stop; and who takes over.
#include "lumbrical/device_sink.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "lumbrical/device.h"
#include "modbus_loop.h"

namespace lumbrical {
namespace {

using test::eventually;
using test::ModbusLoop;

TEST_F(ModbusLoop, AStalledTickThreadIsHeldThenFadesAndComesBack) {
  profile.safety.tick_hold = 0.3;
  profile.safety.tick_timeout = 9;
  start();
  sink.stalled = true;
  EXPECT_TRUE(rests()) << sink.log();
  EXPECT_EQ(sink.sink.report().state, SafetyState::active);
  sink.stalled = false;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, ATickThreadThatNeverComesBackIsAFault) {
  start();
  sink.stalled = true;
  EXPECT_TRUE(sink.reaches(SafetyState::fault)) << sink.log();
  EXPECT_TRUE(sink.told("active -> fault: no new tick")) << sink.log();
  EXPECT_TRUE(rests());
  sink.stalled = false;
  sink.sink.request_arm();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(sink.sink.report().state, SafetyState::fault) << "until someone resets it";
  sink.sink.request_reset();
  EXPECT_TRUE(sink.reaches(SafetyState::idle));
  sink.sink.request_arm();
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, IsArmedOnlyWhenTicksAreFreshHoweverLongTheyTookToBegin) {
  profile.safety.tick_hold = 0.2;
  profile.safety.tick_timeout = 0.2;
  device.listen();
  profile.transport.port = device.port();
  SinkOptions options;
  options.arm = false;
  sink.open(profile, options);
  EXPECT_TRUE(sink.reaches(SafetyState::idle)) << sink.log();
  sink.stalled = true;  // as while a recording is opened, memory locked, a large world read
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  sink.sink.arm_when_ready();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(sink.sink.report().state, SafetyState::idle) << sink.log();
  sink.stalled = false;
  EXPECT_TRUE(sink.reaches(SafetyState::active)) << sink.log();
  EXPECT_EQ(sink.log().find("fault"), std::string::npos) << sink.log();
}

TEST_F(ModbusLoop, ACommandThatIsNoNumberIsAFault) {
  start();
  sink.wanted = std::nan("");
  EXPECT_TRUE(sink.reaches(SafetyState::fault)) << sink.log();
  EXPECT_TRUE(sink.told("a command that is no number"));
  EXPECT_TRUE(rests());
}

TEST_F(ModbusLoop, TakingOverFadesFromWhatTheDeviceWasToldLast) {
  profile.safety.fade = 1;
  device.listen();
  profile.transport.port = device.port();
  const int other = test::connect_to(device.port());
  const std::array<std::uint8_t, 25> force = {
      0, 1, 0, 0, 0, 19, 1, 16, 0, 0, 0, 6,   12,
      0, 1, 0, 9, 0, 0,  0, 0,  0, 0, 3, 0xE8};  // on, heartbeat, 0.1 N m for the index
  ASSERT_EQ(send(other, force.data(), force.size(), 0), static_cast<ssize_t>(force.size()));
  ASSERT_TRUE(acts());
  close(other);
  SinkOptions options;
  options.arm = false;
  options.take_over = true;
  DeviceSink guard;
  ASSERT_TRUE(test::open_modbus(profile, options, guard).ok());
  EXPECT_TRUE(eventually([&] { return guard.is_safe(); }));
  EXPECT_TRUE(guard.close());
  EXPECT_TRUE(rests());
  SentCommand first;
  ASSERT_TRUE(guard.sent(first));
  EXPECT_NEAR(first.value[3], 0.1 * (1 - 1 / (profile.safety.fade * profile.rate)), 1e-9)
      << "one period's part, however late the first command";
}

TEST_F(ModbusLoop, ForcesAreRefusedWhereNothingWouldLetGoOfThem) {
  device.listen();
  profile.transport.port = device.port();
  profile.heartbeat = {};
  DeviceSink refused, dry, accepted;
  EXPECT_NE(test::open_modbus(profile, {}, refused).message().find("has no heartbeat"), std::string::npos);
  SinkOptions options;
  options.dry_run = true;
  EXPECT_TRUE(test::open_modbus(profile, options, dry).ok());
  profile.unattended = true;
  EXPECT_TRUE(test::open_modbus(profile, {}, accepted).ok());
}

TEST_F(ModbusLoop, AnotherMastersWritesAreNoticedAndStopTheForces) {
  start();
  std::atomic<bool> enough{false};
  std::thread other([&] { test::write_again_and_again(device.port(), 5, 3000, enough); });
  EXPECT_TRUE(sink.told("active -> fault: another master writes to the device")) << sink.log();
  enough = true;
  other.join();
  EXPECT_TRUE(rests());
  sink.sink.request_reset();
  EXPECT_TRUE(sink.reaches(SafetyState::idle)) << sink.log();
  sink.sink.request_arm();
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, CommandsThatCannotBeReadBackAreToldOnceAndNoReasonToStop) {
  device.faults.hide_commands = 2;  // illegal data address
  start();
  EXPECT_TRUE(sink.told("another master would not be noticed")) << sink.log();
  const int before = sink.acknowledged;
  EXPECT_TRUE(eventually([&] { return sink.acknowledged > before + 40; }));
  EXPECT_EQ(sink.log().find("would not be noticed"), sink.log().rfind("would not be noticed"));
  EXPECT_EQ(sink.sink.report().state, SafetyState::active);
}

TEST_F(ModbusLoop, AnotherMasterIsNoticedAgainOnceCommandsCanBeReadBackOrOnANewConnection) {
  start();
  const auto other_master_is_noticed = [&] {
    std::atomic<bool> enough{false};
    std::thread other([&] { test::write_again_and_again(device.port(), 5, 3000, enough); });
    const bool noticed = sink.reaches(SafetyState::fault);
    enough = true;
    other.join();
    return noticed;
  };
  device.faults.hide_commands = 6;  // busy
  EXPECT_TRUE(sink.told("another master would not be noticed for now")) << sink.log();
  device.faults.hide_commands = 0;
  EXPECT_TRUE(other_master_is_noticed()) << sink.log();
  sink.sink.request_reset();
  ASSERT_TRUE(sink.reaches(SafetyState::idle)) << sink.log();
  sink.sink.request_arm();
  ASSERT_TRUE(acts()) << sink.log();
  device.faults.hide_commands = 1;  // illegal function
  EXPECT_TRUE(sink.told("another master would not be noticed: ")) << sink.log();
  device.faults.hide_commands = 0;
  device.restart();
  ASSERT_TRUE(acts()) << sink.log();
  EXPECT_TRUE(other_master_is_noticed()) << sink.log();
}

TEST_F(ModbusLoop, TheDevicesOwnStopFaultHangAndDeadManCount) {
  start();
  device.release_dead_man = true;
  EXPECT_TRUE(sink.reaches(SafetyState::armed)) << sink.log();
  EXPECT_TRUE(rests());
  device.release_dead_man = false;
  EXPECT_TRUE(acts());
  device.press_stop = true;
  EXPECT_TRUE(sink.reaches(SafetyState::fault));
  EXPECT_TRUE(sink.told("emergency stop"));
  device.press_stop = false;
  EXPECT_TRUE(eventually([&] {
    sink.sink.request_reset();
    sink.sink.request_arm();
    return sink.sink.report().state == SafetyState::active;
  })) << sink.log();
  device.break_down = true;
  EXPECT_TRUE(sink.told("the device reports a fault")) << sink.log();
  device.break_down = false;
  EXPECT_TRUE(eventually([&] {
    sink.sink.request_reset();
    sink.sink.request_arm();
    return sink.sink.report().state == SafetyState::active;
  })) << sink.log();
  device.hang = true;
  EXPECT_TRUE(sink.told("heartbeat not echoed")) << sink.log();
  EXPECT_TRUE(rests()) << "its registers still take commands";
}

TEST_F(ModbusLoop, AnglesThatCannotBeAreToldByTheNameOfTheirJoint) {
  start();
  device.sensors = SensorFault::out_of_range;
  EXPECT_TRUE(sink.told("angle of thumb metacarpal out of its range")) << sink.log();
  device.sensors = SensorFault::none;
  EXPECT_TRUE(eventually([&] { return sink.doubts == 0; }));
  device.sensors = SensorFault::jumping;
  EXPECT_TRUE(sink.told("angle of thumb metacarpal jumps farther than a finger can move")) << sink.log();
  device.sensors = SensorFault::none;
  EXPECT_TRUE(eventually([&] { return sink.doubts == 0; }));
  device.sensors = SensorFault::stuck;
  EXPECT_TRUE(eventually([&] {
    sink.wanted = 0.1 - sink.wanted;  // back and forth
    return (sink.doubts & kAngleStuck) != 0;
  })) << sink.log();
  EXPECT_EQ(sink.sink.report().state, SafetyState::active) << "it is the ticks' forces that fade";
}

TEST_F(ModbusLoop, TheHostsEmergencyStopWorksFromAnywhere) {
  start();
  sink.sink.press_stop(true);
  EXPECT_TRUE(rests());
  EXPECT_TRUE(eventually([&] { return sink.sink.is_safe(); }));
  EXPECT_EQ(sink.sink.report().state, SafetyState::fault);
}

// As long as its heartbeat went on it would hold what it has where it takes nothing any more.
TEST(ModbusWire, ADeviceThatRefusesAPartOfItsCommandsHearsTheOthersButNoHeartbeat) {
  DeviceProfile profile = test::patient_profile();
  profile.actuators[14].field.address = 40;
  SimulatedDevice device(profile, {});
  profile.actuators[0].field.address = 30;  // where the device has no register
  ModbusServer server;
  ASSERT_TRUE(server.listen("127.0.0.1", 0).ok());
  profile.transport.port = server.port();
  ServerFaults faults;
  std::atomic<bool> ending{false};
  std::thread serving([&] { server.serve(device, faults, [&] { return ending.load(); }); });
  std::unique_ptr<DeviceWire> wire;
  EXPECT_TRUE(make_modbus_wire(profile, wire).ok());
  EXPECT_TRUE(wire->open().ok());
  SafetyOutput output;
  output.command.fill(0.1);
  output.device_on = true;
  WireAnswer answer;
  EXPECT_EQ(wire->exchange({7, output, {}}, answer).outcome, WireOutcome::refused);
  ending = true;
  serving.join();
  std::array<std::uint16_t, 1> word{};
  for (const auto& [address, value] :
       {std::pair<int, int>(3, 1000), {40, 1000}, {0, profile.control.active}, {1, 0}}) {
    EXPECT_EQ(device.read(1, static_cast<std::uint16_t>(address), word), 0);
    EXPECT_EQ(word[0], value) << address;
  }
}

}  // namespace
}  // namespace lumbrical
