// See registers.h.
#include "device/registers.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace lumbrical {
namespace {

struct RawRange {
  double low, high;
};

RawRange raw_range(RegisterType type) {
  switch (type) {
    case RegisterType::u16:
      return {0, 65535};
    case RegisterType::s16:
      return {-32768, 32767};
    case RegisterType::u8_high:
    case RegisterType::u8_low:
      return {0, 255};
    case RegisterType::s32:
      return {-2147483648.0, 2147483647.0};
    case RegisterType::f32:
      break;
  }
  return {-3.4028234663852886e38, 3.4028234663852886e38};
}

void put_pair(bool low_word_first, std::uint32_t bits, std::span<std::uint16_t> words) {
  const auto high = static_cast<std::uint16_t>(bits >> 16);
  const auto low = static_cast<std::uint16_t>(bits & 0xFFFFu);
  words[0] = low_word_first ? low : high;
  words[1] = low_word_first ? high : low;
}

std::uint32_t take_pair(bool low_word_first, std::span<const std::uint16_t> words) {
  const std::uint32_t high = words[low_word_first ? 1 : 0];
  const std::uint32_t low = words[low_word_first ? 0 : 1];
  return high << 16 | low;
}

}  // namespace

int register_count(RegisterType type) {
  return type == RegisterType::s32 || type == RegisterType::f32 ? 2 : 1;
}

FieldRange field_range(const RegisterField& field) {
  const RawRange raw = raw_range(field.type);
  const double a = raw.low * field.scale + field.offset;
  const double b = raw.high * field.scale + field.offset;
  return {std::min(a, b), std::max(a, b)};
}

bool can_hold(const RegisterField& field, double value) {
  const FieldRange range = field_range(field);
  const double slack = 0.5 * std::fabs(field.scale);
  return value >= range.low - slack && value <= range.high + slack;
}

bool encode_field(const RegisterField& field, double value, std::span<std::uint16_t> words) {
  assert(words.size() >= static_cast<std::size_t>(register_count(field.type)));
  const double raw = (value - field.offset) / field.scale;
  if (!std::isfinite(value) || std::isnan(raw)) return false;
  const RawRange range = raw_range(field.type);
  if (field.type == RegisterType::f32) {
    const auto number = static_cast<float>(std::clamp(raw, range.low, range.high));
    put_pair(field.low_word_first, std::bit_cast<std::uint32_t>(number), words);
    return true;
  }
  const auto count = static_cast<std::int64_t>(std::clamp(std::floor(raw + 0.5), range.low, range.high));
  switch (field.type) {
    case RegisterType::s32:
      put_pair(field.low_word_first, static_cast<std::uint32_t>(count), words);
      break;
    case RegisterType::u8_high:
      words[0] = static_cast<std::uint16_t>((words[0] & 0x00FFu) | static_cast<unsigned>(count) << 8);
      break;
    case RegisterType::u8_low:
      words[0] = static_cast<std::uint16_t>((words[0] & 0xFF00u) | static_cast<unsigned>(count));
      break;
    default:
      words[0] = static_cast<std::uint16_t>(count & 0xFFFF);
  }
  return true;
}

double decode_field(const RegisterField& field, std::span<const std::uint16_t> words) {
  assert(words.size() >= static_cast<std::size_t>(register_count(field.type)));
  double raw = 0;
  switch (field.type) {
    case RegisterType::u16:
      raw = words[0];
      break;
    case RegisterType::s16:
      raw = static_cast<std::int16_t>(words[0]);
      break;
    case RegisterType::u8_high:
      raw = words[0] >> 8;
      break;
    case RegisterType::u8_low:
      raw = words[0] & 0xFF;
      break;
    case RegisterType::s32:
      raw = static_cast<std::int32_t>(take_pair(field.low_word_first, words));
      break;
    case RegisterType::f32:
      raw = std::bit_cast<float>(take_pair(field.low_word_first, words));
      break;
  }
  return raw * field.scale + field.offset;
}

int find_register(const std::vector<RegisterBlock>& blocks, std::uint8_t unit, std::uint16_t address) {
  int first = 0;
  for (const RegisterBlock& block : blocks) {
    if (block.unit == unit && address >= block.address && address < block.address + block.count) {
      return first + address - block.address;
    }
    first += block.count;
  }
  return -1;
}

int total_count(const std::vector<RegisterBlock>& blocks) {
  int count = 0;
  for (const RegisterBlock& block : blocks) count += block.count;
  return count;
}

}  // namespace lumbrical
