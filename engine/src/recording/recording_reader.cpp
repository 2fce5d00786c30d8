// Reading a recording: find its session and chunks, then hand out one tick after the other.
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "lumbrical/recording.h"
#include "lumbrical/world.h"
#include "recording/channels.h"
#include "recording/mcap_reader.h"
#include "recording/record_fields.h"
#include "recording/recorder.h"
#include "recording/session_message.h"
#include "recording/state_message.h"
#include "recording/tick_message.h"

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
  std::uint64_t data_end = 0;      // where walking stops at the latest
  std::vector<ChunkIndex> chunks;  // of a complete file; every chunk met must be the next of these
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
  Status take_session(Bytes bytes, std::uint64_t at);
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
  Status take_message(Bytes bytes, std::uint64_t at, TickRecord& record, bool& found);
  bool take_schema(Bytes bytes);
  bool take_channel(Bytes bytes);
};

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
  message = {channel->kind, static_cast<std::uint8_t>(*whose), 0, parsed.data};
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

RecordingReader::RecordingReader() = default;
RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;

Status RecordingReader::open(const std::string& path, std::optional<Side> side) try {
  auto file = std::make_unique<File>();
  file->asked = side;
  if (Status status = file->open(path); !status.ok()) return status;
  file_ = std::move(file);
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to read the recording");
}

const RecordingInfo& RecordingReader::info() const {
  static const RecordingInfo kNothing;
  return file_ ? file_->info : kNothing;
}

Status RecordingReader::find_world(const std::string& path) {
  if (!file_ || !file_->scene.world || file_->scene.world->bytes) return {};
  const World& named = *file_->scene.world;
  std::string chosen = path;
  if (chosen.empty()) {
    // A recording is somebody else's: it names no file but one beside it, and no link leads elsewhere.
    namespace fs = std::filesystem;
    chosen = (fs::path(info().path).parent_path() / named.path).string();
    std::error_code ignored;
    const fs::file_type type = fs::symlink_status(chosen, ignored).type();
    if (type != fs::file_type::regular)
      return Status::error(
          info().path + ": was recorded with the world file " + named.path + ", which is " +
          (type == fs::file_type::not_found ? "not beside it" : "no regular file beside it") +
          "; name it with --world FILE, or put it beside the recording");
  }
  std::shared_ptr<const World> world;
  if (Status status = open_world(chosen, world); !status.ok()) return status;
  if (world->content != named.content)
    return Status::error(info().path + ": was recorded with another world than is in " + chosen +
                         "; name the right one with --world FILE, or put it beside the recording");
  auto found = std::make_shared<World>(*world);
  found->path = named.path;  // as recorded, so that copies of the session are the same
  file_->scene.world = std::move(found);
  return {};
}

const Scene& RecordingReader::scene() const {
  static const Scene kNothing;
  return file_ ? file_->scene : kNothing;
}

const State& RecordingReader::initial_state() const {
  static const State kNothing;
  return file_ ? file_->initial_state[file_->hand] : kNothing;
}

State RecordingReader::initial_state(const Model& model) const {
  State state = initial_state();
  if (state.objects.size() != model.apart.size()) state.objects = make_state(model).objects;
  return state;
}

const std::optional<Hand>& RecordingReader::other_hand() const {
  static const std::optional<Hand> kNothing;
  return file_ ? file_->other_hand : kNothing;
}

const State& RecordingReader::other_initial_state() const {
  static const State kNothing;
  return file_ ? file_->initial_state[1 - file_->hand] : kNothing;
}

Status RecordingReader::next(TickRecord& record, bool& end) try {
  end = true;
  if (!file_) return Status::error("no recording is open; call open() first");
  return file_->next(record, end);
} catch (const std::bad_alloc&) {
  return Status::error("not enough memory to read the recording");
}

Status RecordingReader::next_message(RecordedMessage& message, bool& end) {
  TickRecord none;
  if (file_) file_->all_messages = true;
  const Status status = next(file_ ? file_->passed_on : none, end);
  if (!file_) return status;
  file_->all_messages = false;
  message = file_->message;
  return status;
}

std::optional<Divergence> RecordingReader::altered_input() const {
  return file_ ? file_->altered : std::nullopt;
}

Status RecordingReader::seek(std::uint64_t tick) {
  if (!file_) return Status::error("no recording is open; call open() first");
  const std::uint64_t time = tick_time(tick, 1e9 / file_->scene.settings.rate);
  const std::vector<ChunkIndex>& chunks = file_->chunks;
  const auto chunk = std::partition_point(chunks.begin(), chunks.end(),
                                          [time](const ChunkIndex& c) { return c.end_time < time; });
  const bool from_start = tick == 0 || chunk == chunks.begin();
  if (from_start)
    file_->rewind();
  else if (chunk != chunks.end())
    file_->go_to_chunk(static_cast<std::size_t>(chunk - chunks.begin()));
  else
    file_->go_to_chunk(chunks.size() - 1);
  file_->skip_below = tick;
  return {};
}

Status open_hands(const std::string& path, std::vector<RecordingReader>& readers, std::optional<Side> side) {
  std::vector<RecordingReader> opened(1);
  if (Status status = opened[0].open(path, side); !status.ok()) return status;
  if (const std::optional<Hand> other = opened[0].other_hand(); other && !side)
    if (Status status = opened.emplace_back().open(path, other->side); !status.ok()) return status;
  readers = std::move(opened);
  return {};
}

}  // namespace lumbrical
