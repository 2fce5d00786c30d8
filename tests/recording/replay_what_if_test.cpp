// What another law, stiffness or mesh would have changed in a recorded session.
#include <gtest/gtest.h>

#include <cmath>

#include "touch_session.h"

namespace lumbrical::test {
namespace {

class WhatIf : public TouchReplay {};
INSTANTIATE_TEST_SUITE_P(Inputs, WhatIf, ::testing::Values(InputKind::joint_poses, InputKind::joint_angles),
                         testing::PrintToStringParamName());

TEST_P(WhatIf, FindsTheFirstTickThatChanges) {
  ReplayOptions law, stiffness;
  law.law = Law::max_depth;
  stiffness.stiffness = 1e6;
  ReplayResult result;
  ASSERT_TRUE(replay_file(path_, result, law).ok());
  EXPECT_TRUE(result.first_divergence.has_value());
  ASSERT_TRUE(replay_file(path_, result, stiffness).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  EXPECT_GE(result.first_divergence->tick, 1u) << "nothing is touched at first";
  EXPECT_EQ(result.ticks, result.first_divergence->tick + 1);

  ReplayOptions bad;
  bad.stiffness = -1;
  const Status status = replay_file(path_, result, bad);
  EXPECT_NE(status.message().find("stiffness"), std::string::npos) << status.message();
}

Status what_if_file(const std::string& path, const ReplayOptions& options, WhatIfResult& result) {
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  return what_if(reader, options, result);
}

TEST_P(WhatIf, SaysHowMuchAStifferWorldWouldChange) {
  Scene unlimited = touch_scene();
  unlimited.settings.max_force = 1e6;
  record_touch(path_, GetParam(), {}, unlimited);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path_).ok());
  std::vector<TickRecord> records;
  ASSERT_TRUE(read_records(reader, records).ok());

  WhatIfResult same, stiffer;
  ASSERT_TRUE(what_if_file(path_, {}, same).ok());
  ReplayOptions options;
  options.stiffness = 1.5 * touch_scene().settings.stiffness;
  ASSERT_TRUE(what_if_file(path_, options, stiffer).ok());
  EXPECT_EQ(stiffer.ticks, kTicks);
  EXPECT_GT(stiffer.baseline_time, 0);
  EXPECT_GT(stiffer.changed_time, 0);
  int touched = 0;
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    EXPECT_EQ(same.force[finger].max, 0);
    double largest = 0, squares = 0, noticed = 0;
    for (const TickRecord& record : records) {
      Vec3 force;
      for (std::size_t s = 3 * finger; s < 3 * finger + 3; ++s) force += record.output.segment[s].force;
      const double change = 0.5 * norm(force);  // half as much again
      largest = std::fmax(largest, change);
      noticed = std::fmax(noticed, change / (0.07 * std::fmax(norm(force), 0.5)));
      squares += change * change;
    }
    EXPECT_NEAR(stiffer.force[finger].max, largest, 1e-9 + 1e-9 * largest);
    EXPECT_NEAR(stiffer.force[finger].rms, std::sqrt(squares / static_cast<double>(kTicks)), 1e-9);
    EXPECT_NEAR(stiffer.force_jnd[finger].max, noticed, 1e-6);
    touched += largest > 0.5 ? 1 : 0;
    EXPECT_EQ(stiffer.felt_ticks[finger] > 0, noticed > 1);
  }
  EXPECT_GE(touched, 1);
}

TEST_P(WhatIf, KeepsNoPartOfASessionThatCannotBeReadToItsEnd) {
  const std::string damaged = temporary_path("damaged.mcap"), kept = temporary_path("kept.mcap");
  std::vector<std::uint8_t> bytes = read_bytes(path_);
  bytes[bytes.size() / 2] ^= 1;  // in a chunk
  write_bytes(damaged, bytes);
  ReplayOptions options;
  options.stiffness = 1e6;
  options.record = kept;
  WhatIfResult result;
  EXPECT_FALSE(what_if_file(damaged, options, result).ok());
  EXPECT_FALSE(std::filesystem::exists(kept));
  EXPECT_FALSE(std::filesystem::exists(kept + kPartSuffix));
  const Status status = what_if_file(path_, options, result);
  EXPECT_TRUE(status.ok()) << status.message();
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(kept, info).ok());
  EXPECT_EQ(info.ticks, kTicks);
}

TEST_P(WhatIf, SaysWhatAnotherMeshWouldChange) {
  ReplayOptions options;
  options.mesh["ball"] = touch_scene().objects[0].mesh;
  WhatIfResult result;
  ASSERT_TRUE(what_if_file(path_, options, result).ok());
  for (const Change& change : result.force) EXPECT_EQ(change.max, 0);
  for (Vec3& vertex : options.mesh["ball"].vertices) vertex.z += 0.002;
  ASSERT_TRUE(what_if_file(path_, options, result).ok());
  double largest = 0;
  for (const Change& change : result.force) largest = std::fmax(largest, change.max);
  EXPECT_GT(largest, 0.1);
  options.mesh = {{"bowl", options.mesh["ball"]}};
  const Status status = what_if_file(path_, options, result);
  EXPECT_NE(status.message().find("no object \"bowl\""), std::string::npos) << status.message();
}

}  // namespace
}  // namespace lumbrical::test
