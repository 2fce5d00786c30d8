// What goes into a device's registers, cycle by cycle: other people's maps, word for word.
#include "modbus/exchange_words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "device/registers.h"
#include "device_fixture.h"

namespace lumbrical {
namespace {

TEST(ExchangeWords, WriteTheRobotiqGrippersRegisters) {
  const DeviceProfile profile = test::shipped_profile("robotiq_2f");
  ExchangeWords words(profile);
  ASSERT_EQ(words.plan.writes, (std::vector<RegisterBlock>{{9, 0x3E8, 1}, {9, 0x3EA, 1}}));
  SafetyOutput output;
  output.command[0] = 255;
  output.device_on = true;
  words.write(profile, {1, output, {}});
  EXPECT_EQ(words.written, (std::vector<std::uint16_t>{0x0900, 0xFFFF})) << "as in the frame of its manual";
  words.write(profile, {2, SafetyOutput{}, {}});
  EXPECT_EQ(words.written, (std::vector<std::uint16_t>{0x0100, 0xFF00})) << "the speed is the handshake's";
}

// A device that refuses another part holds what it has for as long as the heartbeat goes on.
TEST(ExchangeWords, TheHeartbeatIsWrittenLast) {
  DeviceProfile profile = test::shipped_profile("exoskeleton");
  profile.actuators[0].field.address = 50;
  profile.actuators[1].field.unit = 2;
  const ExchangeWords words(profile);
  EXPECT_EQ(words.plan.writes, (std::vector<RegisterBlock>{{1, 4, 13}, {1, 50, 1}, {2, 3, 1}, {1, 0, 2}}));
}

TEST(ExchangeWords, WriteAndReadTheInspireHandsRegisters) {
  const DeviceProfile profile = test::shipped_profile("inspire_rh56");
  ExchangeWords words(profile);
  ASSERT_EQ(words.plan.writes, (std::vector<RegisterBlock>{{1, 1498, 5}}));
  ASSERT_EQ(words.plan.reads, (std::vector<RegisterBlock>{{1, 1546, 5}}));
  SafetyOutput output;
  output.command[3] = 400;  // index
  words.write(profile, {1, output, {}});
  EXPECT_EQ(words.written, (std::vector<std::uint16_t>{0, 0, 0, 400, 0}));
  words.read = {0, 1000, 500, 65535, 0};
  std::array<float, kAngleCount> angle{};
  std::uint32_t valid = 0;
  words.angles(profile, angle, valid);
  EXPECT_NEAR(angle[4 * 4 + 1], 1.5, 1e-6);  // little, closed
  EXPECT_NEAR(angle[4 * 3 + 1], 0, 1e-6);    // ring, open
  EXPECT_NEAR(angle[4 * 2 + 1], 0.75, 1e-6);
  EXPECT_EQ(valid >> (4 * 1 + 1) & 1u, 0u) << "65535 is no angle";
  EXPECT_EQ(valid >> (4 * 0 + 1) & 1u, 1u);
}

TEST(ExchangeWords, NeverHoldACountBeyondWhatAnActuatorMayBeTold) {
  DeviceProfile profile = test::shipped_profile("exoskeleton");
  Actuator& actuator = profile.actuators[3];
  actuator.field.scale = 0.3;
  actuator.lower = -0.5;
  actuator.upper = 0.5;
  ExchangeWords words(profile);
  SafetyOutput output;
  ActuatorArray told{};
  for (const auto& [value, count] : {std::pair(0.5, 1), {-0.5, -1}, {0.4, 1}, {0.1, 0}, {-0.46, -1}}) {
    output.command[3] = value;
    words.write(profile, {1, output, {}});
    words.commands(profile, told);
    EXPECT_NEAR(told[3], 0.3 * count, 1e-12) << value;
    EXPECT_EQ(words.written[static_cast<std::size_t>(2 + 3)], static_cast<std::uint16_t>(count)) << value;
  }
}

TEST(ExchangeWords, AreReadBackPartByPartAndHoldUnlessABitOfAFieldDiffers) {
  for (const char* const name : {"exoskeleton", "exoskeleton_serial", "robotiq_2f", "inspire_rh56"}) {
    ExchangeWords words(test::shipped_profile(name));
    std::vector<int> seen(words.written.size(), 0);
    for (std::size_t i = 0; i < words.written.size(); ++i)
      words.written[i] = static_cast<std::uint16_t>(7 * i + 1);
    std::size_t parts = 0;
    for (; words.part(parts) != words.part(0) || parts == 0; ++parts) {
      const auto [block, at] = words.part(parts);
      ASSERT_LE(block.count, kLookBack);
      std::copy_n(words.written.begin() + static_cast<std::ptrdiff_t>(at), block.count,
                  words.read_back.begin());
      EXPECT_TRUE(words.holds(block, at));
      for (std::size_t k = 0; k < block.count; ++k) {
        ++seen[at + k];
        EXPECT_EQ(find_register(words.plan.writes, block.unit, static_cast<std::uint16_t>(block.address + k)),
                  static_cast<int>(at + k));
        words.read_back[k] ^= 1;
        EXPECT_EQ(words.holds(block, at), (words.claimed[at + k] & 1) == 0);
        words.read_back[k] ^= 1;
      }
      if (words.written.size() <= kLookBack && words.plan.writes.size() == 1) break;
    }
    EXPECT_EQ(seen, std::vector<int>(seen.size(), 1)) << name;
  }
}

TEST(ExchangeWords, SendTheLocalModelOnlyWithTheTorqueItBelongsTo) {
  const DeviceProfile profile = test::shipped_profile("exoskeleton_serial");
  ExchangeWords words(profile);
  ASSERT_EQ(words.plan.writes, (std::vector<RegisterBlock>{{1, 0, 62}}));
  DeviceCommand command;
  command.wanted[0] = 0.1;
  command.angle[0] = 0.5;
  command.stiffness[0] = 2;
  command.radius[0] = 0.05;
  SafetyOutput output;
  output.command[0] = 0.1;
  words.write(profile, {7, output, command});
  EXPECT_EQ(std::vector<std::uint16_t>(words.written.begin(), words.written.begin() + 6),
            (std::vector<std::uint16_t>{0, 7, 1000, 5000, 2000, 500}));
  output.command[0] = 0.05;  // the envelope has cut it
  words.write(profile, {8, output, command});
  EXPECT_EQ(std::vector<std::uint16_t>(words.written.begin(), words.written.begin() + 6),
            (std::vector<std::uint16_t>{0, 8, 500, 5000, 0, 0}));
}

// A motion's, say, of a joint without a sensor.
TEST(ExchangeWords, SendTheTorqueAloneAtAnAngleThatItsRegisterDoesNotHold) {
  const DeviceProfile profile = test::shipped_profile("exoskeleton_serial");
  ExchangeWords words(profile);
  DeviceCommand command;
  SafetyOutput output;
  output.command[0] = command.wanted[0] = 0.1;
  command.stiffness[0] = 2;
  command.radius[0] = 0.05;
  const auto model_at = [&](double angle) {
    command.angle[0] = angle;
    words.write(profile, {1, output, command});
    return std::vector<std::uint16_t>(words.written.begin() + 2, words.written.begin() + 6);
  };
  EXPECT_EQ(model_at(3.2767), (std::vector<std::uint16_t>{1000, 32767, 2000, 500}));
  EXPECT_EQ(model_at(3.3), (std::vector<std::uint16_t>{1000, 32767, 0, 0}));
  EXPECT_EQ(model_at(-3.3), (std::vector<std::uint16_t>{1000, 0x8000, 0, 0}));
  EXPECT_EQ(model_at(std::nan("")), (std::vector<std::uint16_t>{1000, 0, 0, 0}));
  EXPECT_EQ(model_at(1), (std::vector<std::uint16_t>{1000, 10000, 2000, 500}));
}

}  // namespace
}  // namespace lumbrical
