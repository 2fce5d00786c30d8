// MCAP writing. A chunk and its index leave in one piece, so that a killed process loses the open chunk at
// most.
#include "recording/mcap_writer.h"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <utility>

namespace lumbrical {

using namespace mcap;

namespace {

/// The name MCAP gives a compression.
std::string_view compression_text(Compression compression) {
  switch (compression) {
    case Compression::lz4:
      return "lz4";
    case Compression::zstd:
      return "zstd";
    case Compression::none:
      break;
  }
  return "";
}

/// `out` becomes the compressed bytes; false where the library fails.
bool compress(Compression compression, Bytes bytes, std::vector<std::uint8_t>& out) {
  if (compression == Compression::none) {
    out.assign(bytes.begin(), bytes.end());
    return true;
  }
  if (compression == Compression::lz4) {
    LZ4F_preferences_t preferences{};
    preferences.frameInfo.contentSize = bytes.size();
    out.resize(LZ4F_compressFrameBound(bytes.size(), &preferences));
    const std::size_t size =
        LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), &preferences);
    if (LZ4F_isError(size) != 0) return false;
    out.resize(size);
    return true;
  }
  out.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0) return false;
  out.resize(size);
  return true;
}

}  // namespace

Compression compression_named(std::string_view name) {
  if (name == "zstd") return Compression::zstd;
  return name == "lz4" ? Compression::lz4 : Compression::none;
}

bool is_known_compression(std::string_view name) { return name == compression_text(compression_named(name)); }

Status McapWriter::write(Bytes bytes) {
  if (Status status = file_.write(bytes); !status.ok()) return status;
  crc_ = crc32(crc_, bytes);
  return {};
}

Status McapWriter::open(const std::string& path, const McapWriterOptions& options, const Start& start) {
  options_ = options;
  append_channels(start);
  ByteWriter first;
  first.raw(kMagic);
  append(first, Header{"", std::string(start.library)});
  first.raw(once_.bytes());
  metadata_ = {first.size(), 0, std::string(start.metadata_name)};
  append(first, Metadata{metadata_.name, *start.metadata});
  metadata_.length = first.size() - metadata_.offset;
  if (metadata_.length > kRecordHeaderSize + kLargestOtherRecord)
    return Status::error(path + ": the metadata take " + std::to_string(metadata_.length) +
                         " bytes, and at most 4 MiB can be read; shorten them");

  if (Status status = file_.open(path); !status.ok()) return status;
  if (Status status = write(first.bytes()); !status.ok()) return status;
  for (const Start::Content& content : start.attachments)
    if (Status status = write_attachment(content); !status.ok()) return status;
  return {};
}

void McapWriter::append_channels(const Start& start) {
  std::vector<std::string_view> schemas;
  std::vector<std::uint16_t> schema_ids;  // from 1 on: 0 would mean "no schema"
  for (const Start::Channel& channel : start.channels) {
    const auto known = std::find(schemas.begin(), schemas.end(), channel.schema_name);
    schema_ids.push_back(static_cast<std::uint16_t>(known - schemas.begin() + 1));
    if (known != schemas.end()) continue;
    schemas.push_back(channel.schema_name);
    append(once_, Schema{schema_ids.back(), std::string(channel.schema_name), "flatbuffer", channel.schema});
  }
  schemas_size_ = once_.size();
  for (std::size_t i = 0; i < start.channels.size(); ++i) {
    const auto id = static_cast<std::uint16_t>(i + 1);
    append(once_,
           Channel{id, schema_ids[i], start.channels[i].topic, "flatbuffer", start.channels[i].metadata});
    chunk_index_.push_back({id, {}});
  }
  written_.assign(start.channels.size(), 0);
  statistics_.schema_count = static_cast<std::uint16_t>(schemas.size());
  statistics_.channel_count = static_cast<std::uint32_t>(start.channels.size());
}

// In three pieces: a world of millions of triangles is not copied once more.
Status McapWriter::write_attachment(const Start::Content& attached) {
  ByteWriter before;
  const std::size_t begun = before.begin_record(Opcode::attachment);
  before.u64(
      0);  // logged and created at the beginning of session time; no clock, so that runs stay comparable
  before.u64(0);
  before.text(attached.name);
  before.text("application/octet-stream");
  before.u64(attached.bytes.size());
  const std::uint64_t content_size = before.size() - begun + attached.bytes.size() + sizeof(std::uint32_t);
  ByteWriter head;
  head.u8(static_cast<std::uint8_t>(Opcode::attachment));
  head.u64(content_size);
  head.raw(before.bytes().subspan(begun));

  ByteWriter after;
  after.u32(crc32(crc32(0, before.bytes().subspan(begun)), attached.bytes));
  attachments_.push_back({file_.size(), kRecordHeaderSize + content_size, 0, 0, attached.bytes.size(),
                          std::string(attached.name), "application/octet-stream"});
  for (const Bytes piece : {head.bytes(), attached.bytes, after.bytes()})
    if (Status status = write(piece); !status.ok()) return status;
  return {};
}

// More session time than a chunk may, with a message of that time.
bool McapWriter::covers_too_much(std::uint64_t time) const {
  return is_chunk_open() && time - chunk_start_ >= options_.chunk_time;
}

// Messages of one time share a chunk as long as a reader takes it.
bool McapWriter::goes_on_with(std::uint64_t time, std::size_t data_size) const {
  const bool is_full = chunk_.size() >= options_.chunk_bytes && time != statistics_.end_time;
  return !is_full && !covers_too_much(time) && chunk_.size() + data_size <= kLargestMessage;
}

Status McapWriter::message(std::uint64_t time, std::uint32_t sequence, Bytes data, std::size_t channel) {
  if (!goes_on_with(time, data.size()))
    if (Status status = flush(); !status.ok()) return status;
  if (data.size() > kLargestMessage)
    return Status::error(file_.growing_at() + ": a message of " + std::to_string(data.size()) +
                         " bytes is larger than the 16 MiB that can be read; record no contact points");

  if (!is_chunk_open()) chunk_start_ = time;
  MessageIndex& index = chunk_index_[channel];
  index.entries.emplace_back(time, chunk_.size());
  append(chunk_, Message{index.channel_id, sequence, time, time, data});
  if (statistics_.message_count++ == 0) statistics_.start_time = time;
  statistics_.end_time = time;

  // A chunk that has no room for the next tick leaves now, not when that tick comes.
  if (channel != options_.last_channel) return {};
  if (covers_too_much(time + options_.period) || chunk_.size() >= options_.chunk_bytes) return write_chunk();
  return {};
}

// False where the library fails, and where the chunk becomes so small that no reader would believe it.
bool McapWriter::compress_chunk(Compression compression) {
  return compress(compression, chunk_.bytes(), compressed_) &&
         chunk_.size() <= kLargestRatio * compressed_.size() + kLargestGift;
}

Status McapWriter::append_chunk(ByteWriter& out) {
  Compression used = options_.compression;
  if (!compress_chunk(used) && !compress_chunk(used = Compression::lz4))
    return Status::error(file_.growing_at() +
                         ": a chunk cannot be compressed; free memory or record uncompressed");
  const std::uint64_t end_time = statistics_.end_time;
  const std::string compression(compression_text(used));
  append(out,
         Chunk{chunk_start_, end_time, chunk_.size(), crc32(0, chunk_.bytes()), compression, compressed_});
  const std::uint64_t chunk_length = out.size();
  std::map<std::uint16_t, std::uint64_t> indexes;
  for (const MessageIndex& index : chunk_index_) {
    if (index.entries.empty()) continue;
    indexes[index.channel_id] = file_.size() + out.size();
    append(out, index);
  }
  chunks_.push_back({chunk_start_, end_time, file_.size(), chunk_length, std::move(indexes),
                     out.size() - chunk_length, compression, compressed_.size(), chunk_.size()});
  return {};
}

Status McapWriter::write_chunk() {
  ByteWriter out;
  const std::uint64_t whole = file_.size();
  if (Status status = append_chunk(out); !status.ok()) return status;
  if (Status status = write(out.bytes()); !status.ok()) {
    // What is whole stays readable. The cut only removes bytes; should it fail too, readers stop at the torn
    // chunk.
    const Status cut = file_.cut(whole);
    return cut.ok() ? status : Status::error(status.message() + "; " + cut.message());
  }
  chunk_.clear();
  for (std::size_t i = 0; i < chunk_index_.size(); ++i) {
    written_[i] += chunk_index_[i].entries.size();
    chunk_index_[i].entries.clear();
  }
  return {};
}

// Groups by opcode, each told by a summary offset; the caller knows where in the file they will stand.
void McapWriter::append_summary(ByteWriter& out) {
  const std::uint64_t summary_start = file_.size();
  std::vector<SummaryOffset> groups;
  const auto group = [&](Opcode opcode, auto&& append_records) {
    const std::uint64_t begun = out.size();
    append_records();
    if (out.size() > begun) groups.push_back({opcode, summary_start + begun, out.size() - begun});
  };
  group(Opcode::schema, [&] { out.raw(once_.bytes().first(schemas_size_)); });
  group(Opcode::channel, [&] { out.raw(once_.bytes().subspan(schemas_size_)); });
  group(Opcode::statistics, [&] { append(out, statistics_); });
  group(Opcode::chunk_index, [&] {
    for (const ChunkIndex& chunk : chunks_) append(out, chunk);
  });
  group(Opcode::attachment_index, [&] {
    for (const AttachmentIndex& attachment : attachments_) append(out, attachment);
  });
  group(Opcode::metadata_index, [&] { append(out, metadata_); });

  const std::uint64_t offsets_start = summary_start + out.size();
  for (const SummaryOffset& offset : groups) append(out, offset);

  // The checksum covers the summary and the footer up to the checksum itself.
  ByteWriter footer;
  append(footer, Footer{summary_start, offsets_start, 0});
  const Bytes covered = footer.bytes().first(footer.size() - sizeof(std::uint32_t));
  out.raw(covered);
  out.u32(crc32(0, out.bytes()));
  out.raw(kMagic);
}

Status McapWriter::flush() { return is_chunk_open() ? write_chunk() : Status{}; }

Status McapWriter::close() {
  if (Status status = flush(); !status.ok()) return status;
  const std::uint64_t whole = file_.size();
  statistics_.attachment_count = static_cast<std::uint32_t>(attachments_.size());
  statistics_.metadata_count = 1;
  statistics_.chunk_count = static_cast<std::uint32_t>(chunks_.size());
  for (std::size_t i = 0; i < written_.size(); ++i)
    if (written_[i] > 0) statistics_.channel_message_counts[chunk_index_[i].channel_id] = written_[i];

  ByteWriter data_end;
  append(data_end, DataEnd{crc_});
  ByteWriter summary;
  Status status = file_.write(data_end.bytes());
  if (status.ok()) {
    append_summary(summary);
    status = file_.write(summary.bytes());
  }
  if (status.ok()) return file_.commit();
  const Status cut = file_.cut(whole);
  return cut.ok() ? status : Status::error(status.message() + "; " + cut.message());
}

}  // namespace lumbrical
