// Numbers of a benchmark's command line.
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>
#include <system_error>

namespace lumbrical::bench {

/// A number above 0 to `most`, the whole text of it; false, and `number` as it was: it is none.
template <class Number>
bool read_number(std::string_view text, Number most, Number& number) {
  Number read = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), read);
  if (error != std::errc() || end != text.data() + text.size() || !(read > 0 && read <= most)) return false;
  number = read;
  return true;
}

}  // namespace lumbrical::bench
