// Names and values of a tick record's numbers, and comparison by bits: -0 is not +0, and a NaN equals itself.
#include "recording/record_fields.h"

#include <bit>
#include <charconv>
#include <cmath>

#include "base/hash.h"
#include "tick/tick_trace.h"

namespace lumbrical {
namespace {

// Places in InputFields; the order of the names below.
enum : int { kTick, kBase, kKind = kBase + 7, kFlags, kValid, kJoints, kAngles = kJoints + 7 * kJointCount };
static_assert(kAngles + kAngleCount == kInputFieldCount);
constexpr int kFirstRealOutput = 2;  // behind flags and contact count

constexpr std::array<const char*, 7> kBaseNames = {"position.x",    "position.y",    "position.z",
                                                   "orientation.w", "orientation.x", "orientation.y",
                                                   "orientation.z"};
constexpr std::array<const char*, 10> kSegmentNames = {
    "force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z", "x", "y", "z", ""};

std::uint64_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }
std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value); }

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

std::string float_text(std::uint64_t bits) {
  return exact_text(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
}
std::string double_text(std::uint64_t bits) { return exact_text(std::bit_cast<double>(bits)); }

std::string numbered(const char* name, int index, const char* part) {
  return name + ("[" + std::to_string(index) + "]") + part;
}

// The field whose change alone explains how much sum and moment have changed; -1 where none does.
int changed_field(std::int64_t sum_change, std::int64_t moment_change) {
  if (sum_change == 0 || moment_change % sum_change != 0) return -1;
  const std::int64_t field = moment_change / sum_change - 1;
  return field >= 0 && field < kInputFieldCount ? static_cast<int>(field) : -1;
}

std::uint64_t hash_of(const InputFields& fields) {
  Hasher hasher;
  hasher.array(fields);
  return hasher.digest();
}

std::int64_t difference(std::uint64_t a, std::uint64_t b) { return static_cast<std::int64_t>(a - b); }

/// The one field that explains the change from `recorded` to `present`, put back to what it was; -1 if there
/// is none.
int restore_field(InputFields& fields, const InputCheck& recorded, const InputCheck& present) {
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
  return make_input_check(fields) == recorded ? field : -1;
}

std::optional<Divergence> first_output_difference(const TickRecord& recorded, const TickRecord& replayed) {
  const OutputFields a = output_fields(recorded.output), b = output_fields(replayed.output);
  // Of forces left out there is the hash alone.
  const int count = recorded.has_forces && replayed.has_forces ? kOutputFieldCount : kFirstForce;
  for (int i = 0; i < count; ++i) {
    if (a[i] == b[i]) continue;
    Divergence divergence{recorded.output.tick, "output", output_field_name(i), output_field_text(i, a[i]),
                          output_field_text(i, b[i])};
    const bool whole = i < kFirstRealOutput;
    divergence.ulp = ulps_between(whole ? TraceValue::Type::whole : TraceValue::Type::real, a[i], b[i]);
    return divergence;
  }
  return std::nullopt;
}

}  // namespace

std::string exact_text(float value) { return real_text(value); }
std::string exact_text(double value) { return real_text(value); }
std::string hash_text(std::uint64_t hash) { return hexadecimal(hash, 16); }

InputFields input_fields(const TickRecord& record) {
  const DeviceFrame& device = record.device;
  const Vec3 p = device.base.position;
  const Quat q = device.base.orientation;
  InputFields fields;
  std::size_t next = 0;
  fields[next++] = record.output.tick;
  for (const double value : {p.x, p.y, p.z, q.w, q.x, q.y, q.z}) fields[next++] = bits_of(value);
  fields[next++] = static_cast<std::uint64_t>(device.kind);
  fields[next++] = device.flags;
  fields[next++] = device.valid;
  for (const JointPose& joint : device.joint) {
    for (const float value : joint.position) fields[next++] = bits_of(value);
    for (const float value : joint.orientation) fields[next++] = bits_of(value);
  }
  for (const float value : device.angle) fields[next++] = bits_of(value);
  return fields;
}

std::string input_field_name(int field) {
  if (field >= kAngles) return numbered("angle", field - kAngles, "");
  if (field >= kJoints) {
    const int joint = (field - kJoints) / 7, part = (field - kJoints) % 7;
    return numbered("joint", joint, "") +
           (part < 3 ? numbered(".position", part, "") : numbered(".orientation", part - 3, ""));
  }
  if (field == kTick) return "tick";
  if (field == kKind) return "kind";
  if (field == kFlags) return "flags";
  if (field == kValid) return "valid";
  return std::string("base.") + kBaseNames[field - kBase];
}

std::string input_field_text(int field, std::uint64_t bits) {
  if (field >= kJoints) return float_text(bits);
  if (field == kKind && bits == 0) return "joint_poses";
  if (field == kKind && bits == 1) return "joint_angles";
  return field >= kBase && field < kKind ? double_text(bits) : std::to_string(bits);
}

OutputFields output_fields(const ActuatorFrame& frame) {
  OutputFields fields;
  std::size_t next = 0;
  fields[next++] = frame.flags;
  fields[next++] = frame.contact_count;
  fields[next++] = bits_of(frame.force_error);
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    for (const Vec3 v : {frame.segment[s].force, frame.segment[s].torque, frame.joint_torque[s]})
      for (const double value : {v.x, v.y, v.z}) fields[next++] = bits_of(value);
    fields[next++] = bits_of(frame.flexion_torque[s]);
  }
  return fields;
}

std::string output_field_name(int field) {
  if (field == 0) return "flags";
  if (field == 1) return "contact_count";
  if (field == 2) return "force_error";
  const int segment = (field - 3) / 10, part = (field - 3) % 10;
  if (part == 9) return numbered("flexion_torque", segment, "");
  const char* const owner = part < 6 ? "segment" : "joint_torque";
  return numbered(owner, segment, ".") + kSegmentNames[part];
}

std::string output_field_text(int field, std::uint64_t bits) {
  return field < kFirstRealOutput ? std::to_string(bits) : double_text(bits);
}

InputCheck make_input_check(const InputFields& fields) {
  InputCheck check;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::uint64_t low = fields[i] & 0xffffffffu, high = fields[i] >> 32;
    check.low_sum += low;
    check.low_moment += (i + 1) * low;
    check.high_sum += high;
    check.high_moment += (i + 1) * high;
  }
  check.hash = hash_of(fields);
  return check;
}

std::optional<Divergence> find_altered_input(const TickRecord& record, const InputCheck& recorded) {
  const InputFields fields = input_fields(record);
  const InputCheck present = make_input_check(fields);
  if (present == recorded) return std::nullopt;
  Divergence altered{record.output.tick, "input", "several", hash_text(recorded.hash),
                     hash_text(present.hash)};
  InputFields original = fields;
  if (present.hash == recorded.hash) {
    altered.field = "input_check";  // the input is whole, its check is not
  } else if (const int field = restore_field(original, recorded, present); field >= 0) {
    altered.field = input_field_name(field);
    altered.recorded = input_field_text(field, original[field]);
    altered.replayed = input_field_text(field, fields[field]);
    altered.tick = original[kTick];
    const bool real = (field >= kBase && field < kKind) || field >= kJoints;
    const auto type = !real              ? TraceValue::Type::whole
                      : field >= kJoints ? TraceValue::Type::real32
                                         : TraceValue::Type::real;
    altered.ulp = ulps_between(type, original[field], fields[field]);
  }
  return altered;
}

std::optional<Divergence> compare_results(const TickRecord& recorded, const TickRecord& replayed) {
  for (int stage = 0; stage < kStageCount; ++stage) {
    if (recorded.stage_hash[stage] == replayed.stage_hash[stage]) continue;
    Divergence divergence{recorded.output.tick, "", "hash", hash_text(recorded.stage_hash[stage]),
                          hash_text(replayed.stage_hash[stage])};
    if (std::optional<Divergence> output = first_output_difference(recorded, replayed)) divergence = *output;
    divergence.stage = stage_name(static_cast<Stage>(stage));
    return divergence;
  }
  if (std::optional<Divergence> output = first_output_difference(recorded, replayed)) return output;
  if (recorded.state_hash == replayed.state_hash) return std::nullopt;
  return Divergence{recorded.output.tick, "state", "hash", hash_text(recorded.state_hash),
                    hash_text(replayed.state_hash)};
}

}  // namespace lumbrical
