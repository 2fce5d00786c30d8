// Motion files of landmarks and of joint angles.
#include <gtest/gtest.h>

#include "motion_samples.h"

namespace lumbrical::test {
namespace {

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
  for (const std::string time : {"-1e308", "1e308", "2e12"})
    expect_refused(landmark_header(true) + time + "," + row, "frame 0: time is beyond 1e12 s");
}

TEST(LandmarkMotion, KnowsAColumnOfSecondsByManyTitlesAndRefusesOtherUnits) {
  const std::string row = landmark_row(bent_hand(Side::right, 0.3));
  const auto titled = [&](const std::string& title) {
    return replaced(landmark_header(true), "time", title) + "1," + row + "\n1.5," + row + "\n";
  };
  for (const char* title :
       {"time", "t", "Time", "\"time\"", "timestamp", "t [s]", "\"Time (s)\"", "timestamp[s]"}) {
    SCOPED_TRACE(title);
    EXPECT_EQ(duration(parse_good(titled(title))), 0.5);
  }
  for (const char* title : {"t [ms]", "time(ms)", "frame", "\"timestamp [us]\""})
    expect_refused(titled(title), "a time in seconds only if the header begins with time, timestamp or t");
}

TEST(LandmarkMotion, FramesWithoutAHandDoNotBlurWhichHandItIs) {
  const std::string left = landmark_row(bent_hand(Side::left, 0.3));
  std::string lost = "0";
  for (int i = 1; i < 63; ++i) lost += ",0";
  std::string file = left + "\n";
  for (int i = 0; i < 9; ++i) file += lost + "\n";
  EXPECT_EQ(parse_good(file).side, Side::left);
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

// As programs write tables: `cell` in each of the 63 columns of points.
std::string row_of_cells(const std::string& cell) {
  std::string row = cell;
  for (int i = 1; i < 63; ++i) row += "," + cell;
  return row;
}

TEST(LandmarkMotion, TakesARowOfBlankCellsOrOfNanForALostHand) {
  const std::string row = landmark_row(bent_hand(Side::right, 0.3));
  MotionOptions options;
  options.rate = 10;
  for (const char* const cell : {"", " ", "nan", "NaN", "-nan"}) {
    SCOPED_TRACE(cell);
    const std::string lost = row_of_cells(cell);
    for (const std::string& file : {lost + "\n" + row + "\n" + lost + "\r\n" + row,
                                    landmark_header(false) + lost + "\n" + row + "\n" + lost + "\n" + row}) {
      const Motion motion = parse_good(file, options);
      ASSERT_EQ(motion.samples.size(), 4u);
      EXPECT_EQ(motion.samples[0].frame.flags, std::uint32_t{kTrackingLost});
      EXPECT_EQ(motion.samples[2].frame.flags, std::uint32_t{kTrackingLost});
      EXPECT_EQ(motion.samples[3].frame.flags, 0u);
      EXPECT_EQ(motion.samples[3].time, 0.3);
    }
    EXPECT_EQ(parse_good(row + "\n" + lost).samples.size(), 2u) << "without a line's end";
    const Motion timed =
        parse_good(landmark_header(true) + "0.1," + row + "\n0.2," + lost + "\n0.4," + row + "\n");
    ASSERT_EQ(timed.samples.size(), 3u);
    EXPECT_EQ(timed.samples[1].frame.flags, std::uint32_t{kTrackingLost});
    EXPECT_DOUBLE_EQ(timed.samples[2].time, 0.3);
  }
  expect_refused(landmark_header(true) + "nan," + row, "file:2:1: 'nan' is not finite");
  expect_refused(landmark_header(true) + "0.2,,,", "file:2:1: found 1 columns instead of 64");
  expect_refused(row + "\n,,,\n", "file:2:1: found 0 columns instead of 63");
}

TEST(LandmarkMotion, ARowWithoutEvenATimeIsNoFrame) {
  const std::string row = landmark_row(bent_hand(Side::right, 0.3));
  const std::string blank = "," + row_of_cells("") + "\n";
  EXPECT_EQ(parse_good(landmark_header(true) + "1," + row + "\n" + blank + "2," + row + "\n" + blank)
                .samples.size(),
            2u);
}

TEST(LandmarkMotion, AFirstRowThatHoldsNumbersIsNoHeader) {
  const std::string row = landmark_row(bent_hand(Side::right, 0.3));
  expect_refused("broken" + row.substr(row.find(',')) + "\n" + row,
                 "file:1:1: 'broken' is not a number; remove the line or correct it");
  std::string numbered = "time";
  for (int i = 0; i < 63; ++i) numbered += "," + std::to_string(i);
  EXPECT_EQ(parse_good(numbered + "\n1," + row + "\n2," + row).samples.size(), 2u);
}

TEST(LandmarkMotion, ReportsTheLineAndColumnOfWhatIsNoNumber) {
  const std::string row = landmark_row(bent_hand(Side::right, 0.3));
  const std::string first = row.substr(0, row.find(','));
  for (const char* wrong : {"nan", "inf", "1e999", "0x10", "1.2.3", "one"}) {
    expect_refused(row + "\n" + first + "," + wrong + row.substr(row.find(',', first.size() + 1)),
                   "file:2:" + std::to_string(first.size() + 2) + ": ");
  }
  expect_refused(row + "\n" + row.substr(0, row.rfind(',')), "file:2:1: found 62 columns");
  expect_refused(row + "," + row, "found 126 columns");
  expect_refused(replaced(row, first, "1e6"), "10 km");
  expect_refused("", "no samples");
  expect_refused("hello", "file:1:1: neither JSON, BVH nor a CSV");
  std::string gap = row;
  gap.erase(gap.find(',') + 1, gap.find(',', gap.find(',') + 1) - gap.find(',') - 1);
  expect_refused(gap, "file:1:1: found 62 columns instead of 63");
}

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
  expect_refused(replaced(good, "\"side\"", "\"sida\": 1, \"side\""), "unknown field 'sida'");
  expect_refused(replaced(good, "\"time\": 2.25", "\"time\": 2.25, \"angels\": []"),
                 "sample 1: unknown field 'angels'");
  expect_refused(replaced(good, "\"position\"", "\"speed\": 0, \"position\""),
                 "sample 0: wrist: unknown field 'speed'");
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

}  // namespace
}  // namespace lumbrical::test
