// Verification of a recording: the whole file is read once and compared with everything it says about itself.
#include <algorithm>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lumbrical/recording.h"
#include "recording/channels.h"
#include "recording/hand_views.h"
#include "recording/mcap_reader.h"
#include "recording/record_fields.h"
#include "recording/scene_views.h"
#include "recording/session_message.h"
#include "recording/tick_message.h"
#include "recording/tick_ranges.h"

namespace lumbrical {

using namespace mcap;

namespace {

/// What of a tick is not what its own hashes say; null: nothing. Of forces that are left out there is the
/// hash alone, which a replay compares.
const char* changed_result(const TickRecord& record) {
  if (record.stage_hash[static_cast<std::size_t>(Stage::input)] !=
      hash_input(record.device, given_of(record)))
    return "the hash of its input was";
  if (record.has_forces && record.stage_hash[static_cast<std::size_t>(Stage::limits)] !=
                               hash_output(record.output, objects_of(record)))
    return "its output was";
  return nullptr;
}

Status check_view_bytes(Bytes bytes, MessageKind kind) {
  std::vector<Pose> joints;
  std::vector<ContactPoint> points;
  switch (kind) {
    case MessageKind::pose:
      return decode_pose(bytes, joints);
    case MessageKind::contacts:
      return decode_contacts(bytes, points);
    case MessageKind::transforms:
      return check_transforms(bytes);
    default:
      return check_scene(bytes);
  }
}

/// What a walk through the data section has found, to be held against the summary.
class Verification {
 public:
  /// `first_ticks`: by hand, that the session, or the part of it, begins with.
  Verification(double period, std::map<Side, std::uint64_t> first_ticks)
      : period_(period), next_tick_(std::move(first_ticks)) {}
  Status run(const std::string& path);
  /// Of either hand.
  [[nodiscard]] std::vector<TickRange> missing() const { return united(missing_); }

 private:
  Status walk(std::uint64_t data_start, std::uint64_t& data_end);
  Status check_record(const RecordPlace& place);
  Status check_schema(Bytes bytes, std::uint64_t at);
  Status check_channel(Bytes bytes, std::uint64_t at);
  Status check_message(Bytes bytes, std::uint64_t at, std::uint64_t& time, std::uint16_t& channel);
  Status check_tick(const Message& message, std::optional<Side> side, std::uint64_t at);
  Status check_view(const Message& message, MessageKind kind, std::uint64_t at);
  Status check_chunk(const RecordPlace& place);
  Status check_message_index(const RecordPlace& place);
  Status check_attachment(const RecordPlace& place);
  Status check_metadata(const RecordPlace& place);
  Status check_summary(std::uint64_t data_end);
  void miss_ends();
  void count_message(std::uint16_t channel, std::uint64_t time);

  InputFile file_;
  double period_;                            // [ns]
  std::map<Side, std::uint64_t> next_tick_;  // that is due
  std::vector<TickRange> missing_;
  std::vector<std::uint8_t> content_;
  LoadedChunk chunk_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_messages_;

  std::map<std::uint16_t, std::string> schemas_;     // id, name
  std::map<std::uint16_t, std::uint16_t> channels_;  // id, schema
  ChannelIds ours_;                                  // of those
  std::vector<ChunkIndex> chunks_;
  std::vector<AttachmentIndex> attachments_;
  std::vector<MetadataIndex> metadata_;
  Statistics statistics_;
};

void Verification::count_message(std::uint16_t channel, std::uint64_t time) {
  const bool first = statistics_.message_count++ == 0;
  if (first || time < statistics_.start_time) statistics_.start_time = time;
  if (first || time > statistics_.end_time) statistics_.end_time = time;
  ++statistics_.channel_message_counts[channel];
}

Status Verification::check_schema(Bytes bytes, std::uint64_t at) {
  Schema schema;
  if (!parse(bytes, schema) || schema.id == 0) return file_.broken(at, "a schema record is damaged");
  schemas_[schema.id] = schema.name;
  ours_.add_schema(schema.id, schema.name, schema.encoding);
  return {};
}

Status Verification::check_channel(Bytes bytes, std::uint64_t at) {
  Channel channel;
  if (!parse(bytes, channel)) return file_.broken(at, "a channel record is damaged");
  if (channel.schema_id != 0 && !schemas_.contains(channel.schema_id))
    return file_.broken(at, "a channel names a schema that has not been given");
  channels_[channel.id] = channel.schema_id;
  ours_.add_channel(channel);
  return {};
}

Status Verification::check_tick(const Message& message, std::optional<Side> side, std::uint64_t at) {
  TickRecord record;
  InputCheck check;
  if (Status status = decode_tick(message.data, record, check); !status.ok())
    return file_.broken(at, status.message());
  std::optional<State> after;
  if (Status status = decode_state_after(message.data, after); !status.ok())
    return file_.broken(at, status.message());
  const std::uint64_t tick = record.output.tick;
  // A lone hand's channel needs no side in its topic.
  const auto next = next_tick_.size() > 1 && side ? next_tick_.find(*side) : next_tick_.begin();
  if (next == next_tick_.end() || (next_tick_.size() > 1 && !side))
    return file_.broken(at, "a tick is of a hand that the session does not have");
  const std::string whose = next_tick_.size() > 1 ? std::string(side_name(*side)) + " hand, " : std::string();
  const std::string name = whose + "tick " + std::to_string(tick);
  if (const std::optional<Divergence> altered = find_altered_input(record, check))
    return file_.broken(at, name + ": its input was changed after it was recorded: " + altered->field +
                                " was " + altered->recorded + " and is " + altered->replayed);
  if (const char* const changed = changed_result(record))
    return file_.broken(
        at, name + ": " + changed + " changed after it was recorded: it is not what its hash says");
  if (tick < next->second)
    return file_.broken(
        at, name + " stands where tick " + std::to_string(next->second) + " or a later one is due");
  if (tick > next->second) missing_.push_back({next->second, tick - 1});
  next->second = tick + 1;
  if (message.log_time != tick_time(tick, period_) || message.publish_time != message.log_time)
    return file_.broken(at, name + " is logged at " + std::to_string(message.log_time) +
                                " ns, which is not its time at the session's rate");
  if (message.sequence != static_cast<std::uint32_t>(tick))
    return file_.broken(at, name + " has the sequence number " + std::to_string(message.sequence));
  return {};
}

Status Verification::check_view(const Message& message, MessageKind kind, std::uint64_t at) {
  if (const Status status = check_view_bytes(message.data, kind); !status.ok())
    return file_.broken(at, status.message());
  const std::uint64_t tick = tick_at(message.log_time, 1e9 / period_);
  if (message.log_time != tick_time(tick, period_))
    return file_.broken(at, "what others draw stands at a time that is no tick's");
  return {};
}

Status Verification::check_message(Bytes bytes, std::uint64_t at, std::uint64_t& time,
                                   std::uint16_t& channel) {
  Message message;
  if (!parse(bytes, message)) return file_.broken(at, "a message is shorter than it declares");
  const auto found = channels_.find(message.channel_id);
  if (found == channels_.end()) return file_.broken(at, "a message names a channel that has not been given");
  time = message.log_time;
  channel = message.channel_id;
  count_message(channel, time);
  const RecordingChannel* const ours = ours_.find(message.channel_id);
  if (ours == nullptr) return {};
  return ours->kind == MessageKind::tick ? check_tick(message, ours->side, at)
                                         : check_view(message, ours->kind, at);
}

Status Verification::check_chunk(const RecordPlace& place) {
  if (Status status = load_chunk(file_, place, content_, chunk_); !status.ok()) return status;
  chunk_messages_.clear();
  std::uint64_t first = 0, last = 0, count = 0;
  for (std::size_t offset = 0; offset < chunk_.records.size();) {
    InnerRecord inner;
    if (!find_inner_record(chunk_.records, offset, inner))
      return file_.broken(place.offset, "the chunk ends in the middle of a record");
    Status status;
    if (inner.opcode == Opcode::message) {
      std::uint64_t time = 0;
      std::uint16_t channel = 0;
      status = check_message(inner.content, place.offset, time, channel);
      first = count == 0 || time < first ? time : first;
      last = count == 0 || time > last ? time : last;
      ++count;
      chunk_messages_[channel].emplace_back(time, offset);
    } else if (inner.opcode == Opcode::schema) {
      status = check_schema(inner.content, place.offset);
    } else if (inner.opcode == Opcode::channel) {
      status = check_channel(inner.content, place.offset);
    } else {
      status = file_.broken(place.offset, "the chunk holds a record that does not belong in chunks");
    }
    if (!status.ok()) return status;
    offset = inner.end;
  }
  const Chunk& header = chunk_.header;
  if (header.start_time != first || header.end_time != last)
    return file_.broken(place.offset, "the chunk's times are not those of its messages");
  chunks_.push_back({first,
                     last,
                     place.offset,
                     place.end() - place.offset,
                     {},
                     0,
                     header.compression,
                     chunk_.compressed_size,
                     header.uncompressed_size});
  return {};
}

Status Verification::check_message_index(const RecordPlace& place) {
  MessageIndex index;
  if (!parse(content_, index) || chunks_.empty())
    return file_.broken(place.offset, "a message index is damaged");
  const auto messages = chunk_messages_.find(index.channel_id);
  const bool known = messages != chunk_messages_.end();
  if (known ? index.entries != messages->second : !index.entries.empty())
    return file_.broken(place.offset, "a message index does not fit the chunk before it");
  chunks_.back().message_index_offsets[index.channel_id] = place.offset;
  chunks_.back().message_index_length += place.end() - place.offset;
  return {};
}

Status Verification::check_attachment(const RecordPlace& place) {
  Attachment attachment;
  if (Status status = load_attachment(file_, place, content_, attachment); !status.ok()) return status;
  attachments_.push_back({place.offset, place.end() - place.offset, attachment.log_time,
                          attachment.create_time, attachment.data.size(), attachment.name,
                          attachment.media_type});
  return {};
}

Status Verification::check_metadata(const RecordPlace& place) {
  Metadata metadata;
  if (!parse(content_, metadata))
    return file_.broken(place.offset, "the metadata is shorter than it declares");
  metadata_.push_back({place.offset, place.end() - place.offset, metadata.name});
  return {};
}

// `content_` holds the record's content.
Status Verification::check_record(const RecordPlace& place) {
  switch (place.opcode) {
    case Opcode::schema:
      return check_schema(content_, place.offset);
    case Opcode::channel:
      return check_channel(content_, place.offset);
    case Opcode::chunk:
      return check_chunk(place);
    case Opcode::message_index:
      return check_message_index(place);
    case Opcode::attachment:
      return check_attachment(place);
    case Opcode::metadata:
      return check_metadata(place);
    case Opcode::message: {
      std::uint64_t time = 0;
      std::uint16_t channel = 0;
      return check_message(content_, place.offset, time, channel);
    }
    default:
      break;
  }
  if (place.opcode >= Opcode::first_private) return {};
  return file_.broken(place.offset, "there is a record here that does not belong here");
}

Status Verification::walk(std::uint64_t data_start, std::uint64_t& data_end) {
  std::vector<std::uint8_t> header;
  if (Status status = file_.read(0, data_start, header); !status.ok()) return status;
  std::uint32_t crc = crc32(0, header);
  for (std::uint64_t offset = data_start;;) {
    RecordPlace place;
    bool whole = false;
    if (Status status = find_record(file_, offset, file_.size(), place, whole); !status.ok()) return status;
    if (!whole) return file_.broken(offset, "the file is torn here; recover keeps what stands before");
    if (Status status = read_content(file_, place, content_); !status.ok()) return status;
    if (place.opcode == Opcode::data_end) {
      mcap::DataEnd end;
      if (!parse(content_, end)) return file_.broken(offset, "the end of the data is damaged");
      if (end.data_section_crc != 0 && end.data_section_crc != crc)
        return file_.broken(offset, "the checksum of the data (bytes 0 to " + std::to_string(offset - 1) +
                                        ") is wrong; recover keeps what is whole");
      data_end = place.end();
      return {};
    }
    if (Status status = file_.read(offset, kRecordHeaderSize, header); !status.ok()) return status;
    crc = crc32(crc32(crc, header), content_);
    if (Status status = check_record(place); !status.ok()) return status;
    offset = place.end();
  }
}

Status Verification::check_summary(std::uint64_t data_end) {
  Summary summary;
  bool present = false;
  if (Status status = read_summary(file_, summary, present); !status.ok()) return status;
  if (!present || summary.start != data_end)
    return file_.broken(data_end, "the index does not follow the data; recover rebuilds it");
  const auto wrong = [&](const char* what) {
    return file_.broken(summary.start,
                        std::string("the summary's ") + what + " does not fit the data; recover rebuilds it");
  };
  if (summary.chunks != chunks_) return wrong("chunk index");
  if (summary.attachments != attachments_) return wrong("attachment index");
  if (summary.metadata != metadata_) return wrong("metadata index");
  for (const Summary::SchemaName& schema : summary.schemas)
    if (!schemas_.contains(schema.id) || schemas_.at(schema.id) != schema.name) return wrong("schema");
  for (const Channel& channel : summary.channels)
    if (!channels_.contains(channel.id) || channels_.at(channel.id) != channel.schema_id)
      return wrong("channel");
  if (summary.schemas.size() != schemas_.size() || summary.channels.size() != channels_.size())
    return wrong("list of schemas and channels");

  statistics_.schema_count = static_cast<std::uint16_t>(schemas_.size());
  statistics_.channel_count = static_cast<std::uint32_t>(channels_.size());
  statistics_.attachment_count = static_cast<std::uint32_t>(attachments_.size());
  statistics_.metadata_count = static_cast<std::uint32_t>(metadata_.size());
  statistics_.chunk_count = static_cast<std::uint32_t>(chunks_.size());
  if (summary.statistics && *summary.statistics != statistics_) return wrong("statistics record");

  if (summary.offset_start == 0) return {};
  std::vector<SummaryOffset>& groups = summary.groups;
  const bool last_is_offsets = !groups.empty() && groups.back().group == Opcode::summary_offset;
  if (last_is_offsets && groups.back().start != summary.offset_start) return wrong("offset section");
  if (last_is_offsets) groups.pop_back();
  return groups == summary.summary_offsets ? Status{} : wrong("offset section");
}

// What one hand has behind the last tick of the other.
void Verification::miss_ends() {
  std::uint64_t end = 0;
  for (const auto& [side, next] : next_tick_) end = std::max(end, next);
  for (const auto& [side, next] : next_tick_)
    if (next < end) missing_.push_back({next, end - 1});
}

Status Verification::run(const std::string& path) {
  if (Status status = file_.open(path); !status.ok()) return status;
  Header header;
  std::uint64_t data_start = 0, data_end = 0;
  if (Status status = read_start(file_, header, data_start); !status.ok()) return status;
  if (Status status = walk(data_start, data_end); !status.ok()) return status;
  miss_ends();
  return check_summary(data_end);
}

}  // namespace

Status verify_recording(const std::string& path, RecordingInfo& info, std::vector<TickRange>* missing) try {
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  info = reader.info();
  if (info.growing) return Status::error(path + ": is still being recorded; verify it when that has ended");
  std::map<Side, std::uint64_t> first_ticks = {{reader.scene().hand.side, reader.initial_state().tick}};
  if (const std::optional<Hand>& other = reader.other_hand())
    first_ticks[other->side] = reader.other_initial_state().tick;
  Verification verification(1e9 / reader.scene().settings.rate, std::move(first_ticks));
  const std::string file = info.path;
  reader = {};  // a scene may be as large as the file
  const Status status = verification.run(file);
  if (missing != nullptr) *missing = verification.missing();
  return status;
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to verify the recording");
}

}  // namespace lumbrical
