// Memory that runs out while a recording is written or read: an error that is told, and what was written
// stays.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>

#include "lumbrical/world.h"
#include "own_allocator.h"
#include "scarce_memory.h"
#include "touch_session.h"

namespace lumbrical::test {
namespace {

TEST(ScarceMemory, EndsARecordingWithAnErrorThatIsTold) {
  const std::vector<TickRecord> records = random_records(1500, 37);
  for (const std::int64_t allowed : {0, 1, 3, 10, 20}) {
    SCOPED_TRACE("after " + std::to_string(allowed) + " allocations");
    const std::string path = cleared(temporary_path("scarce.mcap"));
    Recorder recorder;
    ASSERT_TRUE(recorder.open(path, small_scene(), {}).ok());
    std::size_t kept = 0;
    Status status;
    {
      const ScarceMemory memory(allowed);
      while (kept < records.size() && recorder.record(records[kept])) ++kept;
      status = recorder.close();
    }
    EXPECT_NE(status.message().find("scarce.mcap: not enough memory to go on recording"), std::string::npos)
        << status.message();
    EXPECT_FALSE(std::filesystem::exists(path)) << "it is not whole";
    RecordingReader reader;
    const Status opened = reader.open(path);
    EXPECT_TRUE(opened.ok()) << opened.message();
  }
}

/// While this lives, one allocation fails, of whatever thread: the one behind `allowed` others. One at a
/// time.
class OneFailure {
 public:
  explicit OneFailure(std::int64_t allowed) {
    left() = allowed;
    may_allocate = [] { return left()-- != 0; };
  }
  ~OneFailure() { may_allocate = nullptr; }
  [[nodiscard]] static bool has_come() { return left() < 0; }

 private:
  static std::atomic<std::int64_t>& left() {
    static std::atomic<std::int64_t> allocations;
    return allocations;
  }
};

/// Whichever allocation fails: what `work` makes of it is an error that names the file, or as if none had.
template <class Work>
void expect_failures_told(const std::string& path, const std::string& otherwise, Work&& work) {
  bool failed = true;
  for (std::int64_t allowed = 0; failed; allowed += 1 + allowed / 8) {
    Status status;
    {
      const OneFailure failure(allowed);
      status = work();
      failed = failure.has_come();
    }
    const std::string& message = status.message();
    const bool is_told = message.find(path) == 0 && message.find("not enough memory") != std::string::npos;
    const bool is_as_ever = otherwise.empty() ? status.ok() : message.find(otherwise) != std::string::npos;
    EXPECT_TRUE(is_told || is_as_ever) << allowed << ": " << message;
  }
}

TEST(ScarceMemory, OfWhateverReadsARecordingIsAnErrorThatNamesIt) {
  const std::string path = temporary_path("touch.mcap");
  record_touch(path, InputKind::joint_angles, {}, touch_scene(), 200);
  std::array<RecordingReader, 2> readers;
  for (RecordingReader& reader : readers) ASSERT_TRUE(reader.open(path).ok());
  ReplayOptions softer;
  softer.stiffness = 1e6;
  ReplayResult result;
  WhatIfResult changes;
  DeviceHistory history;
  expect_failures_told(path, "", [&] { return replay(readers[0], {}, result); });
  expect_failures_told(path, "", [&] { return replay_hands(path, {}, result); });
  expect_failures_told(path, "", [&] { return diff_recordings(readers[0], readers[1], result); });
  expect_failures_told(path, "", [&] { return what_if(readers[0], softer, changes); });
  expect_failures_told(path, "", [&] { return read_device_history(readers, history); });
}

TEST(ScarceMemory, OfWhoeverLooksForAWorldIsAnErrorThatNamesTheRecording) {
  const std::string path = temporary_path("world.mcap");
  Scene scene = small_scene();
  scene.objects.clear();
  auto world = std::make_shared<World>();
  world->path = "a world with a name that takes memory.world";
  scene.world = world;
  write_recording(path, scene, {});
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  expect_failures_told(path, "not beside it", [&] { return reader.find_world(""); });
}

}  // namespace
}  // namespace lumbrical::test
