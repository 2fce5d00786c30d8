// Text for tables and JSON.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace lumbrical::bench {

/// printf into a string of up to 2000 characters.
[[gnu::format(printf, 1, 2)]] inline std::string print(const char* format, ...) {
  char text[2000];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

/// As a JSON string; control characters other than line ends are left out.
inline std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (c == '\n') result += "\\n";
    if (static_cast<unsigned char>(c) >= 0x20) result += c;
  }
  return result + '"';
}

}  // namespace lumbrical::bench
