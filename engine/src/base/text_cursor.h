// Walks through the words of a text file and turns them into numbers: what the readers of text share.
//
// Every word has a place (line and column, both from 1, columns in bytes), so that a message can point at it.
// Nothing here depends on the locale and nothing is copied.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

#include "lumbrical/math.h"
#include "lumbrical/status.h"

namespace lumbrical {

struct TextPlace {
  std::size_t line = 1;    ///< from 1
  std::size_t column = 1;  ///< from 1, in bytes
};

/// What the format adds to plain words and lines.
struct TextRules {
  bool hash_comments = false;        ///< '#' at the start of a word hides the rest of the line
  bool backslash_continues = false;  ///< a backslash right before a line end joins the two lines
  bool commas_separate = false;      ///< as blanks do; a line of nothing else is one without words, not none
};

/// Words are separated by blanks; lines end with LF, CR LF or CR. A byte order mark at the start is skipped.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text, TextRules rules = {}) : text_(text), rules_(rules) {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") at_ = line_start_ = word_at_ = 3;
  }

  /// Leaves the current line and stops before the first word of the next line that has one; the first call
  /// stops at the first such line of the text. False where the text ends.
  bool next_line() {
    if (started_) skip_line();
    started_ = true;
    for (;;) {
      const std::size_t before = at_;
      skip_blanks();
      word_at_ = at_;
      if (rules_.commas_separate && text_.substr(before, at_ - before).find(',') != text_.npos) return true;
      if (at_ == text_.size()) return false;
      if (!is_line_end(text_[at_])) return true;
      take_line_end();
    }
  }

  /// The next word of the current line; empty at the end of the line.
  std::string_view word() {
    started_ = true;
    skip_blanks();
    word_at_ = at_;
    while (at_ < text_.size() && !ends_word(at_)) ++at_;
    return text_.substr(word_at_, at_ - word_at_);
  }

  /// The next word on this line or a later one; empty at the end of the text.
  std::string_view word_across_lines() {
    for (;;) {
      const std::string_view found = word();
      if (!found.empty() || at_ == text_.size()) return found;
      take_line_end();
    }
  }

  void skip_line() {
    while (!word().empty()) continue;
  }

  /// All of the current line.
  std::string_view line() const {
    return text_.substr(line_start_, text_.find_first_of("\r\n", line_start_) - line_start_);
  }

  /// Where the last word began, or where one was looked for in vain.
  TextPlace place() const { return {line_, word_at_ - line_start_ + 1}; }
  /// Offset of the first byte not read yet.
  std::size_t offset() const { return at_; }
  std::size_t remaining() const { return text_.size() - at_; }

 private:
  bool is_blank(char c) const {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f' || (rules_.commas_separate && c == ',');
  }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  bool continues_at(std::size_t at) const {
    return rules_.backslash_continues && text_[at] == '\\' && at + 1 < text_.size() &&
           is_line_end(text_[at + 1]);
  }
  bool ends_word(std::size_t at) const {
    return is_blank(text_[at]) || is_line_end(text_[at]) || continues_at(at);
  }

  void skip_blanks() {
    while (at_ < text_.size()) {
      if (is_blank(text_[at_])) {
        ++at_;
      } else if (rules_.hash_comments && text_[at_] == '#') {
        while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
      } else if (continues_at(at_)) {
        ++at_;
        take_line_end();
      } else {
        return;
      }
    }
  }

  void take_line_end() {
    if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
    ++at_;
    ++line_;
    line_start_ = at_;
  }

  std::string_view text_;
  TextRules rules_;
  std::size_t at_ = 0;          // first byte not read yet
  std::size_t word_at_ = 0;     // where the last word began
  std::size_t line_ = 1;        // number of the line at_ is in
  std::size_t line_start_ = 0;  // offset of that line
  bool started_ = false;        // a word was taken or next_line() was called
};

/// "name:line:column: what".
inline Status text_error(std::string_view name, TextPlace place, const std::string& what) {
  return Status::error(std::string(name) + ":" + std::to_string(place.line) + ":" +
                       std::to_string(place.column) + ": " + what);
}

/// Text of a file in quotes, short and printable whatever the file holds.
inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t kShown = 32;
  std::string shown = "'";
  for (const char c : text.substr(0, kShown)) shown += c >= ' ' && c < '\x7f' ? c : '?';
  return shown + (text.size() > kShown ? "...'" : "'");
}

/// ASCII only, so that no locale can change what a file means.
inline std::string lower_case(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

/// Is this number, which no double can hold, too small rather than too large? Told by the decimal exponent of
/// its first digit that is not zero.
inline bool underflows(std::string_view number) {
  const std::size_t exponent_at = number.find_first_of("eE");
  const std::string_view mantissa = number.substr(0, exponent_at);
  const std::size_t digit = mantissa.find_first_of("123456789");
  if (digit == std::string_view::npos) return true;
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const double shift = static_cast<double>(point) - static_cast<double>(digit);
  if (exponent_at == std::string_view::npos) return shift < 0;

  std::string_view exponent = number.substr(exponent_at + 1);
  const bool negative = exponent.substr(0, 1) == "-";
  if (negative || exponent.substr(0, 1) == "+") exponent.remove_prefix(1);
  std::uint64_t size = 0;
  const auto result = std::from_chars(exponent.data(), exponent.data() + exponent.size(), size);
  if (result.ec != std::errc()) return negative;
  return static_cast<double>(size) * (negative ? -1.0 : 1.0) + shift < 0;
}

/// Reads the whole word as a number. Answers null, or else what is wrong with the word: not a number, not
/// finite, or too large for a double. Numbers too small for a double become 0.
inline const char* read_finite(std::string_view word, double& value) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  const char* const end = digits.data() + digits.size();
  const std::from_chars_result result = std::from_chars(digits.data(), end, value);
  if (result.ptr != end || result.ec == std::errc::invalid_argument) return "is not a number";
  if (result.ec == std::errc::result_out_of_range) {
    if (!underflows(digits)) return "is too large";
    value = 0;
  }
  return std::isfinite(value) ? nullptr : "is not finite";
}

/// Reads the whole word as an integer; false where it is none or does not fit into 64 bits.
inline bool read_integer(std::string_view word, std::int64_t& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const std::from_chars_result result = std::from_chars(word.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

/// Reads the next three words of the line as a point with finite coordinates.
inline Status read_point(TextCursor& cursor, std::string_view name, Vec3& point) {
  double coordinate[3];
  for (double& value : coordinate) {
    const std::string_view word = cursor.word();
    if (word.empty()) {
      return text_error(name, cursor.place(),
                        "the line ends before the third coordinate; re-export the mesh");
    }
    if (const char* fault = read_finite(word, value)) {
      return text_error(name, cursor.place(),
                        "coordinate " + in_quotes(word) + " " + fault + "; repair or re-export the mesh");
    }
  }
  point = {coordinate[0], coordinate[1], coordinate[2]};
  return {};
}

}  // namespace lumbrical
