// The sink against a simulated device on a terminal.
#include "lumbrical/device_sink.h"

#include <gtest/gtest.h>

#include "modbus_loop.h"
#include "terminals.h"

namespace lumbrical {
namespace {

using test::ModbusLoop;

class SerialLoop : public ModbusLoop {
 protected:
  void SetUp() override {
    if (!test::have_terminals()) GTEST_SKIP() << test::kNoTerminals;
  }
  void start_serial() {
    device.open_terminal();
    profile.transport.kind = TransportKind::rtu;
    profile.transport.line = device.name();
    sink.open(profile);
    ASSERT_TRUE(acts()) << sink.log();
  }
};

TEST_F(SerialLoop, RunsOverATerminal) {
  start_serial();
  EXPECT_TRUE(sink.close());
  EXPECT_TRUE(rests());
}

// Two of them would read each other's replies.
TEST_F(SerialLoop, ALineIsOneSessions) {
  start_serial();
  test::TickingSink second;
  second.open(profile);
  EXPECT_TRUE(second.told("is in use by another session")) << second.log();
  EXPECT_TRUE(acts()) << sink.log();
  EXPECT_TRUE(sink.close());
  EXPECT_TRUE(acts()) << second.log();
}

TEST_F(SerialLoop, GarbageBytesBeforeRepliesAndRepliesCutShort) {
  start_serial();
  device.faults.garbage = true;
  EXPECT_TRUE(sink.reaches(SafetyState::disconnected)) << sink.log();
  EXPECT_TRUE(rests());
  device.faults.garbage = false;
  EXPECT_TRUE(acts()) << sink.log();
  device.faults.cut_reply = true;
  EXPECT_TRUE(sink.reaches(SafetyState::disconnected)) << sink.log();
  device.faults.cut_reply = false;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(SerialLoop, RepliesOfAnotherUnitAreNoAcknowledgement) {
  start_serial();
  device.faults.wrong = WrongReply::unit;
  EXPECT_TRUE(sink.told("a reply of another unit")) << sink.log();
  EXPECT_TRUE(rests());
  device.faults.wrong = WrongReply::nothing;
  EXPECT_TRUE(acts()) << sink.log();
}

TEST_F(SerialLoop, ABaudRateThatTheLineDidNotTakeIsRefused) {
  device.open_terminal();
  profile.transport.kind = TransportKind::rtu;
  profile.transport.line = device.name();
  profile.transport.baud = 2000000;
  sink.open(profile);
  EXPECT_TRUE(sink.told("asked for 2000000 baud, the line runs at 9600")) << sink.log();
  EXPECT_EQ(device.requests(), 0u);
}

}  // namespace
}  // namespace lumbrical
