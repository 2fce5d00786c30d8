// A power cut at any instant: what the disk was told to keep is recovered, and it was told in time.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>

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

}  // namespace
}  // namespace lumbrical::test
