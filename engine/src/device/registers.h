// Numbers in Modbus registers and back (MODBUS Application Protocol V1.1b3, section 4: most significant byte
// first; the order of two words is the device's choice).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/device_profile.h"

namespace lumbrical {

/// The values a field can hold, low to high whatever the sign of its scale.
struct FieldRange {
  double low = 0, high = 0;
};
FieldRange field_range(const RegisterField& field);

/// Whether encode_field cuts nothing of `value` but what is rounded off.
bool can_hold(const RegisterField& field, double value);

/// Writes `value`, rounded to the nearest count and cut to what the field can hold, into the field's
/// register_count words; a u8 field leaves the other byte alone. False, and nothing written, if `value` is
/// not finite.
bool encode_field(const RegisterField& field, double value, std::span<std::uint16_t> words);

/// What the words say; may be NaN or infinite for f32.
double decode_field(const RegisterField& field, std::span<const std::uint16_t> words);

/// Where a register stands in the words of all blocks, one behind the other; -1: in none of them.
int find_register(const std::vector<RegisterBlock>& blocks, std::uint8_t unit, std::uint16_t address);
int total_count(const std::vector<RegisterBlock>& blocks);

}  // namespace lumbrical
