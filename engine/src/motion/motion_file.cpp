// Tells the format of a motion file by its content, lets that format's reader read it, and checks what all
// have in common: time, completeness, size and side of the hand.
#include "base/floating_point.h"
#include "base/packed_content.h"
#include "base/set_bits.h"
#include "model/json_text.h"
#include "motion/motion_formats.h"

#include <array>
#include <new>
#include <nlohmann/json.hpp>

namespace lumbrical {
namespace {

using nlohmann::json;

constexpr int kDeepest = 32;              // nesting of JSON
constexpr double kFarthestFromWrist = 1;  // [m] as the engine's own plausibility limit
constexpr double kSmallestReach = 0.005;  // [m] of some joint from the wrist

std::string at_byte(std::string_view content, const std::string& name, std::size_t byte) {
  std::size_t line = 1, column = 1;
  for (std::size_t i = 0; i < byte && i < content.size(); ++i) {
    ++column;
    if (content[i] == '\n') {
      ++line;
      column = 1;
    }
  }
  return name + ":" + std::to_string(line) + ":" + std::to_string(column);
}

std::string_view without_byte_order_mark(std::string_view content) {
  return content.substr(0, 3) == "\xEF\xBB\xBF" ? content.substr(3) : content;
}

bool looks_like_json(std::string_view content) {
  const std::size_t first = content.find_first_not_of(" \t\r\n");
  return first != content.npos && (content[first] == '{' || content[first] == '[');
}

bool looks_like_bvh(std::string_view content) {
  const std::size_t first = content.find_first_not_of(" \t\r\n");
  return first != content.npos && content.substr(first, 9) == "HIERARCHY";
}

// Captures that people have and that are not read, by their file names or by words near their start, and the
// way out. All of them hold parameters of a model, which only that model turns into joints.
struct Foreign {
  std::string_view ending, word;
  const char* what;
};

constexpr const char* kToLandmarks =
    " is not read; let its model compute the 21 joints and save them as CSV (wrist, then thumb to little "
    "finger, base to "
    "tip; x,y,z in metres)";
constexpr Foreign kForeign[] = {
    {"", "umetrack", "UmeTrack"},
    {"", "wrist_xform", "UmeTrack"},
    {"", "wrist_transforms", "UmeTrack"},
    {"", "hand_pose_labels", "UmeTrack"},
    {"", "mano_pose", "MANO"},
    {"", "\"betas\"", "MANO"},
    {".pkl", "", "MANO (pickled)"},
    {".npz", "", "MANO (NumPy archive)"},
    {".npy", "", "a NumPy array"},
    {".bag", "", "a ROS bag"},
    {".c3d", "", "C3D (markers)"},
    {".trc", "", "TRC (markers)"},
};

Status refuse_foreign(std::string_view content, const std::string& name) {
  constexpr std::size_t kLookedAt = 4096;
  const std::string start = lower_case(content.substr(0, kLookedAt));
  const std::string file = lower_case(name);
  if (start.substr(0, 11) == "kaydara fbx" || file.ends_with(".fbx"))
    return refuse(name, "FBX is not read; open it in Blender and export BVH");
  for (const Foreign& format : kForeign) {
    const bool named = !format.ending.empty() && file.ends_with(format.ending);
    const bool said = !format.word.empty() && (start.find(format.word) != start.npos);
    if (named || said) return refuse(name, std::string(format.what) + kToLandmarks);
  }
  return {};
}

Status parse_json_motion(std::string_view content, const std::string& name, const MotionOptions& options,
                         Motion& motion) {
  json root;
  Status status = parse_json(content, name, root);
  if (!status.ok()) return status;
  if (root.is_array() || find_member(root, "jointTransforms"))
    return parse_webxr(root, name, options, motion);
  if (find_member(root, "format")) return parse_angles(root, name, options, motion);
  if (find_member(root, "frames")) return parse_leap(root, content.size(), name, options, motion);
  return refuse(
      name,
      "not a hand motion that is read: expected \"jointTransforms\" (WebXR), \"frames\" (LeapJS), \"format\" "
      "(joint angles) or an array of frames (WebXR)");
}

bool is_lost(const MotionSample& sample) { return (sample.frame.flags & kTrackingLost) != 0; }

// Lost samples repeat the last good pose, leading ones the first; times start from 0.
Status complete_samples(const std::string& name, Motion& motion) {
  const MotionSample* good = nullptr;
  for (const MotionSample& sample : motion.samples) {
    if (!is_lost(sample)) {
      good = &sample;
      break;
    }
  }
  if (!good) {
    if (motion.samples.empty()) return refuse(name, "no samples; record at least one");
    std::string what = "no frame shows a whole hand";
    if (motion.other_frames > 0)
      what += " that was asked for; " + std::to_string(motion.other_frames) + " of its frames show a " +
              std::string(side_name(motion.other_side)) + " one; set the side";
    return refuse(name, what);
  }
  const double start = motion.samples.front().time;
  for (MotionSample& sample : motion.samples) {
    sample.time -= start;
    if (is_lost(sample)) {
      const std::uint32_t flags = sample.frame.flags;
      sample.frame = good->frame;
      sample.frame.flags = flags;
    } else {
      good = &sample;
    }
  }
  return {};
}

Vec3 position_of(const DeviceFrame& frame, int joint) {
  const std::array<float, 3>& p = frame.joint[joint].position;
  return {p[0], p[1], p[2]};
}

bool is_valid(const DeviceFrame& frame, int joint) { return has_bit(frame.valid, joint); }

// A hand a thousand times too large or small is a wrong unit.
Status check_size(const std::string& name, const Motion& motion) {
  for (std::size_t i = 0; i < motion.samples.size(); ++i) {
    const DeviceFrame& frame = motion.samples[i].frame;
    double reach = 0;
    for (int j = 0; j < kJointCount; ++j) {
      if (!is_valid(frame, j)) continue;
      const double distance = norm(position_of(frame, j) - position_of(frame, kWrist));
      reach = max(reach, distance);
      if (distance <= kFarthestFromWrist) continue;
      return refuse(name, "sample " + std::to_string(i) + ": " + std::string(joint_name(j)) + " is " +
                              std::to_string(distance) + " m from the wrist; set the file's unit");
    }
    const bool wrist_alone = frame.valid == 1u << kWrist;  // has no length
    if (reach < kSmallestReach && !wrist_alone) {
      return refuse(name, "sample " + std::to_string(i) + ": the hand is only " +
                              std::to_string(reach * 1000) + " mm long; set the file's unit");
    }
  }
  return {};
}

// Where the back of the hand is known, the side of the thumb tells which hand it is.
Status check_side(const std::string& name, const Motion& motion) {
  const double sign = motion.side == Side::right ? 1 : -1;
  if (sign * right_handedness(motion) > -0.3) return {};
  const Side other = other_side(motion.side);
  return refuse(name, "taken for a " + std::string(side_name(motion.side)) +
                          " hand, but its thumb is on the other side of the palm; set the side to " +
                          std::string(side_name(other)));
}

Status check_options(const std::string& name, const MotionOptions& options) {
  if (!(options.rate > 0 && options.rate <= 1e6))
    return refuse(name, "the rate must be > 0 and at most 1e6 Hz");
  if (!(options.unit >= 0 && options.unit <= 1e3))
    return refuse(name, "the unit must be > 0 (or 0) and at most 1000 m");
  return {};
}

Status parse_checked(std::string_view content, const std::string& name, const MotionOptions& options,
                     Motion& motion) {
  Status status = check_options(name, options);
  if (!status.ok()) return status;
  Motion parsed;
  content = without_byte_order_mark(content);
  status = refuse_foreign(content, name);
  if (!status.ok()) return status;
  if (const char* const what = how_to_unpack(content)) return refuse(name, what);
  if (looks_like_json(content))
    status = parse_json_motion(content, name, options, parsed);
  else if (looks_like_bvh(content))
    status = parse_bvh(content, name, options, parsed);
  else
    status = parse_landmarks(content, name, options, parsed);
  if (status.ok()) status = complete_samples(name, parsed);
  if (status.ok() && parsed.samples.front().frame.kind == InputKind::joint_poses) {
    status = check_size(name, parsed);
    if (status.ok()) status = check_side(name, parsed);
  }
  if (status.ok()) motion = std::move(parsed);
  return status;
}

}  // namespace

Status parse_json(std::string_view content, const std::string& name, json& root) {
  const JsonFault fault = parse_json_text(content, kDeepest, root);
  if (fault.what.empty()) return {};
  return Status::error(at_byte(content, name, fault.byte) + ": " + fault.what +
                       "; correct it or record again");
}

const json* find_member(const json& object, std::string_view key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

bool read_number(const json* value, double& number) {
  if (!value || !value->is_number()) return false;
  number = value->get<double>();
  return is_finite(number);
}

bool read_position(const json* value, double unit, Vec3& position) {
  if (!value || !value->is_array() || value->size() != 3) return false;
  double* const coordinate[3] = {&position.x, &position.y, &position.z};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!read_number(&(*value)[i], *coordinate[i])) return false;
    *coordinate[i] *= unit;
    if (!(std::fabs(*coordinate[i]) <= kFarthest)) return false;
  }
  return true;
}

bool read_quaternion(const json* value, bool first_is_w, Quat& quaternion) {
  if (!value || !value->is_array() || value->size() != 4) return false;
  std::array<double, 4> q{};
  for (std::size_t i = 0; i < 4; ++i) {
    if (!read_number(&(*value)[i], q[i])) return false;
  }
  const Quat raw = first_is_w ? Quat{q[0], q[1], q[2], q[3]} : Quat{q[3], q[0], q[1], q[2]};
  const double length = std::sqrt(dot(raw, raw));
  if (!(std::fabs(length - 1) <= 0.05)) return false;
  quaternion = normalized(raw);
  return true;
}

Status refuse(const std::string& name, const std::string& what) { return Status::error(name + ": " + what); }

Status append_sample(const std::string& name, const std::string& where, double time, const DeviceFrame& frame,
                     Motion& motion) {
  if (!(std::fabs(time) <= kLastTime))
    return refuse(name, where + ": time is beyond 1e12 s; correct it, or give it in the format's unit");
  if (!motion.samples.empty()) {
    const double last = motion.samples.back().time;
    if (time == last) return {};
    if (!(time > last)) {
      return refuse(name, where + ": time goes back from " + std::to_string(last) + " to " +
                              std::to_string(time) + " s; put the frames in order");
    }
    if (!(time - motion.samples.front().time <= kLongestMotion))
      return refuse(name, where +
                              ": time is more than 1e9 s after the first; correct it, or give it in the "
                              "format's unit");
  }
  motion.samples.push_back({time, frame});
  return {};
}

DeviceFrame lost_frame() {
  DeviceFrame frame;
  frame.flags = kTrackingLost;
  return frame;
}

double right_handedness(const Motion& motion) {
  double sum = 0;
  int count = 0;
  for (const MotionSample& sample : motion.samples) {
    const DeviceFrame& frame = sample.frame;
    if (is_lost(sample) || !is_valid(frame, kIndexProximal) || !is_valid(frame, kLittleProximal)) continue;
    const std::array<float, 4>& q = frame.joint[kWrist].orientation;
    const Vec3 x = rotate(Quat{q[3], q[0], q[1], q[2]}, {1, 0, 0});
    sum += dot(unit_or(position_of(frame, kLittleProximal) - position_of(frame, kIndexProximal), {}), x);
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

Status parse_motion(std::string_view content, const std::string& name, const MotionOptions& options,
                    Motion& motion) {
  const FloatingPointGuard guard;
  try {
    return parse_checked(content, name, options, motion);
  } catch (const std::bad_alloc&) {
    return refuse(name, "not enough memory to read it");
  } catch (const std::exception& error) {  // the JSON library's way to say that a value has another type
    return refuse(name, std::string("not a hand motion: ") + error.what());
  }
}

}  // namespace lumbrical
