// Standard input in the place of a file: what "-" names.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

#include "lumbrical/status.h"

namespace lumbrical {

inline bool names_standard_input(const std::string& path) { return path == "-"; }

/// How messages call the file at a path.
inline std::string shown_name(const std::string& path) {
  return names_standard_input(path) ? "standard input" : path;
}

/// All there is to its end, at most `most` bytes.
inline Status read_standard_input(std::uintmax_t most, std::string& content) {
  content.clear();
  std::array<char, 65536> block{};
  while (const std::size_t size = std::fread(block.data(), 1, block.size(), stdin)) {
    if (size > most - content.size())
      return Status::error("standard input: more than it may hold; use a file");
    content.append(block.data(), size);
  }
  return std::ferror(stdin) == 0 ? Status{} : Status::error("standard input: can't be read to its end");
}

}  // namespace lumbrical
