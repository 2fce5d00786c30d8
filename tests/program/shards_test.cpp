// Many recordings and scenes over many machines: lists, shards, lines of results, and the scripts for
// schedulers.
#include <algorithm>
#include <fstream>
#include <map>
#include <new>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "scenes.h"
#include "work_list.h"

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
    list << name << "\r\n\n\r\n";  // as on any system
  }
  list << "none.mcap";
  std::ofstream(folder / "none.mcap") << "no recording";
  return folder;
}

std::set<std::string> entries_of(const fs::path& file, const char* key) {
  std::set<std::string> names;
  std::istringstream lines(read_file(file.string()));
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json json = nlohmann::json::parse(line);
    EXPECT_TRUE(names.insert(json[key]).second) << line;
  }
  return names;
}

std::set<std::string> recordings_of(const fs::path& file) { return entries_of(file, "recording"); }
std::set<std::string> scenes_of(const fs::path& file) { return entries_of(file, "scene"); }

// The results of a file by the lines of their list.
std::map<std::string, nlohmann::json> results_in(const fs::path& file) {
  std::map<std::string, nlohmann::json> results;
  std::istringstream lines(read_file(file.string()));
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json json = nlohmann::json::parse(line);
    results[json["scene"]] = json;
  }
  return results;
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
  for (const char* const shard : {"0/3", "4/3", "1", "1/", "/3", "a/b", "1/3x", "''"}) {
    const Outcome wrong = shell("lumbrical replay a.mcap --shard " + std::string(shard), folder);
    EXPECT_EQ(wrong.exit_code, 2) << shard;
    EXPECT_NE(wrong.error.find("--shard"), std::string::npos) << wrong.error;
  }
  EXPECT_EQ(shell("lumbrical replay", folder).exit_code, 2) << "no recording at all";
  EXPECT_EQ(shell("lumbrical replay --list nowhere", folder).exit_code, 2);
  std::ofstream(folder / "bad.jsonl") << "{}\n";
  EXPECT_NE(shell("lumbrical merge-results bad.jsonl", folder).error.find("bad.jsonl:1"), std::string::npos);
}

// A broadphase asked for is compared as a what-if is, but may change nothing.
TEST(Shards, MergedTellWhatDivergedFromWhatAWhatIfHasChanged) {
  const fs::path folder = fresh_folder();
  const nlohmann::json diverged = {{"recording", "a.mcap"}, {"identical", false},
                                   {"diverged", true},      {"what_if", nlohmann::json::object()},
                                   {"damage", nullptr},     {"ticks", 3}};
  nlohmann::json changed = diverged;
  changed["recording"] = "b.mcap";
  changed["diverged"] = false;
  std::ofstream(folder / "results") << diverged << '\n' << changed << '\n';
  const Outcome merged = shell("lumbrical merge-results results", folder);
  EXPECT_EQ(merged.exit_code, 3);
  EXPECT_EQ(merged.json()["diverged"], 1);
  EXPECT_EQ(merged.json()["changed"], 1);
}

// As `replay` of several recordings does: what is wrong with one hides nothing of another.
TEST(Shards, MergedTellOfADivergenceWhateverElseHasFailed) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "diverged")
      << R"({"recording": "a", "diverged": true, "damage": "torn", "ticks": 3})" << '\n';
  std::ofstream(folder / "failed") << R"({"recording": "b", "error": "gone"})" << '\n';
  std::ofstream(folder / "list") << "a\nb\nc";
  const Outcome merged = shell("lumbrical merge-results diverged failed --list list", folder);
  EXPECT_EQ(merged.exit_code, 3);
  EXPECT_EQ(merged.json()["diverged"], 1);
  EXPECT_EQ(merged.json()["failed"], 1);
  EXPECT_EQ(merged.json()["missing"].size(), 1u);
  EXPECT_EQ(shell("lumbrical merge-results failed", folder).exit_code, 2);
}

TEST(Shards, MergedCountAllTicksThatAWhatIfRan) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "results")
      << R"({"recording": "a", "identical": false, "diverged": false, "ticks": 3, "what_if": {"ticks": 50}})"
      << '\n';
  EXPECT_EQ(shell("lumbrical merge-results results", folder).json()["ticks"], 50);
}

TEST(Shards, MergedCountTheTicksOfBothHands) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "results") << R"({"recording": "a", "identical": false, "ticks": 3, "hands": [)"
                                    << R"({"ticks": 7}, {"ticks": 3, "what_if": {"ticks": 50}}]})" << '\n';
  EXPECT_EQ(shell("lumbrical merge-results results", folder).json()["ticks"], 57);
}

TEST(Shards, AnswerForTheWholeShareHoweverOftenTheyAreRun) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "list") << "gone.mcap\n";
  for (const int done_before : {0, 1}) {
    const Outcome done = shell("lumbrical replay --list list --results r", folder);
    EXPECT_EQ(done.exit_code, 2);
    EXPECT_EQ(done.json()["done_before"], done_before);
    EXPECT_EQ(done.json()["failed"], 1);
  }
  std::ofstream(folder / "r") << R"({"recording": "gone.mcap", "diverged": true, "ticks": 3})" << '\n';
  EXPECT_EQ(shell("lumbrical replay --list list --results r", folder).exit_code, 3);
}

TEST(Shards, DoWhatHasANameThatIsNoUtf8OnceToo) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "list") << "t\xffrn.mcap\n";
  for (const int done_before : {0, 1})
    EXPECT_EQ(shell("lumbrical replay --list list --results r", folder).json()["done_before"], done_before);
  EXPECT_EQ(shell("lumbrical merge-results r --list list", folder).json()["missing"].size(), 0u);
  std::ofstream(folder / "list", std::ios::app) << "t\xfern.mcap\n";
  const Outcome refused = shell("lumbrical replay --list list --results r", folder);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("two entries of the list"), std::string::npos) << refused.error;
}

TEST(Shards, SayWhyResultsCannotBeWritten) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "list") << "gone.mcap\n";
  const Outcome refused = shell("lumbrical replay --list list --results nowhere/r", folder);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("nowhere/r: can't be written: No such file"), std::string::npos)
      << refused.error;
}

// What the second entry would read is still there.
TEST(Shards, DoNothingMoreWhereResultsCanNoLongerBeWritten) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "list") << "gone.json\n-\n";
  const Outcome full = shell(
      "{ (ulimit -f 0; lumbrical run --list list --results r --threads 1 2>&1) | cat >&2; cat; } <demo.json",
      folder);
  EXPECT_NE(full.error.find("r: can't be written: File too large"), std::string::npos) << full.error;
  EXPECT_EQ(full.output, read_file((folder / "demo.json").string()));
}

TEST(Shards, AnEntryThatTakesMoreMemoryThanThereIsEndsByItself) {
  const auto none = []() -> Status { throw std::bad_alloc(); };
  const auto other = []() -> Status { throw std::runtime_error("no such thing"); };
  EXPECT_EQ(tool::by_itself("a.mcap", none).message(), "a.mcap: there is not enough memory for it");
  EXPECT_EQ(tool::by_itself("a.mcap", other).message(), "a.mcap: no such thing");
  EXPECT_TRUE(tool::by_itself("a.mcap", [] { return Status(); }).ok());
}

TEST(Shards, MergedTakeThePlaceOfResultsOnly) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "results") << R"({"recording": "a.mcap", "identical": true, "ticks": 3})" << '\n';
  std::ofstream(folder / "list") << "a.mcap\n";
  const std::string merge = "lumbrical merge-results results --list list --output ";
  for (const char* const output : {"all", "all", "results"})
    EXPECT_EQ(shell(merge + output, folder).exit_code, 0) << output;
  std::ofstream(folder / "notes") << "what took a year";
  for (const char* const output : {"notes", "list", "./list"})
    EXPECT_EQ(shell(merge + output, folder).exit_code, 2) << output;
  EXPECT_EQ(read_file((folder / "notes").string()), "what took a year");
  EXPECT_EQ(read_file((folder / "list").string()), "a.mcap\n");
  fs::create_symlink("notes", folder / "all.part");
  EXPECT_EQ(shell(merge + "all", folder).exit_code, 2);
  EXPECT_EQ(read_file((folder / "notes").string()), "what took a year");
}

TEST(Shards, MergedRefuseWhatCannotBeCountedByFileAndLine) {
  const fs::path folder = fresh_folder();
  const std::string deep(100000, '['), ends(100000, ']');
  for (const std::string& wrong :
       {std::string(R"("ticks": "three")"), std::string(R"("ticks": -3)"), std::string(R"("identical": 1)"),
        std::string(R"("hands": 2)"), std::string(R"("hands": [{"ticks": null}])"),
        std::string(R"("what_if": {"ticks": []})"), "\"damage\": " + deep + ends}) {
    std::ofstream(folder / "results") << R"({"recording": "a", "identical": true, "ticks": 3})" << '\n'
                                      << R"({"recording": "b", )" << wrong << "}\n";
    const Outcome refused = shell("lumbrical merge-results results --output all", folder);
    EXPECT_EQ(refused.exit_code, 2) << wrong.substr(0, 40);
    EXPECT_NE(refused.error.find("results:2: is no result of a recording or scene"), std::string::npos)
        << refused.error;
    EXPECT_FALSE(fs::exists(folder / "all"));
  }
}

TEST(Shards, LeaveAFileThatHoldsNoResultsAsItIs) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "list") << "rec.mcap";
  std::string scene = read_file((folder / "demo.json").string());
  std::replace(scene.begin(), scene.end(), '\n', ' ');
  const std::string whole = "{\"recording\":\"rec.mcap\",\"error\":\"\"}\n";
  for (const std::string& text :
       {std::string("rec.mcap"), scene, std::string("[1, 2]"), whole + "rec.mcap"}) {
    std::ofstream(folder / "results") << text;
    const Outcome refused = shell("lumbrical replay --list list --results results", folder);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.error.find("is no result of a recording or scene; name a file"), std::string::npos)
        << refused.error;
    EXPECT_EQ(read_file((folder / "results").string()), text);
  }
}

TEST(Shards, GoOnBehindATornFirstLine) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "list") << "none.mcap";
  const std::string replay = "lumbrical replay --list list --results results";
  shell(replay, folder);
  const std::string whole = read_file((folder / "results").string());
  ASSERT_EQ(recordings_of(folder / "results").size(), 1u);
  for (const std::size_t size : {std::size_t{1}, whole.size() / 2, whole.size() - 1}) {
    std::ofstream(folder / "results") << whole.substr(0, size);
    EXPECT_EQ(shell(replay, folder).json()["done_before"], 0) << size;
    EXPECT_EQ(read_file((folder / "results").string()), whole) << size;
  }
}

TEST(Shards, RefuseAListThatCannotBeRead) {
  const fs::path folder = folder_with_demo();
  for (const char* const command : {"replay --list .", "replay --list . --results r",
                                    "run --list . --results r", "merge-results r --list ."}) {
    std::ofstream(folder / "r").close();
    const Outcome refused = shell("lumbrical " + std::string(command), folder);
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_NE(refused.error.find(".: can't be read to its end"), std::string::npos) << refused.error;
  }
  const Outcome refused = shell("lumbrical replay a.mcap --results .", folder);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find(".: can't be read"), std::string::npos) << refused.error;
}

// They have no end.
TEST(Shards, RefuseDevicesAsResults) {
  if (!fs::exists("/dev/zero") || !fs::exists("/dev/full")) GTEST_SKIP() << "this system has no such devices";
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "list") << "a.mcap";
  for (const char* const command :
       {"merge-results /dev/zero", "replay --list list --results /dev/full", "merge-results ."}) {
    const Outcome refused = shell("lumbrical " + std::string(command), folder);
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_NE(refused.error.find("can't be read; name a file of results"), std::string::npos)
        << refused.error;
  }
  EXPECT_EQ(shell("echo '{\"recording\": \"a\"}' | lumbrical merge-results /dev/stdin", folder).exit_code, 0)
      << "a pipe has an end";
}

// As a task of an array has it, without the scheduler.
TEST(Shards, ATaskOfAJobArrayDoesItsShare) {
  const fs::path folder = folder_with_list();
  const std::string script = std::string(LUMBRICAL_SOURCE_DIR) + "/tools/cluster/shards_slurm";
  for (const char* const task : {"1", "2"}) {
    const Outcome done = shell("LUMBRICAL='" LUMBRICAL_PROGRAM "' SLURM_ARRAY_TASK_ID=" + std::string(task) +
                                   " bash '" + script + "' replay list 2 results",
                               folder);
    EXPECT_EQ(done.exit_code, 0) << done.error << " what could not be read stands in the results";
  }
  EXPECT_EQ(
      recordings_of(folder / "results/1.jsonl").size() + recordings_of(folder / "results/2.jsonl").size(),
      8u);
}

TEST(Shards, ThatAreKilledLeaveOnlyTheRestToDo) {
  const fs::path folder = folder_with_demo();
  EXPECT_EQ(shell("lumbrical run demo.json --record rec.mcap", folder).exit_code, 0);
  std::ofstream list(folder / "list");
  for (int i = 0; i < 12; ++i) {
    const std::string name = "rec" + std::to_string(i) + ".mcap";
    fs::create_hard_link(folder / "rec.mcap", folder / name);
    list << name << "\n";
  }
  list.close();
  const std::string replay = "lumbrical replay --list list --shard 1/1 --results r --threads 1";
  shell(replay +
            " & for i in $(seq 3000); do [ \"$(wc -l <r)\" -gt 1 ] && break; sleep 0.01; done; kill -9 $!; "
            "wait",
        folder);
  const std::string killed = read_file((folder / "r").string());
  const auto lines = std::count(killed.begin(), killed.end(), '\n');
  EXPECT_GE(lines, 2);
  const nlohmann::json again = shell(replay, folder).json();
  EXPECT_EQ(again["done_before"], lines);
  EXPECT_EQ(again["recordings"], 12 - lines);
  EXPECT_EQ(recordings_of(folder / "r").size(), 12u) << "each once";
  const std::string all = read_file((folder / "r").string());
  EXPECT_TRUE(all.starts_with(killed.substr(0, killed.rfind('\n') + 1))) << "what was done stands as it was";
}

TEST(Shards, GnuParallelWorksThroughAListAndGoesOnWhereItEnded) {
  if (shell("command -v parallel", fresh_folder()).exit_code != 0)
    GTEST_SKIP() << "parallel is missing; install parallel";
  const fs::path folder = folder_with_list();
  const std::string script = "LUMBRICAL='" LUMBRICAL_PROGRAM "' HOME=$PWD bash '" LUMBRICAL_SOURCE_DIR
                             "/tools/cluster/shards_parallel' replay list 3 'results of 3'";
  for (int i = 0; i < 2; ++i) {
    const Outcome done = shell(script, folder);
    EXPECT_EQ(done.exit_code, 2) << "one could not be read" << done.error;
    EXPECT_EQ(done.json()["identical"], 7);
    EXPECT_EQ(done.json()["missing"].size(), 0u);
    const std::string first = read_file((folder / "results of 3/1.summary").string());
    EXPECT_EQ(nlohmann::json::parse(first)["done_before"], i == 0 ? 0 : 3);
  }
  EXPECT_EQ(recordings_of(folder / "results of 3/results").size(), 8u);
}

// Scenes of a sweep: one, with switches of its own in each line.
constexpr const char* kSweep =
    "demo.json\ndemo.json --stiffness 4e7\n\n\"a copy.json\" --ticks 30\ndemo.json --law max-depth\n"
    "none.json\ndemo.json --record x.mcap\n";

fs::path folder_with_sweep() {
  const fs::path folder = folder_with_demo();
  fs::copy_file(folder / "demo.json", folder / "a copy.json");
  std::ofstream(folder / "list") << kSweep;
  return folder;
}

TEST(Shards, RunALineOfASweepAsTheCommandLineWould) {
  const fs::path folder = folder_with_sweep();
  const Outcome done = shell("lumbrical run --list list --results all.jsonl --threads 2 --ticks 700", folder);
  EXPECT_EQ(done.exit_code, 2) << "one is no scene, one has a switch that a line can't have";
  EXPECT_EQ(done.json()["sessions"], 6);
  EXPECT_EQ(done.json()["failed"], 2);
  const auto results = results_in(folder / "all.jsonl");
  ASSERT_EQ(results.size(), 6u);
  for (const char* const line : {"demo.json", "demo.json --stiffness 4e7", "demo.json --law max-depth"}) {
    ASSERT_TRUE(results.contains(line)) << line;
    const Outcome alone = shell("lumbrical run --json --ticks 700 " + std::string(line), folder);
    for (const char* const key : {"ticks", "contacts", "peak_force", "peak_torque", "law", "flags"})
      EXPECT_EQ(results.at(line)[key], alone.json()[key]) << line << " " << key;
    EXPECT_GT(alone.json()["peak_force"]["thumb"], 0) << line;
  }
  EXPECT_EQ(results.at("\"a copy.json\" --ticks 30")["ticks"], 30) << "the line has the last word";
  EXPECT_NE(results.at("none.json")["error"].get<std::string>().find("none.json"), std::string::npos);
  EXPECT_NE(results.at("demo.json --record x.mcap")["error"].get<std::string>().find("--record"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "x.mcap"));
}

TEST(Shards, OfASweepGoOnWhereTheyEnded) {
  const fs::path folder = folder_with_sweep();
  for (const char* const shard : {"1", "2"})
    shell("lumbrical run --ticks 10 --list list --shard " + std::string(shard) + "/2 --results " + shard,
          folder);
  EXPECT_EQ(scenes_of(folder / "1"),
            (std::set<std::string>{"demo.json", "\"a copy.json\" --ticks 30", "none.json"}));
  EXPECT_EQ(scenes_of(folder / "2").size(), 3u);
  const std::string whole = read_file((folder / "2").string());
  std::ofstream(folder / "2") << whole.substr(0, whole.size() - 1);  // torn at its very end

  const std::string merge = "lumbrical merge-results 1 2 --list list --output ";
  EXPECT_EQ(shell(merge + "torn", folder).json()["missing"].size(), 1u);
  const Outcome again = shell("lumbrical run --ticks 10 --list list --shard 2/2 --results 2", folder);
  EXPECT_EQ(again.json()["sessions"], 1) << again.error;
  EXPECT_EQ(again.json()["done_before"], 2);
  const nlohmann::json merged = shell(merge + "all", folder).json();
  EXPECT_EQ(merged["sessions"], 6);
  EXPECT_EQ(merged["recordings"], 0);
  EXPECT_EQ(merged["failed"], 2);
  EXPECT_EQ(merged["ticks"], 10 + 10 + 30 + 10);
  EXPECT_EQ(merged["missing"].size(), 0u);
  EXPECT_EQ(scenes_of(folder / "all").size(), 6u);
}

TEST(Shards, OfScenesRefuseWhatASessionAloneHas) {
  const fs::path folder = folder_with_sweep();
  for (const char* const wrong :
       {"", "demo.json --list list", "--list list", "--list list --results r --record x.mcap",
        "--list list --results r --rate 100", "--list list --results r --view",
        "--list list --results r --compare-precision", "--list list --results r --shard 3/2",
        "--list nowhere --results r", "demo.json --results r", "demo.json --shard 1/2"}) {
    const Outcome refused = shell("lumbrical run " + std::string(wrong), folder);
    EXPECT_EQ(refused.exit_code, 2) << wrong;
    EXPECT_FALSE(refused.error.empty()) << wrong;
    EXPECT_FALSE(fs::exists(folder / "r")) << wrong;
  }
}

}  // namespace
}  // namespace lumbrical::test
