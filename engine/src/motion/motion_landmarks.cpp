// CSV of 21 hand landmarks per line in MediaPipe's order, with or without a header and a leading time column.
#include "model/hand_from_positions.h"
#include "motion/motion_formats.h"

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

DeviceFrame frame_of(const std::array<Vec3, kLandmarkCount>& points, Side side) {
  if (all_coincide(points)) return lost_frame();
  HandPoints hand;
  hand.side = side;
  for (std::size_t i = 0; i < kLandmarkCount; ++i) {
    hand.position[kJointOfLandmark[i]] = points[i];
    hand.known |= 1u << kJointOfLandmark[i];
  }
  const std::array<Pose, kJointCount> poses = hand_from_positions(hand);
  DeviceFrame frame;
  for (int j = 0; j < kJointCount; ++j) frame.joint[j] = to_joint_pose(poses[j]);
  return frame;
}

// How far the fingertips lean to the palmar side of the palm, if it is a right hand's, as the sine of an
// angle; negative on a left hand, and near zero where the fingers are straight. Fingers bend far to one side
// only.
double palmar_lean(const std::array<Vec3, kLandmarkCount>& points) {
  constexpr int kIndexBase = 5, kLittleBase = 17;
  const Vec3 palmar = unit_or(cross(points[kIndexBase] - points[0], points[kLittleBase] - points[0]), {});
  double sum = 0;
  for (std::size_t base = kIndexBase; base <= kLittleBase; base += 4) {
    sum += dot(unit_or(points[base + 3] - points[base], {}), palmar);
  }
  return 0.25 * sum;
}

Status choose_side(const std::string& name, double lean, const std::optional<Side>& asked, Side& side) {
  constexpr double kTelling = 0.25;  // beyond what flat hands differ by
  const Side bent = lean < 0 ? Side::left : Side::right;
  side = std::fabs(lean) < kTelling ? asked.value_or(Side::right) : bent;
  if (asked.value_or(side) == side) return {};
  return refuse(name, "as a " + std::string(side_name(other_side(side))) +
                          " hand its fingers would bend backwards; set the side to " +
                          std::string(side_name(side)));
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
  double lean = 0;
  std::vector<std::array<Vec3, kLandmarkCount>> rows;
  std::vector<double> times;
  std::vector<std::size_t> lines;
  for (bool is_first = true; cursor.next_line(); is_first = false) {
    TextCursor head = cursor;
    const std::string_view first = head.word();
    if (is_first && !is_number(first)) {
      if (count_words(cursor) < kCoordinateCount) {
        return text_error(name, {cursor.place().line, 1},
                          "neither JSON, BVH nor a CSV of 21 landmarks; LZ-compressed LeapJS recordings must "
                          "be saved uncompressed");
      }
      has_time = names_time(cursor);
      continue;
    }
    double time = static_cast<double>(rows.size()) / options.rate;
    std::array<Vec3, kLandmarkCount> points;
    Status status = read_row(cursor, name, has_time, unit, time, points);
    if (!status.ok()) return status;
    lean += palmar_lean(points);
    rows.push_back(points);
    times.push_back(time);
    lines.push_back(cursor.place().line);
  }
  const double mean_lean = rows.empty() ? 0 : lean / static_cast<double>(rows.size());
  Status status = choose_side(name, mean_lean, options.side, motion.side);
  for (std::size_t i = 0; status.ok() && i < rows.size(); ++i) {
    status = append_sample(name + ":" + std::to_string(lines[i]) + ":1", "frame " + std::to_string(i),
                           times[i], frame_of(rows[i], motion.side), motion);
  }
  return status;
}

}  // namespace lumbrical
