// MCAP records to bytes and back, field by field in the order of the specification.
#include "recording/mcap_format.h"

#include <zlib.h>

namespace lumbrical::mcap {
namespace {

void append_map(ByteWriter& out, const std::map<std::string, std::string>& map) {
  const std::size_t length = out.begin_length(4);
  for (const auto& [key, value] : map) {
    out.text(key);
    out.text(value);
  }
  out.end_length(length, 4);
}

void append_map(ByteWriter& out, const std::map<std::uint16_t, std::uint64_t>& map) {
  const std::size_t length = out.begin_length(4);
  for (const auto& [key, value] : map) {
    out.u16(key);
    out.u64(value);
  }
  out.end_length(length, 4);
}

bool read_map(ByteReader& in, std::map<std::string, std::string>& map) {
  ByteReader pairs(in.take(in.u32()));
  map.clear();
  while (pairs.ok() && !pairs.at_end()) {
    std::string key = pairs.text();
    map[std::move(key)] = pairs.text();
  }
  return in.ok() && pairs.ok();
}

bool read_map(ByteReader& in, std::map<std::uint16_t, std::uint64_t>& map) {
  ByteReader pairs(in.take(in.u32()));
  map.clear();
  while (pairs.ok() && !pairs.at_end()) {
    const std::uint16_t key = pairs.u16();
    map[key] = pairs.u64();
  }
  return in.ok() && pairs.ok();
}

}  // namespace

std::uint32_t crc32(std::uint32_t crc, Bytes bytes) {
  if (bytes.empty()) return crc;  // zlib takes a null pointer for "start anew"
  return static_cast<std::uint32_t>(::crc32_z(crc, bytes.data(), bytes.size()));
}

void ByteWriter::raw(Bytes bytes) { data_.insert(data_.end(), bytes.begin(), bytes.end()); }
void ByteWriter::raw(std::string_view bytes) { data_.insert(data_.end(), bytes.begin(), bytes.end()); }

void ByteWriter::text(std::string_view text) {
  u32(static_cast<std::uint32_t>(text.size()));
  raw(text);
}

void ByteWriter::number(std::uint64_t value, int width) {
  for (int i = 0; i < width; ++i) data_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

std::size_t ByteWriter::begin_length(int width) {
  number(0, width);
  return data_.size();
}

void ByteWriter::end_length(std::size_t begun, int width) {
  const std::uint64_t length = data_.size() - begun;
  const std::size_t at = begun - static_cast<std::size_t>(width);
  for (int i = 0; i < width; ++i) data_[at + i] = static_cast<std::uint8_t>(length >> (8 * i));
}

std::size_t ByteWriter::begin_record(Opcode opcode) {
  u8(static_cast<std::uint8_t>(opcode));
  return begin_length(8);
}

Bytes ByteReader::take(std::uint64_t size) {
  if (size > bytes_.size() - position_) {
    ok_ = false;
    position_ = bytes_.size();
    return {};
  }
  const Bytes taken = bytes_.subspan(position_, size);
  position_ += size;
  return taken;
}

std::uint64_t ByteReader::number(int width) {
  const Bytes bytes = take(static_cast<std::uint64_t>(width));
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  return value;
}

std::string ByteReader::text() {
  const Bytes bytes = take(u32());
  return std::string(bytes.begin(), bytes.end());
}

void append(ByteWriter& out, const Header& record) {
  const std::size_t begun = out.begin_record(Opcode::header);
  out.text(record.profile);
  out.text(record.library);
  out.end_record(begun);
}

bool parse(Bytes content, Header& record) {
  ByteReader in(content);
  record.profile = in.text();
  record.library = in.text();
  return in.ok();
}

void append(ByteWriter& out, const Footer& record) {
  const std::size_t begun = out.begin_record(Opcode::footer);
  out.u64(record.summary_start);
  out.u64(record.summary_offset_start);
  out.u32(record.summary_crc);
  out.end_record(begun);
}

bool parse(Bytes content, Footer& record) {
  ByteReader in(content);
  record.summary_start = in.u64();
  record.summary_offset_start = in.u64();
  record.summary_crc = in.u32();
  return in.ok();
}

void append(ByteWriter& out, const Schema& record) {
  const std::size_t begun = out.begin_record(Opcode::schema);
  out.u16(record.id);
  out.text(record.name);
  out.text(record.encoding);
  out.u32(static_cast<std::uint32_t>(record.data.size()));
  out.raw(record.data);
  out.end_record(begun);
}

bool parse(Bytes content, Schema& record) {
  ByteReader in(content);
  record.id = in.u16();
  record.name = in.text();
  record.encoding = in.text();
  record.data = in.take(in.u32());
  return in.ok();
}

void append(ByteWriter& out, const Channel& record) {
  const std::size_t begun = out.begin_record(Opcode::channel);
  out.u16(record.id);
  out.u16(record.schema_id);
  out.text(record.topic);
  out.text(record.message_encoding);
  append_map(out, record.metadata);
  out.end_record(begun);
}

bool parse(Bytes content, Channel& record) {
  ByteReader in(content);
  record.id = in.u16();
  record.schema_id = in.u16();
  record.topic = in.text();
  record.message_encoding = in.text();
  return read_map(in, record.metadata);
}

void append(ByteWriter& out, const Message& record) {
  const std::size_t begun = out.begin_record(Opcode::message);
  out.u16(record.channel_id);
  out.u32(record.sequence);
  out.u64(record.log_time);
  out.u64(record.publish_time);
  out.raw(record.data);
  out.end_record(begun);
}

bool parse(Bytes content, Message& record) {
  ByteReader in(content);
  record.channel_id = in.u16();
  record.sequence = in.u32();
  record.log_time = in.u64();
  record.publish_time = in.u64();
  record.data = in.take(content.size() - in.position());
  return in.ok();
}

void append(ByteWriter& out, const Chunk& record) {
  const std::size_t begun = out.begin_record(Opcode::chunk);
  out.u64(record.start_time);
  out.u64(record.end_time);
  out.u64(record.uncompressed_size);
  out.u32(record.uncompressed_crc);
  out.text(record.compression);
  out.u64(record.records.size());
  out.raw(record.records);
  out.end_record(begun);
}

bool parse(Bytes content, Chunk& record) {
  ByteReader in(content);
  record.start_time = in.u64();
  record.end_time = in.u64();
  record.uncompressed_size = in.u64();
  record.uncompressed_crc = in.u32();
  record.compression = in.text();
  record.records = in.take(in.u64());
  return in.ok();
}

void append(ByteWriter& out, const MessageIndex& record) {
  const std::size_t begun = out.begin_record(Opcode::message_index);
  out.u16(record.channel_id);
  const std::size_t length = out.begin_length(4);
  for (const auto& [time, offset] : record.entries) {
    out.u64(time);
    out.u64(offset);
  }
  out.end_length(length, 4);
  out.end_record(begun);
}

bool parse(Bytes content, MessageIndex& record) {
  ByteReader in(content);
  record.channel_id = in.u16();
  ByteReader pairs(in.take(in.u32()));
  record.entries.clear();
  while (pairs.ok() && !pairs.at_end()) {
    const std::uint64_t time = pairs.u64();
    record.entries.emplace_back(time, pairs.u64());
  }
  return in.ok() && pairs.ok();
}

void append(ByteWriter& out, const ChunkIndex& record) {
  const std::size_t begun = out.begin_record(Opcode::chunk_index);
  out.u64(record.start_time);
  out.u64(record.end_time);
  out.u64(record.offset);
  out.u64(record.length);
  append_map(out, record.message_index_offsets);
  out.u64(record.message_index_length);
  out.text(record.compression);
  out.u64(record.compressed_size);
  out.u64(record.uncompressed_size);
  out.end_record(begun);
}

bool parse(Bytes content, ChunkIndex& record) {
  ByteReader in(content);
  record.start_time = in.u64();
  record.end_time = in.u64();
  record.offset = in.u64();
  record.length = in.u64();
  if (!read_map(in, record.message_index_offsets)) return false;
  record.message_index_length = in.u64();
  record.compression = in.text();
  record.compressed_size = in.u64();
  record.uncompressed_size = in.u64();
  return in.ok();
}

bool parse(Bytes content, Attachment& record) {
  ByteReader in(content);
  record.log_time = in.u64();
  record.create_time = in.u64();
  record.name = in.text();
  record.media_type = in.text();
  record.data = in.take(in.u64());
  record.checked_size = in.position();
  record.crc = in.u32();
  return in.ok();
}

void append(ByteWriter& out, const AttachmentIndex& record) {
  const std::size_t begun = out.begin_record(Opcode::attachment_index);
  out.u64(record.offset);
  out.u64(record.length);
  out.u64(record.log_time);
  out.u64(record.create_time);
  out.u64(record.data_size);
  out.text(record.name);
  out.text(record.media_type);
  out.end_record(begun);
}

bool parse(Bytes content, AttachmentIndex& record) {
  ByteReader in(content);
  record.offset = in.u64();
  record.length = in.u64();
  record.log_time = in.u64();
  record.create_time = in.u64();
  record.data_size = in.u64();
  record.name = in.text();
  record.media_type = in.text();
  return in.ok();
}

void append(ByteWriter& out, const Statistics& record) {
  const std::size_t begun = out.begin_record(Opcode::statistics);
  out.u64(record.message_count);
  out.u16(record.schema_count);
  out.u32(record.channel_count);
  out.u32(record.attachment_count);
  out.u32(record.metadata_count);
  out.u32(record.chunk_count);
  out.u64(record.start_time);
  out.u64(record.end_time);
  append_map(out, record.channel_message_counts);
  out.end_record(begun);
}

bool parse(Bytes content, Statistics& record) {
  ByteReader in(content);
  record.message_count = in.u64();
  record.schema_count = in.u16();
  record.channel_count = in.u32();
  record.attachment_count = in.u32();
  record.metadata_count = in.u32();
  record.chunk_count = in.u32();
  record.start_time = in.u64();
  record.end_time = in.u64();
  return read_map(in, record.channel_message_counts);
}

void append(ByteWriter& out, const Metadata& record) {
  const std::size_t begun = out.begin_record(Opcode::metadata);
  out.text(record.name);
  append_map(out, record.metadata);
  out.end_record(begun);
}

bool parse(Bytes content, Metadata& record) {
  ByteReader in(content);
  record.name = in.text();
  return read_map(in, record.metadata);
}

void append(ByteWriter& out, const MetadataIndex& record) {
  const std::size_t begun = out.begin_record(Opcode::metadata_index);
  out.u64(record.offset);
  out.u64(record.length);
  out.text(record.name);
  out.end_record(begun);
}

bool parse(Bytes content, MetadataIndex& record) {
  ByteReader in(content);
  record.offset = in.u64();
  record.length = in.u64();
  record.name = in.text();
  return in.ok();
}

void append(ByteWriter& out, const SummaryOffset& record) {
  const std::size_t begun = out.begin_record(Opcode::summary_offset);
  out.u8(static_cast<std::uint8_t>(record.group));
  out.u64(record.start);
  out.u64(record.length);
  out.end_record(begun);
}

bool parse(Bytes content, SummaryOffset& record) {
  ByteReader in(content);
  record.group = static_cast<Opcode>(in.u8());
  record.start = in.u64();
  record.length = in.u64();
  return in.ok();
}

void append_data_end(ByteWriter& out, std::uint32_t data_section_crc) {
  const std::size_t begun = out.begin_record(Opcode::data_end);
  out.u32(data_section_crc);
  out.end_record(begun);
}

bool parse_data_end(Bytes content, std::uint32_t& data_section_crc) {
  ByteReader in(content);
  data_section_crc = in.u32();
  return in.ok();
}

}  // namespace lumbrical::mcap
