// What verify tells of a file whose container is in order: forged numbers, ticks that are missing or out of
// order. And replay tells whatever verify does.
#include <gtest/gtest.h>

#include "touch_session.h"

namespace lumbrical::test {
namespace {

class Verified : public ::testing::Test {
 protected:
  void SetUp() override { write_recording(path_, small_scene(), records_); }

  /// The recording after `edit` has gone over its ticks, with every checksum right.
  Status edited(const std::function<bool(TickRecord&)>& edit) {
    alter_recording(path_, edited_, edit);
    return verify_recording(edited_, info_, &missing_);
  }
  void expect_told(const Status& status, const std::string& what) {
    EXPECT_NE(status.message().find(what), std::string::npos) << status.message();
    EXPECT_EQ(status.message().find(edited_ + ": byte "), 0u) << status.message();
  }

  std::vector<TickRecord> records_ = random_records(700, 71);
  std::string path_ = temporary_path("a.mcap"), edited_ = temporary_path("edited.mcap");
  RecordingInfo info_;
  std::vector<TickRange> missing_;
};

TEST_F(Verified, ForgedForcesAreTold) {
  expect_told(edited([](TickRecord& record) {
                if (record.output.tick == 321) record.output.segment[4].force.x = 12.5;
                return true;
              }),
              "tick 321: its output was changed");
  expect_told(edited([](TickRecord& record) {
                if (record.output.tick == 3) record.output.flags ^= kFading;
                return true;
              }),
              "tick 3: its output was changed");
  expect_told(edited([](TickRecord& record) {
                if (record.output.tick == 699) ++record.stage_hash[static_cast<std::size_t>(Stage::limits)];
                return true;
              }),
              "tick 699: its output was changed");
}

TEST_F(Verified, AForgedInputIsToldByItsField) {
  expect_told(edited([](TickRecord& record) {
                if (record.output.tick == 20) record.device.base.position.y = 1;
                return true;
              }),
              "base.position.y was ");
  expect_told(edited([](TickRecord& record) {
                if (record.output.tick == 20) ++record.stage_hash[static_cast<std::size_t>(Stage::input)];
                return true;
              }),
              "the hash of its input was changed");
}

TEST_F(Verified, EveryMissingTickIsTold) {
  const auto is_gone = [](std::uint64_t tick) {
    return tick < 5 || (tick >= 57 && tick < 60) || tick == 400;
  };
  ASSERT_TRUE(edited([&](const TickRecord& record) { return !is_gone(record.output.tick); }).ok());
  EXPECT_EQ(missing_, (std::vector<TickRange>{{0, 4}, {57, 59}, {400, 400}}));
  ASSERT_TRUE(edited([](const TickRecord&) { return true; }).ok());
  EXPECT_TRUE(missing_.empty());
}

TEST_F(Verified, ALaterPartThatBringsItsStateLacksNothing) {
  const std::string path = temporary_path("touch.mcap"), part = temporary_path("part.mcap");
  record_touch(path, InputKind::joint_poses);
  CopyResult result;
  ASSERT_TRUE(copy_recordings({path}, part, {50, 90, std::nullopt}, result).ok());
  ASSERT_TRUE(result.replayable);
  ASSERT_TRUE(verify_recording(part, info_, &missing_).ok());
  EXPECT_TRUE(missing_.empty());
}

// Ticks as the edit numbers them, in a container that is in order.
Status renumbered(const std::string& path,
                  const std::vector<std::pair<std::uint64_t, std::uint32_t>>& ticks) {
  std::vector<std::uint8_t> session;
  EXPECT_TRUE(encode_session(small_scene(), session).ok());
  McapWriter writer;
  EXPECT_TRUE(open_recording(cleared(path), 1000, session, {}, {}, {}, writer).ok());
  RandomBits random(72);
  flatbuffers::FlatBufferBuilder builder;
  for (const auto& [tick, sequence] : ticks) {
    const TickRecord record = random_record(random, tick);
    encode_tick(record, true, input_check_of(record), builder);
    EXPECT_TRUE(
        writer.message(tick_time(tick, 1e6), sequence, {builder.GetBufferPointer(), builder.GetSize()}).ok());
  }
  EXPECT_TRUE(writer.close().ok());
  RecordingInfo info;
  return verify_recording(path, info);
}

TEST_F(Verified, TicksOutOfOrderAreTold) {
  EXPECT_TRUE(renumbered(edited_, {{0, 0}, {1, 1}, {2, 2}}).ok());
  expect_told(renumbered(edited_, {{0, 0}, {2, 2}, {1, 1}}),
              "tick 1 stands where tick 3 or a later one is due");
  expect_told(renumbered(edited_, {{0, 0}, {1, 1}, {1, 1}}),
              "tick 1 stands where tick 2 or a later one is due");
  expect_told(renumbered(edited_, {{0, 0}, {1, 7}}), "tick 1 has the sequence number 7");
}

// Any bit of a closed file: replay fails, differs, or says what verify says.
TEST(Flipped, NoBitOfFiveHundredPassesVerifyOrReplay) {
  const std::string whole = temporary_path("touch.mcap"), path = temporary_path("short.mcap"),
                    flipped = temporary_path("flipped.mcap");
  record_touch(whole, InputKind::joint_angles);
  CopyResult copied;
  ASSERT_TRUE(copy_recordings({whole}, path, {0, 30, std::nullopt}, copied).ok());
  const std::vector<std::uint8_t> good = read_bytes(path);
  RandomBits random(73);
  std::uint64_t by_damage = 0;
  for (int i = 0; i < 500; ++i) {
    std::vector<std::uint8_t> bytes = good;
    const std::uint64_t bit = random.word() % (8 * bytes.size());
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    write_bytes(flipped, bytes);
    RecordingInfo info;
    EXPECT_FALSE(verify_recording(flipped, info).ok()) << "bit " << bit;
    RecordingReader reader;
    ReplayResult result;
    if (!reader.open(flipped).ok() || !replay(reader, {}, result).ok() || result.first_divergence) continue;
    EXPECT_NE(result.damage, "") << "bit " << bit;
    ++by_damage;
  }
  EXPECT_GT(by_damage, 0u) << "none was left to verify";
  RecordingReader reader;
  ReplayResult result;
  ASSERT_TRUE(reader.open(path).ok());
  ASSERT_TRUE(replay(reader, {}, result).ok());
  EXPECT_EQ(result.damage, "");
}

}  // namespace
}  // namespace lumbrical::test
