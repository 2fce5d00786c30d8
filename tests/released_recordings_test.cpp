// Recordings of released format versions are still read, verified and replayed.
#include <gtest/gtest.h>

#include <filesystem>

#include "lumbrical/recording.h"
#include "touch_session.h"

namespace lumbrical {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> released_recordings() {
  std::vector<std::string> paths;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::path(LUMBRICAL_SOURCE_DIR) / "recordings")) {
    if (entry.path().extension() == ".mcap") paths.push_back(entry.path().string());
  }
  return paths;
}

TEST(ReleasedRecordings, AreStillReadVerifiedAndReplayed) {
  const std::vector<std::string> paths = released_recordings();
  ASSERT_FALSE(paths.empty());
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    RecordingInfo info;
    Status status = verify_recording(path, info);
    EXPECT_TRUE(status.ok()) << status.message();
    RecordingReader reader;
    status = reader.open(path);
    ASSERT_TRUE(status.ok()) << status.message();
    ReplayResult replayed;
    status = replay(reader, {}, replayed);
    ASSERT_TRUE(status.ok()) << status.message();
    if (replayed.first_divergence) {  // the engine may compute otherwise by now, but not much
      EXPECT_NE(replayed.first_divergence->stage, "input");
      // Up to version 2 the hash of a hand that touches nothing tells of a palm that is another one by now.
      EXPECT_GT(replayed.ticks, info.version > 2 ? 10u : 0u) << "not even a hand that touches nothing agrees";
      RecordProperty("diverges", replayed.first_divergence->stage);
    }
    WhatIfResult change;
    status = what_if(reader, {}, change);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(change.ticks, info.ticks);
    EXPECT_GE(change.ticks, 100u);
    for (const Change& force : change.force) EXPECT_LT(force.max, 0.1);  // [N] the palm was a prism
    double felt = 0;
    ASSERT_TRUE(reader.seek(0).ok());
    for (bool end = false; !end;) {
      TickRecord record;
      ASSERT_TRUE(reader.next(record, end).ok());
      for (const Wrench& wrench : record.output.segment) felt += norm(wrench.force);
    }
    EXPECT_GT(felt, 1) << "the recording touches nothing";
  }
}

// A session as versions 1 and 2 would have recorded it, by an engine that computes as today's.
TEST(ReleasedRecordings, OfFormerHashesAreReplayedIdenticalTrimmedAndTold) {
  const std::string today = test::temporary_path("today.mcap"), former = test::temporary_path("former.mcap"),
                    part = test::temporary_path("part.mcap"), altered = test::temporary_path("altered.mcap");
  test::record_touch(today, InputKind::joint_angles);
  Model model;
  ASSERT_TRUE(build_model(test::touch_scene(), {}, model).ok());
  State state;
  Scratch scratch = make_scratch(model);
  scratch.hash_kind = HashKind::former;
  const auto rewrite = [&](TickRecord& record) {
    tick(model, state, scratch, record.device);
    EXPECT_NE(record.stage_hash, scratch.stage_hash);
    record.stage_hash = scratch.stage_hash;
    record.state_hash = hash_state(state, HashKind::former);
    return true;
  };
  test::alter_recording(today, former, rewrite, 2);
  RecordingInfo info;
  ASSERT_TRUE(verify_recording(former, info).ok());
  EXPECT_EQ(info.version, 2u);
  ReplayResult result;
  ASSERT_TRUE(test::replay_file(former, result).ok());
  EXPECT_FALSE(result.first_divergence);
  EXPECT_EQ(result.ticks, test::kTicks);

  CopyOptions options;
  options.from = 300;  // within the touch
  CopyResult copied;
  ASSERT_TRUE(copy_recordings({former}, part, options, copied).ok());
  EXPECT_TRUE(copied.replayable);
  ASSERT_TRUE(test::replay_file(part, result).ok());
  EXPECT_FALSE(result.first_divergence);
  EXPECT_EQ(result.ticks, test::kTicks - 300);

  test::alter_recording(former, altered, [](TickRecord& record) {
    if (record.output.tick == 301) record.stage_hash[3] ^= 1;
    if (record.output.tick == 305) record.device.angle[2] = 1;
    return true;
  });
  ASSERT_TRUE(test::replay_file(altered, result).ok());
  test::expect_divergence(*result.first_divergence, 301, "narrowphase", "hash");
  RecordingReader reader;
  ASSERT_TRUE(reader.open(altered).ok());
  ASSERT_TRUE(reader.seek(305).ok());
  TickRecord record;
  bool end = false;
  ASSERT_TRUE(reader.next(record, end).ok());
  test::expect_divergence(*reader.altered_input(), 305, "input", "angle[2]");
}

}  // namespace
}  // namespace lumbrical
