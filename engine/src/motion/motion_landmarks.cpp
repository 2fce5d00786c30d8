// CSV of 21 hand landmarks per line in MediaPipe's order, with or without a header and a leading time column.
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

bool is_number(std::string_view word) {
  double ignored = 0;
  return read_finite(word, ignored) == nullptr;
}

// One line's numbers: time, if there is one, then the points.
Status read_row(TextCursor& cursor, const std::string& name, bool has_time, double unit, double& time,
                std::array<Vec3, kLandmarkCount>& points) {
  const std::size_t expected = kCoordinateCount + (has_time ? 1 : 0), found = count_words(cursor);
  if (found != expected) {
    return text_error(
        name, {cursor.place().line, 1},
        "found " + std::to_string(found) + " columns instead of " + std::to_string(expected) +
            " (21 points, and a time in seconds only if the header begins with time, timestamp or t)");
  }
  std::array<double, kCoordinateCount> value{};
  for (std::size_t i = 0; i < expected; ++i) {
    const std::string_view word = cursor.word();
    double number = 0;
    if (const char* const fault = read_finite(word, number))
      return text_error(name, cursor.place(),
                        in_quotes(word) + " " + fault + "; remove the line or correct it");
    if (has_time && i == 0) {
      time = number;
      continue;
    }
    number *= unit;
    if (!(std::fabs(number) <= kFarthest))
      return text_error(name, cursor.place(), "the point lies more than 10 km away; set the file's unit");
    value[has_time ? i - 1 : i] = number;
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
    TextCursor head = cursor;
    if (is_first && !is_number(head.word())) {
      if (count_words(cursor) < kCoordinateCount) {
        return text_error(name, {cursor.place().line, 1},
                          "neither JSON, BVH nor a CSV of 21 landmarks; LZ-compressed LeapJS recordings must "
                          "be saved uncompressed");
      }
      has_time = names_time(cursor);
      continue;
    }
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
