// CSV of 21 hand landmarks per line in MediaPipe's order, with or without a header and a leading time column.
#include <algorithm>
#include <array>

#include "motion/motion_formats.h"
#include "motion/motion_points.h"

namespace lumbrical {
namespace {

constexpr int kLandmarkCount = 21;
constexpr int kCoordinateCount = 3 * kLandmarkCount;

constexpr std::array<int, kLandmarkCount> kJointOfLandmark = {
    kWrist,     kThumbMetacarpal, kThumbProximal,      kThumbDistal,
    kThumbTip,  kIndexProximal,   kIndexIntermediate,  kIndexDistal,
    kIndexTip,  kMiddleProximal,  kMiddleIntermediate, kMiddleDistal,
    kMiddleTip, kRingProximal,    kRingIntermediate,   kRingDistal,
    kRingTip,   kLittleProximal,  kLittleIntermediate, kLittleDistal,
    kLittleTip};

std::size_t count_words(TextCursor line) {
  std::size_t count = 0;
  while (!line.word().empty()) ++count;
  return count;
}

// The number that is none, "nan", is one here.
bool is_number(std::string_view word) {
  double value = 0;
  return read_finite(word, value) == nullptr || !std::isfinite(value);
}

bool is_nan(std::string_view word) {
  double value = 0;
  return read_finite(word, value) != nullptr && std::isnan(value);
}

// Programs that write tables leave all cells of a frame without a hand blank, or write "nan" into them.
bool shows_no_hand(TextCursor row, std::size_t time_count, std::size_t expected) {
  const std::string_view line = row.line();
  const auto commas = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
  if (count_words(row) == time_count && commas + 1 >= expected) return true;
  if (count_words(row) != expected) return false;
  for (std::size_t i = 0; i < expected; ++i) {
    const std::string_view word = row.word();
    if (i >= time_count && !is_nan(word)) return false;
  }
  return true;
}

// One line's numbers: time, if there is one, then the points, all of them zero where the row shows no hand.
Status read_row(TextCursor& cursor, const std::string& name, bool has_time, double unit, double& time,
                std::array<Vec3, kLandmarkCount>& points) {
  const std::size_t time_count = has_time ? 1 : 0, expected = kCoordinateCount + time_count;
  const bool lost = shows_no_hand(cursor, time_count, expected);
  if (const std::size_t found = count_words(cursor); found != expected && !lost) {
    return text_error(
        name, {cursor.place().line, 1},
        "found " + std::to_string(found) + " columns instead of " + std::to_string(expected) +
            " (21 points, and a time in seconds only if the header begins with time, timestamp or t)");
  }
  std::array<double, kCoordinateCount> value{};
  for (std::size_t i = 0; i < (lost ? time_count : expected); ++i) {
    const std::string_view word = cursor.word();
    double number = 0;
    if (const char* const fault = read_finite(word, number))
      return text_error(name, cursor.place(),
                        in_quotes(word) + " " + fault + "; remove the line or correct it");
    if (i < time_count) {
      time = number;
      continue;
    }
    number *= unit;
    if (!(std::fabs(number) <= kFarthest))
      return text_error(name, cursor.place(), "the point lies more than 10 km away; set the file's unit");
    value[i - time_count] = number;
  }
  for (std::size_t i = 0; i < kLandmarkCount; ++i)
    points[i] = {value[3 * i], value[3 * i + 1], value[3 * i + 2]};
  return {};
}

// Trackers write the same point 21 times, mostly zeros, where they see no hand.
bool all_coincide(const std::array<Vec3, kLandmarkCount>& points) {
  for (const Vec3 p : points) {
    if (p != points[0]) return false;
  }
  return true;
}

HandPoints hand_of(const std::array<Vec3, kLandmarkCount>& points) {
  HandPoints hand;
  if (all_coincide(points)) return hand;
  for (std::size_t i = 0; i < kLandmarkCount; ++i) {
    hand.position[kJointOfLandmark[i]] = points[i];
    hand.known |= 1u << kJointOfLandmark[i];
  }
  return hand;
}

std::string bare(std::string_view title) {
  while (!title.empty() && (title.front() == '"' || title.front() == '\'')) title.remove_prefix(1);
  while (!title.empty() && (title.back() == '"' || title.back() == '\'')) title.remove_suffix(1);
  return lower_case(title);
}

// Does the first column hold seconds? "t [s]" is two words; any other unit is none of ours.
bool names_time(TextCursor header) {
  std::string title = bare(header.word());
  const std::string unit = bare(header.word());
  if (unit.substr(0, 1) == "[" || unit.substr(0, 1) == "(") title += unit;
  for (const std::string word : {"time", "timestamp", "t"})
    if (title == word || title == word + "[s]" || title == word + "(s)") return true;
  return false;
}

// Words, none of which is a number; but columns may be numbered behind a time.
bool is_header(TextCursor row) {
  if (is_number(TextCursor(row).word())) return false;
  if (names_time(row)) return true;
  for (std::string_view word = row.word(); !word.empty(); word = row.word())
    if (is_number(word)) return false;
  return true;
}

}  // namespace

Status parse_landmarks(std::string_view content, const std::string& name, const MotionOptions& options,
                       Motion& motion) {
  motion.format = "landmarks";
  const double unit = options.unit > 0 ? options.unit : 1;
  TextRules rules;
  rules.commas_separate = true;
  TextCursor cursor(content, rules);
  bool has_time = false;
  std::vector<HandPoints> frames;
  std::size_t row_count = 0;
  for (bool is_first = true; cursor.next_line(); is_first = false) {
    const std::size_t word_count = count_words(cursor);
    if (is_first && word_count > 0 && !is_number(TextCursor(cursor).word())) {
      if (word_count < kCoordinateCount) {
        return text_error(name, {cursor.place().line, 1},
                          "neither JSON, BVH nor a CSV of 21 landmarks; LZ-compressed LeapJS recordings must "
                          "be saved uncompressed");
      }
      has_time = names_time(cursor);
      if (is_header(cursor)) continue;
    }
    if (has_time && word_count == 0) continue;  // no frame: spreadsheets end so
    const std::size_t row = row_count++;
    double time = static_cast<double>(row) / options.rate;
    std::array<Vec3, kLandmarkCount> points;
    Status status = read_row(cursor, name, has_time, unit, time, points);
    const std::string place = name + ":" + std::to_string(cursor.place().line) + ":1";
    if (status.ok())
      status = append_points(place, "frame " + std::to_string(row), time, hand_of(points), frames, motion);
    if (!status.ok()) return status;
  }
  const std::string remedy = set_other_side(options.side.value_or(Side::right));
  return build_told_by_shape(name, options.side, remedy, frames, motion);
}

}  // namespace lumbrical
