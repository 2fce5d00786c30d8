// Recordings on the command line: replay, export, verify, recover, trim and their kin.
#include <algorithm>
#include <fstream>
#include <string>

#include "lumbrical/recording.h"
#include "read_archive.h"
#include "recording/mcap_reader.h"
#include "scenes.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

TEST(CommandLine, ReplayOfSeveralTellsOfEachInTheOrderGiven) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 300 --record a.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 150 --law point --record b.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 200 --broadphase grid --record c.mcap", folder).exit_code,
            0);
  std::ofstream(folder / "bad.mcap") << "no recording";
  for (const char* const threads : {"", " --threads 1", " --threads 7"}) {
    const Outcome all =
        shell("lumbrical replay a.mcap b.mcap c.mcap a.mcap --json" + std::string(threads), folder);
    EXPECT_EQ(all.exit_code, 0) << all.error;
    const nlohmann::json json = all.json();
    ASSERT_EQ(json.size(), 4u);
    const std::pair<const char*, int> expected[] = {
        {"a.mcap", 300}, {"b.mcap", 150}, {"c.mcap", 200}, {"a.mcap", 300}};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(json[i]["recording"], expected[i].first);
      EXPECT_EQ(json[i]["ticks"], expected[i].second);
      EXPECT_EQ(json[i]["identical"], true);
      EXPECT_EQ(json[i]["threads"], 1);
    }
  }
  // What can't be read keeps no other from being replayed.
  Outcome some = shell("lumbrical replay a.mcap bad.mcap b.mcap --json", folder);
  EXPECT_EQ(some.exit_code, 2);
  EXPECT_NE(some.error.find("bad.mcap"), std::string::npos);
  EXPECT_EQ(some.json()[0]["identical"], true);
  EXPECT_TRUE(some.json()[1].contains("error"));
  EXPECT_EQ(some.json()[2]["ticks"], 150);
  // Only b was recorded under that law.
  some = shell("lumbrical replay bad.mcap a.mcap b.mcap --law point --json", folder);
  EXPECT_EQ(some.exit_code, 2);
  EXPECT_EQ(some.json()[1]["identical"], false);
  EXPECT_EQ(some.json()[2]["identical"], true);
  EXPECT_EQ(shell("lumbrical replay a.mcap b.mcap --trace t.txt", folder).exit_code, 2);
  const Outcome text = shell("lumbrical replay a.mcap b.mcap", folder);
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_LT(text.output.find("a.mcap"), text.output.find("b.mcap"));
}

TEST(CommandLine, ReplayWithAnotherLawAsksAndLeadsWithNewtons) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 400 --record a.mcap", folder).exit_code, 0);
  const Outcome replay = shell("lumbrical replay a.mcap --law max-depth --json", folder);
  EXPECT_EQ(replay.exit_code, 0) << replay.error;
  const nlohmann::json divergence = replay.json()["first_divergence"];
  EXPECT_EQ(replay.json()["identical"], false);
  expect_keys(divergence, {"tick", "stage", "field", "recorded", "replayed"});
  EXPECT_TRUE(divergence["ulp"].is_null());
  const Outcome text = shell("lumbrical replay a.mcap --law max-depth", folder);
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_EQ(text.output.find("Forces change by up to "), 0u) << text.output;
  // The most newtons of all, whoever would notice most.
  double most = 0;
  const nlohmann::json asked = replay.json()["what_if"]["force"];
  for (const nlohmann::json& force : asked) most = std::max(most, force["max"].get<double>());
  const std::size_t number = std::string("Forces change by up to ").size();
  EXPECT_NEAR(std::stod(text.output.substr(number)), most, 0.005 * most) << text.output;
  EXPECT_NE(text.output.find(" N ("), std::string::npos) << text.output;
  EXPECT_EQ(text.output.find("ulp"), std::string::npos) << text.output;
  EXPECT_EQ(text.output.find("diverged"), std::string::npos) << text.output;
  const Outcome same = shell("lumbrical replay a.mcap --law field", folder);
  EXPECT_EQ(same.output.find("No force changes."), 0u) << same.output;
}

TEST(CommandLine, ARecordingOfOtherArithmeticSaysThatBeforeItSaysThatItDiverged) {
  const fs::path folder = folder_with_demo();
  // A recording whose forces are another law's, and whose metadata tell of another arithmetic.
  RecordingReader reader;
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 400 --law column --record column.mcap", folder).exit_code,
            0);
  ASSERT_TRUE(reader.open((folder / "column.mcap").string()).ok());
  Scene scene = reader.scene();
  scene.settings.law.fill(Law::field);
  for (const char* const arithmetic : {"0badbeef", ""}) {
    RecorderOptions options;
    options.metadata["arithmetic"] = *arithmetic == 0 ? std::string(arithmetic_version()) : arithmetic;
    Recorder recorder;
    fs::remove(folder / "other.mcap");
    ASSERT_TRUE(recorder.open((folder / "other.mcap").string(), scene, options).ok());
    ASSERT_TRUE(reader.seek(0).ok());
    TickRecord record;
    for (bool end = false; reader.next(record, end).ok() && !end;) recorder.record(record);
    ASSERT_TRUE(recorder.close().ok());
    const Outcome replay = shell("lumbrical replay other.mcap", folder);
    EXPECT_EQ(replay.exit_code, 3);
    const bool other = replay.output.find("Recorded by other arithmetic (0badbeef") == 0;
    EXPECT_EQ(other, *arithmetic != 0) << replay.output;
    EXPECT_EQ(replay.output.find("Forces change by up to") != std::string::npos, other) << replay.output;
    EXPECT_NE(replay.output.find("diverged at"), std::string::npos) << replay.output;
    EXPECT_EQ(shell("lumbrical replay other.mcap --json", folder).json()["other_arithmetic"].is_null(),
              !other);
  }
}

TEST(CommandLine, ExportIsSmallAndNumPyReadsItsArchive) {
  const fs::path folder = fresh_folder();
  ASSERT_EQ(shell("lumbrical run '" + kDemo + "' --record a.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical export a.mcap -o a.csv", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical export a.mcap --format npz -o a.npz", folder).exit_code, 0);
  EXPECT_LT(fs::file_size(folder / "a.csv"), 5'000'000u);
  EXPECT_LT(fs::file_size(folder / "a.npz"), 5'000'000u);
  const std::string csv = read_file(folder / "a.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 10001);
  EXPECT_EQ(shell("lumbrical export a.mcap --format npz", folder).exit_code, 2);
  EXPECT_EQ(shell("lumbrical export a.mcap --ticks 9:3", folder).exit_code, 2);
  EXPECT_NE(shell("lumbrical export a.mcap --segments 'index distl'", folder)
                .error.find("did you mean index distal"),
            std::string::npos);
  const Outcome few = shell(
      "lumbrical export a.mcap --ticks 4000:4004:2 --columns force.x --segments 'index distal,palm'", folder);
  EXPECT_EQ(few.output.substr(0, few.output.find('\n')),
            "tick,time [s],index_distal.force.x [N],palm.force.x [N]");
  EXPECT_EQ(std::count(few.output.begin(), few.output.end(), '\n'), 4);
  if (shell("python3 --version", folder).exit_code != 0) GTEST_SKIP() << "no python3";
  std::ofstream(folder / "read.py") << kReadArchive;
  const Outcome read = shell("python3 read.py a.npz a.csv", folder);
  EXPECT_EQ(read.exit_code, 0) << read.error;
  EXPECT_EQ(shell("lumbrical export a.mcap --ticks 20000:20005 --format npz -o none.npz", folder).exit_code,
            2);
  EXPECT_FALSE(fs::exists(folder / "none.npz"));
}

TEST(CommandLine, DiffTellsByHowManyNewtonsForcesDiffer) {
  const fs::path folder = folder_with_demo();
  const std::string run = "lumbrical run demo.json --ticks 700 --record ";
  ASSERT_EQ(shell(run + "a.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell(run + "b.mcap --stiffness 1e7", folder).exit_code, 0);
  ASSERT_EQ(shell(run + "c.mcap --stiffness 1e7 --record-forces none", folder).exit_code, 0);
  const Outcome text = shell("lumbrical diff a.mcap b.mcap", folder);
  EXPECT_EQ(text.exit_code, 3);
  EXPECT_NE(text.output.find("The hand's force differs by up to "), std::string::npos) << text.output;
  const nlohmann::json forces =
      shell("lumbrical diff a.mcap b.mcap --json", folder).json()["force_difference"];
  EXPECT_EQ(forces["ticks"], 700);
  EXPECT_GT(forces["max"], 0.1);
  EXPECT_GT(forces["max_tick"], 0);
  EXPECT_EQ(forces["side"], "right");
  EXPECT_TRUE(shell("lumbrical diff a.mcap a.mcap --json", folder).json()["force_difference"].is_null());
  EXPECT_NE(shell("lumbrical diff a.mcap c.mcap", folder).output.find("No tick has its forces in both."),
            std::string::npos);
}

TEST(CommandLine, OneTickIsNotManyAndAWhatIfSaysWristAsRunDoes) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 1 --record one.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical replay one.mcap", folder).output.find("Identical: 1 tick replayed"), 0u);
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 400 --record a.mcap", folder).exit_code, 0);
  const std::string text = shell("lumbrical replay a.mcap --stiffness 1e7", folder).output;
  EXPECT_NE(text.find("most at the wrist: "), std::string::npos) << text;
  EXPECT_EQ(text.find("\n\n"), std::string::npos) << text;
}

TEST(CommandLine, ExportTakesTheFormatFromTheEndingOfItsFile) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 10 --record a.mcap", folder).exit_code, 0);
  const auto begin_of = [&folder](const std::string& file, const std::string& more) {
    const Outcome done = shell("lumbrical export a.mcap -o " + file + more, folder);
    return done.exit_code == 0 ? read_file(folder / file).substr(0, 2) : done.error;
  };
  EXPECT_EQ(begin_of("a.npz", ""), "PK");
  EXPECT_EQ(begin_of("a.json", ""), "{\"");
  EXPECT_EQ(begin_of("a.jsonl", ""), "{\"");
  EXPECT_EQ(begin_of("a.csv", ""), "ti");
  EXPECT_EQ(begin_of("a.txt", ""), "ti");
  EXPECT_EQ(begin_of("b.txt", " --format npz"), "PK");
  EXPECT_NE(begin_of("b.npz", " --format csv").find("the ending of b.npz says npz"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "b.npz"));
}

TEST(CommandLine, ARecordingTellsWhenItWasMadeAndWhatItsNumbersAre) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 10 --record a.mcap", folder).exit_code, 0);
  const nlohmann::json metadata = shell("lumbrical info a.mcap --json", folder).json()["metadata"];
  expect_keys(metadata, {"start_utc", "start_monotonic_ns", "program", "arithmetic", "build"});
  EXPECT_EQ(metadata["arithmetic"], std::string(arithmetic_version()));
  const std::string utc = metadata["start_utc"];
  EXPECT_EQ(utc.size(), 30u) << utc;
  EXPECT_EQ(utc.back(), 'Z');
  const std::string file = read_file(folder / "a.mcap");
  for (const char* const text :
       {"index proximal,index intermediate", "wrist,thumb metacarpal", "thumb abduction,thumb flexion 1",
        "input lost", "segments.force N in the world frame", "about the joint at the segment's base"})
    EXPECT_NE(file.find(text), std::string::npos) << text;
}

// As somebody may have made it: a certificate that nobody could print, and more events than are told.
TEST(CommandLine, InfoTellsOfADeviceWithinBounds) {
  const fs::path folder = folder_with_demo();
  RecorderOptions options;
  options.metadata["certificate"] = std::string(100000, '[') + std::string(100000, ']');
  Recorder recorder;
  Scene scene;
  scene.hand = default_hand(Side::right);
  ASSERT_TRUE(recorder.open(folder / "driven.mcap", scene, options).ok());
  TickRecord record;
  record.sent_count = 1;
  for (std::uint64_t& tick = record.output.tick; tick < 10100; ++tick) {
    record.sent[0].state = tick % 2 == 0 ? SafetyState::idle : SafetyState::armed;
    ASSERT_TRUE(recorder.record(record));
  }
  ASSERT_TRUE(recorder.close().ok());
  const Outcome told = shell("lumbrical info driven.mcap --json", folder);
  ASSERT_EQ(told.exit_code, 0) << told.error;
  const nlohmann::json device = told.json()["device"];
  EXPECT_EQ(device["certificate"], options.metadata["certificate"]);
  EXPECT_EQ(device["events"].size(), 10000u);
  EXPECT_EQ(device["more_events"], 100);
  EXPECT_NE(shell("lumbrical info driven.mcap", folder).output.find("and 10,080 more"), std::string::npos);
}

TEST(CommandLine, ViewShowsARecordingThatIsStillWritten) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 10 --record a.mcap", folder).exit_code, 0);
  fs::rename(folder / "a.mcap", folder / "a.mcap.part");
  const std::string view = "timeout -s INT 2 lumbrical view --no-browser ";
  const Outcome shown = shell(view + "a.mcap", folder);
  EXPECT_EQ(shown.error.find("there is no such file"), std::string::npos) << shown.error;
  if (shown.error.empty()) {
    EXPECT_NE(shown.output.find("#recording=a/a.mcap.part"), std::string::npos) << shown.output;
  }
  EXPECT_EQ(shell(view + ".", folder).exit_code, 2);
}

TEST(CommandLine, ViewRefusesWhatIsNoRecording) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "a.txt") << "tick,time\n";
  const auto told = [&folder](const std::string& file) {
    const Outcome shown = shell("timeout -s INT 2 lumbrical view --no-browser " + file, folder);
    EXPECT_EQ(shown.exit_code, 2) << file;
    return shown.error;
  };
  EXPECT_EQ(told("a.txt"), "a.txt: this is not an MCAP file; name a recording\n");
  EXPECT_EQ(told("none.mcap"), "none.mcap: there is no such file; check the path\n");
  EXPECT_NE(told("demo.json").find("a scene is run: `lumbrical run SCENE --rate 1000 --view`"),
            std::string::npos);
}

TEST(CommandLine, ViewGivesANameToARecordingWhoseNameAnAddressCannotHold) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "gr\xe9.mcap") << "\x89MCAP0\r\nread by the page";
  std::ofstream(folder / "gr\xc3\xa9.mcap") << "\x89MCAP0\r\nread by the page";
  const std::string view = "timeout -s INT 2 lumbrical view --no-browser ";
  const Outcome shown = shell(view + "gr\xe9.mcap gr\xc3\xa9.mcap", folder);
  if (shown.error.empty()) {  // the page is built
    EXPECT_NE(shown.output.find("#recording=a/recording.mcap&recording=b/gr%C3%A9.mcap"), std::string::npos)
        << shown.output;
  }
}

TEST(CommandLine, NothingIsWrittenOverWhatIsThere) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 100 --record a.mcap", folder).exit_code, 0);
  const std::string good = read_file((folder / "a.mcap").string());
  std::ofstream(folder / "notes.txt") << "mine";
  for (const char* const command :
       {"lumbrical run demo.json --ticks 5 --record a.mcap", "lumbrical recover a.mcap -o a.mcap",
        "lumbrical trim a.mcap --to-tick 5 -o a.mcap", "lumbrical export a.mcap -o a.mcap",
        "lumbrical replay a.mcap --trace a.mcap --trace-tick 3", "lumbrical world demo.json --output a.mcap",
        "lumbrical run demo.json --ticks 5 --record notes.txt"}) {
    const Outcome refused = shell(command, folder);
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_NE(refused.error.find("is there already"), std::string::npos) << command << refused.error;
  }
  EXPECT_EQ(read_file((folder / "a.mcap").string()), good);
  EXPECT_EQ(read_file((folder / "notes.txt").string()), "mine");
}

TEST(CommandLine, ADashIsNoFileToWrite) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 10 --record a.mcap", folder).exit_code, 0);
  for (const char* const command :
       {"trim a.mcap -o -", "split a.mcap --ticks 5 -o -", "merge a.mcap -o -", "compress a.mcap -o -",
        "recover a.mcap -o -", "run demo.json --ticks 5 --record -", "replay a.mcap --results -",
        "report . -o -", "inspect a.obj --unit m --fix -"}) {
    const Outcome refused = shell("lumbrical " + std::string(command), folder);
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_NE(refused.error.find("standard output is for the report; name a file"), std::string::npos)
        << command << refused.error;
  }
  for (const char* const name : {"-", "-.001"}) EXPECT_FALSE(fs::exists(folder / name)) << name;
  EXPECT_EQ(shell("lumbrical export a.mcap -o - | grep -q tick", folder).exit_code, 0);
}

TEST(CommandLine, ASignalEndsAnExportWithoutAFile) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 20000 --record a.mcap", folder).exit_code, 0);
  const std::string all = "lumbrical export a.mcap --columns all --exact -o a.csv";
  const Outcome stopped = shell(
      all + " & export=$!; " + wait_until("test -e a.csv.part") + "kill -TERM $export; wait $export", folder);
  EXPECT_EQ(stopped.exit_code, 130) << stopped.error;
  EXPECT_NE(stopped.error.find("a.csv: stopped by a signal"), std::string::npos) << stopped.error;
  EXPECT_FALSE(fs::exists(folder / "a.csv"));
  EXPECT_FALSE(fs::exists(folder / "a.csv.part"));
  EXPECT_EQ(shell("lumbrical export a.mcap --ticks 0:9 -o a.csv", folder).exit_code, 0);
}

// 100 .. 149 are missing: the file is whole, and replay refuses what is behind the gap.
TEST(CommandLine, MissingTicksAreToldWithAnExitCodeOfTheirOwn) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 600 --record a.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical verify a.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical trim a.mcap --to-tick 100 -o b.mcap && lumbrical trim a.mcap --from-tick 150 -o "
                  "c.mcap && "
                  "lumbrical merge b.mcap c.mcap -o gap.mcap",
                  folder)
                .exit_code,
            0);
  const Outcome verify = shell("lumbrical verify gap.mcap", folder);
  EXPECT_EQ(verify.exit_code, 5);
  EXPECT_NE(verify.output.find("50 are missing: ticks 100 to 149"), std::string::npos) << verify.output;
  EXPECT_EQ(shell("lumbrical verify gap.mcap --json", folder).json()["missing"].dump(), "[[100,149]]");
  EXPECT_EQ(shell("lumbrical replay gap.mcap", folder).exit_code, 2);

  InputFile file;
  Summary summary;
  bool present = false;
  ASSERT_TRUE(file.open((folder / "a.mcap").string()).ok());
  ASSERT_TRUE(read_summary(file, summary, present).ok());
  const mcap::ChunkIndex& chunk = summary.chunks.at(summary.chunks.size() / 2);
  std::string bytes = read_file((folder / "a.mcap").string());
  char& inside = bytes[chunk.offset + chunk.length / 2];
  inside = static_cast<char>(inside ^ 1);
  std::ofstream(folder / "flipped.mcap", std::ios::binary) << bytes;
  const Outcome recover = shell("lumbrical recover flipped.mcap -o whole.mcap --json", folder);
  EXPECT_EQ(recover.exit_code, 5) << recover.error;
  EXPECT_EQ(recover.json()["recovered"].get<int>() + recover.json()["lost"].get<int>(), 600);
  ASSERT_EQ(recover.json()["missing"].size(), 1u);
  const auto range = recover.json()["missing"][0];
  EXPECT_EQ(range[1].get<int>() - range[0].get<int>() + 1, recover.json()["lost"]);
  EXPECT_EQ(range[0].get<int>() % 20, 0) << "one chunk: a fifth of a second";
  EXPECT_EQ(recover.json()["lost"], 20);
  // Both parts that replay names can be replayed.
  const std::string first = std::to_string(range[0].get<int>());
  const std::string behind = std::to_string(range[1].get<int>() + 100);
  const Outcome refused = shell("lumbrical replay whole.mcap", folder);
  EXPECT_NE(refused.error.find("trim makes recordings that can: of the ticks before it (--to-tick " + first),
            std::string::npos)
      << refused.error;
  for (const std::string& part : {"--to-tick " + first, "--from-tick " + behind})
    EXPECT_EQ(shell("rm -f part.mcap; lumbrical trim whole.mcap " + part +
                        " -o part.mcap && lumbrical replay part.mcap",
                    folder)
                  .exit_code,
              0)
        << part;
  EXPECT_EQ(shell("lumbrical recover a.mcap -o again.mcap", folder).exit_code, 0);
}

TEST(CommandLine, AReplayThatComesOutRightStillTellsOfADamagedFile) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 50 --record a.mcap", folder).exit_code, 0);
  std::string bytes = read_file((folder / "a.mcap").string());
  bytes[13] = static_cast<char>(bytes[13] ^ 1);  // in the header's record, which no tick depends on
  bytes[30] = static_cast<char>(bytes[30] ^ 1);
  std::ofstream(folder / "flipped.mcap", std::ios::binary) << bytes;
  std::ofstream(folder / "torn.mcap", std::ios::binary)
      << read_file((folder / "a.mcap").string()).substr(0, bytes.size() - 30);
  for (const char* const name : {"flipped.mcap", "torn.mcap"}) {
    const Outcome replay = shell(std::string("lumbrical replay ") + name + " --json", folder);
    EXPECT_EQ(replay.exit_code, 2) << name << replay.error;
  }
  EXPECT_TRUE(shell("lumbrical replay torn.mcap --json", folder).json()["identical"]);
  EXPECT_NE(shell("lumbrical replay torn.mcap", folder).output.find("not whole"), std::string::npos);
  EXPECT_TRUE(shell("lumbrical replay a.mcap --json", folder).json()["damage"].is_null());
}

TEST(CommandLine, PartsOfARecordingReplayAndMakeTheWhole) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 900 --record a.mcap", folder).exit_code, 0);
  const Outcome trim = shell("lumbrical trim a.mcap --from 3 --to 5 -o part.mcap --json", folder);
  ASSERT_EQ(trim.exit_code, 0) << trim.error;
  EXPECT_EQ(trim.json()["ticks"], 200);
  EXPECT_EQ(trim.json()["replayable"], true);
  EXPECT_EQ(shell("lumbrical replay part.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical split a.mcap --ticks 400 -o p.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical merge p.001.mcap p.002.mcap p.003.mcap -o m.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("cmp a.mcap m.mcap", folder).exit_code, 0);
  const std::string gap = shell("lumbrical merge p.001.mcap p.003.mcap -o gap.mcap", folder).output;
  EXPECT_NE(gap.find("Not all of them can be replayed"), std::string::npos) << gap;
  EXPECT_EQ(gap.find("--world"), std::string::npos) << "which merge does not have: " << gap;
  ASSERT_EQ(shell("lumbrical compress a.mcap -o z.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical compress z.mcap --with lz4 -o b.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("cmp a.mcap b.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical trim a.mcap --from 20 -o none.mcap", folder).exit_code, 2);
  EXPECT_FALSE(fs::exists(folder / "none.mcap"));
}

TEST(CommandLine, SplitRefusesPartsOfLessThanATick) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 5 --record a.mcap", folder).exit_code, 0);
  const Outcome refused = shell("lumbrical split a.mcap --seconds 0.0005 -o p.mcap", folder);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("is less than a tick"), std::string::npos) << refused.error;
  EXPECT_FALSE(fs::exists(folder / "p.001.mcap"));
}

// Of a list an array however long it is; a failure an object with its exit code; nothing else beside it.
TEST(CommandLine, WhatJsonPrintsHasOneForm) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 5 --record a.mcap", folder).exit_code, 0);
  std::ofstream(folder / "none").close();
  std::ofstream(folder / "one") << "a.mcap\n";
  std::ofstream(folder / "two") << "a.mcap\na.mcap\n";
  std::size_t size = 0;
  for (const char* const list : {"none", "one", "two"}) {
    const Outcome replay = shell("lumbrical replay --json --list " + std::string(list), folder);
    EXPECT_EQ(replay.exit_code, 0) << replay.error;
    ASSERT_TRUE(replay.json().is_array()) << replay.output;
    EXPECT_EQ(replay.json().size(), size++);
  }
  EXPECT_TRUE(shell("lumbrical replay --json a.mcap", folder).json().is_object());
  const Outcome mixed = shell("lumbrical replay a.mcap --json --trace - --trace-tick 2", folder);
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_EQ(mixed.json()["exit_code"], 2);
  const Outcome bad = shell("lumbrical verify demo.json --json", folder);
  EXPECT_EQ(bad.json()["exit_code"], bad.exit_code);
  std::ofstream(folder / "results") << R"({"recording": "a", "identical": true, "ticks": 3})" << '\n';
  EXPECT_EQ(shell("lumbrical merge-results results --json", folder).json()["identical"], 1);
}

TEST(CommandLine, AUnitOfMeshesThatAreNotNamedIsRefused) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 5 --record a.mcap", folder).exit_code, 0);
  const Outcome refused = shell("lumbrical replay a.mcap --unit mm", folder);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("--mesh"), std::string::npos) << refused.error;
}

TEST(CommandLine, RecoverSaysThatASessionGoesOn) {
  const fs::path folder = folder_with_demo();
  const std::string recover = "lumbrical recover a.mcap --json -o ";
  const Outcome growing =
      shell("lumbrical run demo.json --rate 100 " + kManyTicks + "--record a.mcap & run=$!; " +
                wait_for_ticks("a.mcap") + recover + "now.mcap; kill -INT $run; wait $run",
            folder);
  const std::string line = growing.output.substr(0, growing.output.find('\n'));
  EXPECT_EQ(nlohmann::json::parse(line)["growing"], true) << growing.error;
  EXPECT_EQ(shell(recover + "then.mcap", folder).json()["growing"], false);
}

TEST(CommandLine, SplitMakesNoPartsWhereThereAreNoTicks) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 1 --record a.mcap", folder).exit_code, 0);
  RecordingReader reader;
  ASSERT_TRUE(reader.open((folder / "a.mcap").string()).ok());
  TickRecord record;
  bool end = true;
  ASSERT_TRUE(reader.next(record, end).ok());
  Recorder recorder;
  ASSERT_TRUE(recorder.open((folder / "gaps.mcap").string(), reader.scene(), {}).ok());
  for (const std::uint64_t tick : {std::uint64_t{0}, std::uint64_t{510}, UINT64_MAX - 6}) {
    record.output.tick = tick;
    ASSERT_TRUE(recorder.record(record));
  }
  ASSERT_TRUE(recorder.close().ok());
  const Outcome split = shell("timeout 20 lumbrical split gaps.mcap --ticks 100 -o p.mcap --json", folder);
  ASSERT_EQ(split.exit_code, 0) << split.error;
  ASSERT_EQ(split.json()["parts"].size(), 3u) << split.output;
  for (const auto& part : split.json()["parts"]) EXPECT_EQ(part["ticks"], 1);
  EXPECT_FALSE(fs::exists(folder / "p.004.mcap"));
}

TEST(CommandLine, AnEmergencyStopEndsNoSessionThatHasNoDevice) {
  const fs::path folder = folder_with_demo();
  const Outcome run =
      shell("lumbrical run demo.json --rate 100 " + kManyTicks + "--record a.mcap & run=$!; " +
                wait_for_ticks("a.mcap") + "kill -USR2 $run; kill -INT $run; wait $run",
            folder);
  EXPECT_EQ(run.exit_code, 130) << run.error;
}

TEST(CommandLine, TrimMakesNoRecordingOfAGap) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 20 --record a.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical trim a.mcap --to-tick 5 -o b.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical trim a.mcap --from-tick 15 -o c.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical merge b.mcap c.mcap -o gap.mcap", folder).exit_code, 0);
  const Outcome none = shell("lumbrical trim gap.mcap --from-tick 6 --to-tick 9 -o d.mcap", folder);
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.error.find("no tick is in that range; it holds 0 to 19, with gaps"), std::string::npos)
      << none.error;
  EXPECT_FALSE(fs::exists(folder / "d.mcap"));
}

TEST(CommandLine, ReplayTracesAndWeighsAChange) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 500 --record a.mcap", folder).exit_code, 0);
  const Outcome what_if = shell("lumbrical replay a.mcap --stiffness 1e7 --trace t.txt --json", folder);
  EXPECT_EQ(what_if.exit_code, 0);
  expect_keys(what_if.json()["first_divergence"], {"primitive", "triangle", "ulp", "recorded_build"});
  expect_keys(what_if.json()["what_if"], {"ticks", "force", "torque", "tick_us"});
  expect_keys(what_if.json()["what_if"]["force"]["index"],
              {"max", "rms", "max_jnd", "rms_jnd", "felt_ticks"});
  EXPECT_NE(read_file((folder / "t.txt").string()).find(" contact_force segment"), std::string::npos);
  EXPECT_EQ(shell("lumbrical replay a.mcap --mesh bowl=x.obj", folder).exit_code, 2);
  EXPECT_EQ(shell("lumbrical replay a.mcap --mesh x.obj", folder).exit_code, 2);
  for (const char* const value : {"replay --mesh bowl=x.obj a.mcap", "export --columns force a.mcap -o -",
                                  "export --segments palm a.mcap -o -"}) {
    const Outcome behind = shell(std::string("lumbrical ") + value, folder);
    EXPECT_EQ(behind.error.find("recording"), std::string::npos) << "is behind the value: " << behind.error;
  }
}

TEST(CommandLine, AnotherMeshIsTurnedAndToldOf) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "in.obj") << cube_text(true);
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 5 --record a.mcap", folder).exit_code, 0);
  const std::string name =
      shell("lumbrical info a.mcap --json", folder).json()["scene"]["objects"][0]["name"];
  const std::string replay = "lumbrical replay a.mcap --mesh '" + name + "=in.obj'";
  const Outcome text = shell(replay, folder);
  EXPECT_NE(text.output.find("1 of 1 part turned outside out, 12 triangles"), std::string::npos)
      << text.output << text.error;
  const nlohmann::json windings = shell(replay + " --json", folder).json()["what_if"]["windings"];
  ASSERT_EQ(windings.size(), 1u);
  EXPECT_EQ(windings[0]["name"], name);
  EXPECT_EQ(windings[0]["winding"]["turned_triangles"], 12);
}

TEST(CommandLine, WhatIfIsKeptAsARecordingOfItsOwn) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 2000 --record a.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 2000 --stiffness 1e7 --record b.mcap", folder).exit_code,
            0);
  const Outcome asked = shell("lumbrical replay a.mcap --stiffness 1e7 --record soft.mcap --json", folder);
  EXPECT_EQ(asked.exit_code, 0) << asked.error;
  EXPECT_EQ(shell("lumbrical replay soft.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical verify soft.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical diff b.mcap soft.mcap", folder).exit_code, 0) << "as if it had been run so";
  EXPECT_EQ(shell("lumbrical diff a.mcap soft.mcap", folder).exit_code, 3);
  EXPECT_EQ(shell("lumbrical info soft.mcap --json", folder).json()["metadata"]["what_if_of"], "a.mcap");
  // What is there already stays; a part of a session has no beginning; and a question must be asked.
  ASSERT_EQ(shell("lumbrical trim a.mcap --from 1 --to 1.5 -o part.mcap", folder).exit_code, 0);
  for (const char* const wrong :
       {"a.mcap --stiffness 9e6 --record soft.mcap", "part.mcap --stiffness 1e7 --record none.mcap",
        "a.mcap --record none.mcap", "a.mcap b.mcap --stiffness 1e7 --record none.mcap"}) {
    const Outcome outcome = shell(std::string("lumbrical replay ") + wrong, folder);
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_NE(outcome.error, "") << wrong;
    EXPECT_FALSE(fs::exists(folder / "none.mcap")) << wrong;
  }
}

}  // namespace
}  // namespace lumbrical::test
