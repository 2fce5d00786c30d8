// The recorder and its reader: every bit comes back, gaps and errors are told, and torn or damaged files are
// found out.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "fork.h"
#include "recording_fixture.h"

namespace lumbrical {
namespace {

using namespace std::chrono_literals;
using test::expect_same;
using test::random_records;
using test::read_bytes;
using test::read_records;
using test::small_scene;
using test::temporary_path;
using test::write_bytes;
using test::write_recording;

class Recording : public ::testing::TestWithParam<Compression> {};

TEST_P(Recording, BringsEveryTickBack) {
  const std::string path = temporary_path("a.mcap");
  const std::vector<TickRecord> records = random_records(1300, 2);
  RecorderOptions options;
  options.compression = GetParam();
  options.metadata = {{"operator", "someone"}, {"note", "with \n and \xff"}};
  options.ring_capacity = 16;
  write_recording(path, small_scene(), records, options);

  RecordingReader reader;
  const Status status = reader.open(path);
  ASSERT_TRUE(status.ok()) << status.message();
  const RecordingInfo& info = reader.info();
  EXPECT_TRUE(info.complete);
  EXPECT_EQ(info.ticks, 1300u);
  EXPECT_EQ(info.first_tick, 0u);
  EXPECT_EQ(info.last_tick, 1299u);
  EXPECT_EQ(info.missing_ticks, 0u);
  EXPECT_DOUBLE_EQ(info.seconds, 1.3);
  EXPECT_GE(info.chunks, 6u);
  options.metadata["build"] = build_text();
  options.metadata["arithmetic"] = arithmetic_version();
  EXPECT_EQ(info.metadata, options.metadata);
  EXPECT_EQ(info.bytes, std::filesystem::file_size(path));
  std::vector<TickRecord> read;
  ASSERT_TRUE(read_records(reader, read).ok());
  ASSERT_EQ(read.size(), records.size());
  for (std::size_t i = 0; i < read.size(); ++i) expect_same(read[i], records[i]);

  RecordingInfo verified;
  const Status verdict = verify_recording(path, verified);
  EXPECT_TRUE(verdict.ok()) << verdict.message();
  EXPECT_EQ(verified.ticks, 1300u);
}

INSTANTIATE_TEST_SUITE_P(Compressions, Recording,
                         ::testing::Values(Compression::none, Compression::lz4, Compression::zstd),
                         testing::PrintToStringParamName());

TEST(RecordingReader, FindsAnyTick) {
  const std::string path = temporary_path("a.mcap");
  std::vector<TickRecord> records = random_records(1000, 3);
  records.erase(records.begin() + 300, records.begin() + 700);
  write_recording(path, small_scene(), records);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  for (const std::uint64_t tick : {999u, 0u, 250u, 249u, 299u, 300u, 500u, 700u, 998u, 1u}) {
    ASSERT_TRUE(reader.seek(tick).ok());
    TickRecord record;
    bool end = true;
    ASSERT_TRUE(reader.next(record, end).ok());
    ASSERT_FALSE(end);
    EXPECT_EQ(record.output.tick, tick >= 300 && tick < 700 ? 700 : tick);
  }
  ASSERT_TRUE(reader.seek(1000).ok());
  TickRecord record;
  bool end = false;
  ASSERT_TRUE(reader.next(record, end).ok());
  EXPECT_TRUE(end);
  ASSERT_TRUE(reader.seek(0).ok());
  std::vector<TickRecord> read;
  ASSERT_TRUE(read_records(reader, read).ok());
  EXPECT_EQ(read.size(), records.size());
}

TEST(RecordingReader, AnswersBeforeAnythingIsOpen) {
  RecordingReader reader;
  TickRecord record;
  bool end = false;
  EXPECT_FALSE(reader.next(record, end).ok());
  EXPECT_FALSE(reader.seek(0).ok());
  EXPECT_EQ(reader.info().ticks, 0u);
  const Status status = reader.open(temporary_path("absent.mcap"));
  EXPECT_NE(status.message().find("absent.mcap: there is no such file; check the path"), std::string::npos)
      << status.message();
  EXPECT_FALSE(reader.open(::testing::TempDir()).ok());
}

TEST(Recorder, WritesTheSameBytesForTheSameRun) {
  const std::vector<TickRecord> records = random_records(600, 4);
  const std::string a = temporary_path("a.mcap"), b = temporary_path("b.mcap");
  RecorderOptions small_ring;
  small_ring.ring_capacity = 1;
  write_recording(a, small_scene(), records);
  write_recording(b, small_scene(), records, small_ring);
  EXPECT_EQ(read_bytes(a), read_bytes(b));
}

TEST(Recorder, KeepsASessionWithoutTicks) {
  const std::string path = temporary_path("empty.mcap");
  write_recording(path, small_scene(), {});
  RecordingInfo info;
  const Status status = verify_recording(path, info);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(info.ticks, 0u);
  EXPECT_TRUE(info.complete);
}

TEST(Recorder, MarksGapsByTheirTickNumbers) {
  const std::string path = temporary_path("gap.mcap");
  std::vector<TickRecord> records = random_records(900, 5);
  records.erase(records.begin() + 100, records.begin() + 103);
  records.erase(records.begin(), records.begin() + 10);
  write_recording(path, small_scene(), records);
  RecordingInfo info;
  const Status status = verify_recording(path, info);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(info.first_tick, 10u);
  EXPECT_EQ(info.missing_ticks, 3u);
}

TEST(Recorder, DropsOpenlyWhenLiveAndTheRingIsFull) {
  const std::string path = temporary_path("live.mcap");
  RecorderOptions options;
  options.wait_when_full = false;
  options.ring_capacity = 4;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), options).ok());
  const std::vector<TickRecord> records = random_records(5000, 6);
  std::uint64_t kept = 0;
  for (const TickRecord& record : records) kept += recorder.record(record) ? 1 : 0;
  ASSERT_TRUE(recorder.close().ok());
  EXPECT_LT(kept, records.size()) << "the ring never became full";
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  EXPECT_EQ(reader.info().ticks, kept);
  EXPECT_EQ(reader.info().missing_ticks, reader.info().last_tick - reader.info().first_tick + 1 - kept);
}

TEST(Recorder, LeavesItsFileToTheProcessThatOpenedIt) {
  const std::string path = temporary_path("forked.mcap"), other = temporary_path("own.mcap");
  const std::vector<TickRecord> records = random_records(40, 11);
  auto recorder = std::make_unique<Recorder>();
  ASSERT_TRUE(recorder->open(path, small_scene(), {}).ok());
  for (std::size_t i = 0; i < 20; ++i) ASSERT_TRUE(recorder->record(records[i]));
  const pid_t child = test::fork_alone();
  ASSERT_GE(child, 0);
  if (child == 0) {  // 0: all as it should be; otherwise the first thing that is not
    if (recorder->record(records[20])) ::_exit(1);
    if (recorder->close().ok()) ::_exit(2);
    if (!recorder->open(other, small_scene(), {}).ok() || !recorder->record(records[20])) ::_exit(3);
    if (!recorder->close().ok() || recorder->kept() != 1) ::_exit(4);
    recorder.reset();
    ::_exit(0);
  }
  const pid_t second = test::fork_alone();
  ASSERT_GE(second, 0);
  if (second == 0) {
    recorder.reset();
    ::_exit(0);
  }
  for (const pid_t of : {child, second}) {
    int ended = -1;
    ASSERT_EQ(::waitpid(of, &ended, 0), of);
    EXPECT_EQ(ended, 0);
  }
  for (std::size_t i = 20; i < 40; ++i) ASSERT_TRUE(recorder->record(records[i]));
  const Status closed = recorder->close();
  ASSERT_TRUE(closed.ok()) << closed.message();
  RecordingInfo info;
  const Status verdict = verify_recording(path, info);
  EXPECT_TRUE(verdict.ok()) << verdict.message();
  EXPECT_EQ(info.ticks, 40u);
}

TEST(Recorder, RefusesTicksThatCannotBeReadBack) {
  Recorder recorder;
  TickRecord record;
  EXPECT_FALSE(recorder.record(record)) << "not open";
  ASSERT_TRUE(recorder.open(temporary_path("a.mcap"), small_scene(), {}).ok());
  record.output.tick = 5;
  EXPECT_TRUE(recorder.record(record));
  EXPECT_FALSE(recorder.record(record)) << "the same tick again";
  record.output.tick = 6;
  record.device.kind = static_cast<InputKind>(2);
  EXPECT_FALSE(recorder.record(record)) << "no such kind";
  EXPECT_TRUE(recorder.close().ok());
  EXPECT_FALSE(recorder.record(record)) << "closed";
}

TEST(Recorder, SaysClearlyWhyAFileCannotBeWritten) {
  Recorder recorder;
  const auto message = [&](const std::string& path, const RecorderOptions& options = {}) {
    return recorder.open(path, small_scene(), options).message();
  };
  EXPECT_EQ(message(temporary_path("no/such.mcap")),
            temporary_path("no/such.mcap") + ": its folder is not there; make it or check the path");
  EXPECT_NE(message(::testing::TempDir()).find("is there already"), std::string::npos);
  EXPECT_NE(message("/dev/null").find("is there already"), std::string::npos);
  EXPECT_NE(message("").find("empty"), std::string::npos);
  RecorderOptions options;
  options.chunk_seconds = 0.3;
  EXPECT_NE(message(temporary_path("a.mcap"), options).find("chunk_seconds"), std::string::npos);
  options = {};
  options.ring_capacity = 0;
  EXPECT_NE(message(temporary_path("a.mcap"), options).find("ring_capacity"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(temporary_path("a.mcap")));

  if (::geteuid() != 0) {  // root may write anywhere
    const std::string folder = temporary_path("locked");
    std::filesystem::create_directory(folder);
    ::chmod(folder.c_str(), 0500);
    EXPECT_NE(message(folder + "/a.mcap").find("Permission denied"), std::string::npos);
  }
}

TEST(Recorder, RefusesMetadataThatCouldNotBeRead) {
  const std::string path = temporary_path("notes.mcap");
  RecorderOptions options;
  options.metadata["notes"] = std::string(4u << 20, 'x');
  Recorder recorder;
  const Status refused = recorder.open(path, small_scene(), options);
  EXPECT_NE(refused.message().find("notes.mcap: the metadata take"), std::string::npos) << refused.message();
  EXPECT_FALSE(std::filesystem::exists(path + kPartSuffix));
  options.metadata["notes"].resize(4'000'000);
  write_recording(path, small_scene(), random_records(3, 1), options);
  RecordingReader reader;
  const Status status = reader.open(path);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(reader.info().metadata.at("notes"), options.metadata["notes"]);
}

TEST(Recorder, WritesOverNothingThatIsThere) {
  const std::string path = temporary_path("a.mcap"), link = temporary_path("link.mcap");
  write_recording(path, small_scene(), random_records(20, 7));
  const std::vector<std::uint8_t> before = read_bytes(path);
  std::filesystem::create_symlink(path, link);
  std::filesystem::create_symlink("/nonexistent/target", temporary_path("dangling.mcap"));
  for (const std::string& there : {path, link, temporary_path("dangling.mcap")}) {
    Recorder recorder;
    EXPECT_EQ(
        recorder.open(there, small_scene(), {}).message(),
        there + ": is there already, and nothing is written over it; name another file or move it away");
  }
  // Nor over the part, were it a link to something.
  const std::string other = temporary_path("b.mcap");
  std::filesystem::create_symlink(path, other + ".part");
  EXPECT_NE(Recorder().open(other, small_scene(), {}).message().find("killed"), std::string::npos);
  EXPECT_EQ(read_bytes(path), before);
}

TEST(Recorder, IsTheOnlyWriterOfItsFile) {
  const std::string path = temporary_path("a.mcap");
  const std::vector<TickRecord> records = random_records(600, 8);
  Recorder first, second;
  ASSERT_TRUE(first.open(path, small_scene(), {}).ok());
  for (const TickRecord& record : records) ASSERT_TRUE(first.record(record));
  EXPECT_NE(second.open(path, small_scene(), {}).message().find("is being written by another process"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path)) << "before it is complete";
  ASSERT_TRUE(first.close().ok());
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  EXPECT_NE(second.open(path, small_scene(), {}).message().find("is there already"), std::string::npos);
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(path, info).ok());
  EXPECT_EQ(info.ticks, records.size());
}

TEST(Recorder, LeavesAFileAloneThatTookItsPathMeanwhile) {
  const std::string path = temporary_path("a.mcap");
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), {}).ok());
  for (const TickRecord& record : random_records(300, 8)) ASSERT_TRUE(recorder.record(record));
  const std::vector<std::uint8_t> other = {1, 2, 3};
  write_bytes(path, other);
  EXPECT_NE(recorder.close().message().find("File exists"), std::string::npos);
  EXPECT_EQ(read_bytes(path), other);
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(path + ".part", info).ok()) << "what was recorded is whole beside it";
}

// Ticks come so slowly that no chunk would be full for a minute.
TEST(Recorder, KeepsNoTickOfALiveSessionInMemoryForLong) {
  const std::string path = temporary_path("slow.mcap");
  RecorderOptions options;
  options.wait_when_full = false;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), options).ok());
  const std::vector<TickRecord> records = random_records(5, 9);
  for (const TickRecord& record : records) ASSERT_TRUE(recorder.record(record));
  const auto in_the_file = [&path] {
    RecordingReader reader;
    EXPECT_TRUE(reader.open(path).ok());
    return reader.info().ticks;
  };
  const auto given_up = std::chrono::steady_clock::now() + 30s;
  while (in_the_file() < records.size() && std::chrono::steady_clock::now() < given_up)
    std::this_thread::sleep_for(10ms);
  EXPECT_EQ(in_the_file(), records.size());
  ASSERT_TRUE(recorder.close().ok());
}

TEST(Recorder, AFileBeingRecordedSaysSoUntilItIsClosed) {
  const std::string path = temporary_path("growing.mcap");
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, small_scene(), {}).ok());
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  EXPECT_TRUE(reader.info().growing);
  EXPECT_FALSE(reader.info().complete);
  RecordingInfo info;
  const Status verdict = verify_recording(path, info);
  EXPECT_NE(verdict.message().find("still being recorded"), std::string::npos) << verdict.message();
  ASSERT_TRUE(recorder.close().ok());
  ASSERT_TRUE(reader.open(path).ok());
  EXPECT_FALSE(reader.info().growing);
  EXPECT_TRUE(reader.info().complete);
}

TEST(Recorder, LosesAtMostTheOpenChunkWhenKilled) {
  const std::string path = temporary_path("killed.mcap");
  const pid_t child = test::fork_alone();
  ASSERT_GE(child, 0);
  if (child == 0) {
    Recorder recorder;
    if (!recorder.open(path, small_scene(), {}).ok()) ::_exit(1);
    for (const TickRecord& record : random_records(1130, 10)) recorder.record(record);
    std::this_thread::sleep_for(1s);  // the ring empties within milliseconds
    ::raise(SIGKILL);
  }
  int exit_status = 0;
  ASSERT_EQ(::waitpid(child, &exit_status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(exit_status));

  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  EXPECT_FALSE(reader.info().complete);
  EXPECT_FALSE(reader.info().growing);
  const std::uint64_t whole = reader.info().ticks;
  EXPECT_GE(whole, 1130u - 200u);

  RecordingInfo info;
  const Status verdict = verify_recording(path, info);
  EXPECT_NE(verdict.message().find("torn"), std::string::npos) << verdict.message();
  const std::string recovered_path = temporary_path("recovered.mcap");
  std::uint64_t recovered = 0, lost = 0;
  ASSERT_TRUE(recover_recording(path, recovered_path, recovered, lost).ok());
  EXPECT_EQ(recovered, whole);
  EXPECT_EQ(lost, 0u);
  EXPECT_TRUE(verify_recording(recovered_path, info).ok());
  std::vector<TickRecord> read;
  RecordingReader recovered_reader;
  ASSERT_TRUE(recovered_reader.open(recovered_path).ok());
  ASSERT_TRUE(read_records(recovered_reader, read).ok());
  const std::vector<TickRecord> records = random_records(whole, 10);
  ASSERT_EQ(read.size(), whole);
  for (std::size_t i = 0; i < read.size(); ++i) expect_same(read[i], records[i]);
}

}  // namespace
}  // namespace lumbrical
