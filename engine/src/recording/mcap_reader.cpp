// MCAP reading on POSIX: positioned reads, bounded allocations, checked decompression.
#include "recording/mcap_reader.h"

#include <fcntl.h>
#include <lz4frame.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <system_error>

#include "base/system_status.h"
#include "files/output_file.h"
#include "recording/mcap_writer.h"

namespace lumbrical {

using namespace mcap;

namespace {

// FlatBuffers holds less than 2 GiB, so no attachment of ours is larger.
constexpr std::uint64_t kLargestAttachment = std::uint64_t{1} << 31;

std::uint64_t largest_content(Opcode opcode) {
  if (opcode == Opcode::chunk) return kLargestChunk + (1u << 20);  // what cannot be compressed grows a little
  if (opcode == Opcode::attachment) return kLargestAttachment + (1u << 20);
  return kLargestOtherRecord;
}

struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

/// Exactly one LZ4 frame that gives exactly out.size() bytes.
bool decompress_lz4(Bytes bytes, std::span<std::uint8_t> out) {
  LZ4F_dctx* created = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&created, LZ4F_VERSION)) != 0) return false;
  const std::unique_ptr<LZ4F_dctx, FreeLz4> context(created);
  for (;;) {
    std::size_t taken = bytes.size();
    std::size_t given = out.size();
    const std::size_t hint =
        LZ4F_decompress(context.get(), out.data(), &given, bytes.data(), &taken, nullptr);
    if (LZ4F_isError(hint) != 0) return false;
    bytes = bytes.subspan(taken);
    out = out.subspan(given);
    if (hint == 0) return bytes.empty() && out.empty();
    if (taken == 0 && given == 0) return false;  // wants more than there is
  }
}

/// Fills `out` exactly; false where the bytes are damaged, too short or too long.
bool decompress(const std::string& compression, Bytes bytes, std::span<std::uint8_t> out) {
  if (compression == "lz4") return decompress_lz4(bytes, out);
  if (compression == "zstd")
    return ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size()) == out.size();
  if (bytes.size() != out.size()) return false;
  std::copy(bytes.begin(), bytes.end(), out.begin());
  return true;
}

bool is_magic(Bytes bytes) {
  return bytes.size() == kMagic.size() &&
         std::equal(bytes.begin(), bytes.end(), reinterpret_cast<const std::uint8_t*>(kMagic.data()));
}

// As many as there are channels at most: a list of records takes several times their room in the file.
constexpr std::size_t kMostRecords = 65536;

template <class Record>
bool parse_into(Bytes content, std::vector<Record>& list) {
  return list.size() < kMostRecords && parse(content, list.emplace_back());
}

// Chunks alone are many. Their list never grows, which would take it twice: `room` is of the whole summary.
bool add_chunk(Bytes content, std::uint64_t room, Summary& summary) {
  constexpr std::uint64_t kLeastIndex = 73;
  if (summary.chunks.empty()) summary.chunks.reserve(room / kLeastIndex + 1);
  return parse(content, summary.chunks.emplace_back()) &&
         summary.chunks.back().message_index_offsets.size() <= kMostChannelsInChunk;
}

bool add_to_summary(Opcode opcode, Bytes content, std::uint64_t room, Summary& summary) {
  switch (opcode) {
    case Opcode::schema: {
      Schema schema;
      if (summary.schemas.size() == kMostRecords || !parse(content, schema)) return false;
      summary.schemas.push_back({schema.id, schema.name, schema.encoding});
      return true;
    }
    case Opcode::statistics:
      return !summary.statistics && parse(content, summary.statistics.emplace());
    case Opcode::channel:
      if (!parse_into(content, summary.channels)) return false;
      summary.channels.back().metadata.clear();  // no one asks
      return true;
    case Opcode::chunk_index:
      return add_chunk(content, room, summary);
    case Opcode::attachment_index:
      return parse_into(content, summary.attachments);
    case Opcode::metadata_index:
      return parse_into(content, summary.metadata);
    case Opcode::summary_offset:
      return parse_into(content, summary.summary_offsets);
    default:
      return opcode >= Opcode::first_private;
  }
}

}  // namespace

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Status InputFile::broken(std::uint64_t offset, const std::string& what) const {
  return Status::error(path_ + ": byte " + std::to_string(offset) + ": " + what);
}

Status InputFile::open(const std::string& path) {
  path_ = path;
  // O_NONBLOCK: opening a pipe that nobody writes to must not wait; for files it means nothing.
  constexpr int kMode = O_RDONLY | O_CLOEXEC | O_NONBLOCK;
  descriptor_ = ::open(path.c_str(), kMode);
  if (descriptor_ < 0 && errno == ENOENT) {
    // What a writer that is at work, or was killed, has left.
    const std::string part = path + kPartSuffix;
    descriptor_ = ::open(part.c_str(), kMode);
    if (descriptor_ >= 0 || errno != ENOENT)
      path_ = part;
    else  // it may have been completed in between
      descriptor_ = ::open(path.c_str(), kMode);
  }
  if (descriptor_ < 0) return unreadable(path_, errno);
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode))
    return Status::error(path_ + ": is not a file; name a recording");
  size_ = static_cast<std::uint64_t>(status.st_size);
  growing_ = is_being_written(descriptor_);
  return {};
}

Status InputFile::read(std::uint64_t offset, std::uint64_t count, std::vector<std::uint8_t>& bytes) const {
  if (offset > size_ || count > size_ - offset) return broken(offset, "the file ends too early");
  bytes.resize(count);
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return broken(offset + done, "cannot be read: " + std::generic_category().message(errno));
    if (got == 0) return broken(offset + done, "the file became shorter while it was read");
    done += static_cast<std::size_t>(got);
  }
  return {};
}

Status find_record(const InputFile& file, std::uint64_t offset, std::uint64_t limit, RecordPlace& place,
                   bool& whole) {
  whole = false;
  if (offset > limit || limit - offset < kRecordHeaderSize) return {};
  std::vector<std::uint8_t> bytes;
  if (Status status = file.read(offset, kRecordHeaderSize, bytes); !status.ok()) return status;
  ByteReader in(bytes);
  place.opcode = static_cast<Opcode>(in.u8());
  place.offset = offset;
  place.length = in.u64();
  whole = place.length <= limit - offset - kRecordHeaderSize;
  return {};
}

Status read_content(const InputFile& file, const RecordPlace& place, std::vector<std::uint8_t>& content) {
  if (place.length > largest_content(place.opcode))
    return file.broken(place.offset, "a record declares " + std::to_string(place.length) +
                                         " bytes, more than any recording needs; the file is damaged");
  return file.read(place.content(), place.length, content);
}

Status load_chunk(const InputFile& file, const RecordPlace& place, std::vector<std::uint8_t>& content,
                  LoadedChunk& chunk) {
  if (Status status = read_content(file, place, content); !status.ok()) return status;
  Chunk& header = chunk.header;
  if (!parse(content, header)) return file.broken(place.offset, "the chunk is shorter than it declares");
  if (!is_known_compression(header.compression))
    return file.broken(place.offset,
                       "the chunk's compression is unknown; only lz4, zstd and none can be read");
  if (header.uncompressed_size > kLargestChunk)
    return file.broken(place.offset, "the chunk declares " + std::to_string(header.uncompressed_size) +
                                         " bytes of records; at most 16 MiB can be read");
  chunk.compressed_size = header.records.size();
  if (header.uncompressed_size > kLargestRatio * chunk.compressed_size + kLargestGift)
    return file.broken(place.offset, "the chunk declares " + std::to_string(header.uncompressed_size) +
                                         " bytes of records in " + std::to_string(chunk.compressed_size) +
                                         ", more than ticks can be compressed; the file is damaged");
  chunk.records.resize(header.uncompressed_size);
  if (!decompress(header.compression, header.records, chunk.records))
    return file.broken(place.offset, "the chunk cannot be decompressed; recover keeps the others");
  header.records = {};
  // A checksum of 0 stands for "not computed" (other tools may leave it out).
  if (header.uncompressed_crc != 0 && crc32(0, chunk.records) != header.uncompressed_crc)
    return file.broken(place.offset, "the chunk's checksum is wrong; recover keeps the others");
  return {};
}

bool find_inner_record(Bytes records, std::size_t offset, InnerRecord& record) {
  if (offset > records.size()) return false;
  ByteReader in(records.subspan(offset));
  record.opcode = static_cast<Opcode>(in.u8());
  record.content = in.take(in.u64());
  record.end = offset + in.position();
  return in.ok();
}

Status load_attachment(const InputFile& file, const RecordPlace& place, std::vector<std::uint8_t>& content,
                       Attachment& record) {
  if (Status status = read_content(file, place, content); !status.ok()) return status;
  if (!parse(content, record)) return file.broken(place.offset, "the attachment is shorter than it declares");
  if (record.crc != 0 && crc32(0, Bytes(content).first(record.checked_size)) != record.crc)
    return file.broken(place.offset, "the attachment's checksum is wrong; the scene in it is damaged");
  // To the front, where it is aligned and can be read without a copy: it may be all of a large file.
  const std::size_t size = record.data.size();
  if (size > 0) std::memmove(content.data(), record.data.data(), size);
  record.data = Bytes(content).first(size);
  return {};
}

Status read_start(const InputFile& file, Header& header, std::uint64_t& data_start) {
  std::vector<std::uint8_t> bytes;
  if (file.size() < kMagic.size()) return file.broken(0, "the file is too short to be an MCAP recording");
  if (Status status = file.read(0, kMagic.size(), bytes); !status.ok()) return status;
  if (!is_magic(bytes)) return file.broken(0, "this is not an MCAP file; name a recording");
  RecordPlace place;
  bool whole = false;
  if (Status status = find_record(file, kMagic.size(), file.size(), place, whole); !status.ok())
    return status;
  if (!whole || place.opcode != Opcode::header)
    return file.broken(kMagic.size(), "the file has no whole header record");
  if (Status status = read_content(file, place, bytes); !status.ok()) return status;
  if (!parse(bytes, header))
    return file.broken(place.offset, "the header record is shorter than it declares");
  data_start = place.end();
  return {};
}

namespace {

// The file's last bytes, its footer and where that is. One that names no summary where there is none.
Status find_footer(const InputFile& file, std::vector<std::uint8_t>& tail, Footer& footer,
                   std::uint64_t& footer_at) {
  footer = {};
  constexpr std::uint64_t kTail = kRecordHeaderSize + kFooterContentSize + kMagic.size();
  if (file.size() < kMagic.size() + kTail) return {};
  footer_at = file.size() - kTail;
  if (Status status = file.read(footer_at, kTail, tail); !status.ok()) return status;
  if (!is_magic(Bytes(tail).last(kMagic.size()))) return {};
  ByteReader in(tail);
  const bool is_footer = static_cast<Opcode>(in.u8()) == Opcode::footer && in.u64() == kFooterContentSize;
  if (!is_footer || !parse(in.take(kFooterContentSize), footer))
    return file.broken(footer_at, "the file has no whole footer; recover rebuilds it");
  if (footer.summary_start == 0) return {};
  if (footer.summary_start < kMagic.size() || footer.summary_start > footer_at)
    return file.broken(footer_at, "the footer points outside the file; recover rebuilds it");
  if (footer.summary_offset_start != 0 &&
      (footer.summary_offset_start < footer.summary_start || footer.summary_offset_start > footer_at))
    return file.broken(footer_at, "the footer points outside the summary; recover rebuilds it");
  return {};
}

}  // namespace

Status read_summary(const InputFile& file, Summary& summary, bool& present) {
  present = false;
  std::vector<std::uint8_t> tail;
  Footer footer;
  std::uint64_t footer_at = 0;
  if (Status status = find_footer(file, tail, footer, footer_at); !status.ok()) return status;
  if (footer.summary_start == 0) return {};

  summary.start = footer.summary_start;
  summary.offset_start = footer.summary_offset_start;
  std::uint32_t crc = 0;
  std::uint64_t offset = footer.summary_start;
  std::vector<std::uint8_t> bytes;
  while (offset < footer_at) {
    RecordPlace place;
    bool whole = false;
    if (Status status = find_record(file, offset, footer_at, place, whole); !status.ok()) return status;
    if (!whole) return file.broken(offset, "the summary ends in the middle of a record; recover rebuilds it");
    if (place.length > kLargestOtherRecord)
      return file.broken(offset,
                         "a record of the summary is larger than any needs to be; recover rebuilds it");
    if (Status status = file.read(offset, place.end() - offset, bytes); !status.ok()) return status;
    crc = crc32(crc, bytes);
    if (!add_to_summary(place.opcode, Bytes(bytes).subspan(kRecordHeaderSize), footer_at - summary.start,
                        summary))
      return file.broken(offset,
                         "the summary holds a record that is damaged or does not belong there; "
                         "recover rebuilds it");
    if (summary.groups.empty() || summary.groups.back().group != place.opcode)
      summary.groups.push_back({place.opcode, offset, 0});
    summary.groups.back().length += place.end() - offset;
    offset = place.end();
  }
  crc = crc32(crc, Bytes(tail).first(kRecordHeaderSize + kFooterContentSize - sizeof(std::uint32_t)));
  if (footer.summary_crc != 0 && footer.summary_crc != crc)
    return file.broken(summary.start, "the summary's checksum is wrong; recover rebuilds it");
  std::stable_sort(summary.chunks.begin(), summary.chunks.end(),
                   [](const ChunkIndex& a, const ChunkIndex& b) { return a.offset < b.offset; });
  present = true;
  return {};
}

}  // namespace lumbrical
