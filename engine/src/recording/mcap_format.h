// The records of an MCAP file (https://mcap.dev/spec), to bytes and back. Knows nothing of files or of ticks.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
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

/// What is read, and so what may be written: the records of a chunk together, the data of a message, which is
/// whole in one, and the content of a record that is neither chunk nor attachment. [bytes]
inline constexpr std::uint64_t kLargestChunk = 16u << 20;
inline constexpr std::uint64_t kMessageHeadSize = kRecordHeaderSize + 22;  // id, number and times
inline constexpr std::uint64_t kLargestMessage = kLargestChunk - kMessageHeadSize;
inline constexpr std::uint64_t kLargestOtherRecord = 4u << 20;

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
  /// As its type says; `length_width` bytes tell how many bytes `value` is, if it is that.
  template <class Field>
  void field(const Field& value, int length_width = 0);

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
  Bytes rest() { return take(bytes_.size() - position_); }
  std::string text();
  template <class Field>
  void field(Field& value, int length_width = 0);
  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] bool at_end() const { return position_ == bytes_.size(); }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  std::uint64_t number(int width);
  Bytes bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

// The records. Each lists its fields in their order in the file; where bytes are one of them, `kLengthWidth`
// bytes before them tell how many there are, or with 0 they go on to the record's end.

struct Header {
  std::string profile, library;
  static constexpr Opcode kOpcode = Opcode::header;
  static auto fields(auto& r) { return std::tie(r.profile, r.library); }
};
struct Footer {
  std::uint64_t summary_start = 0, summary_offset_start = 0;
  std::uint32_t summary_crc = 0;
  static constexpr Opcode kOpcode = Opcode::footer;
  static auto fields(auto& r) { return std::tie(r.summary_start, r.summary_offset_start, r.summary_crc); }
};
struct Schema {
  std::uint16_t id = 0;
  std::string name, encoding;
  Bytes data;
  static constexpr Opcode kOpcode = Opcode::schema;
  static constexpr int kLengthWidth = 4;
  static auto fields(auto& r) { return std::tie(r.id, r.name, r.encoding, r.data); }
};
struct Channel {
  std::uint16_t id = 0, schema_id = 0;
  std::string topic, message_encoding;
  std::map<std::string, std::string> metadata;
  static constexpr Opcode kOpcode = Opcode::channel;
  static auto fields(auto& r) { return std::tie(r.id, r.schema_id, r.topic, r.message_encoding, r.metadata); }
};
struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;  // [ns]
  Bytes data;
  static constexpr Opcode kOpcode = Opcode::message;
  static constexpr int kLengthWidth = 0;
  static auto fields(auto& r) {
    return std::tie(r.channel_id, r.sequence, r.log_time, r.publish_time, r.data);
  }
};
struct Chunk {
  std::uint64_t start_time = 0, end_time = 0;  // [ns] of its first and last message
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::string compression;  // "lz4", "zstd" or ""
  Bytes records;            // compressed
  static constexpr Opcode kOpcode = Opcode::chunk;
  static constexpr int kLengthWidth = 8;
  static auto fields(auto& r) {
    return std::tie(r.start_time, r.end_time, r.uncompressed_size, r.uncompressed_crc, r.compression,
                    r.records);
  }
};
struct MessageIndex {
  std::uint16_t channel_id = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;  // log time, offset in the chunk's records
  static constexpr Opcode kOpcode = Opcode::message_index;
  static auto fields(auto& r) { return std::tie(r.channel_id, r.entries); }
};
struct ChunkIndex {
  std::uint64_t start_time = 0, end_time = 0;
  std::uint64_t offset = 0, length = 0;  // of the whole chunk record in the file
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0, uncompressed_size = 0;
  static constexpr Opcode kOpcode = Opcode::chunk_index;
  static auto fields(auto& r) {
    return std::tie(r.start_time, r.end_time, r.offset, r.length, r.message_index_offsets,
                    r.message_index_length, r.compression, r.compressed_size, r.uncompressed_size);
  }
  friend bool operator==(const ChunkIndex&, const ChunkIndex&) = default;
};
struct Attachment {
  std::uint64_t log_time = 0, create_time = 0;
  std::string name, media_type;
  Bytes data;
  std::uint32_t crc = 0;         // of everything before it in the record
  std::size_t checked_size = 0;  // bytes of the content that the crc covers
  static constexpr int kLengthWidth = 8;
  static auto fields(auto& r) { return std::tie(r.log_time, r.create_time, r.name, r.media_type, r.data); }
};
struct AttachmentIndex {
  std::uint64_t offset = 0, length = 0, log_time = 0, create_time = 0, data_size = 0;
  std::string name, media_type;
  static constexpr Opcode kOpcode = Opcode::attachment_index;
  static auto fields(auto& r) {
    return std::tie(r.offset, r.length, r.log_time, r.create_time, r.data_size, r.name, r.media_type);
  }
  friend bool operator==(const AttachmentIndex&, const AttachmentIndex&) = default;
};
struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0, attachment_count = 0, metadata_count = 0, chunk_count = 0;
  std::uint64_t start_time = 0, end_time = 0;
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
  static constexpr Opcode kOpcode = Opcode::statistics;
  static auto fields(auto& r) {
    return std::tie(r.message_count, r.schema_count, r.channel_count, r.attachment_count, r.metadata_count,
                    r.chunk_count, r.start_time, r.end_time, r.channel_message_counts);
  }
  friend bool operator==(const Statistics&, const Statistics&) = default;
};
struct Metadata {
  std::string name;
  std::map<std::string, std::string> metadata;
  static constexpr Opcode kOpcode = Opcode::metadata;
  static auto fields(auto& r) { return std::tie(r.name, r.metadata); }
};
struct MetadataIndex {
  std::uint64_t offset = 0, length = 0;
  std::string name;
  static constexpr Opcode kOpcode = Opcode::metadata_index;
  static auto fields(auto& r) { return std::tie(r.offset, r.length, r.name); }
  friend bool operator==(const MetadataIndex&, const MetadataIndex&) = default;
};
struct SummaryOffset {
  Opcode group = Opcode::none;
  std::uint64_t start = 0, length = 0;
  static constexpr Opcode kOpcode = Opcode::summary_offset;
  static auto fields(auto& r) { return std::tie(r.group, r.start, r.length); }
  friend bool operator==(const SummaryOffset&, const SummaryOffset&) = default;
};

struct DataEnd {
  std::uint32_t data_section_crc = 0;
  static constexpr Opcode kOpcode = Opcode::data_end;
  static auto fields(auto& r) { return std::tie(r.data_section_crc); }
};

template <class Field>
void ByteWriter::field(const Field& value, int length_width) {
  if constexpr (std::is_integral_v<Field> || std::is_enum_v<Field>) {
    number(static_cast<std::uint64_t>(value), sizeof(Field));
  } else if constexpr (std::is_same_v<Field, std::string>) {
    text(value);
  } else if constexpr (std::is_same_v<Field, Bytes>) {
    number(value.size(), length_width);
    raw(value);
  } else {
    const std::size_t length = begin_length(4);
    for (const auto& [first, second] : value) field(first), field(second);
    end_length(length, 4);
  }
}

template <class Field>
void ByteReader::field(Field& value, int length_width) {
  if constexpr (std::is_integral_v<Field> || std::is_enum_v<Field>) {
    value = static_cast<Field>(number(sizeof(Field)));
  } else if constexpr (std::is_same_v<Field, std::string>) {
    value = text();
  } else if constexpr (std::is_same_v<Field, Bytes>) {
    value = length_width > 0 ? take(number(length_width)) : rest();
  } else {
    ByteReader pairs(take(u32()));
    value.clear();
    while (pairs.ok() && !pairs.at_end()) {
      std::pair<std::remove_const_t<typename Field::value_type::first_type>,
                typename Field::value_type::second_type>
          pair;
      pairs.field(pair.first), pairs.field(pair.second);
      if constexpr (requires { value.insert_or_assign(pair.first, pair.second); })
        value.insert_or_assign(std::move(pair.first), std::move(pair.second));
      else
        value.push_back(std::move(pair));
    }
    ok_ = ok_ && pairs.ok();
  }
}

template <class Record>
constexpr int length_width() {
  if constexpr (requires { Record::kLengthWidth; }) return Record::kLengthWidth;
  return 0;
}

/// Adds a whole record, opcode and length included. An attachment is written in pieces by the writer.
template <class Record>
void append(ByteWriter& out, const Record& record) {
  const std::size_t begun = out.begin_record(Record::kOpcode);
  std::apply([&](const auto&... field) { (out.field(field, length_width<Record>()), ...); },
             Record::fields(record));
  out.end_record(begun);
}

/// Reads a record's content (without opcode and length); false: too short for what it declares. Bytes beyond
/// the known fields are allowed, as the specification asks. Spans point into `content`.
template <class Record>
bool parse(Bytes content, Record& record) {
  ByteReader in(content);
  std::apply([&](auto&... field) { (in.field(field, length_width<Record>()), ...); }, Record::fields(record));
  if constexpr (requires { record.checked_size; }) {
    record.checked_size = in.position();
    in.field(record.crc);
  }
  return in.ok();
}

}  // namespace lumbrical::mcap
