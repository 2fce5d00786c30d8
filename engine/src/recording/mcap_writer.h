// Writes an MCAP file: what stands first, then chunks as messages come, then index and summary.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "files/output_file.h"
#include "lumbrical/recording.h"
#include "recording/mcap_format.h"

namespace lumbrical {

struct McapWriterOptions {
  Compression compression = Compression::lz4;
  std::uint64_t period = 1'000'000;        ///< [ns] session time from one message to the next
  std::uint64_t chunk_time = 200'000'000;  ///< [ns] session time a chunk may cover
  std::uint64_t chunk_bytes = 1u << 20;    ///< a chunk of so many, uncompressed, ends with the time it is at
  std::size_t last_channel = 0;            ///< of messages of one time, which share a chunk, its comes last
};

/// Those that can be written can be read, and no others.
bool is_known_compression(std::string_view name);
/// By the name MCAP gives it.
Compression compression_named(std::string_view name);

class McapWriter {
 public:
  struct Start {
    struct Channel {
      std::string_view schema_name;  ///< FlatBuffers: the table's qualified name; channels may share one
      mcap::Bytes schema;            ///< FlatBuffers: the binary schema
      std::string topic;
      std::map<std::string, std::string> metadata;
    };
    std::string_view library;
    std::vector<Channel> channels;  ///< get the ids 1, 2, ...
    struct Content {
      std::string_view name;
      mcap::Bytes bytes;
    };
    std::vector<Content> attachments;
    std::string_view metadata_name;
    const std::map<std::string, std::string>* metadata = nullptr;
  };

  /// Creates the file and writes all that stands before the first message. Metadata that no reader would take
  /// are refused.
  Status open(const std::string& path, const McapWriterOptions& options, const Start& start);
  /// Adds one message to Start::channels[channel]; times [ns] must not descend. A full chunk goes to the file
  /// at once, whole. After an error the file ends with the last whole chunk and stays readable that far. A
  /// message that no reader would take is refused, behind all that came before it.
  Status message(std::uint64_t time, std::uint32_t sequence, mcap::Bytes data, std::size_t channel = 0);
  /// Writes the open chunk, if any message is in it; the next one begins another.
  Status flush();
  /// What has left in chunks outlives a power cut. May run beside all but open() and close().
  Status sync() { return file_.sync(); }
  /// Whether messages wait in an open chunk.
  [[nodiscard]] bool is_chunk_open() const { return chunk_.size() > 0; }
  /// Messages of a channel in chunks that are in the file.
  [[nodiscard]] std::uint64_t written_messages(std::size_t channel = 0) const { return written_[channel]; }
  /// Writes the open chunk, index and summary, and puts the file in its place.
  Status close();
  /// Removes the file.
  void discard() { file_.discard(); }

 private:
  Status write(mcap::Bytes bytes);
  [[nodiscard]] bool covers_too_much(std::uint64_t time) const;
  [[nodiscard]] bool goes_on_with(std::uint64_t time, std::size_t data_size) const;
  void append_channels(const Start& start);
  Status write_attachment(const Start::Content& content);
  Status write_chunk();
  Status append_chunk(mcap::ByteWriter& out);
  bool compress_chunk(Compression compression);
  void append_summary(mcap::ByteWriter& out);

  OutputFile file_;
  McapWriterOptions options_;
  std::uint32_t crc_ = 0;  // of the file so far
  mcap::ByteWriter once_;  // schemas and channels, which the summary repeats
  std::uint64_t schemas_size_ = 0;

  mcap::ByteWriter chunk_;                       // records of the open chunk
  std::uint64_t chunk_start_ = 0;                // [ns] time of its first message
  std::vector<mcap::MessageIndex> chunk_index_;  // its messages, by channel
  std::vector<std::uint64_t> written_;           // messages by channel
  std::vector<std::uint8_t> compressed_;         // and what becomes of it

  mcap::Statistics statistics_;
  std::vector<mcap::ChunkIndex> chunks_;
  std::vector<mcap::AttachmentIndex> attachments_;
  mcap::MetadataIndex metadata_;
};

}  // namespace lumbrical
