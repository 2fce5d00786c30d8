// Reads MCAP records from a file that may be torn, damaged or hostile: every length is checked before it is
// believed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lumbrical/status.h"
#include "recording/mcap_format.h"

namespace lumbrical {

/// A file opened for reading at any place. Not mapped: a file that shrinks must not kill its reader.
class InputFile {
 public:
  InputFile() = default;
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Where there is no file of that name, what was to become it (path.part).
  Status open(const std::string& path);
  [[nodiscard]] const std::string& path() const { return path_; }
  /// `bytes` becomes exactly `count` bytes from `offset`. The caller has bounded `count`.
  Status read(std::uint64_t offset, std::uint64_t count, std::vector<std::uint8_t>& bytes) const;
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Its writer had it open when it was opened here: more may follow behind size().
  [[nodiscard]] bool growing() const { return growing_; }
  /// "path: byte N: what"
  [[nodiscard]] Status broken(std::uint64_t offset, const std::string& what) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  bool growing_ = false;
};

/// Where a record stands.
struct RecordPlace {
  mcap::Opcode opcode = mcap::Opcode::none;
  std::uint64_t offset = 0;  ///< of the opcode
  std::uint64_t length = 0;  ///< of the content
  [[nodiscard]] std::uint64_t content() const { return offset + mcap::kRecordHeaderSize; }
  [[nodiscard]] std::uint64_t end() const { return content() + length; }
};

/// Finds the record at `offset`. False: it does not end before `limit`, so there is no whole record here.
Status find_record(const InputFile& file, std::uint64_t offset, std::uint64_t limit, RecordPlace& place,
                   bool& whole);

/// Reads a record's content, whose size has been found to lie within the file.
Status read_content(const InputFile& file, const RecordPlace& place, std::vector<std::uint8_t>& content);

/// A chunk's decompressed and checked records.
struct LoadedChunk {
  mcap::Chunk header;  ///< its `records` are gone
  std::uint64_t compressed_size = 0;
  std::vector<std::uint8_t> records;
};
/// `content` is room for the compressed bytes, kept from chunk to chunk.
Status load_chunk(const InputFile& file, const RecordPlace& place, std::vector<std::uint8_t>& content,
                  LoadedChunk& chunk);

/// One record inside a chunk. False: the chunk ends in the middle of it.
struct InnerRecord {
  mcap::Opcode opcode = mcap::Opcode::none;
  mcap::Bytes content;
  std::size_t end = 0;  ///< offset of the next one in the chunk
};
bool find_inner_record(mcap::Bytes records, std::size_t offset, InnerRecord& record);

/// Reads an attachment and checks its checksum. `record` points to the front of `content`.
Status load_attachment(const InputFile& file, const RecordPlace& place, std::vector<std::uint8_t>& content,
                       mcap::Attachment& record);

/// A chunk with messages of more channels is not from a recorder of hands.
inline constexpr std::size_t kMostChannelsInChunk = 16;

/// What stands behind the data section of a file that was closed.
struct Summary {
  std::uint64_t start = 0;         ///< offset of the summary section
  std::uint64_t offset_start = 0;  ///< offset of the summary offset section; 0: none
  struct SchemaName {
    std::uint16_t id = 0;
    std::string name, encoding;
  };
  std::vector<SchemaName> schemas;
  std::vector<mcap::Channel> channels;
  std::optional<mcap::Statistics> statistics;
  std::vector<mcap::ChunkIndex> chunks;  ///< ascending by offset
  std::vector<mcap::AttachmentIndex> attachments;
  std::vector<mcap::MetadataIndex> metadata;
  std::vector<mcap::SummaryOffset> groups;           ///< as found: runs of records of the same opcode
  std::vector<mcap::SummaryOffset> summary_offsets;  ///< as stated
};
/// Checks the magic bytes and the header record; `data_start` is the offset behind them.
Status read_start(const InputFile& file, mcap::Header& header, std::uint64_t& data_start);
/// Reads and checks the summary. `present` false, and no error: the file has no footer (killed writer) or no
/// summary.
Status read_summary(const InputFile& file, Summary& summary, bool& present);

}  // namespace lumbrical
