// What a benchmark program says of its command line.
#pragma once

#include <cstdio>
#include <string_view>

namespace lumbrical::bench {

inline bool asks_for_help(int count, const char* const* words) {
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    if (word == "--help" || word == "-h") return true;
  }
  return false;
}

/// Any; "-" is none.
inline bool has_switch(int count, const char* const* words) {
  for (int i = 1; i < count; ++i) {
    if (words[i][0] == '-' && words[i][1] != 0) return true;
  }
  return false;
}

/// What main() answers then: 0 where someone asks for help, else 2.
inline int tell_usage(const char* text, int count, const char* const* words) {
  const bool help = asks_for_help(count, words);
  std::fprintf(help ? stdout : stderr, "usage: %s\n", text);
  return help ? 0 : 2;
}

}  // namespace lumbrical::bench
