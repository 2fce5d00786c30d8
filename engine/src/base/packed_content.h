// Tells content that has to be unpacked, or saved in other letters, before any reader can make sense of it.
#pragma once

#include <string_view>

namespace lumbrical {

/// What it is and what to do, by its first bytes, whatever its name promises; null of what may be read.
inline const char* how_to_unpack(std::string_view content) {
  constexpr struct {
    std::string_view start;
    const char* what;
  } kPacked[] = {
      {"\x1f\x8b", "the file is compressed; unpack it first (gunzip)"},
      {"PK\x03\x04", "the file is an archive; unpack it first (unzip)"},
      {"\3757zXZ", "the file is compressed; unpack it first (unxz)"},
      {"\x28\xb5\x2f\xfd", "the file is compressed; unpack it first (unzstd)"},
      {"7z\xbc\xaf", "the file is an archive; unpack it first (7z x)"},
      {"\xFF\xFE", "the text is in UTF-16; save it in UTF-8"},
      {"\xFE\xFF", "the text is in UTF-16; save it in UTF-8"},
  };
  for (const auto& packed : kPacked)
    if (content.substr(0, packed.start.size()) == packed.start) return packed.what;
  return nullptr;
}

}  // namespace lumbrical
