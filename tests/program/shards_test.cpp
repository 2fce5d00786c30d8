// Many recordings over many machines: lists, shards, lines of results, and the scripts for schedulers.
#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "scenes.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

// Seven recordings and a file that is none, and a list of them.
fs::path folder_with_list() {
  const fs::path folder = folder_with_demo();
  std::ofstream list(folder / "list");
  for (int i = 0; i < 7; ++i) {
    const std::string name = "rec" + std::to_string(i) + ".mcap", ticks = std::to_string(10 + i);
    EXPECT_EQ(shell("lumbrical run demo.json --ticks " + ticks + " --record " + name, folder).exit_code, 0);
    list << name << "\n\n";
  }
  list << "none.mcap";
  std::ofstream(folder / "none.mcap") << "no recording";
  return folder;
}

std::set<std::string> recordings_of(const fs::path& file) {
  std::set<std::string> names;
  std::istringstream lines(read_file(file.string()));
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json json = nlohmann::json::parse(line);
    EXPECT_TRUE(names.insert(json["recording"]).second) << line;
  }
  return names;
}

TEST(Shards, ShareOutAListEachEntryOnceAndGoOnWhereTheyEnded) {
  const fs::path folder = folder_with_list();
  std::set<std::string> all;
  for (int i = 1; i <= 3; ++i) {
    const std::string shard = std::to_string(i);
    const Outcome done =
        shell("lumbrical replay --list list --shard " + shard + "/3 --results " + shard + ".jsonl", folder);
    EXPECT_EQ(done.exit_code, i == 2 ? 2 : 0) << done.error << " (the eighth is no recording)";
    for (const std::string& name : recordings_of(folder / (shard + ".jsonl")))
      EXPECT_TRUE(all.insert(name).second) << name << " is of two shards";
  }
  EXPECT_EQ(all.size(), 8u);
  EXPECT_EQ(recordings_of(folder / "1.jsonl"),
            (std::set<std::string>{"rec0.mcap", "rec3.mcap", "rec6.mcap"}));

  const Outcome merged =
      shell("lumbrical merge-results 1.jsonl 2.jsonl 3.jsonl --list list --output all", folder);
  EXPECT_EQ(merged.exit_code, 2) << "one could not be read";
  EXPECT_EQ(merged.json()["recordings"], 8);
  EXPECT_EQ(merged.json()["identical"], 7);
  EXPECT_EQ(merged.json()["failed"], 1);
  EXPECT_EQ(merged.json()["ticks"], 10 + 11 + 12 + 13 + 14 + 15 + 16);
  EXPECT_EQ(merged.json()["missing"].size(), 0u);
  EXPECT_EQ(recordings_of(folder / "all"), all);

  // A shard that was killed: its last line is torn, and another one is missing.
  const std::string whole = read_file((folder / "1.jsonl").string());
  std::ofstream(folder / "1.jsonl") << whole.substr(0, whole.find('\n') + 20);
  const Outcome torn = shell("lumbrical merge-results 1.jsonl 2.jsonl 3.jsonl --list list", folder);
  EXPECT_EQ(torn.json()["missing"].size(), 2u);
  const Outcome again = shell("lumbrical replay --list list --shard 1/3 --results 1.jsonl", folder);
  EXPECT_EQ(again.json()["done_before"], 1) << again.error;
  EXPECT_EQ(again.json()["recordings"], 2);
  EXPECT_EQ(recordings_of(folder / "1.jsonl").size(), 3u);
}

TEST(Shards, SayWhatIsWrongWithThem) {
  const fs::path folder = folder_with_demo();
  for (const char* const shard : {"0/3", "4/3", "1", "1/", "/3", "a/b", "1/3x"}) {
    const Outcome wrong = shell("lumbrical replay a.mcap --shard " + std::string(shard), folder);
    EXPECT_EQ(wrong.exit_code, 2) << shard;
    EXPECT_NE(wrong.error.find("--shard"), std::string::npos) << wrong.error;
  }
  EXPECT_EQ(shell("lumbrical replay", folder).exit_code, 2) << "no recording at all";
  EXPECT_EQ(shell("lumbrical replay --list nowhere", folder).exit_code, 2);
  std::ofstream(folder / "bad.jsonl") << "{}\n";
  EXPECT_NE(shell("lumbrical merge-results bad.jsonl", folder).error.find("bad.jsonl:1"), std::string::npos);
}

// As a task of an array has it, without the scheduler.
TEST(Shards, ATaskOfAJobArrayDoesItsShare) {
  const fs::path folder = folder_with_list();
  const std::string script = std::string(LUMBRICAL_SOURCE_DIR) + "/tools/cluster/replay_slurm";
  for (const char* const task : {"1", "2"}) {
    const Outcome done = shell("LUMBRICAL='" LUMBRICAL_PROGRAM "' SLURM_ARRAY_TASK_ID=" + std::string(task) +
                                   " bash '" + script + "' list 2 results",
                               folder);
    EXPECT_EQ(done.exit_code, 0) << done.error << " what could not be read stands in the results";
  }
  EXPECT_EQ(
      recordings_of(folder / "results/1.jsonl").size() + recordings_of(folder / "results/2.jsonl").size(),
      8u);
}

}  // namespace
}  // namespace lumbrical::test
