// Numbers and texts of MCAP records to bytes and back.
#include "recording/mcap_format.h"

#include <zlib.h>

namespace lumbrical::mcap {
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

}  // namespace lumbrical::mcap
