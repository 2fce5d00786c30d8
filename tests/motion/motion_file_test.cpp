// What motion files of every format have in common: damage, size, and real captures.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "files.h"
#include "motion_samples.h"
#include "sanitized.h"

namespace lumbrical::test {
namespace {

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
  const std::string path = write_file("motion.json", angle_file());
  Motion motion;
  EXPECT_TRUE(load_motion(path, {}, motion).ok());
  EXPECT_EQ(motion.samples.size(), 3u);
  std::filesystem::remove(path);
  EXPECT_FALSE(load_motion(path, {}, motion).ok());
  EXPECT_FALSE(load_motion(::testing::TempDir(), {}, motion).ok());
  EXPECT_EQ(motion.samples.size(), 3u);
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
    for (std::size_t size = 0; size < content.size(); size += sanitized_step(7)) {
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
    std::size_t sound = 0, refused = 0;
    for (std::size_t at = 0; at < content.size(); at += sanitized_step(7)) {
      std::string changed = content;
      if (at % 2 == 0) {
        changed[at] = static_cast<char>(changed[at] ^ (1 << (at / 2 % 8)));
      } else {
        changed[at] = "0,]e-9\"}"[at / 2 % 8];
      }
      Motion motion;
      if (parse(changed, motion).ok()) {
        ++sound;
        expect_sound(motion);
      } else {
        ++refused;
      }
    }
    EXPECT_GT(sound, 0u) << name;
    EXPECT_GT(refused, sound / 10) << name;
  }
}

// Real captures.

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
  const std::string path = (data_folder() / "hands" / expected.file).string();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real capture at " << path << "; set LUMBRICAL_DATA";
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
void PrintTo(const Capture& capture, std::ostream* out) {
  std::string name = capture.file;
  std::replace(name.begin(), name.end(), '.', '_');
  *out << name;
}

INSTANTIATE_TEST_SUITE_P(MotionFile, RealCapture,
                         ::testing::Values(Capture{"quest_pinch.json", "webxr", Side::left, 1, 0, 0},
                                           Capture{"quest_point.json", "webxr", Side::left, 1, 0, 0},
                                           Capture{"quest_relaxed.json", "webxr", Side::left, 1, 0, 0},
                                           Capture{"leap_grab.json", "leapjs", Side::right, 374, 3.30, 3.31},
                                           Capture{"leap_pinch.json", "leapjs", Side::right, 133, 2.35, 2.36},
                                           Capture{"video_joints_right.csv", "landmarks", Side::right, 621,
                                                   20.6, 20.7}),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace lumbrical::test
