#include "model/ranges.h"

#include <array>
#include <charconv>
#include <cmath>

namespace lumbrical {

std::string text_of(double number) {
  std::array<char, 40> text{};
  char* const end = text.data() + text.size();
  const bool plain = number == 0 || (std::fabs(number) < 1e10 && std::fabs(number) >= 1e-4);
  const auto format = plain ? std::chars_format::fixed : std::chars_format::general;
  return {text.data(), std::to_chars(text.data(), end, number, format).ptr};
}

std::string text_of(const Range& range) {
  return text_of(range.low) + " to " + text_of(range.high) + range.unit;
}

}  // namespace lumbrical
