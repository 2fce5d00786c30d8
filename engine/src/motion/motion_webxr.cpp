// WebXR and OpenXR joint poses: one pose of 4x4 matrices, or a sequence of frames with quaternions.
#include <nlohmann/json.hpp>

#include "model/hand_from_positions.h"
#include "motion/motion_formats.h"

namespace lumbrical {
namespace {

using nlohmann::json;

// The engine's name of a joint from any of the styles in use: words without prefixes, suffixes and "finger".
std::string plain_name(std::string_view text) {
  std::string plain, word;
  const auto finish_word = [&] {
    const bool filler = word.empty() || word == "xr" || word == "hand" || word == "joint" || word == "ext" ||
                        word == "finger" || word == "phalanx";
    if (!filler) plain += (plain.empty() ? "" : " ") + (word == "pinky" ? "little" : word);
    word.clear();
  };
  for (const char c : text) {
    if (c == '-' || c == '_' || c == ' ') {
      finish_word();
    } else {
      word += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
  finish_word();
  return plain;
}

int find_joint(std::string_view text) {
  if (text.size() > 64) return -1;
  return parse_joint(plain_name(text)).value_or(-1);
}

constexpr std::uint32_t bit(int joint) { return 1u << joint; }

struct Joints {
  std::array<Pose, kJointCount> pose;
  std::uint32_t given = 0;  // bit j: the file has joint j
};

// Columns x, y, z axis and position. Refuses what is no rigid transform: scale, shear, reflection.
bool read_matrix(const json* value, double unit, Pose& pose) {
  if (!value || !value->is_array() || value->size() != 16) return false;
  std::array<double, 16> m{};
  for (std::size_t i = 0; i < 16; ++i) {
    if (!read_number(&(*value)[i], m[i])) return false;
  }
  constexpr double kTolerance = 0.01;
  const auto near = [](double a, double b) { return std::fabs(a - b) <= kTolerance; };
  if (!near(m[3], 0) || !near(m[7], 0) || !near(m[11], 0) || !near(m[15], 1)) return false;
  const Vec3 x{m[0], m[1], m[2]}, y{m[4], m[5], m[6]}, z{m[8], m[9], m[10]};
  if (!near(dot(x, x), 1) || !near(dot(y, y), 1) || !near(dot(z, z), 1)) return false;
  if (!near(dot(cross(x, y), z), 1)) return false;
  const Vec3 position{unit * m[12], unit * m[13], unit * m[14]};
  for (const double coordinate : {position.x, position.y, position.z}) {
    if (!(std::fabs(coordinate) <= kFarthest)) return false;
  }
  pose = pose_along(position, -z, y);
  return true;
}

Status read_pose(const std::string& name, const std::string& where, const json& value, double unit,
                 Pose& pose) {
  if (find_member(value, "offsetMatrix")) {
    if (read_matrix(find_member(value, "offsetMatrix"), unit, pose)) return {};
    return refuse(name, where + "\"offsetMatrix\" must be 16 numbers of a rigid transform, column by column");
  }
  if (!read_position(find_member(value, "position"), unit, pose.position)) {
    return refuse(name, where + "\"position\" must be three numbers within 10 km");
  }
  if (!read_quaternion(find_member(value, "orientation"), false, pose.orientation)) {
    return refuse(name, where + "\"orientation\" must be a unit quaternion [x,y,z,w]");
  }
  return {};
}

// Each joint's first radius counts.
Status read_radius(const std::string& name, const std::string& where, const json& value, double unit,
                   double& radius) {
  const json* given = find_member(value, "radius");
  if (!given) return {};
  double number = 0;
  if (!read_number(given, number) || number < 0 || !(number * unit <= kLargestRadius)) {
    return refuse(name, where + "\"radius\" must be between 0 and 0.2 m; set the file's unit");
  }
  if (radius == 0) radius = number * unit;
  return {};
}

Status read_joints(const std::string& name, const std::string& where, const json& object, double unit,
                   Joints& joints, Motion& motion) {
  for (const auto& [key, value] : object.items()) {
    const int j = find_joint(key);
    if (j < 0) return refuse(name, where + in_quotes(key) + " is no joint of WebXR or OpenXR");
    const std::string at = where + std::string(joint_name(j)) + ": ";
    if ((joints.given & bit(j)) != 0) return refuse(name, at + "given twice under different names");
    joints.given |= bit(j);
    Status status = read_pose(name, at, value, unit, joints.pose[j]);
    if (status.ok()) status = read_radius(name, at, value, unit, motion.radius[j]);
    if (!status.ok()) return status;
  }
  constexpr std::uint32_t kPalmNeeds = bit(kMiddleMetacarpal) | bit(kMiddleProximal);
  if ((joints.given & bit(kPalm)) == 0 && (joints.given & kPalmNeeds) == kPalmNeeds) {
    joints.pose[kPalm] = palm_between(joints.pose[kMiddleMetacarpal], joints.pose[kMiddleProximal]);
    joints.given |= bit(kPalm);
  }
  return {};
}

// A joint that is not given stays where it was last, at first in the wrist: finite, and not valid.
DeviceFrame frame_of(const Joints& joints, const Motion& motion) {
  DeviceFrame frame;
  frame.valid = joints.given;
  const bool is_first = motion.samples.empty() || (motion.samples.back().frame.flags & kTrackingLost) != 0;
  for (int j = 0; j < kJointCount; ++j) {
    if ((joints.given & bit(j)) != 0) {
      frame.joint[j] = to_joint_pose(joints.pose[j]);
    } else {
      frame.joint[j] = is_first ? to_joint_pose(joints.pose[kWrist]) : motion.samples.back().frame.joint[j];
    }
  }
  return frame;
}

Status parse_single_pose(const json& root, const std::string& name, double unit, Motion& motion) {
  const json& transforms = *find_member(root, "jointTransforms");
  if (!transforms.is_object()) return refuse(name, "\"jointTransforms\" must be an object");
  Joints joints;
  Status status = read_joints(name, "", transforms, unit, joints, motion);
  if (!status.ok()) return status;
  for (int j = 0; j < kJointCount; ++j) {
    if ((joints.given & bit(j)) == 0 && j != kPalm) {
      return refuse(name, std::string(joint_name(j)) + " is missing; all 25 joints of WebXR are needed");
    }
  }
  return append_sample(name, "frame 0", 0, frame_of(joints, motion), motion);
}

Status parse_sequence(const json& root, const std::string& name, double unit, Motion& motion) {
  for (std::size_t i = 0; i < root.size(); ++i) {
    const std::string where = "frame " + std::to_string(i);
    double time = 0;
    if (!read_number(find_member(root[i], "time"), time)) {
      return refuse(name, where + ": \"time\" must be a number [s]");
    }
    const json* given = find_member(root[i], "joints");
    if (!given || !(given->is_object() || given->is_null())) {
      return refuse(name, where + ": \"joints\" must be an object, or null where no hand was seen");
    }
    Joints joints;
    Status status =
        given->is_object() ? read_joints(name, where + ": ", *given, unit, joints, motion) : Status{};
    if (!status.ok()) return status;
    const bool lost = (joints.given & bit(kWrist)) == 0;
    status = append_sample(name, where, time, lost ? lost_frame() : frame_of(joints, motion), motion);
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace

Status parse_webxr(const json& root, const std::string& name, const MotionOptions& options, Motion& motion) {
  motion.format = "webxr";
  const double unit = options.unit > 0 ? options.unit : 1;
  Status status = root.is_array() ? parse_sequence(root, name, unit, motion)
                                  : parse_single_pose(root, name, unit, motion);
  motion.side = options.side.value_or(right_handedness(motion) < 0 ? Side::left : Side::right);
  return status;
}

}  // namespace lumbrical
