// Recordings read by the MCAP project's own JavaScript library (npm/read_recording.mjs), which shares no code
// with ours.
//
// LUMBRICAL_NPM_FOLDER is a folder with the files of tests/recording/npm in which `npm ci` has been run.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "recording_fixture.h"

namespace lumbrical {
namespace {

using test::random_records;
using test::temporary_path;

class NpmReader : public ::testing::TestWithParam<Compression> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(LUMBRICAL_NPM_FOLDER "/node_modules/@mcap/core"))
      GTEST_SKIP() << "no @mcap/core; install nodejs and npm, then run the test npm.install";
  }

  /// Whether the library reads the file; what it found goes to `found`.
  bool read(const std::string& path, nlohmann::json& found) {
    const std::string output = temporary_path("found.json");
    const std::string command = "node '" LUMBRICAL_NPM_FOLDER "/read_recording.mjs' '" + path + "' >'" +
                                output + "' 2>'" + output + ".error'";
    const int status = std::system(command.c_str());
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return false;
    std::ifstream in(output);
    found = nlohmann::json::parse(in, nullptr, false);
    return !found.is_discarded();
  }

  std::string write(const std::string& name, const std::vector<TickRecord>& records) {
    const std::string path = temporary_path(name);
    RecorderOptions options;
    options.compression = GetParam();
    options.metadata = {{"operator", "someone"}};
    test::write_recording(path, test::small_scene(), records, options);
    return path;
  }
};

INSTANTIATE_TEST_SUITE_P(Compressions, NpmReader,
                         ::testing::Values(Compression::none, Compression::lz4, Compression::zstd),
                         testing::PrintToStringParamName());

TEST_P(NpmReader, FindsEverythingByTheIndexAndAsAStream) {
  std::vector<TickRecord> records = random_records(700, 1);
  records.erase(records.begin() + 300, records.begin() + 310);
  nlohmann::json found;
  ASSERT_TRUE(read(write("a.mcap", records), found));
  for (const char* const way : {"indexed", "streamed"}) {
    EXPECT_EQ(found[way]["count"], 690);
    EXPECT_EQ(found[way]["wrong"], 0);
    EXPECT_EQ(found[way]["first"], 0);
    EXPECT_EQ(found[way]["last"], 699);
  }
  const nlohmann::json& indexed = found["indexed"];
  EXPECT_EQ(indexed["schema"]["name"], "lumbrical.fb.Tick");
  EXPECT_EQ(indexed["schema"]["encoding"], "flatbuffer");
  EXPECT_EQ(indexed["schema"]["size"], tick_schema().size());
  EXPECT_EQ(indexed["channel"]["topic"], "tick");
  EXPECT_EQ(indexed["channel"]["encoding"], "flatbuffer");
  EXPECT_EQ(indexed["statistics"]["messages"], 690);
  EXPECT_EQ(indexed["statistics"]["chunks"], indexed["chunks"]);
  EXPECT_EQ(indexed["attachments"].at(0)["name"], "session");
  EXPECT_EQ(indexed["metadata"]["lumbrical"]["operator"], "someone");
}

TEST_P(NpmReader, RefusesADamagedFileAndReadsItRecovered) {
  const std::string path = write("a.mcap", random_records(700, 2));
  InputFile file;
  Summary summary;
  bool present = false;
  ASSERT_TRUE(file.open(path).ok());
  ASSERT_TRUE(read_summary(file, summary, present).ok());
  std::vector<std::uint8_t> bytes = test::read_bytes(path);
  const mcap::ChunkIndex& chunk = summary.chunks.at(1);
  // Several bytes: LZ4 may decompress one changed bit to the same ticks.
  for (std::size_t i = 0; i < 16; ++i) bytes[chunk.offset + chunk.length / 2 + i] ^= 0x5a;
  const std::string damaged = temporary_path("damaged.mcap"),
                    recovered_path = temporary_path("recovered.mcap");
  test::write_bytes(damaged, bytes);
  nlohmann::json found;
  EXPECT_FALSE(read(damaged, found));

  std::uint64_t recovered = 0, lost = 0;
  ASSERT_TRUE(recover_recording(damaged, recovered_path, recovered, lost).ok());
  EXPECT_EQ(recovered + lost, 700u);
  ASSERT_TRUE(read(recovered_path, found));
  EXPECT_EQ(found["indexed"]["count"], recovered);
  EXPECT_EQ(found["streamed"]["count"], recovered);
}

TEST_P(NpmReader, ReadsASessionWithoutTicks) {
  nlohmann::json found;
  ASSERT_TRUE(read(write("empty.mcap", {}), found));
  EXPECT_EQ(found["indexed"]["count"], 0);
  EXPECT_EQ(found["streamed"]["count"], 0);
}

}  // namespace
}  // namespace lumbrical
