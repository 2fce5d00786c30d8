// Encoding and checked decoding of tick messages.
#include "recording/tick_message.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/message_alignment.h"
#include "recording/state_message.h"
#include "recording_bfbs_generated.h"
#include "recording_generated.h"

namespace lumbrical {
namespace {

// The schema's structs lie in memory as the engine's do.
static_assert(sizeof(fb::ObjectOutput) == sizeof(ObjectOutput) && sizeof(fb::Pose) == sizeof(ObjectFrame));
static_assert(sizeof(fb::Pose) == sizeof(Pose) && sizeof(fb::JointPose) == sizeof(JointPose));

// A comparison of numbers would take -0 for +0.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// fb::SegmentOutput as it lies in memory: of every array of HandForces one segment's numbers, as listed.
struct SegmentOutput {
  static constexpr std::size_t kNumbers = kNumberCount<HandForces> / kSegmentCount;
  std::uint64_t segment = 0;
  std::array<double, kNumbers> number{};
};
static_assert(sizeof(SegmentOutput) == sizeof(fb::SegmentOutput));

/// copy(number of the segment, its place in `output`), of forces to be read or written.
template <class Forces, class Output, class Copy>
void copy_segment(Forces& forces, std::size_t segment, Output& output, Copy&& copy) {
  std::size_t next = 0;
  list_forces(forces, [&](const char*, const char*, auto& array) {
    walk(array[segment], [&](const FieldName&, auto& number) { copy(number, output.number[next++]); });
  });
}

// All of them, in their order, so that a path such as segments[5].force.x is one curve in any plotting tool.
// Zeros take next to no room once compressed.
std::array<SegmentOutput, kSegmentCount> to_fb(const ActuatorFrame& frame) {
  std::array<SegmentOutput, kSegmentCount> segments;
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    copy_segment(frame, s, segments[s], [](const double& from, double& to) { to = from; });
    segments[s].segment = s;
  }
  return segments;
}

Status decode_device(const fb::Tick& message, DeviceFrame& device) {
  const fb::Pose* const base = message.base();
  if (base == nullptr) return Status::error("the tick message has no base pose");
  device.base = std::bit_cast<Pose>(*base);
  if (message.kind() > fb::InputKind::MAX)
    return Status::error("the tick message is of an unknown kind of input");
  device.kind = static_cast<InputKind>(message.kind());
  device.flags = message.device_flags();
  device.valid = message.valid();

  device.joint = {};
  if (const auto* const joints = message.joints()) {
    if (joints->size() != kJointCount) return Status::error("the tick message does not have 26 joints");
    for (std::uint32_t j = 0; j < kJointCount; ++j)
      device.joint[j] = std::bit_cast<JointPose>(*joints->Get(j));
  }
  device.angle = {};
  if (const auto* const angles = message.angles()) {
    if (angles->size() != kAngleCount) return Status::error("the tick message does not have 20 angles");
    for (std::uint32_t a = 0; a < kAngleCount; ++a) device.angle[a] = angles->Get(a);
  }
  return {};
}

HandForces unknown_forces() {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const Vec3 vector{unknown, unknown, unknown};
  HandForces forces;
  forces.segment.fill({vector, vector});
  forces.joint_torque.fill(vector);
  forces.flexion_torque.fill(unknown);
  return forces;
}

Status decode_output(const fb::Tick& message, ActuatorFrame& output) {
  output = {};
  output.tick = message.tick();
  output.flags = message.flags();
  output.contact_count = message.contact_count();
  output.force_error = message.force_error();
  output.error_estimate = message.error_estimate().value_or(0);
  output.evaluations = message.evaluations();
  if (message.segments() == nullptr) return {};
  if (!is_aligned(message.segments())) return Status::error("the tick message's segments are misplaced");
  std::uint32_t least = 0;
  for (const fb::SegmentOutput* const segment : *message.segments()) {
    const std::uint32_t s = segment->segment();
    if (s < least || s >= kSegmentCount)
      return Status::error("the tick message's segments are not ascending numbers below 16");
    least = s + 1;
    const auto numbers = std::bit_cast<SegmentOutput>(*segment);
    copy_segment(output, s, numbers, [](double& to, const double& from) { to = from; });
  }
  return {};
}

// A list of structs that lie in memory as the engine's do.
template <class Row, class Struct, std::size_t Most>
Status decode_rows(const flatbuffers::Vector<const Struct*>* from, std::uint32_t& count,
                   std::array<Row, Most>& rows) {
  count = from == nullptr ? 0 : from->size();
  if (count > Most || !is_aligned(from)) {
    count = 0;
    return Status::error("the tick message has more objects than a scene can have");
  }
  for (std::uint32_t i = 0; i < count; ++i) rows[i] = std::bit_cast<Row>(*from->Get(i));
  return {};
}

template <class Struct, class Row>
flatbuffers::Offset<flatbuffers::Vector<const Struct*>> to_rows(std::span<const Row> rows,
                                                                flatbuffers::FlatBufferBuilder& builder) {
  if (rows.empty()) return {};
  return builder.CreateVectorOfStructs(reinterpret_cast<const Struct*>(rows.data()), rows.size());
}

flatbuffers::Offset<fb::Sent> to_fb(const SentCommand& sent, flatbuffers::FlatBufferBuilder& builder) {
  const auto values = builder.CreateVector(sent.value.data(), sent.actuator_count);
  return fb::CreateSent(builder, sent.cycle, sent.tick, sent.sent, sent.acknowledged, sent.loop_delay,
                        static_cast<std::uint8_t>(sent.state), sent.flags, values);
}

Status decode_sent(const fb::Tick& message, TickRecord& record) {
  record.sent_count = 0;
  record.sent = {};
  if (message.sent() == nullptr) return {};
  for (const fb::Sent* const from : *message.sent()) {
    const std::uint32_t count = from->values() == nullptr ? 0 : from->values()->size();
    if (record.sent_count == kMaxSentPerTick || count > kMaxActuators || !is_aligned(from->values()) ||
        from->state() > static_cast<std::uint8_t>(SafetyState::fault)) {
      return Status::error("the tick message has a command to the device that can't be one");
    }
    SentCommand& sent = record.sent[record.sent_count++];
    sent = {from->cycle(),
            from->tick(),
            from->sent(),
            from->acknowledged(),
            from->loop_delay(),
            static_cast<SafetyState>(from->state()),
            from->flags(),
            count,
            {}};
    for (std::uint32_t i = 0; i < count; ++i) sent.value[i] = from->values()->Get(i);
  }
  return {};
}

}  // namespace

std::span<const std::uint8_t> tick_schema() {
  return {fb::TickBinarySchema::data(), fb::TickBinarySchema::size()};
}

void encode_tick(const TickRecord& record, bool keep_forces, const InputCheck& check,
                 flatbuffers::FlatBufferBuilder& builder, std::span<const std::uint8_t> after) {
  builder.Clear();
  const DeviceFrame& device = record.device;
  flatbuffers::Offset<flatbuffers::Vector<const fb::JointPose*>> joints;
  if (!same_bits(device.joint, DeviceFrame{}.joint)) {
    joints = builder.CreateVectorOfStructs(reinterpret_cast<const fb::JointPose*>(device.joint.data()),
                                           device.joint.size());
  }
  flatbuffers::Offset<flatbuffers::Vector<float>> angles;
  if (!same_bits(device.angle, DeviceFrame{}.angle))
    angles = builder.CreateVector(device.angle.data(), device.angle.size());
  flatbuffers::Offset<flatbuffers::Vector<const fb::SegmentOutput*>> outputs;
  if (keep_forces) {
    const std::array<SegmentOutput, kSegmentCount> segments = to_fb(record.output);
    outputs = builder.CreateVectorOfStructs(reinterpret_cast<const fb::SegmentOutput*>(segments.data()),
                                            segments.size());
  }

  flatbuffers::Offset<flatbuffers::Vector<flatbuffers::Offset<fb::Sent>>> sent;
  if (record.sent_count > 0) {
    std::array<flatbuffers::Offset<fb::Sent>, kMaxSentPerTick> offsets;
    for (std::uint32_t i = 0; i < record.sent_count; ++i) offsets[i] = to_fb(record.sent[i], builder);
    sent = builder.CreateVector(offsets.data(), record.sent_count);
  }

  const auto given = to_rows<fb::Pose>(given_of(record), builder);
  const auto objects = to_rows<fb::ObjectOutput>(objects_of(record), builder);
  flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> state;
  if (!after.empty()) state = builder.CreateVector(after.data(), after.size());

  const auto base = std::bit_cast<fb::Pose>(device.base);
  const auto& hash = record.stage_hash;
  const fb::StageHashes hashes(hash[0], hash[1], hash[2], hash[3], hash[4], hash[5]);
  static_assert(kStageCount == 6);
  const fb::InputCheck input_check(check.hash, check.low_sum, check.low_moment, check.high_sum,
                                   check.high_moment);
  const fb::Timing timing =
      record.timing ? fb::Timing(record.timing->period, record.timing->jitter, record.timing->delay)
                    : fb::Timing();
  builder.Finish(fb::CreateTick(builder, record.output.tick, record.duration_ns, &base,
                                static_cast<fb::InputKind>(device.kind), device.flags, device.valid, joints,
                                angles, record.output.flags, record.output.contact_count, outputs, &hashes,
                                record.state_hash, &input_check, record.output.force_error, sent,
                                !keep_forces, record.output.error_estimate, record.output.evaluations,
                                record.timing ? &timing : nullptr, given, objects, state));
}

Status decode_state_after(std::span<const std::uint8_t> bytes, std::optional<State>& after) {
  after.reset();
  std::vector<std::uint64_t> aligned;
  const fb::Tick* const message = verified<fb::Tick>(bytes, aligned);
  if (message == nullptr || message->after() == nullptr) return {};
  State state;
  if (Status status = decode_state({message->after()->data(), message->after()->size()}, state); !status.ok())
    return status;
  if (hash_state(state) != message->state_hash())
    return Status::error("the state kept beside the tick is not the one it left");
  after = std::move(state);
  return {};
}

Status decode_tick(std::span<const std::uint8_t> bytes, TickRecord& record, InputCheck& check) {
  std::vector<std::uint64_t> aligned;
  const fb::Tick* const found = verified<fb::Tick>(bytes, aligned);
  if (found == nullptr) return Status::error("the tick message does not fit its schema");
  const fb::Tick& message = *found;

  if (Status status = decode_device(message, record.device); !status.ok()) return status;
  if (Status status = decode_output(message, record.output); !status.ok()) return status;
  record.has_forces = !message.forces_left_out();
  if (!record.has_forces && message.segments() != nullptr)
    return Status::error("the tick message has the forces it says it leaves out");
  if (!record.has_forces) static_cast<HandForces&>(record.output) = unknown_forces();
  if (Status status = decode_sent(message, record); !status.ok()) return status;
  if (Status status = decode_rows(message.given(), record.given_count, record.given); !status.ok())
    return status;
  if (Status status = decode_rows(message.objects(), record.object_count, record.object); !status.ok())
    return status;
  record.timing.reset();
  if (const fb::Timing* const timing = message.timing())
    record.timing = {timing->period(), timing->jitter(), timing->delay()};
  const fb::StageHashes* const hashes = message.stage_hashes();
  const fb::InputCheck* const input_check = message.input_check();
  if (hashes == nullptr || input_check == nullptr) return Status::error("the tick message has no hashes");
  record.stage_hash = {hashes->input(),       hashes->hand_pose(),     hashes->broadphase(),
                       hashes->narrowphase(), hashes->contact_force(), hashes->limits()};
  record.state_hash = message.state_hash();
  record.duration_ns = message.duration_ns();
  check = {input_check->hash(), input_check->low_sum(), input_check->low_moment(), input_check->high_sum(),
           input_check->high_moment()};
  return {};
}

void take_input(const DeviceFrame& frame, std::span<const ObjectFrame> given, TickRecord& record) {
  assert(given.size() <= kMostObjects && "a scene has at most kMostObjects that are given");
  given = given.first(std::min(given.size(), kMostObjects));
  record.device = frame;
  record.given_count = static_cast<std::uint32_t>(given.size());
  std::copy(given.begin(), given.end(), record.given.begin());
}

void take_results(const State& after, const Scratch& scratch, TickRecord& record) {
  record.stage_hash = scratch.stage_hash;
  record.state_hash = hash_state(after);
  record.object_count = static_cast<std::uint32_t>(scratch.object_output.size());
  std::copy(scratch.object_output.begin(), scratch.object_output.end(), record.object.begin());
}

std::uint64_t tick_time(std::uint64_t tick, double period) {
  // Beyond 2^62 ns (146 years) session time stands still.
  constexpr double kLast = 4611686018427387904.0;
  const double time = std::floor(static_cast<double>(tick) * period + 0.5);
  return time < kLast ? static_cast<std::uint64_t>(time) : static_cast<std::uint64_t>(kLast);
}

std::uint64_t tick_at(std::uint64_t time, double rate) {
  return static_cast<std::uint64_t>(static_cast<double>(time) * rate * 1e-9 + 0.5);
}

}  // namespace lumbrical
