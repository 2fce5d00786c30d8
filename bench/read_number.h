// Numbers of a benchmark's command line.
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

namespace lumbrical::bench {

/// A number from 0 to `most`, the whole text of it; false, and `number` as it was: it is none.
template <class Number>
bool read_number_or_0(std::string_view text, Number most, Number& number) {
  Number read = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), read);
  if (error != std::errc() || end != text.data() + text.size() || !(read >= 0 && read <= most)) return false;
  number = read;
  return true;
}

/// The same of one above 0.
template <class Number>
bool read_number(std::string_view text, Number most, Number& number) {
  Number read = 0;
  if (!read_number_or_0(text, most, read) || !(read > 0)) return false;
  number = read;
  return true;
}

}  // namespace lumbrical::bench
