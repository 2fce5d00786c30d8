// Memory that runs out while a recording is written: an error that is told, and what was written stays.
#include <gtest/gtest.h>

#include <filesystem>

#include "recording_fixture.h"
#include "scarce_memory.h"

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

}  // namespace
}  // namespace lumbrical::test
