// Motion files of every format: what they say, what they leave out, what is wrong with them, and real
// captures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "lumbrical/motion.h"
#include "model/hand_from_positions.h"

namespace lumbrical {
namespace {

using Poses = std::array<Pose, kJointCount>;

Vec3 position(const DeviceFrame& frame, int joint) {
  const auto& p = frame.joint[joint].position;
  return {p[0], p[1], p[2]};
}

Quat orientation(const DeviceFrame& frame, int joint) {
  const auto& q = frame.joint[joint].orientation;
  return {q[3], q[0], q[1], q[2]};
}

Status parse(const std::string& content, Motion& motion, const MotionOptions& options = {}) {
  return parse_motion(content, "file", options, motion);
}

Motion parse_good(const std::string& content, const MotionOptions& options = {}) {
  Motion motion;
  const Status status = parse(content, motion, options);
  EXPECT_TRUE(status.ok()) << status.message();
  if (motion.samples.empty()) motion.samples.resize(1);
  return motion;
}

void expect_refused(const std::string& content, const std::string& message,
                    const MotionOptions& options = {}) {
  Motion motion;
  motion.format = "untouched";
  const Status status = parse(content, motion, options);
  EXPECT_FALSE(status.ok()) << "expected: " << message;
  EXPECT_NE(status.message().find(message), std::string::npos) << status.message();
  EXPECT_EQ(status.message().substr(0, 4), "file") << status.message();
  EXPECT_EQ(motion.format, "untouched");
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), with);
}

Poses bent_hand(Side side, double flexion) {
  std::array<double, kAngleCount> angles{};
  for (int f = 0; f < kFingerCount; ++f) angles[4 * f + 1] = angles[4 * f + 2] = flexion;
  Poses poses;
  forward_kinematics(default_hand(side), Pose{{0.1, 0.2, 0.3}, {}}, angles, poses);
  return poses;
}

// Generated files.

std::string list(std::initializer_list<double> numbers) {
  std::ostringstream text;
  text.precision(9);
  for (const double number : numbers) text << (text.tellp() > 0 ? "," : "") << number;
  return text.str();
}

std::string list(Vec3 v, double unit = 1) { return list({v.x / unit, v.y / unit, v.z / unit}); }

std::string webxr_name(int joint) {
  std::string name(joint_name(joint));
  if (name.rfind("little", 0) == 0) name.replace(0, 6, "pinky");
  const std::size_t space = name.find(' ');
  if (space == name.npos) return name;
  const std::string finger = name.substr(0, space), part = name.substr(space + 1);
  const bool is_phalanx = part == "proximal" || part == "intermediate" || part == "distal";
  return finger + (finger == "thumb" ? "-" : "-finger-") + (is_phalanx ? "phalanx-" : "") + part;
}

std::string webxr_pose(const Poses& poses) {
  std::string text = "{\"jointTransforms\": {";
  for (int j = kWrist; j < kJointCount; ++j) {
    const Quat q = poses[j].orientation;
    text += (j > kWrist ? ",\n\"" : "\n\"") + webxr_name(j) + "\": {\"offsetMatrix\": [" +
            list(rotate(q, {1, 0, 0})) + ",0," + list(rotate(q, {0, 1, 0})) + ",0," +
            list(rotate(q, {0, 0, 1})) + ",0," + list(poses[j].position) + ",1], \"radius\": 0.01}";
  }
  return text + "}}";
}

std::string openxr_name(int joint) {
  std::string name = "XR_HAND_JOINT_";
  for (const char c : joint_name(joint)) name += c == ' ' ? '_' : static_cast<char>(c - 'a' + 'A');
  return name + "_EXT";
}

std::string sequence_frame(double time, const Poses& poses, int left_out = -1) {
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

std::string leap_finger(const Poses& poses, int finger, int hand_id) {
  const int first = finger == 0 ? kThumbMetacarpal : 2 + 5 * finger;
  const auto point = [&](int joint) { return "[" + list(poses[joint].position, 0.001) + "]"; };
  return "{\"id\": " + std::to_string(10 * hand_id + finger) + ", \"handId\": " + std::to_string(hand_id) +
         ", \"tool\": false, \"width\": 18, \"mcpPosition\": " + point(first) +
         ", \"pipPosition\": " + point(first + 1) + ", \"dipPosition\": " + point(first + 2) +
         ", \"tipPosition\": " + point(first + 3) + "}";
}

std::string leap_hand(int id, Side side) {
  return "{\"id\": " + std::to_string(id) + ", \"type\": \"" + (side == Side::right ? "right" : "left") +
         "\", \"direction\": [0,0,-1], \"palmNormal\": [0,-1,0]}";
}

std::string leap_frame(double stamp, const std::string& hands, const std::string& fingers) {
  return "{\"timestamp\": " + list({stamp}) + ", \"hands\": [" + hands + "], \"pointables\": [" + fingers +
         "]}";
}

std::string leap_fingers(const Poses& poses, int hand_id, int finger_count = kFingerCount) {
  std::string text;
  for (int f = 0; f < finger_count; ++f) text += (f > 0 ? "," : "") + leap_finger(poses, f, hand_id);
  return text;
}

std::string leap_file(std::initializer_list<std::string> frames) {
  std::string text = "{\"metadata\": {}, \"frames\": [";
  for (const std::string& frame : frames) text += (text.back() == '[' ? "\n" : ",\n") + frame;
  return text + "]}";
}

std::string packed_leap(const Poses& poses) {
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

std::string landmark_row(const Poses& poses) {
  std::string text = list(poses[kWrist].position);
  for (int f = 0; f < kFingerCount; ++f) {
    const int first = f == 0 ? kThumbMetacarpal : 2 + 5 * f;
    for (int k = 0; k < 4; ++k) text += "," + list(poses[first + k].position);
  }
  return text;
}

std::string landmark_header(bool with_time) {
  std::string text = with_time ? "time" : "";
  for (int i = 0; i < 21; ++i) {
    for (const char axis : {'x', 'y', 'z'}) {
      text += (text.empty() ? "" : ",") + std::string("j") + std::to_string(i) + "_" + axis;
    }
  }
  return text + "\n";
}

std::string angle_file() {
  std::string text = "{\"format\": \"lumbrical-angles\", \"side\": \"left\", \"samples\": [";
  for (int i = 0; i < 3; ++i) {
    text += std::string(i > 0 ? "," : "") + "\n{\"time\": " + list({2 + 0.25 * i}) +
            ", \"wrist\": {\"position\": [0.5, -1, 2], \"orientation\": [0.8, 0, 0, 0.6]}, \"angles\": [";
    for (int a = 0; a < kAngleCount; ++a) text += (a > 0 ? "," : "") + list({0.01 * a + i});
    text += "]}";
  }
  return text + "]}";
}

// WebXR and OpenXR.

TEST(WebxrMotion, ReadsOnePoseOfMatrices) {
  const Poses poses = bent_hand(Side::right, 0.5);
  const Motion motion = parse_good(webxr_pose(poses));
  EXPECT_EQ(motion.format, "webxr");
  EXPECT_EQ(motion.side, Side::right);
  ASSERT_EQ(motion.samples.size(), 1u);
  const DeviceFrame& frame = motion.samples[0].frame;
  EXPECT_EQ(frame.kind, InputKind::joint_poses);
  EXPECT_EQ(frame.flags, 0u);
  EXPECT_EQ(frame.valid, (1u << kJointCount) - 1);
  for (int j = 0; j < kJointCount; ++j) {  // the palm is derived
    EXPECT_LT(norm(position(frame, j) - poses[j].position), 1e-6) << joint_name(j);
    EXPECT_NEAR(std::fabs(dot(orientation(frame, j), poses[j].orientation)), 1, 1e-6) << joint_name(j);
    EXPECT_EQ(motion.radius[j], j == kPalm ? 0.0 : 0.01);
  }
}

TEST(WebxrMotion, TellsTheHandByTheSideOfItsThumb) {
  const std::string left = webxr_pose(bent_hand(Side::left, 0.5));
  EXPECT_EQ(parse_good(left).side, Side::left);
  MotionOptions options;
  options.side = Side::left;
  EXPECT_EQ(parse_good(left, options).side, Side::left);
  options.side = Side::right;
  expect_refused(left, "set the side to left", options);
}

TEST(WebxrMotion, ReadsASequenceInOpenxrNames) {
  const Poses a = bent_hand(Side::left, 0.1), b = bent_hand(Side::left, 0.9);
  const Motion motion = parse_good("[" + sequence_frame(5, a) + ",\n" + sequence_frame(5.5, b) + "]");
  ASSERT_EQ(motion.samples.size(), 2u);
  EXPECT_EQ(motion.side, Side::left);
  EXPECT_EQ(motion.samples[0].time, 0);
  EXPECT_EQ(motion.samples[1].time, 0.5);
  for (int j = 0; j < kJointCount; ++j) {
    EXPECT_LT(norm(position(motion.samples[1].frame, j) - b[j].position), 1e-6) << joint_name(j);
    EXPECT_EQ(motion.radius[j], 0);
  }
}

TEST(WebxrMotion, MarksLeftOutJointsAsNotTrackedAndFramesWithoutAHandAsLost) {
  const Poses a = bent_hand(Side::right, 0.1), b = bent_hand(Side::right, 0.9);
  const Motion motion = parse_good("[{\"time\": 0, \"joints\": {}}," + sequence_frame(1, a) + "," +
                                   sequence_frame(2, b, kRingTip) + ",{\"time\": 3, \"joints\": null}]");
  ASSERT_EQ(motion.samples.size(), 4u);
  EXPECT_EQ(motion.samples[0].frame.flags, std::uint32_t{kTrackingLost});
  EXPECT_EQ(motion.samples[0].frame.joint, motion.samples[1].frame.joint);
  EXPECT_EQ(motion.samples[2].frame.flags, 0u);
  EXPECT_EQ(motion.samples[2].frame.valid, ((1u << kJointCount) - 1) & ~(1u << kRingTip));
  EXPECT_EQ(motion.samples[2].frame.joint[kRingTip], motion.samples[1].frame.joint[kRingTip]);
  EXPECT_EQ(motion.samples[3].frame.flags, std::uint32_t{kTrackingLost});
  EXPECT_EQ(motion.samples[3].frame.joint, motion.samples[2].frame.joint);
}

TEST(WebxrMotion, SaysWhichJointOrFieldIsWrong) {
  const Poses poses = bent_hand(Side::right, 0.5);
  const std::string pose = webxr_pose(poses);
  expect_refused(replaced(pose, "thumb-tip", "thumb-nail"), "\"thumb-nail\" is no joint");
  expect_refused(replaced(pose, "thumb-tip", "pinky-finger-tip"), "thumb tip is missing");
  expect_refused(replaced(pose, "thumb-tip", "little_tip"), "little tip: given twice");
  expect_refused(replaced(pose, "\"radius\": 0.01", "\"radius\": -1"), "wrist: \"radius\"");
  expect_refused(replaced(pose, "[1,0,0,0,", "[2,0,0,0,"), "wrist: \"offsetMatrix\"");
  expect_refused(replaced(pose, "[1,0,0,0,", "[-1,0,0,0,"), "wrist: \"offsetMatrix\"");
  expect_refused(replaced(pose, "[1,0,0,0,", "[0,0,0,"), "wrist: \"offsetMatrix\"");
  expect_refused("{\"jointTransforms\": 1}", "must be an object");
  const std::string frame = sequence_frame(1, poses);
  expect_refused("[" + replaced(frame, "0.2,", "") + "]", "frame 0: wrist: \"position\"");
  expect_refused("[" + replaced(frame, "\"orientation\": [", "\"orientation\": [9,") + "]",
                 "frame 0: palm: \"orientation\"");
  expect_refused("[" + frame + "," + sequence_frame(0.5, poses) + "]", "frame 1: time goes back");
  expect_refused("[{\"joints\": {}}]", "frame 0: \"time\"");
  expect_refused("[]", "no samples");
  expect_refused("[{\"time\": 0, \"joints\": {}}]", "no frame shows a whole hand");
}

TEST(WebxrMotion, RefusesAHandOfTheWrongUnit) {
  MotionOptions options;
  options.unit = 100;
  const std::string frame = "[" + sequence_frame(1, bent_hand(Side::right, 0.5)) + "]";
  expect_refused(frame, "set the file's unit", options);
  options.unit = 0.001;
  expect_refused(frame, "set the file's unit", options);
  options.unit = 0.9;
  EXPECT_NEAR(position(parse_good(frame, options).samples[0].frame, kWrist).x, 0.09, 1e-7);
}

// LeapJS.

TEST(LeapMotion, ReadsFramesOfObjectsInMillimetresAndMicroseconds) {
  const Poses poses = bent_hand(Side::left, 0.4);
  const std::string hand = leap_hand(3, Side::left), fingers = leap_fingers(poses, 3);
  const Motion motion =
      parse_good(leap_file({leap_frame(7e9, hand, fingers), leap_frame(7e9 + 20000, hand, fingers)}));
  EXPECT_EQ(motion.format, "leapjs");
  EXPECT_EQ(motion.side, Side::left);
  ASSERT_EQ(motion.samples.size(), 2u);
  EXPECT_DOUBLE_EQ(motion.samples[1].time, 0.02);
  const DeviceFrame& frame = motion.samples[0].frame;
  for (const int joint :
       {kThumbMetacarpal, kThumbProximal, kThumbDistal, kThumbTip, kIndexProximal, kIndexTip, kLittleTip}) {
    EXPECT_LT(norm(position(frame, joint) - poses[joint].position), 1e-6) << joint_name(joint);
    EXPECT_DOUBLE_EQ(motion.radius[joint], 0.009) << joint_name(joint);
  }
  for (const int joint : {kWrist, kPalm, kIndexMetacarpal, kLittleMetacarpal}) {
    EXPECT_LT(norm(position(frame, joint) - poses[joint].position), 0.016) << joint_name(joint);
    EXPECT_EQ(motion.radius[joint], 0) << joint_name(joint);
  }
  EXPECT_LT(norm(rotate(orientation(frame, kPalm), {0, 1, 0}) - Vec3{0, 1, 0}), 1e-6);
}

TEST(LeapMotion, ReadsPackedFrames) {
  const Poses poses = bent_hand(Side::right, 0.4);
  const Motion motion = parse_good(packed_leap(poses));
  ASSERT_EQ(motion.samples.size(), 2u);
  EXPECT_DOUBLE_EQ(motion.samples[1].time, 0.01);
  EXPECT_LT(norm(position(motion.samples[1].frame, kMiddleTip) - poses[kMiddleTip].position), 1e-6);
}

TEST(LeapMotion, KeepsFramesWithoutAWholeHandAsLostWithTheLastGoodPose) {
  const Poses a = bent_hand(Side::right, 0.2), b = bent_hand(Side::right, 0.6);
  const std::string hand = leap_hand(3, Side::right);
  const Motion motion =
      parse_good(leap_file({leap_frame(0, "", ""), leap_frame(10, hand, leap_fingers(a, 3)),
                            leap_frame(20, hand, leap_fingers(b, 3, 4)), leap_frame(30, "", ""),
                            leap_frame(40, hand, leap_fingers(b, 3))}));
  ASSERT_EQ(motion.samples.size(), 5u);
  for (const std::size_t i : {0u, 2u, 3u}) {
    EXPECT_EQ(motion.samples[i].frame.flags, std::uint32_t{kTrackingLost}) << i;
    EXPECT_EQ(motion.samples[i].frame.joint, motion.samples[1].frame.joint) << i;
  }
  EXPECT_EQ(motion.samples[4].frame.flags, 0u);
}

TEST(LeapMotion, FollowsOneHandOfSeveral) {
  const Poses right = bent_hand(Side::right, 0.2), left = bent_hand(Side::left, 0.6);
  const std::string hands = leap_hand(3, Side::right) + "," + leap_hand(4, Side::left);
  const std::string swapped = leap_hand(4, Side::left) + "," + leap_hand(3, Side::right);
  const std::string fingers = leap_fingers(right, 3) + "," + leap_fingers(left, 4);
  // Later the right hand is lost and found again under another id, behind a third hand of the other side.
  const std::string found = leap_hand(5, Side::left) + "," + leap_hand(6, Side::right);
  const std::string file =
      leap_file({leap_frame(0, hands, fingers), leap_frame(10, swapped, fingers), leap_frame(20, "", ""),
                 leap_frame(30, found, leap_fingers(left, 5) + "," + leap_fingers(right, 6))});
  MotionOptions options;
  for (const bool ask : {false, true}) {
    if (ask) options.side = Side::right;
    const Motion motion = parse_good(file, options);
    EXPECT_EQ(motion.side, Side::right);
    for (const std::size_t i : {0u, 1u, 3u}) {
      EXPECT_EQ(motion.samples[i].frame.flags, 0u);
      EXPECT_LT(norm(position(motion.samples[i].frame, kIndexTip) - right[kIndexTip].position), 1e-6) << i;
    }
  }
  options.side = Side::left;
  const Motion other = parse_good(file, options);
  EXPECT_EQ(other.side, Side::left);
  EXPECT_LT(norm(position(other.samples[1].frame, kIndexTip) - left[kIndexTip].position), 1e-6);
}

TEST(LeapMotion, DropsFramesWithTheSameTimeAndRefusesThoseThatGoBack) {
  const std::string hand = leap_hand(3, Side::right), fingers = leap_fingers(bent_hand(Side::right, 0.4), 3);
  const std::string a = leap_frame(100, hand, fingers), b = leap_frame(90, hand, fingers);
  EXPECT_EQ(parse_good(leap_file({a, a, a})).samples.size(), 1u);
  expect_refused(leap_file({a, a, b}), "frame 2: time goes back");
}

TEST(LeapMotion, SaysWhatIsWrong) {
  const Poses poses = bent_hand(Side::right, 0.4);
  const std::string good = leap_file({leap_frame(0, leap_hand(3, Side::right), leap_fingers(poses, 3))});
  expect_refused("{\"frames\": \"N4IgZg\"}", "LZ-compressed");
  expect_refused("N4IgZgLghgTg1gUwHYGcIC4QBMCuBbEAGhABcBPAByQgGEB7AdwGMBLAZxgBcp", "LZ-compressed");
  expect_refused("{\"frames\": []}", "array of frames");
  expect_refused(replaced(good, "\"timestamp\": 0", "\"timestamp\": null"), "frame 0: \"timestamp\"");
  expect_refused(replaced(good, "palmNormal", "normal"), "frame 0: the hand's");
  expect_refused(replaced(good, "dipPosition", "dip"), "frame 0: thumb: \"dipPosition\"");
  expect_refused(replaced(good, "\"width\": 18", "\"width\": -1"), "frame 0: thumb: \"width\"");
  expect_refused(replaced(good, "\"type\": \"right\"", "\"type\": \"left\""), "set the side to right");
  MotionOptions options;
  options.side = Side::left;
  expect_refused(good, "no frame shows a whole hand", options);
}

// Landmarks.

TEST(LandmarkMotion, ReadsRowsWithAndWithoutHeader) {
  const Poses a = bent_hand(Side::right, 0.3), b = bent_hand(Side::right, 0.8);
  const std::string rows = landmark_row(a) + "\n" + landmark_row(b) + "\r\n\n";
  MotionOptions options;
  options.rate = 25;
  for (const std::string& text :
       {rows, landmark_header(false) + rows, "\xEF\xBB\xBF" + landmark_header(false) + rows}) {
    const Motion motion = parse_good(text, options);
    EXPECT_EQ(motion.format, "landmarks");
    ASSERT_EQ(motion.samples.size(), 2u);
    EXPECT_EQ(motion.side, Side::right);
    EXPECT_EQ(motion.samples[1].time, 1 / 25.0);
    EXPECT_LT(norm(position(motion.samples[1].frame, kRingTip) - b[kRingTip].position), 1e-6);
    EXPECT_GT(std::fabs(dot(orientation(motion.samples[1].frame, kWrist), b[kWrist].orientation)), 0.99);
  }
}

TEST(LandmarkMotion, TakesTimesFromAColumnThatTheHeaderNames) {
  const std::string row = landmark_row(bent_hand(Side::right, 0.3));
  const Motion motion = parse_good(landmark_header(true) + "10.5," + row + "\n 10.75 , " + row + "\n");
  ASSERT_EQ(motion.samples.size(), 2u);
  EXPECT_EQ(motion.samples[1].time, 0.25);
  expect_refused("10.5," + row, "file:1:1: found 64 columns instead of 63");
  expect_refused(landmark_header(true) + "2," + row + "\n1," + row, "file:3:1: frame 1: time goes back");
}

TEST(LandmarkMotion, TellsTheHandByTheBendOfItsFingers) {
  const std::string left = landmark_row(bent_hand(Side::left, 0.5));
  EXPECT_EQ(parse_good(left).side, Side::left);
  MotionOptions options;
  options.side = Side::right;
  expect_refused(left, "set the side to left", options);
  const std::string flat = landmark_row(bent_hand(Side::left, 0));
  EXPECT_EQ(parse_good(flat, options).side, Side::right) << "a flat hand could be either";
  options.side = Side::left;
  EXPECT_EQ(parse_good(flat, options).side, Side::left);
}

TEST(LandmarkMotion, TakesARowOfOnePointForALostHand) {
  std::string zeros = "0";
  for (int i = 1; i < 63; ++i) zeros += ",0";
  const std::string row = landmark_row(bent_hand(Side::right, 0.3));
  const Motion motion = parse_good(row + "\n" + zeros + "\n" + row + "\n");
  EXPECT_EQ(motion.samples[1].frame.flags, std::uint32_t{kTrackingLost});
  EXPECT_EQ(motion.samples[1].frame.joint, motion.samples[0].frame.joint);
}

TEST(LandmarkMotion, ReportsTheLineAndColumnOfWhatIsNoNumber) {
  const std::string row = landmark_row(bent_hand(Side::right, 0.3));
  const std::string first = row.substr(0, row.find(','));
  for (const char* wrong : {"nan", "inf", "1e999", "0x10", "1.2.3", "", "one"}) {
    expect_refused(row + "\n" + first + "," + wrong + row.substr(row.find(',', first.size() + 1)),
                   "file:2:" + std::to_string(first.size() + 2) + ": ");
  }
  expect_refused(row + "\n" + row.substr(0, row.rfind(',')), "file:2:1: found 62 columns");
  expect_refused(row + "," + row, "found 126 columns");
  expect_refused(replaced(row, first, "1e6"), "10 km");
  expect_refused("", "no samples");
  expect_refused("hello", "file:1:1: neither JSON nor a CSV");
}

// Joint angles.

TEST(AngleMotion, ReadsWristAndAngles) {
  const Motion motion = parse_good(angle_file());
  EXPECT_EQ(motion.format, "angles");
  EXPECT_EQ(motion.side, Side::left);
  ASSERT_EQ(motion.samples.size(), 3u);
  EXPECT_EQ(motion.samples[2].time, 0.5);
  const DeviceFrame& frame = motion.samples[1].frame;
  EXPECT_EQ(frame.kind, InputKind::joint_angles);
  EXPECT_EQ(frame.base.position, (Vec3{0.5, -1, 2}));
  EXPECT_NEAR(frame.base.orientation.z, 0.6, 1e-15);
  for (int a = 0; a < kAngleCount; ++a) EXPECT_FLOAT_EQ(frame.angle[a], static_cast<float>(0.01 * a + 1));
}

TEST(AngleMotion, RefusesUnknownFieldsByName) {
  const std::string good = angle_file();
  expect_refused(replaced(good, "\"side\"", "\"sida\": 1, \"side\""), "unknown field \"sida\"");
  expect_refused(replaced(good, "\"time\": 2.25", "\"time\": 2.25, \"angels\": []"),
                 "sample 1: unknown field \"angels\"");
  expect_refused(replaced(good, "\"position\"", "\"speed\": 0, \"position\""),
                 "sample 0: wrist: unknown field \"speed\"");
}

TEST(AngleMotion, RefusesWrongSizesAndValues) {
  const std::string good = angle_file();
  expect_refused(replaced(good, "lumbrical-angles", "angles"), "\"format\" must be");
  expect_refused(replaced(good, "\"left\"", "\"both\""), "\"side\" must be");
  expect_refused(replaced(good, "\"angles\": [", "\"angles\": [0,"),
                 "sample 0: \"angles\" must be 20 numbers");
  expect_refused(replaced(good, "\"angles\": [0,", "\"angles\": [45,"),
                 "sample 0: angle 0 is not a number of radians");
  expect_refused(replaced(good, "\"angles\": [0,", "\"angles\": [null,"), "sample 0: angle 0");
  expect_refused(replaced(good, "0.8, 0, 0, 0.6", "0, 0, 0, 0"), "\"orientation\"");
  expect_refused(replaced(good, "0.5, -1, 2", "0.5, -1"), "\"position\"");
  expect_refused(replaced(good, "\"time\": 2.25", "\"time\": 1.9"), "sample 1: time goes back");
  expect_refused(replaced(good, "\"time\": 2.25", "\"time\": \"2\""), "sample 1: \"time\"");
  MotionOptions options;
  options.side = Side::right;
  expect_refused(good, "it is a left hand", options);
}

// What all formats share.

TEST(MotionFile, ReportsLineAndColumnOfBrokenJson) {
  expect_refused("{\"frames\":\n [1, 2,]}", "file:2:8: not valid JSON");
  expect_refused("{\"frames\": [1e999]}", "file:1:17: not valid JSON");
  expect_refused("{\"frames\": \"\xff\"}", "file:1:");
  expect_refused("{\"other\": 1}", "not a hand motion");
  expect_refused("{", "file:1:2: not valid JSON");
}

TEST(MotionFile, RefusesDeepNestingWithoutCrashing) {
  expect_refused(std::string(100000, '['), "file:1:33: brackets are nested");
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  expect_refused(objects, "brackets are nested");
  expect_refused("{\"a\": \"" + std::string(100000, '[') + "\"}", "not a hand motion");
}

TEST(MotionFile, RefusesImpossibleOptions) {
  MotionOptions options;
  for (const double rate : {0.0, -30.0, std::nan(""), 1e9}) {
    options.rate = rate;
    expect_refused(angle_file(), "rate", options);
  }
  options = {};
  for (const double unit : {-1.0, std::nan(""), 1e9}) {
    options.unit = unit;
    expect_refused(angle_file(), "unit", options);
  }
}

TEST(MotionFile, LoadsFromDiskAndRefusesWhatIsNoFile) {
  const std::string path = ::testing::TempDir() + "lumbrical_motion_file_test.json";
  std::ofstream(path, std::ios::binary) << angle_file();
  Motion motion;
  EXPECT_TRUE(load_motion(path, {}, motion).ok());
  EXPECT_EQ(motion.samples.size(), 3u);
  std::filesystem::remove(path);
  EXPECT_FALSE(load_motion(path, {}, motion).ok());
  EXPECT_FALSE(load_motion(::testing::TempDir(), {}, motion).ok());
  EXPECT_EQ(motion.samples.size(), 3u);
}

void expect_sound(const Motion& motion) {
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

struct Sample {
  std::string name, content;
};

std::vector<Sample> one_file_of_each_format() {
  const Poses poses = bent_hand(Side::right, 0.4);
  const std::string hand = leap_hand(3, Side::right), fingers = leap_fingers(poses, 3);
  return {
      {"pose", webxr_pose(poses)},
      {"sequence", "[" + sequence_frame(1, poses) + "]"},
      {"leap", leap_file({leap_frame(100, hand, fingers)})},
      {"packed leap", packed_leap(poses)},
      {"landmarks", landmark_header(true) + "1," + landmark_row(poses) + "\n2," + landmark_row(poses) + "\n"},
      {"angles", angle_file()}};
}

TEST(MotionFile, IsRefusedWhenCutAtAnyByte) {
  for (const auto& [name, content] : one_file_of_each_format()) {
    Motion motion;
    EXPECT_TRUE(parse(content, motion).ok()) << name;
    for (std::size_t size = 0; size < content.size(); ++size) {
      const Status status = parse(content.substr(0, size), motion);
      if (status.ok()) {
        // A cut number is a number, and a CSV may end after any line.
        ASSERT_EQ(name, "landmarks") << size;
        expect_sound(motion);
      }
    }
  }
}

TEST(MotionFile, IsRefusedOrSoundWhenAnyByteIsChanged) {
  for (const auto& [name, content] : one_file_of_each_format()) {
    for (std::size_t at = 0; at < content.size(); ++at) {
      std::string changed = content;
      if (at % 2 == 0) {
        changed[at] = static_cast<char>(changed[at] ^ (1 << (at / 2 % 8)));
      } else {
        changed[at] = "0,]e-9\"}"[at / 2 % 8];
      }
      Motion motion;
      if (parse(changed, motion).ok()) expect_sound(motion);
    }
  }
}

// Real captures.

std::string data_folder() {
  if (const char* folder = std::getenv("LUMBRICAL_DATA")) return folder;
  return std::string(LUMBRICAL_SOURCE_DIR) + "/../shared/data";
}

struct Capture {
  const char* file;
  const char* format;
  Side side;
  std::size_t sample_count;
  double least_duration, most_duration;  // [s]
};

class RealCapture : public ::testing::TestWithParam<Capture> {};

TEST_P(RealCapture, LoadsAsAPlausibleHand) {
  const Capture& expected = GetParam();
  const std::string path = data_folder() + "/hands/" + expected.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "The real captures are not here: " << path;
  Motion motion;
  const Status status = load_motion(path, {}, motion);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(motion.format, expected.format);
  EXPECT_EQ(motion.side, expected.side);
  EXPECT_EQ(motion.samples.size(), expected.sample_count);
  EXPECT_GE(duration(motion), expected.least_duration);
  EXPECT_LE(duration(motion), expected.most_duration);
  expect_sound(motion);
  const double sign = motion.side == Side::right ? 1 : -1;
  for (std::size_t i = 0; i < motion.samples.size(); ++i) {
    const DeviceFrame& frame = motion.samples[i].frame;
    ASSERT_EQ(frame.flags, 0u);
    for (int j = kThumbProximal; j < kJointCount; ++j) {
      if (j == kIndexMetacarpal || j == kMiddleMetacarpal || j == kRingMetacarpal || j == kLittleMetacarpal)
        continue;
      const double length = norm(position(frame, j) - position(frame, j - 1));
      ASSERT_GT(length, 0.005) << joint_name(j) << " in sample " << i;
      ASSERT_LT(length, 0.120) << joint_name(j) << " in sample " << i;
    }
    ASSERT_GT(norm(position(frame, kMiddleProximal) - position(frame, kWrist)), 0.06);
    // Thumb and little finger are on opposite sides of the middle finger, the thumb on its own side of the
    // palm.
    const Vec3 x = rotate(orientation(frame, kPalm), {1, 0, 0}), palm = position(frame, kPalm);
    ASSERT_LT(sign * dot(position(frame, kThumbMetacarpal) - palm, x), -0.005) << "in sample " << i;
    ASSERT_GT(sign * dot(position(frame, kLittleProximal) - palm, x), 0.005) << "in sample " << i;
  }
}

// The file's name as a test's name.
std::string test_name(const ::testing::TestParamInfo<Capture>& capture) {
  std::string name = capture.param.file;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(MotionFile, RealCapture,
                         ::testing::Values(Capture{"quest_pinch.json", "webxr", Side::left, 1, 0, 0},
                                           Capture{"quest_point.json", "webxr", Side::left, 1, 0, 0},
                                           Capture{"quest_relaxed.json", "webxr", Side::left, 1, 0, 0},
                                           Capture{"leap_grab.json", "leapjs", Side::right, 374, 3.30, 3.31},
                                           Capture{"leap_pinch.json", "leapjs", Side::right, 133, 2.35, 2.36},
                                           Capture{"video_joints_right.csv", "landmarks", Side::right, 621,
                                                   20.6, 20.7}),
                         test_name);

}  // namespace
}  // namespace lumbrical
