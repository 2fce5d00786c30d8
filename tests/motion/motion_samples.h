// Hand motions in files of every format, as text, and what the tests of their readers ask.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "lumbrical/motion.h"
#include "model/hand_from_positions.h"
#include "names.h"

namespace lumbrical::test {

using Poses = std::array<Pose, kJointCount>;

inline Vec3 position(const DeviceFrame& frame, int joint) {
  const auto& p = frame.joint[joint].position;
  return {p[0], p[1], p[2]};
}

inline Quat orientation(const DeviceFrame& frame, int joint) {
  const auto& q = frame.joint[joint].orientation;
  return {q[3], q[0], q[1], q[2]};
}

inline Status parse(const std::string& content, Motion& motion, const MotionOptions& options = {}) {
  return parse_motion(content, "file", options, motion);
}

inline Motion parse_good(const std::string& content, const MotionOptions& options = {}) {
  Motion motion;
  const Status status = parse(content, motion, options);
  EXPECT_TRUE(status.ok()) << status.message();
  if (motion.samples.empty()) motion.samples.resize(1);
  return motion;
}

inline void expect_refused(const std::string& content, const std::string& message,
                           const MotionOptions& options = {}) {
  Motion motion;
  motion.format = "untouched";
  const Status status = parse(content, motion, options);
  EXPECT_FALSE(status.ok()) << "expected: " << message;
  EXPECT_NE(status.message().find(message), std::string::npos) << status.message();
  EXPECT_EQ(status.message().substr(0, 4), "file") << status.message();
  EXPECT_EQ(motion.format, "untouched");
}

inline std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), with);
}

inline Poses bent_hand(Side side, double flexion) {
  std::array<double, kAngleCount> angles{};
  for (int f = 0; f < kFingerCount; ++f) angles[4 * f + 1] = angles[4 * f + 2] = flexion;
  Poses poses;
  forward_kinematics(default_hand(side), Pose{{0.1, 0.2, 0.3}, {}}, angles, poses);
  return poses;
}

// Generated files.

inline std::string list(std::initializer_list<double> numbers) {
  std::ostringstream text;
  text.precision(9);
  for (const double number : numbers) text << (text.tellp() > 0 ? "," : "") << number;
  return text.str();
}

inline std::string list(Vec3 v, double unit = 1) { return list({v.x / unit, v.y / unit, v.z / unit}); }

inline std::string webxr_name(int joint) {
  std::string name(joint_name(joint));
  if (name.rfind("little", 0) == 0) name.replace(0, 6, "pinky");
  const std::size_t space = name.find(' ');
  if (space == name.npos) return name;
  const std::string finger = name.substr(0, space), part = name.substr(space + 1);
  const bool is_phalanx = part == "proximal" || part == "intermediate" || part == "distal";
  return finger + (finger == "thumb" ? "-" : "-finger-") + (is_phalanx ? "phalanx-" : "") + part;
}

inline std::string webxr_pose(const Poses& poses) {
  std::string text = "{\"jointTransforms\": {";
  for (int j = kWrist; j < kJointCount; ++j) {
    const Quat q = poses[j].orientation;
    text += (j > kWrist ? ",\n\"" : "\n\"") + webxr_name(j) + "\": {\"offsetMatrix\": [" +
            list(rotate(q, {1, 0, 0})) + ",0," + list(rotate(q, {0, 1, 0})) + ",0," +
            list(rotate(q, {0, 0, 1})) + ",0," + list(poses[j].position) + ",1], \"radius\": 0.01}";
  }
  return text + "}}";
}

inline std::string openxr_name(int joint) {
  std::string name = "XR_HAND_JOINT_";
  for (const char c : joint_name(joint)) name += c == ' ' ? '_' : static_cast<char>(c - 'a' + 'A');
  return name + "_EXT";
}

inline std::string sequence_frame(double time, const Poses& poses, int left_out = -1) {
  std::string text = "{\"time\": " + list({time}) + ", \"joints\": {";
  bool is_first = true;
  for (int j = 0; j < kJointCount; ++j) {
    if (j == left_out) continue;
    const Quat q = poses[j].orientation;
    text += std::string(is_first ? "" : ",") + "\"" + openxr_name(j) + "\": {\"position\": [" +
            list(poses[j].position) + "], \"orientation\": [" + list({q.x, q.y, q.z, q.w}) + "]}";
    is_first = false;
  }
  return text + "}}";
}

inline std::string leap_finger(const Poses& poses, int finger, int hand_id) {
  const int first = finger == 0 ? kThumbMetacarpal : 2 + 5 * finger;
  const auto point = [&](int joint) { return "[" + list(poses[joint].position, 0.001) + "]"; };
  return "{\"id\": " + std::to_string(10 * hand_id + finger) + ", \"handId\": " + std::to_string(hand_id) +
         ", \"tool\": false, \"width\": 18, \"mcpPosition\": " + point(first) +
         ", \"pipPosition\": " + point(first + 1) + ", \"dipPosition\": " + point(first + 2) +
         ", \"tipPosition\": " + point(first + 3) + "}";
}

inline std::string leap_hand(int id, Side side) {
  return "{\"id\": " + std::to_string(id) + ", \"type\": \"" + (side == Side::right ? "right" : "left") +
         "\", \"direction\": [0,0,-1], \"palmNormal\": [0,-1,0]}";
}

inline std::string leap_frame(double stamp, const std::string& hands, const std::string& fingers) {
  return "{\"timestamp\": " + list({stamp}) + ", \"hands\": [" + hands + "], \"pointables\": [" + fingers +
         "]}";
}

inline std::string leap_fingers(const Poses& poses, int hand_id, int finger_count = kFingerCount) {
  std::string text;
  for (int f = 0; f < finger_count; ++f) text += (f > 0 ? "," : "") + leap_finger(poses, f, hand_id);
  return text;
}

inline std::string leap_file(std::initializer_list<std::string> frames) {
  std::string text = "{\"metadata\": {}, \"frames\": [";
  for (const std::string& frame : frames) text += (text.back() == '[' ? "\n" : ",\n") + frame;
  return text + "]}";
}

inline std::string packed_leap(const Poses& poses) {
  std::string text =
      "{\"frames\":[[\"id\",\"timestamp\",{\"hands\":[[\"id\",\"type\",\"direction\",\"palmNormal\"]]},{"
      "\"pointables\":[["
      "\"id\",\"handId\",\"mcpPosition\",\"pipPosition\",\"dipPosition\",\"btipPosition\"]]}]";
  for (int i = 0; i < 2; ++i) {
    text += ",\n[" + std::to_string(i) + "," + std::to_string(5000000 + 10000 * i) +
            ",[[7,\"right\",[0,0,-1],[0,-1,0]]],[";
    for (int f = 0; f < kFingerCount; ++f) {
      const int first = f == 0 ? kThumbMetacarpal : 2 + 5 * f;
      text += (f > 0 ? ",[" : "[") + std::to_string(70 + f) + ",7";
      for (int k = 0; k < 4; ++k) text += ",[" + list(poses[first + k].position, 0.001) + "]";
      text += "]";
    }
    text += "]]";
  }
  return text + "]}";
}

inline std::string landmark_row(const Poses& poses) {
  std::string text = list(poses[kWrist].position);
  for (int f = 0; f < kFingerCount; ++f) {
    const int first = f == 0 ? kThumbMetacarpal : 2 + 5 * f;
    for (int k = 0; k < 4; ++k) text += "," + list(poses[first + k].position);
  }
  return text;
}

inline std::string landmark_header(bool with_time) {
  std::string text = with_time ? "time" : "";
  for (int i = 0; i < 21; ++i) {
    for (const char axis : {'x', 'y', 'z'}) {
      text += (text.empty() ? "" : ",") + std::string("j") + std::to_string(i) + "_" + axis;
    }
  }
  return text + "\n";
}

inline std::string angle_file() {
  std::string text = "{\"format\": \"lumbrical-angles\", \"side\": \"left\", \"samples\": [";
  for (int i = 0; i < 3; ++i) {
    text += std::string(i > 0 ? "," : "") + "\n{\"time\": " + list({2 + 0.25 * i}) +
            ", \"wrist\": {\"position\": [0.5, -1, 2], \"orientation\": [0.8, 0, 0, 0.6]}, \"angles\": [";
    for (int a = 0; a < kAngleCount; ++a) text += (a > 0 ? "," : "") + list({0.01 * a + i});
    text += "]}";
  }
  return text + "]}";
}

/// Finite numbers, rising times, unit quaternions.
inline void expect_sound(const Motion& motion) {
  ASSERT_FALSE(motion.samples.empty());
  EXPECT_EQ(motion.samples[0].time, 0);
  for (std::size_t i = 0; i < motion.samples.size(); ++i) {
    const auto& [time, frame] = motion.samples[i];
    ASSERT_TRUE(is_finite(time) && (i == 0 || time > motion.samples[i - 1].time));
    ASSERT_TRUE(is_finite(frame.base.position) &&
                is_finite(dot(frame.base.orientation, frame.base.orientation)));
    for (int j = 0; j < kJointCount; ++j) {
      ASSERT_TRUE(is_finite(position(frame, j)));
      ASSERT_NEAR(dot(orientation(frame, j), orientation(frame, j)), 1, 1e-5);
    }
    for (const float angle : frame.angle) ASSERT_TRUE(is_finite(double{angle}));
  }
  for (const double radius : motion.radius) ASSERT_TRUE(radius >= 0 && radius < 1);
}

}  // namespace lumbrical::test
