// A disk that is full, failing or slow: told at once, what was written stays readable, and no tick waits for
// it.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <thread>

#include "faulty_disk.h"
#include "file_size_limit.h"
#include "recording_fixture.h"
#include "sanitized.h"

namespace lumbrical::test {
namespace {

using namespace std::chrono_literals;

/// Ticks in a chunk: a fifth of a second of a thousand ticks per second.
constexpr std::uint64_t kChunkTicks = 200;

/// Hands over ticks until one is refused. The writer has met the error by then, or will before close().
std::uint64_t record_until_refused(Recorder& recorder, const std::vector<TickRecord>& records) {
  std::uint64_t kept = 0;
  while (kept < records.size() && recorder.record(records[kept])) ++kept;
  return kept;
}

/// The records the file holds are the first ones of `records`; returns how many.
std::uint64_t expect_first_of(const std::string& path, const std::vector<TickRecord>& records) {
  RecordingReader reader;
  const Status status = reader.open(path);
  EXPECT_TRUE(status.ok()) << status.message();
  std::vector<TickRecord> read;
  EXPECT_TRUE(read_records(reader, read).ok());
  EXPECT_LE(read.size(), records.size());
  for (std::size_t i = 0; i < read.size(); ++i) EXPECT_TRUE(is_same(read[i], records[i])) << i;
  return read.size();
}

TEST(FullDisk, IsToldAtOnceWhereverItStrikesAndLeavesWholeChunks) {
  const std::vector<TickRecord> records = random_records(2000, 31);
  const std::string whole_path = temporary_path("whole.mcap");
  write_recording(whole_path, small_scene(), records);
  const std::uint64_t whole = std::filesystem::file_size(whole_path);
  std::uint64_t without_file = 0, without_tick = 0, with_ticks = 0;
  constexpr std::uint64_t kSteps = 40 / sanitized_step(3);
  for (std::uint64_t step = 0; step < kSteps; ++step) {
    const std::uint64_t room = (step * whole + step) / kSteps;
    SCOPED_TRACE("full after " + std::to_string(room) + " bytes");
    const std::string path = temporary_path("full.mcap");
    FaultyDisk disk(cleared(path));
    disk.fail_after(room, step % 2 == 0 ? ENOSPC : EIO);
    const std::string words = step % 2 == 0 ? "No space left on device" : "Input/output error";
    const std::string expected = path + ".part: cannot be written: " + words;
    Recorder recorder;
    Status status = recorder.open(path, small_scene(), {});
    if (!status.ok()) {  // no room for the session: there is nothing worth keeping
      EXPECT_EQ(status.message(), expected);
      EXPECT_FALSE(std::filesystem::exists(path + ".part"));
      ++without_file;
      continue;
    }
    if (record_until_refused(recorder, records) < records.size()) {
      EXPECT_EQ(recorder.failure().message(), expected);
      EXPECT_FALSE(recorder.record(records.back())) << "nothing is kept any more";
    }
    status = recorder.close();
    EXPECT_EQ(status.message(), expected);
    const std::uint64_t kept = expect_first_of(path, records);
    EXPECT_EQ(kept % kChunkTicks, 0u);
    EXPECT_LE(std::filesystem::file_size(path + ".part"), room);
    ++(kept > 0 ? with_ticks : without_tick);
    std::uint64_t recovered = 0, lost = 0;
    EXPECT_TRUE(recover_recording(path, cleared(temporary_path("recovered.mcap")), recovered, lost).ok());
    EXPECT_EQ(recovered, kept);
  }
  EXPECT_GT(without_file, 0u);
  EXPECT_GT(with_ticks, kSteps / 2);
}

TEST(FullDisk, LeavesAReadableFileEvenWhereItCannotBeCutBack) {
  const std::vector<TickRecord> records = random_records(2000, 32);
  const std::string path = temporary_path("full.mcap");
  write_recording(path, small_scene(), records);
  const std::uint64_t whole = std::filesystem::file_size(path);
  FaultyDisk disk(cleared(path));
  disk.fail_after(whole / 2, ENOSPC);
  disk.fail_cuts(EIO);
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), {}).ok());
  record_until_refused(recorder, records);
  const Status status = recorder.close();
  EXPECT_EQ(status.message(), path + ".part: cannot be written: No space left on device; " + path +
                                  ".part: cannot be cut back: Input/output error");
  EXPECT_GE(expect_first_of(path, records), kChunkTicks);
}

TEST(FullDisk, ThatFailsAtTheEndLeavesWhatWasRecordedUnderItsOtherName) {
  const std::string path = temporary_path("a.mcap");
  const std::vector<TickRecord> records = random_records(600, 34);
  for (const int fault : {1, 2}) {
    FaultyDisk disk(cleared(path));
    Recorder recorder;
    ASSERT_TRUE(recorder.open(path, small_scene(), {}).ok());
    if (fault == 1) disk.fail_syncs(EIO);
    if (fault == 2) disk.fail_renames(EXDEV);
    const std::uint64_t kept = record_until_refused(recorder, records);  // all, but on a machine that stalls
    const Status status = recorder.close();
    EXPECT_NE(status.message().find(path), std::string::npos) << status.message();
    EXPECT_FALSE(std::filesystem::exists(path)) << fault;
    EXPECT_GE(expect_first_of(path + ".part", records) + kChunkTicks + RecorderOptions{}.ring_capacity, kept);
  }
}

TEST(FullDisk, ThatDoesNotTakeTheSessionIsToldBeforeTheFirstTick) {
  const std::string path = temporary_path("a.mcap");
  FaultyDisk disk(path);
  disk.fail_syncs(EIO);
  EXPECT_EQ(Recorder().open(path, small_scene(), {}).message(),
            path + ".part: cannot be written: Input/output error");
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

TEST(FullDisk, IsToldByTheSystemItself) {
  const std::string path = temporary_path("full.mcap");
  const std::vector<TickRecord> records = random_records(5000, 9);
  {
    const FileSizeLimit limit(300000);
    ASSERT_TRUE(limit.is_set());
    Recorder recorder;
    ASSERT_TRUE(recorder.open(path, small_scene(), {}).ok());
    bool kept = true;
    for (const TickRecord& record : records) kept = recorder.record(record);
    EXPECT_FALSE(kept);
    EXPECT_NE(recorder.close().message().find(path + ".part: cannot be written: File too large"),
              std::string::npos);
  }
  EXPECT_GT(expect_first_of(path, records), 0u);
}

// The writer is held inside its write to the disk for as long as ticks come. That they all come proves that
// none of them waits.
TEST(SlowDisk, NeverDelaysATickOfALiveSessionAndTheGapIsMarked) {
  constexpr std::uint32_t kRing = 64;
  const std::string path = temporary_path("slow.mcap");
  const std::vector<TickRecord> records = random_records(4000, 35);
  RecorderOptions options;
  options.wait_when_full = false;
  options.ring_capacity = kRing;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), options).ok());
  FaultyDisk disk(path);
  disk.hold();

  std::vector<bool> kept(records.size());
  std::size_t next = 0;
  const auto push = [&] {
    kept[next] = recorder.record(records[next]);
    return kept[next++];
  };
  while (!push() || next <= kChunkTicks) std::this_thread::sleep_for(100us);  // beyond the first chunk's end
  disk.wait_until_held();
  const std::uint64_t bytes = disk.written();
  std::uint64_t room = 0;
  while (push()) ++room;
  EXPECT_LE(room, kRing);
  for (int i = 0; i < 2000; ++i) ASSERT_FALSE(push()) << "the ring is full";
  EXPECT_EQ(disk.written(), bytes) << "the disk was not held";
  disk.release();
  // Once the disk is back so is the recording.
  while (!push()) {
    ASSERT_LT(next + 1, records.size()) << "the writer does not go on";
    std::this_thread::sleep_for(1ms);
  }
  ASSERT_TRUE(recorder.failure().ok());
  ASSERT_TRUE(recorder.close().ok());

  RecordingInfo info;
  const Status verdict = verify_recording(path, info);
  ASSERT_TRUE(verdict.ok()) << verdict.message();
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  std::vector<TickRecord> read;
  ASSERT_TRUE(read_records(reader, read).ok());
  std::vector<bool> found(records.size());
  for (const TickRecord& record : read) found[record.output.tick] = true;
  EXPECT_EQ(found, kept) << "the missing numbers are not those that were refused";
  EXPECT_GE(reader.info().missing_ticks, 2000u);
  EXPECT_EQ(reader.info().missing_ticks,
            reader.info().last_tick - reader.info().first_tick + 1 - reader.info().ticks);
  // Copies and recovery tell the same gap.
  std::uint64_t recovered = 0, lost = 0;
  std::vector<TickRange> missing;
  ASSERT_TRUE(recover_recording(path, temporary_path("again.mcap"), recovered, lost, &missing).ok());
  EXPECT_EQ(lost, reader.info().missing_ticks);
  for (const TickRange& gap : missing)
    for (std::uint64_t tick = gap.first; tick <= gap.last; ++tick) EXPECT_FALSE(kept[tick]) << tick;
}

TEST(SlowDisk, MakesALockstepSessionWaitAndLosesNothing) {
  const std::string path = temporary_path("slow.mcap");
  const std::vector<TickRecord> records = random_records(2000, 36);
  RecorderOptions options;
  options.ring_capacity = 64;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), options).ok());
  FaultyDisk disk(path);
  disk.hold();
  std::atomic<std::uint64_t> pushed{0};
  std::thread session([&] {
    for (const TickRecord& record : records) pushed += recorder.record(record) ? 1 : 0;
  });
  disk.wait_until_held();
  std::this_thread::sleep_for(20ms);  // time enough to go on, were it wrong
  EXPECT_LE(pushed.load(), kChunkTicks + options.ring_capacity);
  disk.release();
  session.join();
  EXPECT_EQ(pushed.load(), records.size());
  ASSERT_TRUE(recorder.close().ok());
  EXPECT_EQ(expect_first_of(path, records), records.size());
}

TEST(SlowDisk, ThatFailsInTheEndEndsALockstepSessionsWait) {
  const std::string path = temporary_path("slow.mcap");
  const std::vector<TickRecord> records = random_records(2000, 37);
  RecorderOptions options;
  options.ring_capacity = 64;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), options).ok());
  FaultyDisk disk(path);
  disk.fail_after(0, ENOSPC);
  disk.hold();
  std::thread helper([&] {
    disk.wait_until_held();
    disk.release();
  });
  EXPECT_LT(record_until_refused(recorder, records), records.size());
  helper.join();
  EXPECT_FALSE(recorder.failure().ok());
  EXPECT_FALSE(recorder.close().ok());
}

}  // namespace
}  // namespace lumbrical::test
