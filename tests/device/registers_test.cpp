// Numbers in registers: what the Modbus and the makers' documents say, and round trips over every type.
#include "device/registers.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "random.h"

namespace lumbrical {
namespace {

RegisterField field(RegisterType type, double scale = 1, double offset = 0, bool low_first = false) {
  RegisterField result;
  result.type = type;
  result.scale = scale;
  result.offset = offset;
  result.low_word_first = low_first;
  return result;
}

TEST(Registers, HoldTheWordsByHand) {
  std::array<std::uint16_t, 2> words{};
  ASSERT_TRUE(encode_field(field(RegisterType::s16, 1e-4), -0.5, words));
  EXPECT_EQ(words[0], 0xEC78);  // -5000
  ASSERT_TRUE(encode_field(field(RegisterType::u16, 0.001, 0.2), 3.5, words));
  EXPECT_EQ(words[0], 3300);
  ASSERT_TRUE(encode_field(field(RegisterType::f32), 1.5, words));
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x3FC0, 0x0000}));
  ASSERT_TRUE(encode_field(field(RegisterType::f32, 1, 0, true), -1.5, words));
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x0000, 0xBFC0}));
  ASSERT_TRUE(encode_field(field(RegisterType::s32), -2, words));
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0xFFFF, 0xFFFE}));
  ASSERT_TRUE(encode_field(field(RegisterType::s32, 1, 0, true), 65536 + 7, words));
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{7, 1}));
}

TEST(Registers, LeaveTheOtherByteAlone) {
  std::array<std::uint16_t, 1> word{0xFF00};  // Robotiq: speed in the upper byte, force in the lower
  ASSERT_TRUE(encode_field(field(RegisterType::u8_low), 255, word));
  EXPECT_EQ(word[0], 0xFFFF);
  ASSERT_TRUE(encode_field(field(RegisterType::u8_high), 18, word));
  EXPECT_EQ(word[0], 0x12FF);
  EXPECT_EQ(decode_field(field(RegisterType::u8_high), word), 18);
}

TEST(Registers, CutWhatTheyCannotHoldAndRefuseWhatIsNoNumber) {
  std::array<std::uint16_t, 2> words{};
  ASSERT_TRUE(encode_field(field(RegisterType::s16), 1e300, words));
  EXPECT_EQ(words[0], 0x7FFF);
  ASSERT_TRUE(encode_field(field(RegisterType::s16, -1), 1e300, words));
  EXPECT_EQ(words[0], 0x8000);
  ASSERT_TRUE(encode_field(field(RegisterType::u16), -3, words));
  EXPECT_EQ(words[0], 0);
  ASSERT_TRUE(encode_field(field(RegisterType::f32), 1e300, words));
  EXPECT_TRUE(std::isfinite(decode_field(field(RegisterType::f32), words)));
  words = {1, 2};
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(encode_field(field(RegisterType::s16), bad, words));
    EXPECT_EQ(words, (std::array<std::uint16_t, 2>{1, 2}));
  }
}

TEST(Registers, ComeBackWithinHalfACountWhateverScaleAndOrder) {
  test::Random random(6);
  const RegisterType types[] = {RegisterType::u16,    RegisterType::s16, RegisterType::u8_high,
                                RegisterType::u8_low, RegisterType::s32, RegisterType::f32};
  for (int i = 0; i < 20000; ++i) {
    const RegisterType type = types[random.bits() % 6];
    const double scale = (random.bits() % 2 == 0 ? 1 : -1) * random.between(1e-4, 10);
    const RegisterField one = field(type, scale, random.between(-5, 5), random.bits() % 2 == 0);
    const FieldRange range = field_range(one);
    const double value =
        type == RegisterType::f32 ? random.between(-1e3, 1e3) : random.between(range.low, range.high);
    std::array<std::uint16_t, 2> words{};
    ASSERT_TRUE(encode_field(one, value, words));
    const double tolerance = type == RegisterType::f32 ? 1e-7 * (1 + std::fabs(value - one.offset)) + 1e-9
                                                       : 0.5 * std::fabs(scale) * (1 + 1e-9);
    ASSERT_NEAR(decode_field(one, words), value, tolerance);
  }
}

TEST(Registers, AreFoundInTheWordsOfAllBlocks) {
  const std::vector<RegisterBlock> blocks = {{1, 10, 3}, {2, 10, 2}};
  EXPECT_EQ(find_register(blocks, 1, 12), 2);
  EXPECT_EQ(find_register(blocks, 2, 11), 4);
  EXPECT_EQ(find_register(blocks, 1, 13), -1);
  EXPECT_EQ(find_register(blocks, 3, 10), -1);
  EXPECT_EQ(total_count(blocks), 5);
}

}  // namespace
}  // namespace lumbrical
