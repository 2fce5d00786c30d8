// Comparison of two recordings without the engine.
#include <gtest/gtest.h>

#include "touch_session.h"

namespace lumbrical::test {
namespace {

class Diff : public ::testing::Test {
 protected:
  void SetUp() override {
    record_touch(a_, InputKind::joint_angles);
    record_touch(b_, InputKind::joint_angles, {.broadphase = Broadphase::brute});
  }
  ReplayResult diff(const std::string& a, const std::string& b) {
    RecordingReader reader_a, reader_b;
    EXPECT_TRUE(reader_a.open(a).ok());
    EXPECT_TRUE(reader_b.open(b).ok());
    ReplayResult result;
    const Status status = diff_recordings(reader_a, reader_b, result);
    EXPECT_TRUE(status.ok()) << status.message();
    return result;
  }
  std::string a_ = temporary_path("a.mcap"), b_ = temporary_path("b.mcap"), c_ = temporary_path("c.mcap");
};

TEST_F(Diff, FindsNoneBetweenRunsOfTheSameSession) {
  const ReplayResult result = diff(a_, b_);
  EXPECT_EQ(result.ticks, kTicks);
  EXPECT_FALSE(result.first_divergence.has_value());
}

TEST_F(Diff, NamesTheFirstFieldThatDiffers) {
  alter_recording(a_, c_, [](TickRecord& record) {
    if (record.output.tick >= 70) record.device.angle[3] = 1;
    if (record.output.tick >= 50) record.output.segment[2].torque.y = 1;
    record.duration_ns = 0;
    return true;
  });
  expect_divergence(*diff(a_, c_).first_divergence, 50, "output", "segment[2].torque.y");
  alter_recording(a_, c_, [](TickRecord& record) {
    if (record.output.tick >= 20) record.device.angle[3] = 1;
    return true;
  });
  expect_divergence(*diff(a_, c_).first_divergence, 20, "input", "angle[3]");
}

TEST_F(Diff, TellsWhereOneHasATickTheOtherHasNot) {
  alter_recording(a_, c_, [](TickRecord& record) { return record.output.tick < 550; });
  const Divergence shorter = *diff(a_, c_).first_divergence;
  expect_divergence(shorter, 550, "input", "tick");
  EXPECT_EQ(shorter.recorded, "550");
  EXPECT_EQ(shorter.replayed, "none");
  alter_recording(a_, c_, [](TickRecord& record) { return record.output.tick != 33; });
  const Divergence gap = *diff(a_, c_).first_divergence;
  expect_divergence(gap, 33, "input", "tick");
  EXPECT_EQ(gap.replayed, "34");
}

TEST_F(Diff, TellsScenesApartThatWereFeltAlike) {
  std::vector<TickRecord> records;
  RecordingReader reader;
  ASSERT_TRUE(reader.open(a_).ok());
  ASSERT_TRUE(read_records(reader, records).ok());
  Scene scene = touch_scene();
  scene.objects.front().mesh.vertices.front().x += 1e-6;
  write_recording(c_, scene, records);
  expect_divergence(*diff(a_, c_).first_divergence, 0, "scene", "hash");
  scene = touch_scene();
  scene.settings.fade_time = 0.021;
  write_recording(c_, scene, records);
  const Divergence setting = *diff(a_, c_).first_divergence;
  expect_divergence(setting, 0, "scene", "fade_time");
  EXPECT_EQ(setting.replayed, "0.021");
}

}  // namespace
}  // namespace lumbrical::test
