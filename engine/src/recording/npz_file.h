// NumPy archives: a ZIP file of arrays, one by one.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/output_file.h"

namespace lumbrical {

/// A file in an archive; sizes and offset in bytes.
struct ZipEntry {
  std::string name;
  std::uint32_t crc = 0, packed = 0, size = 0, offset = 0;
};

/// Writes arrays that numpy.load(path) reads by their names. The archive stays below 4 GiB, as ZIP without
/// extensions does.
class NpzFile {
 public:
  Status open(const std::string& path);
  /// 64 bits each, of the NumPy type "<f8", "<u8"; the bytes are those of the machine's numbers.
  Status add(std::string_view name, std::string_view type, std::span<const std::uint64_t> values);
  /// An array of texts in ASCII.
  Status add(std::string_view name, const std::vector<std::string>& texts);
  /// Writes the directory and puts the file in its place.
  Status close();
  void discard() { file_.discard(); }

 private:
  Status add_bytes(std::string_view name, std::string_view type, std::size_t count,
                   std::span<const std::uint8_t> bytes);

  std::string path_;
  OutputFile file_;
  std::vector<ZipEntry> entries_;
};

}  // namespace lumbrical
