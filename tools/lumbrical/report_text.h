// printf into a string, for SVG.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace lumbrical::tool {

/// Up to 511 bytes; what is longer is cut. Text of others goes beside it, escaped.
template <class... Values>
std::string print(const char* format, Values... values) {
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace lumbrical::tool
