// The sink against a simulated device on a real socket, with everything that can go wrong between them. In
// every case forces get to their safe values, the loop goes on or stops as told, and the log says why.
#include "lumbrical/device_sink.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "modbus_loop.h"

namespace lumbrical {
namespace {

using test::eventually;
using test::ModbusLoop;

TEST_F(ModbusLoop, CommandsArriveAreAcknowledgedAndReported) {
  start();
  EXPECT_TRUE(eventually([&] { return sink.acknowledged > 50; }));
  const SinkReport report = sink.sink.report();
  EXPECT_EQ(report.state, SafetyState::active);
  EXPECT_GT(report.rate, 1);
  EXPECT_LT(report.age, 5);
  EXPECT_EQ(report.broken + report.refused, 0u);
  EXPECT_LE(device.largest(), 0.1 + 1e-9);
  EXPECT_TRUE(sink.close()) << "the device has acknowledged safe values";
  EXPECT_TRUE(rests());
  EXPECT_TRUE(sink.told("closed: the device has acknowledged safe values")) << sink.log();
}

// On a bus that is slower than its rate the next command would otherwise leave before the tick that has felt
// the angles of the last reply.
TEST_F(ModbusLoop, ACommandWaitsForTheTickThatHasFeltTheLastReply) {
  profile.read_back = 0;  // one more exchange now and then
  start();
  device.faults.delay = 0.03;
  EXPECT_TRUE(eventually([&] { return sink.cycles > 2 && sink.sink.report().rate < 50; })) << sink.log();
  const int two = sink.two_exchanges, three = sink.three_exchanges;
  EXPECT_TRUE(eventually([&] { return sink.two_exchanges + sink.three_exchanges > two + three + 20; }));
  EXPECT_GT(sink.two_exchanges - two, sink.three_exchanges - three) << "all of them on an idle machine";
}

TEST_F(ModbusLoop, AKilledAndRestartedServerIsFoundAgain) {
  start();
  device.restart();
  EXPECT_TRUE(acts()) << sink.log();
  EXPECT_GE(sink.sink.report().connections, 2u);
}

TEST_F(ModbusLoop, ADeviceThatIsNotThereYetIsWaitedFor) {
  profile.transport.port = device.port();
  sink.open(profile);
  EXPECT_TRUE(sink.told("not connected: 127.0.0.1:" + std::to_string(device.port()))) << sink.log();
  device.listen();
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, WithoutLeaveToContinueALostLinkLeavesItIdle) {
  SinkOptions options;
  options.continue_after_loss = false;
  start(options);
  device.faults.silent = true;
  EXPECT_TRUE(sink.reaches(SafetyState::disconnected)) << sink.log();
  EXPECT_TRUE(sink.told("active -> disconnected: no answer"));
  EXPECT_TRUE(rests()) << "told so over a new connection: it answers nothing, but takes commands";
  device.faults.silent = false;
  EXPECT_TRUE(sink.reaches(SafetyState::idle)) << sink.log();
  EXPECT_EQ(device.torque(), 0);
  // Asked for again where a machine stalls so long that the link is lost once more.
  const auto is_asked_and_active = [&] {
    if (sink.sink.report().state == SafetyState::idle) sink.sink.request_arm();
    return sink.sink.report().state == SafetyState::active;
  };
  EXPECT_TRUE(eventually(is_asked_and_active)) << sink.log();
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, ACableThatBreaksInTheMiddleOfAReply) {
  start();
  device.faults.cut_reply = true;
  EXPECT_TRUE(sink.reaches(SafetyState::disconnected)) << sink.log();
  EXPECT_TRUE(rests());
  EXPECT_GT(sink.sink.report().broken, 0u);
  device.faults.cut_reply = false;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, LateRepliesNeverPutTheStreamOffByOne) {
  start();
  device.faults.delay = 0.6;  // later than the sink waits
  EXPECT_TRUE(sink.reaches(SafetyState::disconnected)) << sink.log();
  device.faults.delay = 0;
  EXPECT_TRUE(acts()) << sink.log();
  EXPECT_TRUE(eventually([&] { return sink.sink.report().age < 0.5; }));
}

TEST_F(ModbusLoop, RepliesThatAreNoRepliesToTheRequestCloseTheLinkWithTheReasonAndTheRegisters) {
  profile.read_write = false;  // a write is acknowledged by its address
  start();
  const std::pair<WrongReply, std::string> kinds[] = {
      {WrongReply::transaction, "a reply to another request"},
      {WrongReply::protocol, "a reply of another protocol"},
      {WrongReply::length, "a reply of the wrong length"},
      {WrongReply::unit, "a reply of another unit"},
      {WrongReply::function, "a reply to another function"},
      {WrongReply::registers, "a reply about other registers"},
      {WrongReply::behind, "bytes behind the reply"}};
  for (const auto& [wrong, why] : kinds) {
    const std::uint64_t connections = sink.sink.report().connections;
    device.faults.wrong = wrong;
    EXPECT_TRUE(sink.told(why + ", writing control to little distal (registers 0 to 16 of unit 1)"))
        << sink.log();
    device.faults.wrong = WrongReply::nothing;
    EXPECT_TRUE(eventually([&] { return sink.sink.report().connections > connections; })) << sink.log();
    EXPECT_TRUE(acts()) << sink.log();
  }
}

TEST_F(ModbusLoop, AReplyThatTricklesIsGivenUpWhenItsTimeIsOver) {
  profile.response_timeout = 0.2;
  start();
  device.faults.trickle = 0.015;  // each byte by itself well in time: the whole reply would take 0.8 s
  EXPECT_TRUE(sink.told("timed out: a reply that does not end")) << sink.log();
  device.faults.trickle = 0;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, AnEmergencyStopThatIsNotAnsweredClosesTheLinkWithinTwoCycles) {
  profile.response_timeout = 10;
  profile.safety.answer_timeout = 10;
  start();
  device.faults.silent = true;  // forces act, and the sink would wait for its reply for 10 s
  const auto pressed = std::chrono::steady_clock::now();
  sink.sink.press_stop(true);
  EXPECT_TRUE(sink.told("no reply in two cycles to an emergency stop")) << sink.log();
  // Two cycles are 10 ms; a busy machine may take longer, but no time-out of the profile's is as short.
  EXPECT_LT(std::chrono::steady_clock::now() - pressed, std::chrono::seconds(5)) << "its usual patience";
  EXPECT_TRUE(rests()) << "told so over a new connection: it answers nothing, but takes commands";
  device.faults.silent = false;
}

TEST_F(ModbusLoop, AnEmergencyStopIsToldInTheEndWhateverWentWrongAfterIt) {
  start();
  sink.sink.press_stop(true);
  EXPECT_TRUE(sink.told("active -> fault")) << sink.log();
  device.faults.silent = true;
  EXPECT_TRUE(sink.told("no reply")) << sink.log();
  EXPECT_NE(sink.sink.report().trouble.find("emergency stop"), std::string::npos)
      << sink.sink.report().trouble;
  device.faults.silent = false;
}

TEST_F(ModbusLoop, ClientsThatFloodOrTakeNoRepliesDoNotHoldUpTheOthers) {
  start();
  std::vector<int> idle;  // more connections than there are places
  for (int i = 0; i < 40; ++i) idle.push_back(test::connect_to(device.port()));
  std::vector<std::thread> floods;
  std::atomic<bool> enough{false};
  for (int i = 0; i < 3; ++i) floods.emplace_back([&] { test::flood(device.port(), enough); });
  const int before = sink.acknowledged;
  EXPECT_TRUE(eventually([&] { return sink.acknowledged > before + 30; })) << sink.log();
  EXPECT_EQ(sink.sink.report().connections, 1u) << sink.log();
  EXPECT_EQ(sink.sink.report().broken, 0u) << sink.log();
  enough = true;
  for (std::thread& thread : floods) thread.join();
  for (const int file : idle) ::close(file);
}

TEST_F(ModbusLoop, AWrongUnitIdGetsNoAnswer) {
  device.listen();
  profile.transport.port = device.port();
  for (Actuator& actuator : profile.actuators) actuator.field.unit = 7;
  for (Sensor& sensor : profile.sensors) sensor.field.unit = 7;
  profile.control.unit = profile.heartbeat.unit = profile.status.unit = 7;
  sink.open(profile);
  EXPECT_TRUE(eventually([&] { return sink.sink.report().broken >= 2; })) << sink.log();
  EXPECT_EQ(device.largest(), 0);
}

TEST_F(ModbusLoop, ExceptionRepliesAreAnswersButNoAcknowledgements) {
  start();
  device.faults.exception = 4;  // server device failure
  EXPECT_TRUE(sink.reaches(SafetyState::disconnected)) << sink.log();
  EXPECT_TRUE(sink.told("Slave device or server failure")) << sink.log();
  EXPECT_GT(sink.sink.report().refused, 0u);
  EXPECT_EQ(sink.sink.report().connections, 1u) << "no reason to hang up";
  device.faults.exception = 0;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, ARegisterMapOutsideTheDevicesRange) {
  device.listen();
  profile.transport.port = device.port();
  for (Actuator& actuator : profile.actuators) {
    actuator.field.address = static_cast<std::uint16_t>(actuator.field.address + 20);
  }
  sink.open(profile);
  EXPECT_TRUE(sink.told("Illegal data address")) << sink.log();
  EXPECT_EQ(device.largest(), 0);
  EXPECT_NE(sink.sink.report().state, SafetyState::active);
}

TEST_F(ModbusLoop, AHalfOpenConnectionIsNoticedByItsSilence) {
  start();
  device.faults.silent = true;  // the connection stands, nothing ever comes back
  EXPECT_TRUE(sink.reaches(SafetyState::disconnected)) << sink.log();
  EXPECT_TRUE(sink.told("timed out: no reply, writing control to")) << sink.log();
  EXPECT_TRUE(rests());
  device.faults.silent = false;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, GarbageInThePlaceOfReplies) {
  start();
  device.faults.garbage = true;
  EXPECT_TRUE(sink.reaches(SafetyState::disconnected)) << sink.log();
  EXPECT_TRUE(rests());
  device.faults.garbage = false;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, AServerThatHangsUpOnEveryone) {
  device.faults.refuse = true;
  device.listen();
  profile.transport.port = device.port();
  sink.open(profile);
  EXPECT_TRUE(eventually([&] { return sink.sink.report().connections >= 3; })) << sink.log();
  device.faults.refuse = false;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(ModbusLoop, ADryRunDoesEverythingButForces) {
  SinkOptions options;
  options.dry_run = true;
  device.listen();
  profile.transport.port = device.port();
  sink.open(profile, options);
  EXPECT_TRUE(sink.reaches(SafetyState::active)) << sink.log();
  EXPECT_TRUE(eventually([&] { return sink.acknowledged > 50; }));
  EXPECT_EQ(device.largest(), 0);
}

TEST_F(ModbusLoop, EveryCommandSentIsHandedBackWithItsAcknowledgement) {
  device.listen();
  profile.transport.port = device.port();
  DeviceSink plain;
  ASSERT_TRUE(test::open_modbus(profile, {}, plain).ok());
  SentCommand sent;
  DeviceFeedback feedback;
  DeviceCommand command;
  command.wanted.fill(0.1);
  std::uint64_t cycle = 0;
  int delays = 0;
  EXPECT_TRUE(eventually([&] {
    ++command.tick;
    while (plain.feedback(feedback)) command.feedback_time = feedback.time;
    plain.publish(command);
    while (plain.sent(sent)) {
      if (sent.sent == 0) continue;  // no command
      EXPECT_EQ(sent.cycle, cycle + 1) << "none is missing";
      cycle = sent.cycle;
      // On a busy machine an answer may come too late; such a command was never acknowledged.
      if (sent.acknowledged != 0) {
        EXPECT_GE(sent.acknowledged, sent.sent);
      }
      EXPECT_LE(sent.tick, command.tick);
      EXPECT_EQ(sent.actuator_count, 15u);
      EXPECT_LE(sent.value[0], 0.1);
      delays += sent.acknowledged != 0 && sent.loop_delay > 0 ? 1 : 0;
    }
    return delays > 20;
  }));
  EXPECT_TRUE(plain.close());
}

TEST_F(ModbusLoop, SixteenAndThreeInThePlaceOfTwentyThree) {
  profile.read_write = false;
  start();
  EXPECT_TRUE(eventually([&] { return sink.acknowledged > 20; }));
}

}  // namespace
}  // namespace lumbrical
