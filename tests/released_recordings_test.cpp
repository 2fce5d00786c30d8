// Recordings of released format versions are still read, verified and replayed.
#include <gtest/gtest.h>

#include <filesystem>

#include "lumbrical/recording.h"

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
      RecordProperty("diverges", replayed.first_divergence->stage);
    }
    WhatIfResult change;
    status = what_if(reader, {}, change);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(change.ticks, info.ticks);
    EXPECT_GE(change.ticks, 100u);
    for (const Change& force : change.force) EXPECT_LT(force.max, 1e-4);  // [N]
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

}  // namespace
}  // namespace lumbrical
