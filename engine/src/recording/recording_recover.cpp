// Recovery of a torn or damaged recording: whatever the rest of the file looks like, a chunk whose own
// checksum is right is whole, so chunks (and the session) are looked for byte by byte and written to a new
// file.
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/check_stop.h"
#include "lumbrical/recording.h"
#include "recording/channels.h"
#include "recording/mcap_reader.h"
#include "recording/recorder.h"
#include "recording/session_message.h"
#include "recording/state_message.h"
#include "recording/tick_message.h"
#include "recording/tick_ranges.h"

namespace lumbrical {

using namespace mcap;

namespace {

// A record head long enough to be told from chance: opcode, length, and the fields in front of the payload.
constexpr std::uint64_t kHeadSize = 256;

/// Whether the bytes at the start of `head` begin a record that fits itself and the `room` left in the file.
/// With all its lengths in agreement it is not chance.
bool begins_record(Bytes head, std::uint64_t room, RecordPlace& place) {
  ByteReader in(head);
  place.opcode = static_cast<Opcode>(in.u8());
  if (place.opcode != Opcode::chunk && place.opcode != Opcode::attachment &&
      place.opcode != Opcode::metadata && place.opcode != Opcode::channel)
    return false;
  place.length = in.u64();
  if (!in.ok() || room < kRecordHeaderSize || place.length > room - kRecordHeaderSize) return false;
  ByteReader fields(head.subspan(in.position()));
  std::uint64_t payload = 0, behind = 0;
  if (place.opcode == Opcode::chunk) {
    const std::uint64_t start_time = fields.u64();
    if (fields.u64() < start_time) return false;
    fields.take(sizeof(std::uint64_t) + sizeof(std::uint32_t));  // uncompressed size, checksum
    if (!is_known_compression(fields.text())) return false;
    payload = fields.u64();
  } else if (place.opcode == Opcode::attachment) {
    fields.take(2 * sizeof(std::uint64_t));  // times
    const std::string name = fields.text();
    const bool state =
        std::find(kStateAttachments.begin(), kStateAttachments.end(), name) != kStateAttachments.end();
    if (name != kSessionAttachment && !state) return false;
    fields.text();  // media type
    payload = fields.u64();
    behind = sizeof(std::uint32_t);  // checksum
  } else if (place.opcode == Opcode::channel) {
    fields.take(2 * sizeof(std::uint16_t));  // ids
    const std::string topic = fields.text();
    if (fields.text() != "flatbuffer" || !channel_of_topic(topic)) return false;
    payload = fields.u32();
  } else {
    if (fields.text() != kMetadataName) return false;
    payload = fields.u32();
  }
  return fields.ok() && payload <= place.length && fields.position() + payload + behind == place.length;
}

/// The first record worth keeping that seems to begin at `offset` or later.
Status find_next(const InputFile& file, std::uint64_t offset, const std::function<bool()>& stop,
                 RecordPlace& place, bool& found) {
  std::uint64_t step = 64;  // most often the next record begins right here
  std::vector<std::uint8_t> block;
  found = false;
  while (offset < file.size()) {
    const std::uint64_t size = std::min(step + kHeadSize, file.size() - offset);
    if (Status status = check_stop(stop); !status.ok()) return status;
    if (Status status = file.read(offset, size, block); !status.ok()) return status;
    for (std::uint64_t i = 0; i < std::min(step, size); ++i) {
      const std::uint64_t head = std::min(kHeadSize, size - i);
      if (!begins_record(Bytes(block).subspan(i, head), file.size() - offset - i, place)) continue;
      place.offset = offset + i;
      found = true;
      return {};
    }
    offset += step;
    step = std::min<std::uint64_t>(4 * step, 1u << 16);
  }
  return {};
}

/// What is known of one hand's ticks.
struct KnownTicks {
  std::uint64_t begin = 0;  // that the session, or the part of it, begins with
  std::uint64_t recovered = 0;
  std::uint64_t first = 0, last = 0;                     // ticks kept
  std::optional<std::uint64_t> first_known, last_known;  // ticks there once were, kept or not
  std::vector<TickRange> gaps;                           // between ticks kept
};

/// Tick numbers there once were, or that lie between such, and are not kept.
std::vector<TickRange> missing_of(const KnownTicks& ticks) {
  std::vector<TickRange> ranges;
  const auto& [begin, recovered, first, last, first_known, last_known, gaps] = ticks;
  if (recovered == 0) {
    if (last_known) ranges.push_back({*first_known, *last_known});
    return ranges;
  }
  if (first_known && *first_known < first) ranges.push_back({*first_known, first - 1});
  ranges.insert(ranges.end(), gaps.begin(), gaps.end());
  if (last_known && *last_known > last) ranges.push_back({last + 1, *last_known});
  return ranges;
}

class Recovery {
 public:
  explicit Recovery(const std::function<bool()>& stop) : stop_(stop) {}
  Status open(const std::string& path) { return file_.open(path); }
  /// Looks for session, metadata and compression; an error where there is no whole session.
  Status find_session();
  /// Copies the ticks of all whole chunks.
  Status copy_ticks(const std::string& output);
  /// Of both hands together, where there are two.
  [[nodiscard]] std::uint64_t recovered() const;
  /// Of either hand.
  [[nodiscard]] std::vector<TickRange> missing() const;

 private:
  Status copy_chunk(McapWriter& writer);
  Status copy_message(Bytes bytes, McapWriter& writer);
  bool may_doubt(std::uint64_t size);
  std::uint64_t behind(const RecordPlace& place, bool whole);
  [[nodiscard]] bool are_ticks(std::uint64_t start_time, std::uint64_t end_time) const;
  void expect(std::uint64_t start_time, std::uint64_t end_time);
  bool take_index();
  void expect_damaged(const RecordPlace& place);
  bool load(const RecordPlace& place);
  bool take(const RecordPlace& place);
  void take_attachment(const Attachment& attachment);
  void take_channel(const Channel& channel);
  [[nodiscard]] std::optional<RecordingChannel> channel_of(std::uint16_t id) const;
  [[nodiscard]] std::size_t hand_of(const RecordingChannel& channel) const;

  const std::function<bool()>& stop_;
  InputFile file_;
  Scene scene_;
  std::vector<Side> sides_;  // of the session's hands
  ChannelIds indexed_;       // as the index has them, under its checksum
  std::map<std::uint16_t, std::optional<RecordingChannel>> named_;  // by records without one; none: in doubt
  std::vector<RecordingChannel> channels_;                          // that are written
  std::vector<std::uint8_t> session_;
  StateMessages states_;
  std::map<std::string, std::string> metadata_;
  std::optional<Compression> compression_;
  std::vector<std::uint8_t> content_;
  LoadedChunk chunk_;
  Attachment attachment_;
  std::uint64_t doubted_ = 0;  // [bytes] that were read of what proved not to be whole

  std::array<KnownTicks, kMostHands> ticks_;  // by hand
  std::uint64_t newest_ = 0;                  // tick kept
};

void Recovery::take_attachment(const Attachment& attachment) {
  const Bytes data = attachment.data;
  State state;
  for (std::size_t hand = 0; hand < kStateAttachments.size(); ++hand) {
    if (attachment.name != kStateAttachments[hand] || !decode_state(data, state).ok()) continue;
    states_[hand].assign(data.begin(), data.end());
    ticks_[hand].begin = state.tick;
  }
  std::optional<Hand> second;
  if (attachment.name != kSessionAttachment || !session_.empty() ||
      !decode_session(data, scene_, &second).ok())
    return;
  session_.assign(data.begin(), data.end());
  sides_ = {scene_.hand.side};
  if (second) sides_.push_back(second->side);
}

// Of two records for one number either may be the damaged one.
void Recovery::take_channel(const Channel& channel) {
  const auto ours = channel_of_topic(channel.topic);
  const auto [named, is_first] = named_.emplace(channel.id, ours);
  if (!is_first && named->second != ours) named->second.reset();
}

// Where no record can be trusted it is what the recorder gives its number, or all a lone hand has. What is no
// tick does not decode as one.
std::optional<RecordingChannel> Recovery::channel_of(std::uint16_t id) const {
  if (const RecordingChannel* const indexed = indexed_.find(id)) return *indexed;
  const auto named = named_.find(id);
  if (named != named_.end() && named->second) return named->second;
  const std::vector<RecordingChannel> ticks = channels_of(sides_);
  if (ticks.size() == 1) return ticks[0];
  return id >= 1 && id <= ticks.size() ? std::optional(ticks[id - 1u]) : std::nullopt;
}

std::size_t Recovery::hand_of(const RecordingChannel& channel) const {
  return sides_.size() > 1 && channel.side == sides_[1] ? 1 : 0;
}

/// Whether a checksum says that the record is whole, which is then in `chunk_` or `attachment_`.
bool Recovery::load(const RecordPlace& place) {
  chunk_.header = {};
  if (place.opcode == Opcode::chunk) return load_chunk(file_, place, content_, chunk_).ok();
  return place.opcode == Opcode::attachment && load_attachment(file_, place, content_, attachment_).ok();
}

/// Takes what the copy depends on but its ticks, and tells whether the record is known to be whole.
bool Recovery::take(const RecordPlace& place) {
  const auto read = [&](auto& record) {
    return read_content(file_, place, content_).ok() && parse(content_, record);
  };
  Channel channel;
  Metadata metadata;
  Chunk chunk;
  if (place.opcode == Opcode::channel && read(channel)) take_channel(channel);
  if (place.opcode == Opcode::metadata && read(metadata)) metadata_ = std::move(metadata.metadata);
  if (place.opcode == Opcode::chunk && !compression_ && read(chunk))
    compression_ = compression_named(chunk.compression);
  if (place.opcode != Opcode::attachment || !load(place)) return false;
  take_attachment(attachment_);
  return true;
}

Status Recovery::find_session() {
  bool found = true;
  for (std::uint64_t offset = 0; found && (session_.empty() || !compression_);) {
    RecordPlace place;
    if (Status status = find_next(file_, offset, stop_, place, found); !status.ok()) return status;
    if (found) offset = behind(place, take(place));
  }
  if (!session_.empty()) return {};
  return file_.broken(
      0,
      "the file holds no whole session (hand, world, settings); without it the ticks can't be "
      "used, so nothing is recovered");
}

// Records can be put into each other without end: what proves not to be whole may cost as much as reading the
// file once.
bool Recovery::may_doubt(std::uint64_t size) { return (doubted_ += size) <= file_.size(); }

/// Where to look for the next record. The length of one that is not whole may reach over others.
std::uint64_t Recovery::behind(const RecordPlace& place, bool whole) {
  return whole || !may_doubt(place.length) ? place.end() : place.offset + 1;
}

// Times that are damaged themselves must not make up ticks: those of ticks are few among all numbers, and a
// chunk covers a quarter of a second.
bool Recovery::are_ticks(std::uint64_t start_time, std::uint64_t end_time) const {
  constexpr std::uint64_t kMostCovered = 1'000'000'000, kLatest = std::uint64_t{1} << 62;  // [ns]
  if (end_time < start_time || end_time - start_time > kMostCovered || end_time > kLatest) return false;
  const double period = 1e9 / scene_.settings.rate;
  return tick_time(tick_at(start_time, scene_.settings.rate), period) == start_time &&
         tick_time(tick_at(end_time, scene_.settings.rate), period) == end_time;
}

void Recovery::expect(std::uint64_t start_time, std::uint64_t end_time) {
  const std::uint64_t first = tick_at(start_time, scene_.settings.rate),
                      last = tick_at(end_time, scene_.settings.rate);
  for (KnownTicks& ticks : ticks_) {
    ticks.first_known = std::min(ticks.first_known.value_or(first), first);
    ticks.last_known = std::max(ticks.last_known.value_or(last), last);
  }
}

/// Channels, and what the index says there was, where it is whole; it has a checksum.
bool Recovery::take_index() {
  Summary summary;
  bool present = false;
  if (!read_summary(file_, summary, present).ok() || !present) return false;
  for (const auto& [id, name, encoding] : summary.schemas) indexed_.add_schema(id, name, encoding);
  for (const Channel& channel : summary.channels) indexed_.add_channel(channel);
  for (const ChunkIndex& chunk : summary.chunks)
    if (are_ticks(chunk.start_time, chunk.end_time)) expect(chunk.start_time, chunk.end_time);
  return true;
}

/// What there was in a damaged chunk: by the message index behind it, or by its own head.
void Recovery::expect_damaged(const RecordPlace& place) {
  RecordPlace behind;
  bool whole = false;
  MessageIndex index;
  if (find_record(file_, place.end(), file_.size(), behind, whole).ok() && whole &&
      behind.opcode == Opcode::message_index && may_doubt(behind.length) &&
      read_content(file_, behind, content_).ok() && parse(content_, index) && !index.entries.empty() &&
      are_ticks(index.entries.front().first, index.entries.back().first))
    return expect(index.entries.front().first, index.entries.back().first);
  if (are_ticks(chunk_.header.start_time, chunk_.header.end_time))
    expect(chunk_.header.start_time, chunk_.header.end_time);
}

Status Recovery::copy_message(Bytes bytes, McapWriter& writer) {
  Message message;
  TickRecord record;
  InputCheck check;
  if (!parse(bytes, message)) return {};
  const std::optional<RecordingChannel> channel = channel_of(message.channel_id);
  if (!channel || (sides_.size() > 1 && !channel->side)) return {};
  const bool is_tick = channel->kind == MessageKind::tick;
  if (is_tick && !decode_tick(message.data, record, check).ok()) return {};
  const std::size_t hand = hand_of(*channel);
  KnownTicks& ticks = ticks_[hand];
  const std::uint64_t tick = is_tick ? record.output.tick : tick_at(message.log_time, scene_.settings.rate);
  if (tick < newest_ || (is_tick && ticks.recovered > 0 && tick <= ticks.last)) return {};
  const std::size_t number = channel_number(channels_, sides_, channel->kind, hand);
  if (number == channels_.size()) return {};
  if (is_tick) {
    if (ticks.recovered > 0 && tick > ticks.last + 1) ticks.gaps.push_back({ticks.last + 1, tick - 1});
    if (ticks.recovered++ == 0) ticks.first = tick;
    ticks.last = tick;
  }
  newest_ = tick;
  // The message is copied as it is: its input check must go on telling what happened to it.
  return writer.message(tick_time(tick, 1e9 / scene_.settings.rate), static_cast<std::uint32_t>(tick),
                        message.data, number);
}

Status Recovery::copy_chunk(McapWriter& writer) {
  for (std::size_t offset = 0; offset < chunk_.records.size();) {
    InnerRecord inner;
    if (!find_inner_record(chunk_.records, offset, inner)) break;
    offset = inner.end;
    if (inner.opcode != Opcode::message) continue;
    if (Status status = copy_message(inner.content, writer); !status.ok()) return status;
  }
  return {};
}

Status Recovery::copy_ticks(const std::string& output) {
  McapWriter writer;
  McapWriterOptions options;
  options.compression = compression_.value_or(Compression::lz4);
  const bool has_index = take_index();
  const auto holds = [this](MessageKind kind) {
    return indexed_.has(kind) || std::any_of(named_.begin(), named_.end(), [kind](const auto& named) {
             return named.second && named.second->kind == kind;
           });
  };
  channels_ = channels_of(sides_, views_that(holds));
  Status status =
      open_recording(output, scene_.settings.rate, session_, states_, metadata_, options, writer, channels_);
  bool found = true;
  doubted_ = 0;
  for (std::uint64_t offset = 0; status.ok() && found;) {
    RecordPlace place;
    status = find_next(file_, offset, stop_, place, found);
    if (!status.ok() || !found) break;
    const bool whole = load(place);
    offset = behind(place, whole);
    if (place.opcode != Opcode::chunk) continue;
    if (whole) status = copy_chunk(writer);
    if (!whole && !has_index) expect_damaged(place);
  }
  if (status.ok()) status = writer.close();
  if (!status.ok()) {
    writer.discard();
    return status;
  }

  // Without an index the first chunks may be missing without a trace, but not what the session began with.
  for (KnownTicks& ticks : ticks_)
    if (!has_index && ticks.recovered > 0) ticks.first_known = ticks.begin;
  return {};
}

std::uint64_t Recovery::recovered() const {
  std::uint64_t recovered = 0;
  for (const KnownTicks& ticks : ticks_) recovered += ticks.recovered;
  return recovered;
}

std::vector<TickRange> Recovery::missing() const {
  std::vector<TickRange> ranges;
  for (std::size_t hand = 0; hand < sides_.size(); ++hand) {
    const std::vector<TickRange> of_hand = missing_of(ticks_[hand]);
    ranges.insert(ranges.end(), of_hand.begin(), of_hand.end());
  }
  return united(std::move(ranges));
}

}  // namespace

Status recover_recording(const std::string& path, const std::string& output, std::uint64_t& recovered,
                         std::uint64_t& lost, std::vector<TickRange>* missing,
                         const std::function<bool()>& stop) try {
  Recovery recovery(stop);
  if (Status status = recovery.open(path); !status.ok()) return status;
  if (Status status = recovery.find_session(); !status.ok()) return status;
  if (Status status = recovery.copy_ticks(output); !status.ok()) return status;
  recovered = recovery.recovered();
  lost = 0;
  const std::vector<TickRange> ranges = recovery.missing();
  for (const TickRange& range : ranges) lost += range.last - range.first + 1;
  if (missing != nullptr) *missing = ranges;
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to recover the recording");
}

}  // namespace lumbrical
