// A small recording torn at every length and flipped at every byte: nothing crashes, nothing false is read as
// true, verify notices all of it, recover keeps what is whole.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "recording_fixture.h"
#include "sanitized.h"

namespace lumbrical {
namespace {

using test::cleared;
using test::random_records;
using test::read_bytes;
using test::read_records;
using test::sanitized_step;
using test::small_scene;
using test::temporary_path;
using test::write_bytes;
using test::write_recording;

// A file of three chunks of four ticks.
class DamagedRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    records_ = random_records(12, 11);
    RecorderOptions options;
    options.chunk_seconds = 0.004;
    write_recording(good_path_, small_scene(), records_, options);
    good_ = read_bytes(good_path_);
    InputFile file;
    Summary summary;
    bool present = false;
    ASSERT_TRUE(file.open(good_path_).ok());
    ASSERT_TRUE(read_summary(file, summary, present).ok());
    for (const mcap::ChunkIndex& chunk : summary.chunks) chunk_ends_.push_back(chunk.offset + chunk.length);
    ASSERT_EQ(chunk_ends_.size(), 3u);
    session_end_ = summary.attachments.at(0).offset + summary.attachments.at(0).length;
  }

  std::uint64_t ticks_before(std::uint64_t size) const {
    std::uint64_t ticks = 0;
    for (const std::uint64_t end : chunk_ends_) ticks += end <= size ? 4 : 0;
    return ticks;
  }

  /// Reads to the first error. Whatever was read must be true.
  Status read(RecordingInfo& info, std::size_t& count) {
    RecordingReader reader;
    if (Status status = reader.open(path_); !status.ok()) return status;
    info = reader.info();
    std::vector<TickRecord> read;
    const Status status = read_records(reader, read);
    count = read.size();
    EXPECT_LE(read.size(), records_.size());
    for (std::size_t i = 0; i < read.size(); ++i) EXPECT_TRUE(test::is_same(read[i], records_[i])) << i;
    return status;
  }

  /// Every tick of the recovered file must be one of the originals.
  void expect_truth(const std::string& path, std::uint64_t count) {
    RecordingInfo info;
    const Status status = verify_recording(path, info);
    EXPECT_TRUE(status.ok()) << status.message();
    RecordingReader reader;
    ASSERT_TRUE(reader.open(path).ok());
    std::vector<TickRecord> read;
    ASSERT_TRUE(read_records(reader, read).ok());
    EXPECT_EQ(read.size(), count);
    for (const TickRecord& record : read) {
      ASSERT_LT(record.output.tick, records_.size());
      EXPECT_TRUE(test::is_same(record, records_[record.output.tick]));
    }
  }

  // Recovery, which writes a file each time, meets fewer bytes than reading and verifying.
  static constexpr std::size_t kEvery = sanitized_step(37);
  static constexpr std::size_t kRecoverEvery = 29;
  std::string good_path_ = temporary_path("good.mcap"), path_ = temporary_path("damaged.mcap"),
              output_ = temporary_path("output.mcap");
  std::vector<TickRecord> records_;
  std::vector<std::uint8_t> good_;
  std::vector<std::uint64_t> chunk_ends_;
  std::uint64_t session_end_ = 0;
};

TEST_F(DamagedRecording, IsReadUpToWhereItIsTornAtEveryLength) {
  write_bytes(path_, good_);
  for (std::size_t whole = good_.size(); whole > 0; whole -= std::min(whole, kEvery)) {
    const std::size_t size = whole - 1;
    ASSERT_EQ(::truncate(path_.c_str(), static_cast<off_t>(size)), 0);
    RecordingInfo info;
    std::size_t count = 0;
    const Status status = read(info, count);
    EXPECT_EQ(status.ok(), size >= session_end_) << size << ' ' << status.message();
    EXPECT_FALSE(info.complete) << size;
    if (status.ok()) {
      EXPECT_EQ(count, ticks_before(size)) << size;
    }
    EXPECT_FALSE(verify_recording(path_, info).ok()) << size;
    if (::testing::Test::HasFailure()) break;
    if (size % kRecoverEvery != 0) continue;
    std::uint64_t recovered = 0, lost = 0;
    EXPECT_EQ(recover_recording(path_, cleared(output_), recovered, lost).ok(), size >= session_end_) << size;
    EXPECT_EQ(recovered, size >= session_end_ ? ticks_before(size) : 0) << size;
    EXPECT_EQ(lost, 0u) << size;
  }
  EXPECT_FALSE(std::filesystem::exists(output_ + ".part"));
}

TEST_F(DamagedRecording, IsFoundOutAndRecoveredWhereverABitIsFlipped) {
  write_bytes(path_, good_);
  std::FILE* const file = std::fopen(path_.c_str(), "r+b");
  ASSERT_NE(file, nullptr);
  const auto put = [&](std::size_t at, std::uint8_t byte) {
    std::fseek(file, static_cast<long>(at), SEEK_SET);
    std::fputc(byte, file);
    std::fflush(file);
  };
  std::uint64_t whole_recoveries = 0;
  for (std::size_t at = 0; at < good_.size(); at += kEvery) {
    put(at, static_cast<std::uint8_t>(good_[at] ^ (1u << (at % 8))));
    RecordingInfo info;
    EXPECT_FALSE(verify_recording(path_, info).ok()) << "bit of byte " << at << " went unnoticed";
    std::size_t count = 0;
    info = {};
    if (read(info, count).ok()) {
      EXPECT_TRUE(count == records_.size() || !info.complete) << at;
    }
    std::uint64_t recovered = 0, lost = 0;
    const bool recover = at % kRecoverEvery == 0;
    const Status status = recover ? recover_recording(path_, cleared(output_), recovered, lost) : Status{};
    if (recover && status.ok()) {
      EXPECT_GE(recovered, 8u) << "byte " << at << ": more than one chunk lost";
      EXPECT_EQ(recovered + lost, records_.size()) << at;
      whole_recoveries += lost == 0 ? 1 : 0;
      expect_truth(output_, recovered);
    } else if (!status.ok()) {
      EXPECT_LT(at, session_end_) << status.message();
    }
    put(at, good_[at]);
    if (::testing::Test::HasFailure()) break;
  }
  std::fclose(file);
  EXPECT_GT(whole_recoveries, good_.size() / kRecoverEvery / kEvery / 4)
      << "damage outside chunks must cost nothing";
}

TEST_F(DamagedRecording, IsCopiedByteForByteWhenItIsWhole) {
  write_recording(good_path_, small_scene(), random_records(700, 12));
  std::uint64_t recovered = 0, lost = 0;
  ASSERT_TRUE(recover_recording(good_path_, output_, recovered, lost).ok());
  EXPECT_EQ(recovered, 700u);
  EXPECT_EQ(read_bytes(output_), read_bytes(good_path_));
}

TEST_F(DamagedRecording, KeepsWhatComesBehindAHoleOfZeros) {
  std::vector<std::uint8_t> damaged = good_;
  const auto begin = damaged.begin() + static_cast<std::ptrdiff_t>(session_end_);
  std::fill(begin, begin + static_cast<std::ptrdiff_t>(chunk_ends_[0] - session_end_) / 2, std::uint8_t{0});
  write_bytes(path_, std::span(damaged).first(damaged.size() - 100));  // no footer either
  std::uint64_t recovered = 0, lost = 0;
  ASSERT_TRUE(recover_recording(path_, output_, recovered, lost).ok());
  EXPECT_EQ(recovered, 8u);
  expect_truth(output_, 8);
}

// Without an index, whatever chunk is damaged: which ticks are lost is known to the last one.
TEST_F(DamagedRecording, WhichTicksAreLostIsKnownWithoutAnIndexToo) {
  for (std::size_t chunk = 0; chunk < chunk_ends_.size(); ++chunk) {
    std::vector<std::uint8_t> torn(good_.begin(), good_.end() - 100);  // no footer
    torn[chunk_ends_[chunk] - 20] ^= 1;                                // in the chunk's records
    write_bytes(path_, torn);
    std::uint64_t recovered = 0, lost = 0;
    std::vector<TickRange> missing;
    ASSERT_TRUE(recover_recording(path_, cleared(output_), recovered, lost, &missing).ok());
    EXPECT_EQ(recovered, 8u) << chunk;
    EXPECT_EQ(lost, 4u) << chunk;
    EXPECT_EQ(missing, (std::vector<TickRange>{{4 * chunk, 4 * chunk + 3}})) << chunk;
  }
}

// The channel's record is covered by no checksum, and without it no message is known to be a tick.
TEST_F(DamagedRecording, ComesBackWholeWhateverBitOfItsChannelsRecordIsFlipped) {
  mcap::ByteWriter texts;
  texts.text("tick");
  texts.text("flatbuffer");
  const auto found = std::search(good_.begin(), good_.end(), texts.bytes().begin(), texts.bytes().end());
  ASSERT_LT(found, good_.begin() + static_cast<std::ptrdiff_t>(session_end_));
  const auto id = static_cast<std::size_t>(found - good_.begin()) - 2 * sizeof(std::uint16_t);
  for (const std::size_t torn : {0, 100})  // of the footer
    for (std::size_t bit = 8 * id; bit < 8 * (id + 12); ++bit) {
      std::vector<std::uint8_t> damaged(good_.begin(), good_.end() - static_cast<std::ptrdiff_t>(torn));
      damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      write_bytes(path_, damaged);
      std::uint64_t recovered = 0, lost = 0;
      ASSERT_TRUE(recover_recording(path_, cleared(output_), recovered, lost).ok());
      EXPECT_EQ(lost, 0u) << torn << ", bit " << bit - 8 * id;
      expect_truth(output_, records_.size());
      if (::testing::Test::HasFailure()) return;
    }
}

// What is left of the chunk reaches over the head of the next one.
TEST_F(DamagedRecording, AChunkThatLostBytesHidesNoneBehindIt) {
  const std::uint64_t middle = (chunk_ends_[0] + chunk_ends_[1]) / 2;
  for (const std::ptrdiff_t size : {1, 200, 500}) {
    std::vector<std::uint8_t> damaged = good_;
    const auto hole = damaged.begin() + static_cast<std::ptrdiff_t>(middle);
    damaged.erase(hole, hole + size);
    write_bytes(path_, damaged);
    std::uint64_t recovered = 0, lost = 0;
    std::vector<TickRange> missing;
    ASSERT_TRUE(recover_recording(path_, cleared(output_), recovered, lost, &missing).ok());
    EXPECT_EQ(recovered, 8u) << size;
    EXPECT_EQ(missing, (std::vector<TickRange>{{4, 7}})) << size;
    expect_truth(output_, 8);
  }
}

// The head of a chunk again and again, each reaching to the end of the file.
TEST_F(DamagedRecording, ChunksInEachOtherCostNoMoreThanASecondOfProcessorTime) {
  constexpr std::uint64_t kSize = 1'000'000, kHead = 49;
  std::vector<std::uint8_t> bytes(good_.begin(), good_.begin() + static_cast<std::ptrdiff_t>(session_end_));
  while (bytes.size() + kHead < kSize) {
    const std::uint64_t payload = kSize - bytes.size() - kHead;
    mcap::ByteWriter head;
    head.u8(static_cast<std::uint8_t>(mcap::Opcode::chunk));
    head.u64(kSize - bytes.size() - mcap::kRecordHeaderSize);
    for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{0}, payload}) head.u64(number);
    head.u32(1);  // no such checksum
    head.text("");
    head.u64(payload);
    ASSERT_EQ(head.size(), kHead);
    bytes.insert(bytes.end(), head.bytes().begin(), head.bytes().end());
  }
  bytes.resize(kSize);
  write_bytes(path_, bytes);
  const std::clock_t before = std::clock();
  std::uint64_t recovered = 0, lost = 0;
  EXPECT_TRUE(recover_recording(path_, output_, recovered, lost).ok());
  EXPECT_LT(std::clock() - before, CLOCKS_PER_SEC);
  EXPECT_EQ(recovered, 0u);
}

TEST_F(DamagedRecording, IsNotReplacedByItsOwnRecovery) {
  std::uint64_t recovered = 0, lost = 0;
  EXPECT_FALSE(recover_recording(good_path_, good_path_, recovered, lost).ok());
  EXPECT_EQ(read_bytes(good_path_), good_);
  EXPECT_FALSE(recover_recording(temporary_path("absent"), output_, recovered, lost).ok());
  EXPECT_FALSE(std::filesystem::exists(output_));
}

}  // namespace
}  // namespace lumbrical
