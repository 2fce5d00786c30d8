// Walking a recording: into its chunks and through them, one message after the other.
#include <algorithm>

#include "recording/reader_file.h"
#include "recording/record_fields.h"
#include "recording/recorder.h"
#include "recording/tick_message.h"

namespace lumbrical {

using namespace mcap;

// Whose a channel is; none where nobody's of this session.
std::optional<std::size_t> RecordingReader::File::hand_of(const RecordingChannel& channel) const {
  if (info.hands.size() < 2) return 0;
  const auto found = std::find(info.hands.begin(), info.hands.end(), channel.side);
  if (found == info.hands.end()) return std::nullopt;
  return static_cast<std::size_t>(found - info.hands.begin());
}

// Whether a channel carries the ticks of the hand that is read.
bool RecordingReader::File::is_read(std::uint16_t id) const {
  const RecordingChannel* const channel = channels.find(id);
  return channel != nullptr && channel->kind == MessageKind::tick && hand_of(*channel) == hand;
}

bool RecordingReader::File::take_schema(Bytes bytes) {
  Schema schema;
  if (!parse(bytes, schema)) return false;
  channels.add_schema(schema.id, schema.name, schema.encoding);
  return true;
}

bool RecordingReader::File::take_channel(Bytes bytes) {
  Channel channel;
  if (!parse(bytes, channel)) return false;
  channels.add_channel(channel);
  return true;
}

Status RecordingReader::File::take_message(Bytes bytes, std::uint64_t at, TickRecord& record, bool& found) {
  Message parsed;
  if (!parse(bytes, parsed)) return file.broken(at, "a message is shorter than it declares");
  const RecordingChannel* const channel = channels.find(parsed.channel_id);
  if (channel == nullptr || !(all_messages || is_read(parsed.channel_id))) return {};
  const std::optional<std::size_t> whose = hand_of(*channel);
  if (!whose) return {};
  message = {channel->kind, static_cast<std::uint8_t>(*whose), 0, 0, parsed.data};
  found = true;
  if (channel->kind != MessageKind::tick) {
    message.tick = record.output.tick = tick_at(parsed.log_time, scene.settings.rate);
    return {};
  }
  InputCheck check;
  if (Status status = decode_tick(parsed.data, record, check); !status.ok())
    return file.broken(at, status.message() + "; the file is damaged or of another version");
  record.hand = message.hand;
  message.tick = record.output.tick;
  message.state_hash = record.state_hash;
  altered = find_altered_input(record, check);
  return {};
}

Status RecordingReader::File::enter_chunk(const RecordPlace& place) {
  // The index says where every chunk is: a damaged length or opcode must not make one disappear.
  if (info.complete) {
    if (chunk_number >= chunks.size() || chunks[chunk_number].offset != place.offset ||
        chunks[chunk_number].length != place.end() - place.offset)
      return file.broken(place.offset, "the chunk is not where the index says; run recover");
  }
  inner_offset = 0;
  chunk_offset = place.offset;
  if (Status status = load_chunk(file, place, content, chunk); !status.ok()) {
    chunk.records.clear();  // nothing that failed its checksum may be handed out
    return status;
  }
  ++chunk_number;
  return {};
}

Status RecordingReader::File::next_inside(TickRecord& record, bool& found) {
  while (!found && inner_offset < chunk.records.size()) {
    InnerRecord inner;
    if (!find_inner_record(chunk.records, inner_offset, inner))
      return file.broken(chunk_offset, "the chunk ends in the middle of a record");
    inner_offset = inner.end;
    bool good = true;
    if (inner.opcode == Opcode::message) {
      if (Status status = take_message(inner.content, chunk_offset, record, found); !status.ok())
        return status;
    } else if (inner.opcode == Opcode::schema) {
      good = take_schema(inner.content);
    } else if (inner.opcode == Opcode::channel) {
      good = take_channel(inner.content);
    } else {
      good = false;
    }
    if (!good) return file.broken(chunk_offset, "the chunk holds a damaged record");
  }
  return {};
}

// Steps over one record outside chunks, or into the chunk it is.
Status RecordingReader::File::next_outside(TickRecord& record, bool& found, bool& end) {
  RecordPlace place;
  bool whole = false;
  if (Status status = find_record(file, offset, data_end, place, whole); !status.ok()) return status;
  if (!whole || place.opcode == Opcode::data_end) {
    // A torn file ends in the middle of a record; a complete one may not, nor before its last chunk.
    if (info.complete && (!whole || place.end() != data_end || chunk_number != chunks.size()))
      return file.broken(offset, "the ticks end before the index says; run recover");
    end = true;
    return {};
  }
  if (place.opcode == Opcode::none ||
      (place.opcode > Opcode::data_end && place.opcode < Opcode::first_private))
    return file.broken(offset, "there is no record here; run recover");
  offset = place.end();
  if (place.opcode == Opcode::chunk) return enter_chunk(place);
  if (scanning && place.opcode == Opcode::attachment) return take_attachment(place);
  if (scanning && place.opcode == Opcode::metadata) return take_metadata(place);
  if (place.opcode != Opcode::message && place.opcode != Opcode::schema && place.opcode != Opcode::channel)
    return {};

  if (Status status = read_content(file, place, content); !status.ok()) return status;
  if (place.opcode == Opcode::message) return take_message(content, place.offset, record, found);
  const bool good = place.opcode == Opcode::schema ? take_schema(content) : take_channel(content);
  return good ? Status{} : file.broken(place.offset, "the record is shorter than it declares");
}

Status RecordingReader::File::next(TickRecord& record, bool& end) {
  end = false;
  for (;;) {
    bool found = false;
    if (Status status = next_inside(record, found); !status.ok()) return status;
    if (!found) {
      if (Status status = next_outside(record, found, end); !status.ok()) return status;
      if (end) return {};
    }
    if (found && record.output.tick >= skip_below) {
      skip_below = 0;
      return {};
    }
  }
}

void RecordingReader::File::rewind() {
  offset = data_start;
  chunk_number = 0;
  chunk.records.clear();
  inner_offset = 0;
  skip_below = 0;
  altered.reset();
}

void RecordingReader::File::go_to_chunk(std::size_t number) {
  rewind();
  if (number >= chunks.size()) return;
  chunk_number = number;
  offset = chunks[number].offset;
}

}  // namespace lumbrical
