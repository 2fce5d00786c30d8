// The recording in recordings/, made once and kept: what a program wrote then is read, verified and replayed
// now.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "base/hash.h"
#include "golden/golden_hashes.h"
#include "lumbrical/recording.h"

namespace lumbrical {
namespace {

constexpr const char* kSample = LUMBRICAL_SOURCE_DIR "/recordings/sample.mcap";

// Whoever changes bits on purpose makes golden_hashes.h and this recording anew, in the same commit.
TEST(SampleRecording, ReplaysIdenticalUntilItIsMadeAnewTogetherWithTheGoldenHashes) {
  RecordingInfo info;
  Status status = verify_recording(kSample, info);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(info.version, 1u);
  EXPECT_EQ(info.ticks, 100u);
  RecordingReader reader;
  status = reader.open(kSample);
  ASSERT_TRUE(status.ok()) << status.message();
  ReplayResult result;
  status = replay(reader, {}, result);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(result.ticks, info.ticks);
  EXPECT_FALSE(result.first_divergence)
      << "tick " << result.first_divergence->tick << ", " << result.first_divergence->stage << ", "
      << result.first_divergence->field << ": recorded " << result.first_divergence->recorded << ", replayed "
      << result.first_divergence->replayed
      << "\nIf this is what the change is about, make the sample anew as recordings/README.md says.";
}

// Or the test above would say nothing.
TEST(SampleRecording, TouchesForAWhileAndLeavesOutSomeForces) {
  RecordingReader reader;
  ASSERT_TRUE(reader.open(kSample).ok());
  double felt = 0;
  int with_forces = 0, far = 0;
  for (bool end = false; !end;) {
    TickRecord record;
    ASSERT_TRUE(reader.next(record, end).ok());
    if (end) break;
    with_forces += record.has_forces ? 1 : 0;
    far += record.output.contact_count == 0 ? 1 : 0;
    for (const Wrench& wrench : record.output.segment) felt += record.has_forces ? norm(wrench.force) : 0;
  }
  EXPECT_GT(felt, 1);
  EXPECT_GT(far, 10);
  EXPECT_EQ(with_forces, 20);
}

TEST(Arithmetic, VersionIsTheHashOfTheGoldenHashes) {
  Hasher hasher;
  for (const test::GoldenHash& golden : test::kGolden) hasher.value(golden.hash);
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%08x", static_cast<unsigned>(hasher.digest() >> 32));
  EXPECT_EQ(arithmetic_version(), std::string(digits.data()))
      << "the golden hashes have changed: put these digits into engine/src/recording/build_text.cpp";
}

}  // namespace
}  // namespace lumbrical
