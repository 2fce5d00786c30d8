#include "model/ranges.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace lumbrical {

// emscripten's library has no to_chars of numbers with a fraction.
std::string text_of(double number) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.15g", number);
  std::string text = digits.data();
  std::replace(text.begin(), text.end(), ',', '.');  // whatever the host's locale is
  return text;
}

std::string text_of(const Range& range) {
  return text_of(range.low) + " to " + text_of(range.high) + range.unit;
}

}  // namespace lumbrical
