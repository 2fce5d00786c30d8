// Opening a recording: its session, its metadata, its first and last ticks, by the index or by reading all of
// it.
#include <algorithm>
#include <string_view>
#include <utility>

#include "recording/reader_file.h"
#include "recording/recorder.h"
#include "recording/session_message.h"
#include "recording/state_message.h"

namespace lumbrical {

using namespace mcap;

namespace {

/// The hand's attachment, or none's.
std::optional<std::size_t> hand_of_state(std::string_view name) {
  const auto found = std::find(kStateAttachments.begin(), kStateAttachments.end(), name);
  if (found == kStateAttachments.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kStateAttachments.begin());
}

}  // namespace

Status RecordingReader::File::take_attachment(const RecordPlace& place) {
  Attachment attachment;
  if (Status status = load_attachment(file, place, content, attachment); !status.ok()) return status;
  if (const auto whose = hand_of_state(attachment.name)) {
    const Status status = decode_state(attachment.data, initial_state[*whose]);
    return status.ok() ? status : file.broken(place.offset, status.message());
  }
  if (attachment.name != kSessionAttachment || has_scene) return {};
  if (Status status = take_session(attachment.data, place.offset); !status.ok()) return status;
  std::vector<std::uint8_t>().swap(content);  // it may be large, and the chunks to come are small
  return {};
}

Status RecordingReader::File::take_session(Bytes bytes, std::uint64_t at) {
  if (Status status = decode_session(bytes, scene, &other_hand); !status.ok())
    return file.broken(at, status.message());
  has_scene = true;
  info.version = kVersion;
  info.hands = {scene.hand.side};
  if (other_hand) info.hands.push_back(other_hand->side);
  if (!asked || *asked == scene.hand.side) return {};
  if (!other_hand)
    return Status::error(file.path() + ": holds no " + std::string(side_name(*asked)) + " hand, only a " +
                         std::string(side_name(scene.hand.side)) + " one");
  std::swap(scene.hand, *other_hand);
  hand = 1;
  return {};
}

Status RecordingReader::File::take_metadata(const RecordPlace& place) {
  if (Status status = read_content(file, place, content); !status.ok()) return status;
  Metadata metadata;
  if (!parse(content, metadata)) return file.broken(place.offset, "the metadata is shorter than it declares");
  if (metadata.name == kMetadataName) info.metadata = std::move(metadata.metadata);
  return {};
}

void RecordingReader::File::count_tick(const TickRecord& record) {
  const std::uint64_t tick = record.output.tick;
  if (info.ticks++ == 0) info.first_tick = tick;
  info.last_tick = tick;
}

// The records that a complete file's summary points to.
Status RecordingReader::File::take_indexed(const Summary& summary) {
  const auto find = [&](std::uint64_t at, std::uint64_t length, Opcode opcode, RecordPlace& place) {
    bool whole = false;
    if (Status status = find_record(file, at, data_end, place, whole); !status.ok()) return status;
    if (!whole || place.opcode != opcode || place.end() - place.offset != length)
      return file.broken(at, "the summary points to a record that is not there; run recover");
    return Status{};
  };
  RecordPlace place;
  // In the order of the file, so that no record is read twice.
  std::uint64_t least = 0;
  const auto in_order = [&](std::uint64_t at) {
    if (at < least) return file.broken(at, "the summary points to a record twice; run recover");
    return Status{};
  };
  for (const AttachmentIndex& index : summary.attachments) {
    Status status = in_order(index.offset);
    if (status.ok()) status = find(index.offset, index.length, Opcode::attachment, place);
    least = place.end();
    const bool ours = index.name == kSessionAttachment || hand_of_state(index.name);
    if (status.ok() && ours) status = take_attachment(place);
    if (!status.ok()) return status;
  }
  least = 0;
  for (const MetadataIndex& index : summary.metadata) {
    Status status = in_order(index.offset);
    if (status.ok()) status = find(index.offset, index.length, Opcode::metadata, place);
    least = place.end();
    if (status.ok()) status = take_metadata(place);
    if (!status.ok()) return status;
  }
  return {};
}

// The last one that holds ticks of this hand, as far as the index tells.
std::size_t RecordingReader::File::last_chunk() const {
  for (std::size_t i = chunks.size(); i-- > 0;)
    for (const auto& index : chunks[i].message_index_offsets)
      if (is_read(index.first)) return i;
  return chunks.size() - 1;
}

// A complete file: everything is told by the summary, and the last tick stands in the last chunk.
Status RecordingReader::File::read_summary_and_ends() {
  Summary summary;
  if (Status status = read_summary(file, summary, info.complete); !status.ok()) return status;
  if (!info.complete) return {};
  data_end = summary.start;
  chunks = std::move(summary.chunks);
  for (const auto& [id, name, encoding] : summary.schemas) channels.add_schema(id, name, encoding);
  for (const Channel& channel : summary.channels) channels.add_channel(channel);
  info.chunks = chunks.size();
  if (!chunks.empty()) info.compression = chunks.front().compression;
  if (Status status = take_indexed(summary); !status.ok()) return status;

  TickRecord record;
  bool end = false;
  rewind();
  if (Status status = next(record, end); !status.ok() || end) return status;
  count_tick(record);
  std::uint64_t ticks = 0;
  if (summary.statistics)
    for (const auto& [channel, count] : summary.statistics->channel_message_counts)
      if (is_read(channel)) ticks += count;
  // Without statistics or chunks (other tools may leave them out) the ticks are counted one by one.
  if (ticks > 0 && !chunks.empty()) go_to_chunk(last_chunk());
  for (;;) {
    if (Status status = next(record, end); !status.ok()) return status;
    if (end) break;
    count_tick(record);
  }
  if (ticks > 0 && !chunks.empty()) info.ticks = ticks;
  return {};
}

// A file without a summary: everything in it is read once.
Status RecordingReader::File::scan() {
  data_end = file.size();
  rewind();
  scanning = true;
  TickRecord record;
  for (bool end = false;;) {
    if (Status status = next(record, end); !status.ok()) return status;
    if (end) break;
    count_tick(record);
  }
  scanning = false;
  info.chunks = chunk_number;
  if (chunk_number > 0) info.compression = chunk.header.compression;
  return {};
}

Status RecordingReader::File::open(const std::string& path) {
  if (Status status = file.open(path); !status.ok()) return status;
  info.path = file.path();
  info.bytes = file.size();
  info.growing = file.growing();
  Header header;
  if (Status status = read_start(file, header, data_start); !status.ok()) return status;
  info.library = std::move(header.library);
  if (Status status = read_summary_and_ends(); !status.ok()) return status;
  if (!info.complete)
    if (Status status = scan(); !status.ok()) return status;
  info.has_poses = channels.has(MessageKind::pose);
  info.has_scene = channels.has(MessageKind::scene);
  info.has_contacts = channels.has(MessageKind::contacts);
  if (!has_scene)
    return file.broken(file.size(), "the file has no session (hand, world, settings); it can't be used");
  if (info.ticks > 0) {
    const std::uint64_t span = info.last_tick - info.first_tick + 1;
    if (info.last_tick < info.first_tick || span < info.ticks)
      info.missing_ticks = 0;  // numbers out of order; verify tells where
    else
      info.missing_ticks = span - info.ticks;
    info.seconds = static_cast<double>(span) / scene.settings.rate;
  }
  rewind();
  return {};
}

}  // namespace lumbrical
