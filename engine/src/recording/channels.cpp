// See channels.h.
#include "recording/channels.h"

#include <algorithm>
#include <array>

#include "lumbrical/device.h"
#include "lumbrical/hand.h"
#include "recording/hand_views.h"
#include "recording/mcap_reader.h"
#include "recording/scene_views.h"
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
    "angle clamped,candidate overflow,force limited,fading,coarsened,object missing,object implausible,"
    "memory foreign,hand jumped";
static_assert(kHandJumped == 1u << 14);

constexpr const char* kUnits =
    "base.position m,base.orientation quaternion w x y z,joints.position m in the base frame,"
    "joints.orientation quaternion x y z w,angles rad,segments.force N in the world frame,"
    "segments.torque N m,segments.joint_torque N m,segments.flexion_torque N m,force_error N,"
    "error_estimate N,duration_ns ns,given.position m,objects.pose.position m,objects.force N in the world "
    "frame,"
    "objects.torque N m,objects.coordinate m or rad";

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

std::map<std::string, std::string> view_metadata(MessageKind kind) {
  std::map<std::string, std::string> metadata = {{"log_time", "session time of the tick it is of"}};
  switch (kind) {
    case MessageKind::pose:
      metadata["joints"] = listed(kJointCount, joint_name);
      metadata["units"] = "poses.position m in the world frame";
      break;
    case MessageKind::contacts:
      metadata["segments"] = listed(kSegmentCount, segment_name);
      metadata["units"] = "x m,y m,z m in the world frame,force_x N,force_y N,force_z N,depth m,area m^2";
      break;
    case MessageKind::scene:
      metadata["arrows"] = "forces of the segments, 5 mm for each newton";
      [[fallthrough]];
    default:
      metadata["units"] = "lengths m";
  }
  return metadata;
}
static_assert(kArrowScale == 0.005);

struct Kind {
  std::string_view topic, schema;
  bool of_session = false;  // not of a hand: the first one's channel carries it
};
constexpr std::array<Kind, static_cast<std::size_t>(MessageKind::count)> kKinds = {
    {{"tick", kTickSchemaName},
     {"pose", kPoseSchemaName},
     {"contacts", kContactsSchemaName},
     {"scene", kSceneSchemaName},
     {"objects", kSceneSchemaName, true},
     {"transforms", kTransformsSchemaName, true}}};

static_assert(2 * kKinds.size() <= kMostChannelsInChunk, "of two hands");

const Kind& kind_of(MessageKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::string topic_of(const RecordingChannel& channel) {
  return (channel.side ? std::string(side_name(*channel.side)) + "/" : std::string()) +
         std::string(kind_of(channel.kind).topic);
}

}  // namespace

std::optional<RecordingChannel> channel_of_topic(std::string_view topic) {
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
    for (const std::optional<Side> side : {std::optional(Side::left), std::optional(Side::right), {}}) {
      const RecordingChannel channel{static_cast<MessageKind>(kind), side};
      if (topic == topic_of(channel)) return channel;
    }
  return std::nullopt;
}

std::vector<RecordingChannel> channels_of(const std::vector<Side>& hands,
                                          const std::vector<MessageKind>& views) {
  std::vector<RecordingChannel> channels;
  const auto add = [&](MessageKind kind) {
    const std::size_t count = kind_of(kind).of_session ? 1 : hands.size();
    for (std::size_t hand = 0; hand < count; ++hand)
      channels.push_back({kind, hands.size() > 1 ? std::optional(hands[hand]) : std::nullopt});
  };
  add(MessageKind::tick);
  for (const MessageKind kind : views) add(kind);
  return channels;
}

std::size_t channel_number(const std::vector<RecordingChannel>& channels, const std::vector<Side>& hands,
                           MessageKind kind, std::size_t hand) {
  std::size_t number = 0;
  while (number < channels.size() &&
         !(channels[number].kind == kind && (hands.size() < 2 || channels[number].side == hands[hand])))
    ++number;
  return number;
}

McapWriter::Start::Channel start_of(const RecordingChannel& channel) {
  const bool tick = channel.kind == MessageKind::tick;
  return {kind_of(channel.kind).schema, tick ? tick_schema() : view_schema(), topic_of(channel),
          tick ? tick_metadata() : view_metadata(channel.kind)};
}

namespace {

// None: somebody else's. Other tools may have given a lone channel of ticks another topic.
std::optional<RecordingChannel> find_channel(std::string_view schema, std::string_view topic) {
  const std::optional<RecordingChannel> named = channel_of_topic(topic);
  if (named && schema == kind_of(named->kind).schema) return named;
  return schema == kTickSchemaName ? std::optional(RecordingChannel{}) : std::nullopt;
}

}  // namespace

bool ChannelIds::has(MessageKind kind) const {
  return std::any_of(channels_.begin(), channels_.end(),
                     [kind](const auto& channel) { return channel.second.kind == kind; });
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
