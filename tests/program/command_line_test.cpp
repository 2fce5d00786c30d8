// The command line as users' scripts rely on it: usage, exit codes, and what happens to bad input.
#include <fstream>
#include <string>

#include "lumbrical/recording.h"
#include "scenes.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

TEST(CommandLine, HelpAndVersionSucceed) {
  const fs::path folder = fresh_folder();
  EXPECT_EQ(shell("lumbrical --version", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical --help", folder).exit_code, 0);
  for (const char* const command :
       {"run", "replay", "diff", "info", "verify", "recover", "export", "probe", "inspect", "report"}) {
    const Outcome outcome = shell("lumbrical " + std::string(command) + " --help", folder);
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_FALSE(outcome.output.empty());
    for (const char* const type : {"FILE:FILE", ":NUMBER", "TEXT:", ":ALIGNMENT"})
      EXPECT_EQ(outcome.output.find(type), std::string::npos) << command << ' ' << type;
  }
}

TEST(CommandLine, MistakesInItExitWith2AndNameTheSwitch) {
  const fs::path folder = folder_with_square();
  const std::pair<std::string, std::string> mistakes[] = {
      {"", "subcommand"},
      {"feel", "feel"},
      {"inspect square.obj", "--unit"},
      {"inspect square.obj --unit inch", "--unit"},
      {"inspect --unit m", "mesh"},
      {"probe --mesh square.obj --unit m", "--sphere"},
      {"probe --mesh square.obj --unit m --sphere 1,2,3", "--sphere"},
      {"probe --mesh square.obj --unit m --sphere 1,2,3,x", "--sphere"},
      {"probe --mesh square.obj --unit m --sphere 1,2,3,nan", "--sphere"},
      {"probe --mesh square.obj --unit m --sphere 1,2,3,-1", "--sphere"},
      {"probe --mesh square.obj --unit m --sphere 1,2,3,1e999", "--sphere"},
      {"probe --mesh square.obj --unit m --cylinder 0,0,0,0,0,1", "--cylinder"},
      {"probe --mesh square.obj --unit m --capsule 0,0,0,0,0,1,1,1,1", "--capsule"},
      {"probe --mesh square.obj --unit m --sphere 0,0,0,1 --stiffness 0", "--stiffness"},
      {"probe --mesh square.obj --unit m --sphere 0,0,0,1 --stiffness nan", "--stiffness"},
      {"probe --mesh square.obj --unit m --sphere 0,0,0,1 --law hard", "--law"},
      {"run", "scene"},
      {"run '" + kDemo + "' --ticks 0", "--ticks"},
      {"run '" + kDemo + "' --ticks 1e3x", "--ticks"},
      {"run '" + kDemo + "' --rate 0", "--rate"},
      {"run '" + kDemo + "' --threads 65", "--threads"},
      {"run '" + kDemo + "' --broadphase cubes", "tree, grid, voxel or brute"},
      {"run '" + kDemo + "' --isa avx3", "--isa"},
      {"run '" + kDemo + "' --sink tcp://there", "\"tcp://there\" is no sink"},
      {"run '" + kDemo + "' --sink 'modbus-tcp://h?profile=p.json'", "--sink moves a hand at the rate"},
      {"run '" + kDemo + "' --sideways", "--sideways"},
      {"run '" + kDemo + "' --motion ''", "--motion"},
      {"run - --motion -", "standard input is the scene already"},
      {"run '" + kDemo + "' --list l --results r.jsonl", "--list: stands beside a scene"},
      {"run '" + kDemo + "' --record-forces 5", "--record-forces requires --record"},
      {"run '" + kDemo + "' --on-record-error continue", "--on-record-error requires --record"},
      {"run '" + kDemo + "' --voxel-cache c", "--voxel-cache: needs --broadphase voxel"},
      {"run '" + kDemo + "' --unit mm", "built-in grasp"},
      {"run '" + kDemo + "' --motion-rate 60", "built-in grasp"},
      {"replay a.mcap --voxel-cache c", "--voxel-cache: needs --broadphase voxel"},
      {"replay a.mcap --mesh a=square.obj --mesh a=square.obj", "\"a\" is named twice"},
      {"inspect square.obj --unit m --voxel-cache c", "--voxel-cache: needs --broadphase voxel"},
      {"inspect square.obj --unit m --fix x.stl", "ends in .obj"},
      {"export a.mcap --columns ''", "--columns"},
      {"guard null", "\"null\" is no device"},
      {"replay a.mcap --world ''", "--world"},
      {"replay a.mcap --trace ''", "--trace"},
      {"replay --list ''", "--list"},
      {"trim a.mcap -o b.mcap --world ''", "--world"},
      {"merge-results r.jsonl --list ''", "--list"},
  };
  for (const auto& [arguments, named] : mistakes) {
    const Outcome outcome = shell("lumbrical " + arguments, folder);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.error.find(named), std::string::npos) << arguments << "\n" << outcome.error;
    EXPECT_TRUE(outcome.output.empty()) << arguments << "\n" << outcome.output;
  }
}

// 010 was read as octal, and 5.5 refused without a word on what there is.
TEST(CommandLine, WholeNumbersAreTakenHoweverTheyAreWrittenAndElseTheRangeIsNamed) {
  const fs::path folder = fresh_folder();
  const std::string run = "lumbrical run '" + kDemo + "' --json ";
  for (const char* const ten : {"10", "010", "1e1", "10.0"})
    EXPECT_EQ(shell(run + "--ticks " + ten, folder).json()["ticks"], 10) << ten;
  EXPECT_EQ(shell(run + "--ticks 1 --effort 1e9", folder).exit_code, 0);
  for (const char* const wrong : {"-1", "5.5", "ten", "''", "1e10", "nan", "0x10"}) {
    const Outcome outcome = shell(run + "--ticks 1 --effort " + wrong, folder);
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_NE(outcome.error.find("no whole number in 0 .. 1000000000"), std::string::npos) << outcome.error;
  }
}

TEST(CommandLine, BadFilesExitWith2AndAreNamed) {
  const fs::path folder = folder_with_square();
  std::ofstream(folder / "bad.obj") << "v 0 0 0\nf 1 2 3\n";
  std::ofstream(folder / "bad.json") << "{\n  \"objects\": 7\n}\n";
  std::ofstream(folder / "bad.mcap") << "not a recording";
  std::ofstream(folder / "empty");
  const std::pair<std::string, std::string> cases[] = {
      {"inspect bad.obj --unit m", "bad.obj:2:"},
      {"inspect gone.obj --unit m", "gone.obj"},
      {"inspect empty --unit m", "empty"},
      {"probe --mesh bad.obj --unit m --sphere 0,0,0,1", "bad.obj:2:"},
      {"run bad.json", "bad.json:2:"},
      {"run gone.json", "gone.json"},
      {"run empty", "empty"},
      {"replay bad.mcap", "bad.mcap"},
      {"replay gone.mcap", "gone.mcap"},
      {"info bad.mcap", "bad.mcap"},
      {"verify empty", "empty"},
      {"diff bad.mcap bad.mcap", "bad.mcap"},
  };
  for (const auto& [arguments, named] : cases) {
    const Outcome outcome = shell("lumbrical " + arguments, folder);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.error.find(named), std::string::npos) << arguments << "\n" << outcome.error;
  }
}

TEST(CommandLine, VersionNamesCommitAndArithmetic) {
  const std::string version = shell("lumbrical --version", fresh_folder()).output;
  EXPECT_EQ(version.find("lumbrical "), 0u) << version;
  EXPECT_NE(version.find(", commit "), std::string::npos) << version;
  EXPECT_NE(version.find(", arithmetic " + std::string(arithmetic_version())), std::string::npos) << version;
}

TEST(CommandLine, SuggestsTheNameThatWasMeant) {
  const fs::path folder = folder_with_square();
  const std::pair<std::string, std::string> cases[] = {
      {"rnu x.json", "did you mean run?"},
      {"verfy x.mcap", "did you mean verify?"},
      {"inspect square.obj --unit m --jsn", "did you mean --json?"},
      {"run '" + kDemo + "' --tick 5", "did you mean --ticks?"},
      {"run '" + kDemo + "' --record-force 5", "did you mean --record-forces?"},
      {"run '" + kDemo + "' --law max_depth", "did you mean max-depth?"},
      {"sim-device --profil x --tcp 0", "did you mean --profile?"},
      {"trim a.mcap --form-tick 5 -o b.mcap", "did you mean --from-tick?"},
  };
  for (const auto& [arguments, suggestion] : cases) {
    const Outcome outcome = shell("lumbrical " + arguments, folder);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.error.find(suggestion), std::string::npos) << arguments << "\n" << outcome.error;
    EXPECT_EQ(outcome.error.find("\\n"), std::string::npos)
        << "a line break that was escaped: " << outcome.error;
  }
  EXPECT_EQ(shell("lumbrical inspect square.obj --unit m --xyzzy", folder).error.find("did you mean"),
            std::string::npos);
}

TEST(CommandLine, AFailureIsAJsonObjectToo) {
  const fs::path folder = folder_with_demo();
  for (const char* const arguments :
       {"run gone.json --json", "run demo.json --tics 3 --json", "replay gone.mcap --json", "inspect --json",
        "info gone.mcap --json", "diff gone.mcap gone.mcap --json", "--json", "verify gone.mcap --json",
        "world gone.json -o x.world --json", "report gone --json",
        "probe --mesh gone.obj --unit m --sphere 0,0,0,1 --json"}) {
    const Outcome outcome = shell("lumbrical " + std::string(arguments), folder);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    ASSERT_FALSE(outcome.output.empty()) << arguments;
    EXPECT_FALSE(outcome.json()["error"].get<std::string>().empty()) << outcome.output;
  }
}

TEST(CommandLine, APipeThatIsClosedEndsQuietlyWith0) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --record a.mcap", folder).exit_code, 0);
  for (const char* const command :
       {"export a.mcap", "export a.mcap --format json", "info a.mcap", "run demo.json --ticks 5 --json",
        "replay a.mcap --trace - --trace-tick 5", "--help"}) {
    // The reader goes before the first word is written.
    const Outcome outcome =
        shell("{ sleep 0.1; lumbrical " + std::string(command) + "; echo $? >code; } | true", folder);
    EXPECT_EQ(read_file(folder / "code"), "0\n") << command;
    EXPECT_EQ(outcome.error, "") << command;
  }
}

TEST(CommandLine, ADashIsStandardInput) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "square.obj") << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
  const Outcome inspected = shell("cat square.obj | lumbrical inspect - --unit m --json", folder);
  ASSERT_EQ(inspected.exit_code, 0) << inspected.error;
  EXPECT_EQ(inspected.json()["triangles"], 2);
  EXPECT_EQ(shell("cat square.obj | lumbrical probe --mesh - --unit m --sphere 0,0,0,0.01", folder).exit_code,
            0);
  const Outcome run = shell("cat demo.json | lumbrical run - --ticks 5 --json", folder);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.json()["ticks"], 5);
  const Outcome bad = shell("echo '{\"objects\": 7}' | lumbrical run -", folder);
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_EQ(bad.error.find("standard input:1:"), 0u) << bad.error;
  std::ofstream(folder / "pose.json")
      << R"({"format": "lumbrical-angles", "side": "right", "samples": [{"time": 0, "wrist": {"position": [0,0,1],
         "orientation": [1,0,0,0]}, "angles": [0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0]}]})";
  EXPECT_EQ(shell("cat pose.json | lumbrical run demo.json --motion - --ticks 5", folder).exit_code, 0);
}

// ESC, the C1 set's own, BEL, DEL, a line end, in the names of a scene and of a recording's metadata.
TEST(CommandLine, TextFromFilesHasItsControlCharactersEscaped) {
  const fs::path folder = folder_with_demo();
  const std::string name = "m\\u001b[2Jug\\u009b31m\\u0007\\u007f\\nforged: line";
  std::ofstream(folder / "evil.json") << R"({"objects": [{"name": ")" + name + R"(", "mug": {"segments": 8}}],
"motion": {"grasp": {}}})";
  std::ofstream(folder / "wrong.json")
      << R"({"objects": [{"name": ")" + name + R"(", "mesh": "\u001b[2J.obj", "unit": "m"}],
"motion": {"grasp": {}}})";
  std::ofstream(folder / "bad.json") << "{\"obj\x1b[2Jects\": 1}";
  const auto expect_clean = [](const Outcome& outcome) {
    for (const std::string* const text : {&outcome.output, &outcome.error}) {
      EXPECT_EQ(text->find_first_of("\x1b\x07\x7f"), std::string::npos) << *text;
      EXPECT_EQ(text->find("\xc2\x9b"), std::string::npos) << *text;
      EXPECT_EQ(text->find("\nforged"), std::string::npos) << *text;
    }
  };
  ASSERT_EQ(shell("lumbrical run evil.json --ticks 20 --record a.mcap", folder).exit_code, 0);
  const Outcome info = shell("lumbrical info a.mcap", folder);
  expect_clean(info);
  EXPECT_NE(info.output.find("m\\x1b[2Jug\\x9b31m\\x07\\x7f\\nforged"), std::string::npos) << info.output;
  const Outcome json = shell("lumbrical info a.mcap --json", folder);
  expect_clean(json);
  EXPECT_EQ(json.json()["scene"]["objects"][0]["name"],
            "m\x1b[2Jug\xc2\x9b"
            "31m\x07\x7f\nforged: line");
  expect_clean(shell("lumbrical run wrong.json", folder));
  expect_clean(shell("lumbrical run bad.json", folder));
  expect_clean(shell("lumbrical replay a.mcap --mesh x=y", folder));
}

}  // namespace
}  // namespace lumbrical::test
