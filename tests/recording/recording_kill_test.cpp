// A writer killed at any instant: what had reached the file is recovered, bit for bit, and nothing else is
// made up. LUMBRICAL_KILLS sets how many are killed.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <thread>

#include "fork.h"
#include "recording_fixture.h"

namespace lumbrical::test {
namespace {

constexpr double kChunkSeconds = 0.05;
constexpr std::uint64_t kChunkTicks = 50;  // at the scene's 1000 ticks per second
constexpr std::uint32_t kRing = 256;

std::uint64_t kill_count() {
  const char* const text = std::getenv("LUMBRICAL_KILLS");
  return text != nullptr ? std::strtoull(text, nullptr, 10) : 25;
}

/// What the writing process tells the one that kills it.
struct Shared {
  std::atomic<std::uint64_t> handed_over{0};  // ticks
};

class SharedMemory {
 public:
  SharedMemory()
      : memory_(::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ != MAP_FAILED) new (memory_) Shared;
  }
  ~SharedMemory() { ::munmap(memory_, sizeof(Shared)); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  [[nodiscard]] bool good() const { return memory_ != MAP_FAILED; }
  [[nodiscard]] Shared& operator*() const { return *static_cast<Shared*>(memory_); }

 private:
  void* memory_;
};

TickRecord record_of(const std::vector<TickRecord>& records, std::uint64_t tick) {
  TickRecord record = records[tick % records.size()];
  record.output.tick = tick;
  seal(record);
  return record;
}

/// Never returns: records until it is killed.
[[noreturn]] void record_for_ever(const std::string& path, const std::vector<TickRecord>& records,
                                  Shared& shared) {
  RecorderOptions options;
  options.chunk_seconds = kChunkSeconds;
  options.ring_capacity = kRing;
  Recorder recorder;
  if (!recorder.open(path, small_scene(), options).ok()) ::_exit(1);
  for (std::uint64_t tick = 0;; ++tick) {
    if (!recorder.record(record_of(records, tick))) ::_exit(2);
    shared.handed_over.store(tick + 1, std::memory_order_release);
  }
}

/// Starts a writer and kills it `delay` later, once it has handed `least` ticks to its recorder. Returns how
/// many it had.
std::uint64_t kill_writer(const std::string& path, const std::vector<TickRecord>& records,
                          std::chrono::microseconds delay, std::uint64_t least) {
  SharedMemory shared;
  EXPECT_TRUE(shared.good());
  const pid_t child = test::fork_alone();
  if (child == 0) record_for_ever(path, records, *shared);
  EXPECT_GT(child, 0);
  std::this_thread::sleep_for(delay);
  while ((*shared).handed_over.load(std::memory_order_acquire) < least &&
         ::waitpid(child, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  ::kill(child, SIGKILL);
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status)) << "the writer ended by itself";
  return (*shared).handed_over.load(std::memory_order_acquire);
}

/// Ticks in the file's whole chunks, found without the recovery under test.
std::uint64_t ticks_in_whole_chunks(const std::string& path) {
  RecordingReader reader;
  const Status status = reader.open(path);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_FALSE(reader.info().complete);
  return reader.info().ticks;
}

void expect_first_ticks(const std::string& path, const std::vector<TickRecord>& records,
                        std::uint64_t count) {
  RecordingInfo info;
  const Status verdict = verify_recording(path, info);
  ASSERT_TRUE(verdict.ok()) << verdict.message();
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  for (std::uint64_t tick = 0;; ++tick) {
    TickRecord record;
    bool end = false;
    ASSERT_TRUE(reader.next(record, end).ok());
    if (end) {
      EXPECT_EQ(tick, count);
      return;
    }
    ASSERT_TRUE(is_same(record, record_of(records, tick))) << tick;
  }
}

TEST(KilledWriter, LosesNothingThatHadReachedTheFile) {
  const std::string path = temporary_path("killed.mcap"), recovered_path = temporary_path("recovered.mcap");
  const std::vector<TickRecord> records = random_records(400, 21);
  RandomBits random(22);
  std::uint64_t with_ticks = 0;
  for (std::uint64_t i = 0; i < kill_count(); ++i) {
    SCOPED_TRACE("kill " + std::to_string(i));
    cleared(path);
    const std::chrono::microseconds delay(random.word() % (i % 4 == 0 ? 3000 : 60000));
    // A quarter of them, however slow the machine, when there is more than may be lost.
    const std::uint64_t least = i % 4 == 3 ? kRing + 2 * kChunkTicks + 2 : 0;
    const std::uint64_t handed_over = kill_writer(path, records, delay, least);
    std::uint64_t recovered = 0, lost = 0;
    std::vector<TickRange> missing;
    const Status status = recover_recording(path, cleared(recovered_path), recovered, lost, &missing);
    if (!status.ok()) {  // killed before the session was in the file
      EXPECT_FALSE(RecordingReader().open(path).ok()) << status.message();
      EXPECT_LE(handed_over, kRing + 2 * kChunkTicks);
      continue;
    }
    EXPECT_EQ(recovered, ticks_in_whole_chunks(path));
    EXPECT_TRUE(missing.empty());
    // Lost is what was in the ring, in the open chunk, and in the chunk on its way to the file.
    EXPECT_GE(recovered + kRing + 2 * kChunkTicks + 1, handed_over);
    EXPECT_LE(recovered, handed_over + 1);
    expect_first_ticks(recovered_path, records, recovered);
    if (::testing::Test::HasFailure()) return;
    with_ticks += recovered > 0 ? 1 : 0;
  }
  EXPECT_GE(with_ticks, kill_count() / 4);
}

}  // namespace
}  // namespace lumbrical::test
