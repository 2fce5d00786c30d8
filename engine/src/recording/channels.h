// The channels of a recording: ticks of one hand or of two, what of them others can draw, and what a tool
// that does not know this project needs to label their numbers.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/hand.h"
#include "lumbrical/recording.h"
#include "recording/mcap_format.h"
#include "recording/mcap_writer.h"

namespace lumbrical {

/// What a channel carries.
struct RecordingChannel {
  MessageKind kind = MessageKind::tick;
  std::optional<Side> side{};  ///< of whose hand, in a session of two; none in a session of one
  friend bool operator==(const RecordingChannel&, const RecordingChannel&) = default;
};

/// The channel of a topic ("tick", "left/tick", "pose"), if there is one.
std::optional<RecordingChannel> channel_of_topic(std::string_view topic);

/// Those of a session with these hands, in the order in which the recorder numbers them, from 1: the ticks of
/// all hands first, then of each kind of `views`, which are in order. What is no hand's is the first one's.
std::vector<RecordingChannel> channels_of(const std::vector<Side>& hands,
                                          const std::vector<MessageKind>& views = {});

/// Those kinds but ticks, in order, of which `holds(kind)`.
template <class Holds>
std::vector<MessageKind> views_that(Holds&& holds) {
  std::vector<MessageKind> views;
  for (auto kind = MessageKind::pose; kind < MessageKind::count;
       kind = static_cast<MessageKind>(static_cast<int>(kind) + 1))
    if (holds(kind)) views.push_back(kind);
  return views;
}

/// Which of them it is; their number where it is none.
std::size_t channel_number(const std::vector<RecordingChannel>& channels, const std::vector<Side>& hands,
                           MessageKind kind, std::size_t hand);

/// As the writer takes it, with its schema. Metadata: names of segments, joints, angles and flags in their
/// order, units by the schema's names, and what log times are.
McapWriter::Start::Channel start_of(const RecordingChannel& channel);

/// Which ids stand for which of our channels, as schema and channel records are met.
class ChannelIds {
 public:
  void add_schema(std::uint16_t id, const std::string& name, const std::string& encoding);
  void add_channel(const mcap::Channel& channel);
  /// None: somebody else's.
  [[nodiscard]] const RecordingChannel* find(std::uint16_t id) const;
  [[nodiscard]] bool has(MessageKind kind) const;

 private:
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, RecordingChannel> channels_;
};

}  // namespace lumbrical
