// What a RecordingReader holds: the file, what it says of itself, and where reading stands.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lumbrical/recording.h"
#include "recording/channels.h"
#include "recording/mcap_reader.h"

namespace lumbrical {

struct RecordingReader::File {
  InputFile file;
  RecordingInfo info;
  Scene scene;
  bool has_scene = false;
  std::optional<Side> asked;       // for a session of two hands
  std::optional<Hand> other_hand;  // the one that is not read
  std::size_t hand = 0;            // that is read: 0 or 1
  std::array<State, kMostHands> initial_state;
  std::uint64_t data_start = 0;
  std::uint64_t data_end = 0;            // where walking stops at the latest
  std::vector<mcap::ChunkIndex> chunks;  // of a complete file; every chunk met must be the next of these
  ChannelIds channels;

  bool scanning = false;  // session and metadata are taken where they are met

  // Where next() stands.
  std::uint64_t offset = 0;      // of the next record outside chunks
  std::size_t chunk_number = 0;  // of the next chunk
  LoadedChunk chunk;
  std::uint64_t chunk_offset = 0;     // in the file, for messages
  std::size_t inner_offset = 0;       // of the next record in the chunk
  std::uint64_t skip_below = 0;       // ticks that seek() passes over
  std::optional<Divergence> altered;  // what was changed in the last record handed out
  RecordedMessage message;            // the last one; in the chunk or in `content`
  bool all_messages = false;          // of whatever kind and hand; else the ticks of `hand`
  TickRecord passed_on;               // whose message next_message() hands out
  std::vector<std::uint8_t> content;  // room that is used again and again

  Status open(const std::string& path);
  Status read_summary_and_ends();
  Status scan();
  Status take_attachment(const RecordPlace& place);
  Status take_session(mcap::Bytes bytes, std::uint64_t at);
  Status take_metadata(const RecordPlace& place);
  [[nodiscard]] std::optional<std::size_t> hand_of(const RecordingChannel& channel) const;
  [[nodiscard]] bool is_read(std::uint16_t channel) const;
  [[nodiscard]] std::size_t last_chunk() const;
  Status take_indexed(const Summary& summary);
  void count_tick(const TickRecord& record);

  void rewind();
  void go_to_chunk(std::size_t number);
  Status next(TickRecord& record, bool& end);
  Status next_outside(TickRecord& record, bool& found, bool& end);
  Status next_inside(TickRecord& record, bool& found);
  Status enter_chunk(const RecordPlace& place);
  Status take_message(mcap::Bytes bytes, std::uint64_t at, TickRecord& record, bool& found);
  bool take_schema(mcap::Bytes bytes);
  bool take_channel(mcap::Bytes bytes);
};

}  // namespace lumbrical
