// Files that people write by hand, or little larger ones, read as a whole.
#pragma once

#include <string>

#include "lumbrical/status.h"

namespace lumbrical {

/// Reads a regular file, or "-" for standard input, of at most 16 MiB. `wanted` ("a JSON file") tells whoever
/// named something else what to name.
Status read_small_file(const std::string& path, const char* wanted, std::string& content);

}  // namespace lumbrical
