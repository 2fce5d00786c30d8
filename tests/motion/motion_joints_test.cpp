// Motion files of tracked joints: WebXR, OpenXR and LeapJS.
#include <gtest/gtest.h>

#include "motion_samples.h"

namespace lumbrical::test {
namespace {

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

TEST(WebxrMotion, KeepsAFrameInWhichOnlyTheWristIsTracked) {
  const Poses poses = bent_hand(Side::right, 0.4);
  const Motion motion = parse_good("[" + sequence_frame(1, poses) +
                                   ",{\"time\": 2, \"joints\": {\"wrist\": {\"position\": [0,0,0], "
                                   "\"orientation\": [0,0,0,1]}}}]");
  ASSERT_EQ(motion.samples.size(), 2u);
  EXPECT_EQ(motion.samples[1].frame.flags, 0u);
  EXPECT_EQ(motion.samples[1].frame.valid, 1u << kWrist);
}

TEST(WebxrMotion, SaysWhichJointOrFieldIsWrong) {
  const Poses poses = bent_hand(Side::right, 0.5);
  const std::string pose = webxr_pose(poses);
  expect_refused(replaced(pose, "thumb-tip", "thumb-nail"), "'thumb-nail' is no joint");
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
  expect_refused("[" + sequence_frame(-1e300, poses) + "]", "frame 0: time is beyond 1e12 s");
  expect_refused("[" + frame + "," + sequence_frame(1e308, poses) + "]", "frame 1: time is beyond 1e12 s");
  expect_refused("[" + frame + "," + sequence_frame(2e9, poses) + "]", "frame 1: time is more than 1e9 s");
  const Motion since_1970 =
      parse_good("[" + sequence_frame(1.7e9, poses) + "," + sequence_frame(1.8e9, poses) + "]");
  EXPECT_EQ(since_1970.samples.back().time, 1e8);
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
    EXPECT_EQ(motion.other_frames, 3u);
    EXPECT_EQ(motion.other_side, Side::left);
    for (const std::size_t i : {0u, 1u, 3u}) {
      EXPECT_EQ(motion.samples[i].frame.flags, 0u);
      EXPECT_LT(norm(position(motion.samples[i].frame, kIndexTip) - right[kIndexTip].position), 1e-6) << i;
    }
  }
  options.side = Side::left;
  const Motion other = parse_good(file, options);
  EXPECT_EQ(other.side, Side::left);
  EXPECT_EQ(other.other_frames, 3u);
  EXPECT_EQ(other.other_side, Side::right);
  EXPECT_LT(norm(position(other.samples[1].frame, kIndexTip) - left[kIndexTip].position), 1e-6);
}

TEST(LeapMotion, TakesNoHandOfTheOtherSideWhateverItsId) {
  const Poses right = bent_hand(Side::right, 0.2), left = bent_hand(Side::left, 0.6);
  const std::string hands = leap_hand(-1, Side::left) + "," + leap_hand(4, Side::right);
  MotionOptions options;
  options.side = Side::right;
  const Motion motion = parse_good(
      leap_file({leap_frame(0, hands, leap_fingers(left, -1) + "," + leap_fingers(right, 4))}), options);
  EXPECT_EQ(motion.other_side, Side::left);
  EXPECT_LT(norm(position(motion.samples[0].frame, kIndexTip) - right[kIndexTip].position), 1e-6);
}

TEST(LeapMotion, AHandWhoseSideIsToldLateOrNeverIsTheOneThatIsToldAtOnce) {
  for (const Side side : {Side::right, Side::left}) {
    SCOPED_TRACE(side_name(side));
    const Poses poses = bent_hand(side, 0.4);
    const std::string typed = leap_hand(3, side), fingers = leap_fingers(poses, 3);
    const std::string type = ", \"type\": \"" + std::string(side_name(side)) + "\"";
    const std::string untyped = replaced(typed, type, "");
    const auto motion_of = [&](const std::string& first, const std::string& second) {
      return parse_good(leap_file({leap_frame(0, first, fingers), leap_frame(10, second, fingers)}));
    };
    const Motion expected = motion_of(typed, typed);
    for (const Motion& motion : {motion_of(untyped, untyped), motion_of(untyped, typed)}) {
      EXPECT_EQ(motion.side, side);
      for (const std::size_t i : {0u, 1u})
        EXPECT_EQ(motion.samples[i].frame.joint, expected.samples[i].frame.joint);
    }
  }
}

TEST(LeapMotion, OfOneHandTellsNoOtherAndOfTheWrongSideWhichOneItShows) {
  const std::string file =
      leap_file({leap_frame(0, leap_hand(3, Side::left), leap_fingers(bent_hand(Side::left, 0.2), 3))});
  EXPECT_EQ(parse_good(file).other_frames, 0u);
  MotionOptions options;
  options.side = Side::right;
  expect_refused(file, "1 of its frames show a left one; set the side", options);
}

TEST(LeapMotion, RefusesFramesThatTakeMoreMemoryThanTheirFile) {
  std::string file = R"({"frames":[["timestamp"])";
  for (int i = 0; i < 65536; ++i) file += ",[" + std::to_string(i) + "]";
  expect_refused(file + "]}", "more than 65536 frames of less than 32 bytes");
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
  expect_refused("{\"frames\": []}", "\"frames\" is empty");
  expect_refused("{\"frames\": 5}", "array of frames");
  expect_refused(replaced(good, "\"timestamp\": 0", "\"timestamp\": null"), "frame 0: \"timestamp\"");
  expect_refused(replaced(good, "palmNormal", "normal"), "frame 0: the hand's");
  expect_refused(replaced(good, "dipPosition", "dip"), "frame 0: thumb: \"dipPosition\"");
  expect_refused(replaced(good, "\"width\": 18", "\"width\": -1"), "frame 0: thumb: \"width\"");
  expect_refused(replaced(good, "\"type\": \"right\"", "\"type\": \"left\""), "set the side to right");
  MotionOptions options;
  options.side = Side::left;
  expect_refused(good, "no frame shows a whole hand", options);
}

}  // namespace
}  // namespace lumbrical::test
