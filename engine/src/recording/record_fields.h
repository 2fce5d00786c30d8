// Every number of a tick record under its name, and the check that finds an input number changed after
// recording.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "lumbrical/recording.h"
#include "tick/field_lists.h"

namespace lumbrical {

/// What comes into a tick: its number and the device frame.
struct TickInput {
  std::uint64_t tick = 0;
  DeviceFrame frame;
};
constexpr void list_fields(Is<TickInput> auto& input, auto&& field) {
  field("tick", "", input.tick);
  list_fields(input.frame, field);
}
using InputFields = Numbers<TickInput>;
InputFields input_fields(const TickRecord& record);

/// What comes out of it. Those below kFirstForce are kept where forces are left out.
using OutputFields = Numbers<ActuatorFrame>;
inline constexpr std::size_t kFirstForce = kNumberCount<ActuatorFrame> - kNumberCount<HandForces>;
OutputFields output_fields(const ActuatorFrame& frame);

/// The shortest decimal that reads back as the same number; "inf", "-inf", and a NaN by its bits
/// ("nan:0x7fc00000").
std::string exact_text(float value);
std::string exact_text(double value);
/// Six digits are more than any quantity is worth; no -0.
std::string rounded_text(double value, int digits = 6);
std::string number_text(NumberType type, std::uint64_t bits);  ///< kinds of input and laws by their names
std::string hash_text(std::uint64_t hash);                     ///< "0x" and 16 hexadecimal digits
std::string_view kind_name(InputKind kind);

/// Sums over the input fields' lower and upper 32 bits, plain and weighted by 1 + the field's number, and a
/// hash.
///
/// A change of one field by d changes the sum by d and the weighted sum by (1 + field) d, so the two tell
/// which field it was and what it held before. Sums of 32-bit halves stay below 2^47: they are exact, nothing
/// wraps round. The hash then confirms it, and notices changes that cancel in the sums, and such of given
/// objects.
struct InputCheck {
  std::uint64_t hash = 0;
  std::uint64_t low_sum = 0, low_moment = 0, high_sum = 0, high_moment = 0;
  friend bool operator==(const InputCheck&, const InputCheck&) = default;
};
InputCheck make_input_check(const InputFields& fields, std::span<const ObjectFrame> given);
InputCheck input_check_of(const TickRecord& record);
/// Of a record: input and output that come in lists.
inline std::span<const ObjectFrame> given_of(const TickRecord& record) {
  return {record.given.data(), record.given_count};
}
inline std::span<const ObjectOutput> objects_of(const TickRecord& record) {
  return {record.object.data(), record.object_count};
}

/// What was changed since `recorded` was made from the record's input; nothing if all is as it was.
/// `recorded` of the answer is the original value, `replayed` the present one.
std::optional<Divergence> find_altered_input(const TickRecord& record, const InputCheck& recorded);

/// The first input field in which two records differ.
std::optional<Divergence> compare_inputs(const TickRecord& recorded, const TickRecord& replayed);

/// The first setting in which two scenes differ; its stage is "scene".
std::optional<Divergence> compare_settings(std::uint64_t tick, const Settings& recorded,
                                           const Settings& replayed);

/// Where two results of the same tick part: the first stage whose hash differs, or "output", or "state".
std::optional<Divergence> compare_results(const TickRecord& recorded, const TickRecord& replayed);

}  // namespace lumbrical
