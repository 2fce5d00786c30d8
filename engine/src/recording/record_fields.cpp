// Names and values of a tick record's numbers, and comparison by bits: -0 is not +0, and a NaN equals itself.
#include "recording/record_fields.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "tick/tick_trace.h"

namespace lumbrical {
namespace {

std::string hexadecimal(std::uint64_t bits, int digits) {
  std::string text = "0x";
  for (int i = digits - 1; i >= 0; --i) text += "0123456789abcdef"[(bits >> (4 * i)) & 15];
  return text;
}

// There are many NaNs, so they are told by their bits.
template <class Real>
std::string real_text(Real value) {
  if (std::isnan(value)) return "nan:" + hexadecimal(bits_of(value), 2 * sizeof(Real));
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return std::string(text.data(), end);
}

// The field whose change alone explains how much sum and moment have changed; -1 where none does. The changes
// are a file's: the least of all numbers, which no sum comes near, has no quotient by -1.
int changed_field(std::int64_t sum_change, std::int64_t moment_change) {
  if (sum_change == 0 || moment_change == std::numeric_limits<std::int64_t>::min()) return -1;
  if (moment_change % sum_change != 0) return -1;
  const std::int64_t field = moment_change / sum_change - 1;
  return field >= 0 && field < static_cast<std::int64_t>(kNumberCount<TickInput>) ? static_cast<int>(field)
                                                                                  : -1;
}

// Wraps round, as a file may hold any sums.
std::int64_t difference(std::uint64_t a, std::uint64_t b) { return static_cast<std::int64_t>(a - b); }

/// The one field that explains the change from `recorded` to `present`, put back to what it was; -1 if there
/// is none.
int restore_field(InputFields& fields, std::span<const ObjectFrame> given, const InputCheck& recorded,
                  const InputCheck& present) {
  const std::int64_t low = difference(present.low_sum, recorded.low_sum);
  const std::int64_t high = difference(present.high_sum, recorded.high_sum);
  const int low_field = changed_field(low, difference(present.low_moment, recorded.low_moment));
  const int high_field = changed_field(high, difference(present.high_moment, recorded.high_moment));
  if (low != 0 && high != 0 && low_field != high_field) return -1;
  const int field = low != 0 ? low_field : high_field;
  if (field < 0) return -1;
  std::uint64_t& bits = fields[field];
  const std::uint64_t low_half = (bits & 0xffffffffu) - static_cast<std::uint64_t>(low);
  const std::uint64_t high_half = (bits >> 32) - static_cast<std::uint64_t>(high);
  bits = (high_half << 32) | (low_half & 0xffffffffu);
  return make_input_check(fields, given) == recorded ? field : -1;
}

Divergence difference_of(std::uint64_t tick, const char* stage, const NumberField& field,
                         std::uint64_t recorded, std::uint64_t replayed) {
  Divergence divergence{tick, stage, field.name, number_text(field.type, recorded),
                        number_text(field.type, replayed)};
  divergence.ulp = ulps_between(field.type, recorded, replayed);
  return divergence;
}

/// The first of the fields below `count` that differs.
template <class T>
std::optional<Divergence> first_difference(std::uint64_t tick, const char* stage, const Numbers<T>& recorded,
                                           const Numbers<T>& replayed, std::size_t count = kNumberCount<T>) {
  for (std::size_t i = 0; i < count; ++i)
    if (recorded[i] != replayed[i])
      return difference_of(tick, stage, fields_of<T>()[i], recorded[i], replayed[i]);
  return std::nullopt;
}

std::optional<Divergence> compare_outputs(const TickRecord& recorded, const TickRecord& replayed) {
  // Of forces left out there is the hash alone.
  const bool forces = recorded.has_forces && replayed.has_forces;
  return first_difference<ActuatorFrame>(recorded.output.tick, "output", output_fields(recorded.output),
                                         output_fields(replayed.output),
                                         forces ? kNumberCount<ActuatorFrame> : kFirstForce);
}

}  // namespace

std::string exact_text(float value) { return real_text(value); }
std::string exact_text(double value) { return real_text(value); }
std::string rounded_text(double value, int digits) {
  if (std::isnan(value)) return "nan";
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value + 0.0,  // no -0
                                          std::chars_format::general, digits);
  return std::string(text.data(), end);
}
std::string hash_text(std::uint64_t hash) { return hexadecimal(hash, 16); }

std::string number_text(NumberType type, std::uint64_t bits) {
  switch (type) {
    case NumberType::real:
      return exact_text(std::bit_cast<double>(bits));
    case NumberType::real32:
      return exact_text(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    case NumberType::kind:
      if (bits <= bits_of(InputKind::joint_angles))
        return std::string(kind_name(static_cast<InputKind>(bits)));
      break;
    case NumberType::law:
      if (bits <= bits_of(Law::point)) return std::string(law_name(static_cast<Law>(bits)));
      break;
    case NumberType::whole:
      break;
  }
  return std::to_string(bits);
}

std::string_view kind_name(InputKind kind) {
  return kind == InputKind::joint_poses ? "joint_poses" : "joint_angles";
}

std::optional<Divergence> find_altered_input(const TickRecord& record, const InputCheck& recorded) {
  const InputFields fields = input_fields(record);
  const InputCheck present = make_input_check(fields, given_of(record));
  if (present == recorded) return std::nullopt;
  Divergence altered{record.output.tick, "input", "several", hash_text(recorded.hash),
                     hash_text(present.hash)};
  InputFields original = fields;
  if (present.hash == recorded.hash) {
    altered.field = "input_check";  // the input is whole, its check is not
  } else if (const int field = restore_field(original, given_of(record), recorded, present); field >= 0) {
    const auto i = static_cast<std::size_t>(field);
    altered = difference_of(original[0], "input", fields_of<TickInput>()[i], original[i], fields[i]);
  }
  return altered;
}

std::optional<Divergence> compare_inputs(const TickRecord& recorded, const TickRecord& replayed) {
  const InputFields a = input_fields(recorded), b = input_fields(replayed);
  if (auto difference = first_difference<TickInput>(std::min(a[0], b[0]), "input", a, b)) return difference;
  const std::uint64_t given_a = hash_rows(given_of(recorded)), given_b = hash_rows(given_of(replayed));
  if (given_a == given_b) return std::nullopt;
  return Divergence{recorded.output.tick, "input", "given", hash_text(given_a), hash_text(given_b)};
}

std::optional<Divergence> compare_settings(std::uint64_t tick, const Settings& recorded,
                                           const Settings& replayed) {
  return first_difference<Settings>(tick, "scene", numbers_of(recorded), numbers_of(replayed));
}

std::optional<Divergence> compare_results(const TickRecord& recorded, const TickRecord& replayed) {
  for (int stage = 0; stage < kStageCount; ++stage) {
    if (recorded.stage_hash[stage] == replayed.stage_hash[stage]) continue;
    Divergence divergence{recorded.output.tick, "", "hash", hash_text(recorded.stage_hash[stage]),
                          hash_text(replayed.stage_hash[stage])};
    if (std::optional<Divergence> output = compare_outputs(recorded, replayed)) divergence = *output;
    divergence.stage = stage_name(static_cast<Stage>(stage));
    return divergence;
  }
  if (std::optional<Divergence> output = compare_outputs(recorded, replayed)) return output;
  if (recorded.state_hash == replayed.state_hash) return std::nullopt;
  return Divergence{recorded.output.tick, "state", "hash", hash_text(recorded.state_hash),
                    hash_text(replayed.state_hash)};
}

}  // namespace lumbrical
