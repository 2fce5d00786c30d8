// The records of an MCAP file (https://mcap.dev/spec), to bytes and back. Knows nothing of files or of ticks.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lumbrical::mcap {

using Bytes = std::span<const std::uint8_t>;

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::uint64_t kRecordHeaderSize = 9;  // opcode, length
inline constexpr std::uint64_t kFooterContentSize = 20;

/// How many times its compressed size a chunk may have: no less than LZ4 can reach at all. Zstandard goes on
/// to thousands, which is how a small file keeps its reader busy.
inline constexpr std::uint64_t kLargestRatio = 256, kLargestGift = 1024;

enum class Opcode : std::uint8_t {
  none = 0x00,
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0a,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  summary_offset = 0x0e,
  data_end = 0x0f,
  first_private = 0x80,  // from here on: other people's records, to be skipped
};

/// CRC-32 as zlib computes it; `crc` is that of the bytes before (0 at the start).
std::uint32_t crc32(std::uint32_t crc, Bytes bytes);

/// Collects little-endian numbers, texts and whole records.
class ByteWriter {
 public:
  void u8(std::uint8_t value) { data_.push_back(value); }
  void u16(std::uint16_t value) { number(value, 2); }
  void u32(std::uint32_t value) { number(value, 4); }
  void u64(std::uint64_t value) { number(value, 8); }
  void raw(Bytes bytes);
  void raw(std::string_view bytes);
  void text(std::string_view text);  ///< 32-bit length, then the bytes

  /// Starts a length field of `width` bytes that end_length() fills in with the number of bytes between.
  [[nodiscard]] std::size_t begin_length(int width);
  void end_length(std::size_t begun, int width);
  [[nodiscard]] std::size_t begin_record(Opcode opcode);
  void end_record(std::size_t begun) { end_length(begun, 8); }

  [[nodiscard]] Bytes bytes() const { return data_; }
  [[nodiscard]] std::size_t size() const { return data_.size(); }
  void clear() { data_.clear(); }

 private:
  void number(std::uint64_t value, int width);
  std::vector<std::uint8_t> data_;
};

/// Takes the same apart. Reading beyond the end gives zeros and turns ok() to false, once and for all.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : bytes_(bytes) {}
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  Bytes take(std::uint64_t size);
  std::string text();
  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] bool at_end() const { return position_ == bytes_.size(); }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  std::uint64_t number(int width);
  Bytes bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

struct Header {
  std::string profile, library;
};
struct Footer {
  std::uint64_t summary_start = 0, summary_offset_start = 0;
  std::uint32_t summary_crc = 0;
};
struct Schema {
  std::uint16_t id = 0;
  std::string name, encoding;
  Bytes data;
};
struct Channel {
  std::uint16_t id = 0, schema_id = 0;
  std::string topic, message_encoding;
  std::map<std::string, std::string> metadata;
};
struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;  // [ns]
  Bytes data;
};
struct Chunk {
  std::uint64_t start_time = 0, end_time = 0;  // [ns] of its first and last message
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::string compression;  // "lz4", "zstd" or ""
  Bytes records;            // compressed
};
struct MessageIndex {
  std::uint16_t channel_id = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;  // log time, offset in the chunk's records
};
struct ChunkIndex {
  std::uint64_t start_time = 0, end_time = 0;
  std::uint64_t offset = 0, length = 0;  // of the whole chunk record in the file
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0, uncompressed_size = 0;
  friend bool operator==(const ChunkIndex&, const ChunkIndex&) = default;
};
struct Attachment {
  std::uint64_t log_time = 0, create_time = 0;
  std::string name, media_type;
  Bytes data;
  std::uint32_t crc = 0;         // of everything before it in the record
  std::size_t checked_size = 0;  // bytes of the content that the crc covers
};
struct AttachmentIndex {
  std::uint64_t offset = 0, length = 0, log_time = 0, create_time = 0, data_size = 0;
  std::string name, media_type;
  friend bool operator==(const AttachmentIndex&, const AttachmentIndex&) = default;
};
struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0, attachment_count = 0, metadata_count = 0, chunk_count = 0;
  std::uint64_t start_time = 0, end_time = 0;
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
  friend bool operator==(const Statistics&, const Statistics&) = default;
};
struct Metadata {
  std::string name;
  std::map<std::string, std::string> metadata;
};
struct MetadataIndex {
  std::uint64_t offset = 0, length = 0;
  std::string name;
  friend bool operator==(const MetadataIndex&, const MetadataIndex&) = default;
};
struct SummaryOffset {
  Opcode group = Opcode::none;
  std::uint64_t start = 0, length = 0;
  friend bool operator==(const SummaryOffset&, const SummaryOffset&) = default;
};

// append() adds a whole record, opcode and length included. An attachment is written in pieces by the writer.
void append(ByteWriter& out, const Header& record);
void append(ByteWriter& out, const Footer& record);
void append(ByteWriter& out, const Schema& record);
void append(ByteWriter& out, const Channel& record);
void append(ByteWriter& out, const Message& record);
void append(ByteWriter& out, const Chunk& record);
void append(ByteWriter& out, const MessageIndex& record);
void append(ByteWriter& out, const ChunkIndex& record);
void append(ByteWriter& out, const AttachmentIndex& record);
void append(ByteWriter& out, const Statistics& record);
void append(ByteWriter& out, const Metadata& record);
void append(ByteWriter& out, const MetadataIndex& record);
void append(ByteWriter& out, const SummaryOffset& record);
void append_data_end(ByteWriter& out, std::uint32_t data_section_crc);

// parse() reads a record's content (without opcode and length); false: too short for what it declares. Bytes
// beyond the known fields are allowed, as the specification asks. Spans point into `content`.
bool parse(Bytes content, Header& record);
bool parse(Bytes content, Footer& record);
bool parse(Bytes content, Schema& record);
bool parse(Bytes content, Channel& record);
bool parse(Bytes content, Message& record);
bool parse(Bytes content, Chunk& record);
bool parse(Bytes content, MessageIndex& record);
bool parse(Bytes content, ChunkIndex& record);
bool parse(Bytes content, Attachment& record);
bool parse(Bytes content, AttachmentIndex& record);
bool parse(Bytes content, Statistics& record);
bool parse(Bytes content, Metadata& record);
bool parse(Bytes content, MetadataIndex& record);
bool parse(Bytes content, SummaryOffset& record);
bool parse_data_end(Bytes content, std::uint32_t& data_section_crc);

}  // namespace lumbrical::mcap
