// Every number of a tick record under its name, and the check that finds an input number changed after
// recording.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "lumbrical/recording.h"

namespace lumbrical {

/// Tick number, device frame: 11 single numbers, 7 per joint, the angles. Each is the number's bits.
inline constexpr int kInputFieldCount = 11 + 7 * kJointCount + kAngleCount;
using InputFields = std::array<std::uint64_t, kInputFieldCount>;
InputFields input_fields(const TickRecord& record);
std::string input_field_name(
    int field);  ///< "tick", "base.position.x", "joint[7].position[1]", "angle[4]", ...
std::string input_field_text(int field, std::uint64_t bits);  ///< exact: reading it back gives the same bits

/// Actuator frame without the tick number: flags, contact count, error bound, 10 numbers per segment.
inline constexpr int kFirstForce = 3;
inline constexpr int kOutputFieldCount = kFirstForce + 10 * kSegmentCount;
using OutputFields = std::array<std::uint64_t, kOutputFieldCount>;
OutputFields output_fields(const ActuatorFrame& frame);
std::string output_field_name(int field);  ///< "flags", "segment[3].force.x", "joint_torque[3].y", ...
std::string output_field_text(int field, std::uint64_t bits);

/// The shortest decimal that reads back as the same number; "inf", "-inf", and a NaN by its bits
/// ("nan:0x7fc00000").
std::string exact_text(float value);
std::string exact_text(double value);
std::string hash_text(std::uint64_t hash);  ///< "0x" and 16 hexadecimal digits

/// Sums over the input fields' lower and upper 32 bits, plain and weighted by 1 + the field's number, and a
/// hash.
///
/// A change of one field by d changes the sum by d and the weighted sum by (1 + field) d, so the two tell
/// which field it was and what it held before. Sums of 32-bit halves stay below 2^47: they are exact, nothing
/// wraps round. The hash then confirms it, and notices changes that cancel in the sums.
struct InputCheck {
  std::uint64_t hash = 0;
  std::uint64_t low_sum = 0, low_moment = 0, high_sum = 0, high_moment = 0;
  friend bool operator==(const InputCheck&, const InputCheck&) = default;
};
InputCheck make_input_check(const InputFields& fields);

/// What was changed since `recorded` was made from the record's input; nothing if all is as it was.
/// `recorded` of the answer is the original value, `replayed` the present one.
std::optional<Divergence> find_altered_input(const TickRecord& record, const InputCheck& recorded);

/// Where two results of the same tick part: the first stage whose hash differs, or "output", or "state".
std::optional<Divergence> compare_results(const TickRecord& recorded, const TickRecord& replayed);

}  // namespace lumbrical
