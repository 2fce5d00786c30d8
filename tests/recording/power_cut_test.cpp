// A power cut at any instant: what the disk was told to keep is recovered, and it was told in time.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

#include "faulty_disk.h"
#include "recording_fixture.h"

namespace lumbrical::test {
namespace {

using namespace std::chrono_literals;

/// The file as it may be found after the cut: what was kept, and of the rest any pages, as they were or zero.
std::vector<std::uint8_t> after_cut(const std::vector<std::uint8_t>& file, std::uint64_t kept,
                                    RandomBits& random) {
  constexpr std::uint64_t kPage = 4096;
  std::vector<std::uint8_t> found(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(kept));
  if (random.coin()) return found;
  found = file;
  for (std::uint64_t page = kept / kPage; page * kPage < file.size(); ++page) {
    const std::uint64_t begin = std::max(kept, page * kPage), end = std::min((page + 1) * kPage, file.size());
    if (random.coin()) std::memset(found.data() + begin, 0, end - begin);
  }
  return found;
}

std::uint64_t ticks_in(const std::vector<std::uint8_t>& bytes) {
  const std::string path = temporary_path("kept.mcap");
  write_bytes(path, bytes);
  RecordingReader reader;
  const Status status = reader.open(path);
  EXPECT_TRUE(status.ok()) << status.message();
  return reader.info().ticks;
}

struct Moment {
  std::vector<std::uint8_t> file;
  Kept kept;
};

TEST(PowerCut, LosesNothingTheDiskWasToldToKeep) {
  const std::string path = temporary_path("cut.mcap"), found = temporary_path("found.mcap"),
                    recovered_path = temporary_path("recovered.mcap");
  const std::vector<TickRecord> records = random_records(2000, 51);
  FaultyDisk disk(path);
  RecorderOptions options;
  options.sync_seconds = 0.01;
  options.chunk_seconds = 0.01;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), options).ok());
  EXPECT_TRUE(disk.kept().part) << "the file has a name before the first tick";
  std::vector<Moment> moments;
  const auto cut = [&] {
    const Kept kept = disk.kept();  // before the file is read: it only grows
    moments.push_back({read_bytes(path + ".part"), kept});
  };
  cut();
  for (const TickRecord& record : records) {
    ASSERT_TRUE(recorder.record(record));
    if (record.output.tick % 100 == 99) std::this_thread::sleep_for(3ms);
    if (record.output.tick % 130 == 129) cut();
  }
  const std::uint64_t syncs = disk.kept().syncs;
  while (disk.kept().syncs < syncs + 2) std::this_thread::sleep_for(1ms);  // it goes on being told
  cut();
  EXPECT_GE(ticks_in(moments.back().file), records.size() - 10) << "all but the open chunk";
  EXPECT_EQ(moments.back().kept.bytes, moments.back().file.size());
  ASSERT_TRUE(recorder.close().ok());
  EXPECT_FALSE(disk.kept().renamed_unsynced) << "a name for a file that may be torn";
  EXPECT_TRUE(disk.kept().whole) << "the name may be lost";

  RandomBits random(52);
  for (const Moment& moment : moments) {
    ASSERT_LE(moment.kept.bytes, moment.file.size());
    const std::vector<std::uint8_t> kept(
        moment.file.begin(), moment.file.begin() + static_cast<std::ptrdiff_t>(moment.kept.bytes));
    write_bytes(found, after_cut(moment.file, moment.kept.bytes, random));
    std::uint64_t recovered = 0, lost = 0;
    const Status status = recover_recording(found, cleared(recovered_path), recovered, lost);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_GE(recovered, ticks_in(kept));
    RecordingReader reader;
    std::vector<TickRecord> read;
    ASSERT_TRUE(reader.open(recovered_path).ok());
    ASSERT_TRUE(read_records(reader, read).ok());
    for (const TickRecord& record : read) EXPECT_TRUE(is_same(record, records[record.output.tick]));
  }
}

// As `lumbrical run` records with a device: whatever instant the power is cut at, what is on the disk is no
// older than docs/recording.md says. On a machine so busy that this thread wakes up late, the recorder's may,
// too.
TEST(PowerCut, LosesNoMoreThanOneAndAHalfSecondsOfALiveSession) {
  const std::string path = temporary_path("live.mcap");
  const std::vector<TickRecord> records = random_records(2600, 53);
  FaultyDisk disk(path);
  RecorderOptions options;
  options.wait_when_full = false;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), options).ok());
  struct Instant {
    std::uint64_t ticks, kept;
  };
  std::vector<Instant> instants;
  const auto begun = std::chrono::steady_clock::now();
  auto latest = begun;
  std::chrono::steady_clock::duration late{};
  std::uint64_t ticks = 0;
  while (ticks < records.size()) {
    const auto now = std::chrono::steady_clock::now();
    late = std::max(late, now - std::exchange(latest, now));
    while (ticks < records.size() && begun + ticks * 1ms <= now)
      ASSERT_TRUE(recorder.record(records[ticks++]));
    instants.push_back({ticks, disk.kept().bytes});
    std::this_thread::sleep_for(20ms);
  }
  const std::vector<std::uint8_t> file = read_bytes(path + ".part");
  const double allowed = 1500 + 2e3 * std::chrono::duration<double>(late).count();
  std::uint64_t kept = 0, of = 0;
  for (const Instant& instant : instants) {
    if (instant.kept != of) {
      of = instant.kept;
      kept = ticks_in({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(of)});
    }
    EXPECT_LE(static_cast<double>(instant.ticks - kept), allowed);
  }
  EXPECT_GT(kept, 1000u) << "the disk was told, and more than once";
}

}  // namespace
}  // namespace lumbrical::test
