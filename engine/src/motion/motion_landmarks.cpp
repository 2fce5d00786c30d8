// CSV of 21 hand landmarks per line in MediaPipe's order, with or without a header and a leading time column.
#include <charconv>

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

struct Cell {
  std::string_view text;  // without blanks round it
  std::size_t column;     // of the line, from 1
};

std::string_view trimmed(std::string_view text, std::size_t& offset) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  offset += first;
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// The cells of a line; the vector is reused from line to line.
void split(std::string_view line, std::vector<Cell>& cells) {
  cells.clear();
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = line.find(',', start);
    std::size_t offset = start;
    const std::string_view text =
        trimmed(line.substr(start, comma == line.npos ? comma : comma - start), offset);
    cells.push_back({text, offset + 1});
    if (comma == line.npos) return;
    start = comma + 1;
  }
}

bool read_cell(std::string_view text, double& number) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc{} && result.ptr == text.data() + text.size() && is_finite(number);
}

// The lines of the file and where they are.
struct Reader {
  std::string_view rest;
  const std::string& name;
  std::size_t line_number = 0;
  std::vector<Cell> cells{};

  bool next_line() {
    while (!rest.empty()) {
      const std::size_t end = rest.find('\n');
      std::string_view line = rest.substr(0, end);
      rest = end == rest.npos ? std::string_view{} : rest.substr(end + 1);
      ++line_number;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      if (line.find_first_not_of(" \t") == line.npos) continue;
      split(line, cells);
      return true;
    }
    return false;
  }

  Status refuse_at(std::size_t column, const std::string& what) const {
    return Status::error(name + ":" + std::to_string(line_number) + ":" + std::to_string(column) + ": " +
                         what);
  }
};

// One frame's numbers: time, if there is one, then the points.
Status read_row(const Reader& reader, bool has_time, double unit, double& time,
                std::array<Vec3, kLandmarkCount>& points) {
  const std::size_t expected = kCoordinateCount + (has_time ? 1 : 0);
  if (reader.cells.size() != expected) {
    return reader.refuse_at(1, "found " + std::to_string(reader.cells.size()) + " columns instead of " +
                                   std::to_string(expected) +
                                   " (21 points, and a time only if the header names it first)");
  }
  std::array<double, kCoordinateCount> value{};
  for (std::size_t i = 0; i < expected; ++i) {
    const Cell& cell = reader.cells[i];
    double number = 0;
    if (!read_cell(cell.text, number)) {
      return reader.refuse_at(
          cell.column, in_quotes(cell.text) + " is not a finite number; remove the line or correct it");
    }
    if (has_time && i == 0) {
      time = number;
      continue;
    }
    number *= unit;
    if (!(std::fabs(number) <= kFarthest)) {
      return reader.refuse_at(cell.column, "the point lies more than 10 km away; set the file's unit");
    }
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

}  // namespace

Status parse_landmarks(std::string_view content, const std::string& name, const MotionOptions& options,
                       Motion& motion) {
  motion.format = "landmarks";
  const double unit = options.unit > 0 ? options.unit : 1;
  Reader reader{content, name};
  bool has_time = false;
  double lean = 0;
  std::vector<std::array<Vec3, kLandmarkCount>> rows;
  std::vector<double> times;
  std::vector<std::size_t> lines;
  for (bool is_first = true; reader.next_line(); is_first = false) {
    double ignored = 0;
    if (is_first && !read_cell(reader.cells[0].text, ignored)) {
      if (reader.cells.size() < kCoordinateCount) {
        return reader.refuse_at(
            1,
            "neither JSON, BVH nor a CSV of 21 landmarks; LZ-compressed LeapJS recordings must be "
            "saved uncompressed");
      }
      has_time = reader.cells[0].text == "time" || reader.cells[0].text == "t";
      continue;
    }
    double time = static_cast<double>(rows.size()) / options.rate;
    std::array<Vec3, kLandmarkCount> points;
    Status status = read_row(reader, has_time, unit, time, points);
    if (!status.ok()) return status;
    lean += palmar_lean(points);
    rows.push_back(points);
    times.push_back(time);
    lines.push_back(reader.line_number);
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
