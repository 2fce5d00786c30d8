// See channels.h.
#include "recording/channels.h"

#include "lumbrical/device.h"
#include "lumbrical/hand.h"
#include "recording/tick_message.h"

namespace lumbrical {
namespace {

template <class NameOf>
std::string listed(int count, NameOf&& name_of) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i == 0 ? "" : ",") + std::string(name_of(i));
  return text;
}

std::string angle_name(int angle) {
  const std::string finger(finger_name(angle / 4));
  return finger + (angle % 4 == 0 ? " abduction" : " flexion " + std::to_string(angle % 4));
}

// TickFlag, from bit 0 on.
constexpr const char* kFlags =
    "input not finite,input implausible,input lost,input extrapolated,segment missing,segment degenerate,"
    "angle clamped,candidate overflow,force limited,fading,coarsened";
static_assert(kCoarsened == 1u << 10);

constexpr const char* kUnits =
    "base.position m,base.orientation quaternion w x y z,joints.position m in the base frame,"
    "joints.orientation quaternion x y z w,angles rad,segments.force N in the world frame,"
    "segments.torque N m,segments.joint_torque N m,segments.flexion_torque N m,force_error N,"
    "error_estimate N,duration_ns ns";

std::map<std::string, std::string> tick_metadata() {
  return {
      {"segments", listed(kSegmentCount, segment_name)},
      {"joints", listed(kJointCount, joint_name)},
      {"angles", listed(kAngleCount, angle_name)},
      {"flags", kFlags},
      {"units", kUnits},
      {"log_time",
       "session time: tick / rate in ns; the clock at its start: metadata start_utc, start_monotonic_ns"}};
}

constexpr std::string_view kTickTopic = "tick";

}  // namespace

std::string topic_of(const RecordingChannel& channel) {
  return (channel.side ? std::string(side_name(*channel.side)) + "/" : std::string()) +
         std::string(kTickTopic);
}

// Other tools may have given a lone channel another topic.
std::optional<RecordingChannel> find_channel(std::string_view schema, std::string_view topic) {
  if (schema != kTickSchemaName) return std::nullopt;
  for (const Side side : {Side::left, Side::right})
    if (topic == topic_of({side})) return RecordingChannel{side};
  return RecordingChannel{};
}

std::vector<RecordingChannel> channels_of(const std::vector<Side>& hands) {
  if (hands.size() == 1) return {{}};
  std::vector<RecordingChannel> channels;
  for (const Side side : hands) channels.push_back({side});
  return channels;
}

McapWriter::Start::Channel start_of(const RecordingChannel& channel) {
  return {kTickSchemaName, tick_schema(), topic_of(channel), tick_metadata()};
}

void ChannelIds::add_schema(std::uint16_t id, const std::string& name, const std::string& encoding) {
  if (encoding == "flatbuffer") schemas_.emplace(id, name);
}

void ChannelIds::add_channel(const mcap::Channel& channel) {
  const auto schema = schemas_.find(channel.schema_id);
  if (schema == schemas_.end()) return;
  if (const auto found = find_channel(schema->second, channel.topic)) channels_.emplace(channel.id, *found);
}

const RecordingChannel* ChannelIds::find(std::uint16_t id) const {
  const auto found = channels_.find(id);
  return found == channels_.end() ? nullptr : &found->second;
}

}  // namespace lumbrical
