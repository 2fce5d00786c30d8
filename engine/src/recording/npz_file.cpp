// See npz_file.h. ZIP: APPNOTE 6.3.3, without its 64-bit extension; arrays: NumPy's format 1.0.
#include "recording/npz_file.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <string>

namespace lumbrical {
namespace {

constexpr std::uint64_t kMostBytes = 0xFFFFFFFFu;
constexpr std::uint16_t kDeflated = 8, kZipVersion = 20;
constexpr std::uint32_t kDate = 0x00210000;  // 1980-01-01, so that equal tables are equal files

using Buffer = std::vector<std::uint8_t>;

void put(Buffer& out, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i, value >>= 8) out.push_back(static_cast<std::uint8_t>(value));
}
// Not insert: with -O3 gcc 12 warns of an overflow in it that can't be.
void put(Buffer& out, std::string_view text) {
  for (const char c : text) out.push_back(static_cast<std::uint8_t>(c));
}

// What an archive says of an entry, before it and again in its directory.
void put(Buffer& out, const ZipEntry& entry) {
  put(out, kZipVersion, 2);
  put(out, 0, 2);
  put(out, kDeflated, 2);
  put(out, kDate, 4);
  put(out, entry.crc, 4);
  put(out, entry.packed, 4);
  put(out, entry.size, 4);
  put(out, entry.name.size(), 2);
}

// What stands before an array's bytes, a multiple of 64 long.
Buffer array_header(std::string_view type, std::size_t count) {
  std::string text = "{'descr': '" + std::string(type) + "', 'fortran_order': False, 'shape': (" +
                     std::to_string(count) + ",), }";
  while ((10 + text.size() + 1) % 64 != 0) text += ' ';
  text += '\n';
  Buffer header;
  put(header, "\x93NUMPY");
  put(header, 0x0001, 2);  // version 1.0
  put(header, text.size(), 2);
  put(header, text);
  return header;
}

// Deflated without zlib's own header, as ZIP has it. Empty where zlib fails.
Buffer deflated(std::span<const std::uint8_t> head, std::span<const std::uint8_t> bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  Buffer packed(deflateBound(&stream, static_cast<uLong>(head.size() + bytes.size())));
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  int result = Z_OK;
  for (const auto& [part, flush] : {std::pair{head, Z_NO_FLUSH}, std::pair{bytes, Z_FINISH}}) {
    stream.next_in = const_cast<Bytef*>(part.data());  // zlib only reads it
    stream.avail_in = static_cast<uInt>(part.size());
    result = deflate(&stream, flush);
  }
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return result == Z_STREAM_END ? packed : Buffer{};
}

}  // namespace

Status NpzFile::open(const std::string& path) {
  if (path == "-") return Status::error("a NumPy archive needs a file; name one with --output");
  path_ = path;
  return file_.open(path);
}

Status NpzFile::add_bytes(std::string_view name, std::string_view type, std::size_t count,
                          std::span<const std::uint8_t> bytes) {
  const Buffer header = array_header(type, count);
  if (file_.size() + 2 * (header.size() + bytes.size()) > kMostBytes)
    return Status::error(path_ + ": would be larger than 4 GiB; export fewer ticks or columns");
  ZipEntry entry;
  entry.name = std::string(name) + ".npy";
  entry.offset = static_cast<std::uint32_t>(file_.size());
  entry.size = static_cast<std::uint32_t>(header.size() + bytes.size());
  uLong crc = ::crc32(0, header.data(), static_cast<uInt>(header.size()));
  if (!bytes.empty()) crc = ::crc32(crc, bytes.data(), static_cast<uInt>(bytes.size()));  // null begins anew
  entry.crc = static_cast<std::uint32_t>(crc);
  const Buffer packed = deflated(header, bytes);
  if (packed.empty()) return Status::error(path_ + ": can't be compressed; is there memory left?");
  entry.packed = static_cast<std::uint32_t>(packed.size());

  Buffer local;
  put(local, 0x04034b50, 4);
  put(local, entry);
  put(local, 0, 2);
  put(local, entry.name);
  Status status = file_.write(local);
  if (status.ok()) status = file_.write(packed);
  entries_.push_back(std::move(entry));
  return status;
}

Status NpzFile::add(std::string_view name, std::string_view type, std::span<const std::uint64_t> values) {
  if constexpr (std::endian::native == std::endian::little)
    return add_bytes(name, type, values.size(),
                     {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()});
  Buffer bytes;
  for (const std::uint64_t value : values) put(bytes, value, 8);
  return add_bytes(name, type, values.size(), bytes);
}

Status NpzFile::add(std::string_view name, const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  Buffer bytes;
  for (const std::string& text : texts) {
    put(bytes, text);
    bytes.insert(bytes.end(), width - text.size(), 0);
  }
  return add_bytes(name, "|S" + std::to_string(width), texts.size(), bytes);
}

Status NpzFile::close() {
  Buffer directory;
  for (const ZipEntry& entry : entries_) {
    put(directory, 0x02014b50, 4);
    put(directory, kZipVersion, 2);
    put(directory, entry);
    put(directory, 0, 12);
    put(directory, entry.offset, 4);
    put(directory, entry.name);
  }
  const std::uint64_t start = file_.size(), size = directory.size();
  if (start + size > kMostBytes || entries_.size() > 0xFFFF)
    return Status::error(path_ + ": would be larger than 4 GiB; export fewer ticks or columns");
  put(directory, 0x06054b50, 4);
  put(directory, 0, 4);
  put(directory, entries_.size(), 2);
  put(directory, entries_.size(), 2);
  put(directory, size, 4);
  put(directory, start, 4);
  put(directory, 0, 2);
  Status status = file_.write(directory);
  return status.ok() ? file_.commit() : status;
}

}  // namespace lumbrical
