// Files that are read as a whole, or standard input in the place of one: what "-" names.
#pragma once

#include <cstdint>
#include <string>

#include "lumbrical/status.h"

namespace lumbrical {

/// How messages call the file at a path.
std::string shown_name(const std::string& path);

/// Reads a regular file, or "-" for standard input, of at most `most` bytes. `wanted` ("a JSON file") tells
/// whoever named something else what to name.
Status read_whole_file(const std::string& path, std::uintmax_t most, const char* wanted,
                       std::string& content);

/// Of files that people write by hand, or little larger ones [bytes].
inline constexpr std::uintmax_t kSmallFile = std::uintmax_t{16} << 20;

}  // namespace lumbrical
