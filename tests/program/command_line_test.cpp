// The command line as users' scripts rely on it: exit codes, JSON keys, and what happens to bad input and
// files.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/recording.h"
#include "motion/motion_samples.h"
#include "program.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

const std::string kDemo = LUMBRICAL_SOURCE_DIR "/examples/demo.json";

// A folder with the demo at 100 ticks per second in demo.json: the whole motion, in a tenth of the ticks.
fs::path folder_with_demo() {
  const fs::path folder = fresh_folder();
  nlohmann::json demo = nlohmann::json::parse(read_file(kDemo));
  demo["settings"]["rate"] = 100;
  std::ofstream(folder / "demo.json") << demo.dump(1);
  return folder;
}

// The square of side 2 m in z = 0, facing up, in two triangles.
fs::path folder_with_square() {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "square.obj") << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
  return folder;
}

void expect_keys(const nlohmann::json& json, const std::vector<std::string>& keys) {
  for (const std::string& key : keys)
    EXPECT_TRUE(json.contains(key)) << key << " is missing in " << json.dump();
}

TEST(CommandLine, HelpAndVersionSucceed) {
  const fs::path folder = fresh_folder();
  EXPECT_EQ(shell("lumbrical --version", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical --help", folder).exit_code, 0);
  for (const char* const command :
       {"run", "replay", "diff", "info", "verify", "recover", "export", "probe", "inspect", "report"}) {
    const Outcome outcome = shell("lumbrical " + std::string(command) + " --help", folder);
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_FALSE(outcome.output.empty());
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
      {"run '" + kDemo + "' --sink tcp://there", "--sink"},
      {"run '" + kDemo + "' --sideways", "--sideways"},
  };
  for (const auto& [arguments, named] : mistakes) {
    const Outcome outcome = shell("lumbrical " + arguments, folder);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.error.find(named), std::string::npos) << arguments << "\n" << outcome.error;
    EXPECT_TRUE(outcome.output.empty()) << arguments << "\n" << outcome.output;
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

// A cube of 0.1 m round the origin; its triangles face inwards if so wished.
std::string cube_text(bool inside_out) {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += "v " + std::to_string(0.1 * (i & 1) - 0.05) + " " + std::to_string(0.05 * (i & 2) - 0.05) + " " +
            std::to_string(0.025 * (i & 4) - 0.05) + "\n";
  for (const char* const face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
    std::string corners = face;
    if (inside_out) std::reverse(corners.begin(), corners.end());
    text += "f " + corners + "\n";
  }
  return text;
}

// But for rounding: polygons that begin at other corners fall into other triangles.
void expect_same_peaks(const nlohmann::json& a, const nlohmann::json& b) {
  for (const auto& [name, force] : a["peak_force"].items())
    EXPECT_NEAR(force.get<double>(), b["peak_force"][name].get<double>(), 1e-9) << name;
}

TEST(CommandLine, AMeshThatIsInsideOutIsFeltAsIfItWereRightAndTheRunSaysSo) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "right.obj") << cube_text(false);
  std::ofstream(folder / "wrong.obj") << cube_text(true);
  const auto run = [&](const std::string& mesh, const std::string& more) {
    std::ofstream(folder / "scene.json")
        << R"({"objects": [{"mesh": ")" << mesh << R"(", "unit": "m")" << more
        << R"(, "position": [0, 0, 0.05]}], "motion": {"grasp": {}}, "settings": {"rate": 100}})";
    const Outcome outcome = shell(
        "rm -f " + mesh + ".mcap; lumbrical run scene.json --ticks 600 --record " + mesh + ".mcap --json",
        folder);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return outcome.json();
  };
  const nlohmann::json right = run("right.obj", ""), turned = run("wrong.obj", "");
  EXPECT_GT(right["peak_force"]["index"], 0.1);
  expect_same_peaks(turned, right);
  EXPECT_EQ(right["objects"][0]["winding"]["turned_triangles"], 0);
  EXPECT_EQ(turned["objects"][0]["winding"]["turned_triangles"], 12);
  EXPECT_EQ(shell("lumbrical replay wrong.obj.mcap", folder).exit_code, 0);
  EXPECT_NE(shell("lumbrical run scene.json --ticks 1", folder)
                .output.find("wrong: 1 of 1 part turned outside out"),
            std::string::npos);
  const nlohmann::json as_is = run("wrong.obj", R"(, "winding": "as is")");
  EXPECT_EQ(as_is["objects"][0]["winding"]["turned_triangles"], 0);
  EXPECT_EQ(shell("lumbrical replay wrong.obj.mcap", folder).exit_code, 0);
  const nlohmann::json flipped = run("right.obj", R"(, "winding": "flip")");
  expect_same_peaks(flipped, as_is);
  const Outcome outcome = shell("lumbrical inspect wrong.obj --unit m --json", folder);
  EXPECT_EQ(outcome.json()["winding"]["turned_triangles"], 12);
}

TEST(CommandLine, AFixedMeshIsWhatASceneWouldTakeAndNothingElseIsChanged) {
  const fs::path folder = fresh_folder();
  // A tetrahedron inside out, in numbers that no power of two makes shorter; one corner twice, one triangle
  // flat.
  std::ofstream(folder / "wrong.obj") << "v 0.1 0 0\nv 3 0.3 0\nv 0 3 0.7\nv 0 0 3\nv 0 0 3\n"
                                         "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 5\nf 1 2 2\n";
  const Outcome outcome = shell("lumbrical inspect wrong.obj --unit cm --fix right.obj --json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json fixed = outcome.json()["fixed"];
  EXPECT_EQ(fixed["turned_triangles"], 4);
  EXPECT_EQ(fixed["merged_vertices"], 1);
  EXPECT_EQ(fixed["degenerate_triangles"], 1);
  EXPECT_EQ(read_file((folder / "right.obj").string()),
            "v 0.1 0 0\nv 3 0.3 0\nv 0 3 0.7\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const nlohmann::json again = shell("lumbrical inspect right.obj --unit cm --json", folder).json();
  EXPECT_EQ(again["watertight"], true);
  EXPECT_GT(again["volume"], 0);
  EXPECT_EQ(shell("lumbrical inspect wrong.obj --unit cm --fix right.obj", folder).exit_code, 2)
      << "not over it";
  EXPECT_NE(shell("lumbrical inspect scene.json --fix a.obj", folder).exit_code, 0);
}

TEST(CommandLine, AProbeFeelsTheFileAsItIsAndWarnsOfWhatASceneWouldTurn) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "wrong.obj") << cube_text(true);
  const Outcome outcome =
      shell("lumbrical probe --mesh wrong.obj --unit m --sphere 0,0,0.055,0.01 --json", folder);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_LT(outcome.json()["total"]["force"][2], 0);
  EXPECT_NE(outcome.error.find("12 of its triangles turned outside out"), std::string::npos);
}

TEST(CommandLine, AnOpenMeshIsToldWithTheShareThatFacesOutwards) {
  const fs::path folder = fresh_folder();
  std::string open = cube_text(true);
  std::ofstream(folder / "open.obj") << open.substr(0, open.rfind("f "));
  std::ofstream(folder / "scene.json")
      << R"({"objects": [{"mesh": "open.obj", "unit": "m"}], "motion": {"grasp": {}}})";
  const Outcome outcome = shell("lumbrical run scene.json --ticks 10", folder);
  EXPECT_NE(outcome.output.find(
                "open: 1 part not closed, left as wound: 0 % of its area faces away from its middle, "
                "100 % towards it"),
            std::string::npos)
      << outcome.output;
}

// A ball that the demo's hand misses by about a metre; `more` stands in the motion.
fs::path folder_with_a_miss(const std::string& more) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "scene.json")
      << R"({"objects": [{"name": "ball", "sphere": {}, "position": [1, 0.5, 0.2]}], "motion": {"grasp": {})"
      << more << R"(}, "settings": {"rate": 100}})";
  return folder;
}

TEST(CommandLine, ARunThatTouchesNothingSaysSoFirstAndHowNearTheHandCame) {
  const fs::path folder = folder_with_a_miss("");
  const Outcome text = shell("lumbrical run scene.json", folder);
  EXPECT_EQ(text.output.find("trouble"), 0u) << text.output;
  EXPECT_NE(text.output.substr(0, text.output.find('\n')).find("nothing was touched"), std::string::npos);
  EXPECT_NE(text.output.find("ball: nearest "), std::string::npos) << text.output;
  const nlohmann::json run = shell("lumbrical run scene.json --json", folder).json();
  const nlohmann::json inspected = shell("lumbrical inspect scene.json --json", folder).json();
  const nlohmann::json& ball = run["clearance"]["objects"][0];
  EXPECT_EQ(ball["name"], "ball");
  EXPECT_GT(ball["distance"], 0.5);
  EXPECT_LT(ball["distance"], 1.5);
  EXPECT_NEAR(ball["box"]["upper"][0], 1.04, 1e-3);
  EXPECT_EQ(inspected["objects"][0]["distance"], ball["distance"]);
  EXPECT_EQ(inspected["hand"], run["clearance"]["hand"]);
  EXPECT_NE(shell("lumbrical inspect scene.json", folder).output.find("ball: nearest "), std::string::npos);
}

TEST(CommandLine, ARunThatTouchesHasNoTroubleAndItsStartIsNoLossOfTracking) {
  const Outcome outcome = shell("lumbrical run demo.json --json", folder_with_demo());
  const nlohmann::json run = outcome.json();
  EXPECT_EQ(run["trouble"], nlohmann::json::array());
  EXPECT_FALSE(run.contains("clearance"));
  EXPECT_FALSE(run["flags"].contains("fading")) << run["flags"];
  EXPECT_GT(run["starting_ticks"], 0);
  EXPECT_LE(run["peak_segment"]["force"], run["max_force"]);
  EXPECT_GT(run["peak_segment"]["force"], 0);
  const std::string text = shell("lumbrical run demo.json", folder_with_demo()).output;
  EXPECT_EQ(text.find("loss of tracking"), std::string::npos) << text;
  EXPECT_NE(text.find("as at every start"), std::string::npos) << text;
  EXPECT_NE(text.find("at most max_force 20"), std::string::npos) << text;
}

TEST(CommandLine, AlignMovesTheMotionToTheObjectAndTellsWhereTo) {
  for (const char* const way : {"contact", "ball:centre", "1,0.5,0.2"}) {
    const nlohmann::json run =
        shell(std::string("lumbrical run scene.json --json --align ") + way, folder_with_a_miss("")).json();
    EXPECT_GT(run["contacts"]["max"], 0) << way;
    const nlohmann::json in_scene = shell("lumbrical run scene.json --json",
                                          folder_with_a_miss(std::string(R"(, "align": ")") + way + "\""))
                                        .json();
    EXPECT_EQ(in_scene["aligned"], run["aligned"]) << way;
    std::string written = run["aligned"].dump();
    written = ", " + written.substr(1, written.size() - 2);
    const nlohmann::json again = shell("lumbrical run scene.json --json", folder_with_a_miss(written)).json();
    EXPECT_EQ(again["peak_force"], run["peak_force"]) << way;
    EXPECT_FALSE(again.contains("aligned"));
  }
  const Outcome wrong = shell("lumbrical run scene.json --align cup:top", folder_with_a_miss(""));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.error.find("no object \"cup\""), std::string::npos) << wrong.error;
  EXPECT_EQ(shell("lumbrical run scene.json --align sideways", folder_with_a_miss("")).exit_code, 2);
}

TEST(CommandLine, AHandThatIsLeftOutOfACaptureIsSaidAndCanBeChosen) {
  const fs::path folder = folder_with_a_miss("");
  const Poses right = bent_hand(Side::right, 0.2), left = bent_hand(Side::left, 0.6);
  const std::string hands = leap_hand(3, Side::right) + "," + leap_hand(4, Side::left);
  const std::string fingers = leap_fingers(right, 3) + "," + leap_fingers(left, 4);
  std::ofstream(folder / "two.json") << leap_file(
      {leap_frame(0, hands, fingers), leap_frame(9e5, hands, fingers)});
  std::ofstream(folder / "scene.json") << R"({"objects": [{"sphere": {}}], "motion": {"file": "two.json"}})";
  for (const auto& [taken, other] : {std::pair("right", "left"), std::pair("left", "right")}) {
    const std::string command = std::string("lumbrical run scene.json --ticks 5 --side ") + taken;
    const nlohmann::json hand = shell(command + " --json", folder).json()["hand"];
    EXPECT_EQ(hand["side"], taken);
    EXPECT_EQ(hand["other_side"], other);
    EXPECT_EQ(hand["other_frames"], 2);
    EXPECT_NE(shell(command, folder).output.find(std::string("2 frames show another one, a ") + other),
              std::string::npos);
  }
  EXPECT_NE(shell("lumbrical inspect scene.json", folder).output.find("--side left takes that"),
            std::string::npos);
}

TEST(CommandLine, AWrongUnitIsSuspectedByItsSize) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "mug.obj")
      << "v 0 0 0\nv 95 0 0\nv 0 80 0\nv 0 0 80\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  for (const auto& [unit, hint] : {std::pair("m", "mm read as m"), std::pair("mm", "")}) {
    std::ofstream(folder / "scene.json") << R"({"objects": [{"mesh": "mug.obj", "unit": ")" << unit
                                         << R"(", "position": [1, 0, 0]}], "motion": {"grasp": {}}})";
    const nlohmann::json scene = shell("lumbrical inspect scene.json --json", folder).json();
    EXPECT_EQ(scene["objects"][0]["likely_unit"], hint) << scene;
  }
}

TEST(CommandLine, InspectReportsASquare) {
  const Outcome outcome = shell("lumbrical inspect square.obj --unit cm --json", folder_with_square());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json json = outcome.json();
  EXPECT_EQ(json["triangles"], 2);
  EXPECT_EQ(json["vertices"], 4);
  EXPECT_EQ(json["degenerate"], 0);
  EXPECT_EQ(json["duplicate"], 0);
  EXPECT_EQ(json["boundary_edges"], 4);
  EXPECT_EQ(json["non_manifold_edges"], 0);
  EXPECT_EQ(json["watertight"], false);
  ASSERT_EQ(json["extent"].size(), 3u);
  EXPECT_NEAR(json["extent"][0].get<double>(), 0.02, 1e-15);
}

TEST(CommandLine, ProbeFeelsTheDiscASphereCutsFromAPlane) {
  const Outcome outcome =
      shell("lumbrical probe --mesh square.obj --unit m --sphere 0.5,-0.25,0.006,0.008 --json",
            folder_with_square());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json json = outcome.json();
  expect_keys(json, {"contacts", "total"});
  ASSERT_EQ(json["contacts"].size(), 1u);
  const nlohmann::json& contact = json["contacts"][0];
  expect_keys(contact, {"triangle", "primitive", "depth", "area", "centroid", "volume", "force"});
  const double area = 4 * std::atan(1.0) * (0.008 * 0.008 - 0.006 * 0.006);
  EXPECT_EQ(contact["triangle"], 0);
  EXPECT_NEAR(contact["area"].get<double>(), area, 1e-9 * area);
  EXPECT_NEAR(contact["depth"].get<double>(), 0.002, 1e-12);
  EXPECT_NEAR(contact["centroid"][0].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(contact["centroid"][1].get<double>(), -0.25, 1e-12);
  EXPECT_GT(contact["force"][2].get<double>(), 0);
  EXPECT_EQ(json["total"]["area"], contact["area"]);
  EXPECT_EQ(json["total"]["force"], contact["force"]);
  EXPECT_EQ(json["total"]["volume"], contact["volume"]);
}

TEST(CommandLine, ProbeNumbersPrimitivesInTheOrderGiven) {
  const Outcome outcome = shell(
      "lumbrical probe --mesh square.obj --unit m --capsule 0.5,-0.2,0.006,0.53,-0.2,0.006,0.008 "
      "--sphere -0.5,0.2,0.007,0.008 --cylinder 0.5,-0.5,-0.01,0.5,-0.5,0.02,0.003 --sphere "
      "-0.5,0.5,0.006,0.008 --json",
      folder_with_square());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json json = outcome.json();
  ASSERT_EQ(json["contacts"].size(), 4u);
  const double disc = 4 * std::atan(1.0);
  const double areas[] = {28e-6 * disc + 2 * std::sqrt(28e-6) * 0.03, 15e-6 * disc, 9e-6 * disc,
                          28e-6 * disc};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(json["contacts"][i]["primitive"], i);
    EXPECT_NEAR(json["contacts"][i]["area"].get<double>(), areas[i], 1e-9 * areas[i]) << i;
  }
}

TEST(CommandLine, RunPrintsTheContractsKeysAndReplayFindsTheRecordingIdentical) {
  const fs::path folder = folder_with_demo();
  const Outcome run = shell("lumbrical run demo.json --record a.mcap --json", folder);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const nlohmann::json json = run.json();
  expect_keys(json, {"ticks", "rate_hz", "tick_us", "contacts", "deadline_misses", "isa", "threads",
                     "broadphase", "law", "recording"});
  expect_keys(json["tick_us"], {"p50", "p99", "p999", "max"});
  expect_keys(json["contacts"], {"mean", "max"});
  EXPECT_EQ(json["ticks"], 1000);
  EXPECT_GT(json["contacts"]["max"], 10);
  EXPECT_GT(json["peak_force"]["index"], 0.01);
  EXPECT_GT(json["peak_force"]["thumb"], 0.01);
  EXPECT_EQ(json["recording"], "a.mcap");
  EXPECT_LE(json["tick_us"]["p50"], json["tick_us"]["p99"]);
  EXPECT_LE(json["tick_us"]["p999"], json["tick_us"]["max"]);

  const Outcome replay = shell("lumbrical replay a.mcap --json", folder);
  EXPECT_EQ(replay.exit_code, 0) << replay.error;
  EXPECT_EQ(replay.json()["identical"], true);
  EXPECT_EQ(replay.json()["ticks"], 1000);
  EXPECT_TRUE(replay.json()["first_divergence"].is_null());
}

TEST(CommandLine, AWorldFileTakesTheObjectsPlace) {
  const fs::path folder = folder_with_demo();
  nlohmann::json scene = nlohmann::json::parse(read_file(folder / "demo.json"));
  scene.erase("objects");
  scene["world"] = "demo.world";
  write_file("in_world.json", scene.dump());
  fs::rename(own_folder() / "in_world.json", folder / "in_world.json");
  const Outcome world = shell("lumbrical world demo.json --output demo.world --json", folder);
  ASSERT_EQ(world.exit_code, 0) << world.error;
  const Outcome before = shell("lumbrical run demo.json --precision exact --json", folder);
  const Outcome run = shell("lumbrical run in_world.json --precision exact --record w.mcap --json", folder);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.json()["broadphase"], "grid");
  EXPECT_EQ(run.json()["triangles"], world.json()["triangles"]);
  EXPECT_EQ(run.json()["peak_force"], before.json()["peak_force"]);
  EXPECT_EQ(run.json()["contacts"], before.json()["contacts"]);
  EXPECT_EQ(run.json()["world"]["bytes"], fs::file_size(folder / "demo.world"));
  EXPECT_EQ(shell("lumbrical replay w.mcap", folder).exit_code, 0);
  fs::rename(folder / "demo.world", folder / "moved.world");
  const Outcome lost = shell("lumbrical replay w.mcap", folder);
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_NE(lost.error.find("--world FILE"), std::string::npos) << lost.error;
  EXPECT_EQ(shell("lumbrical replay w.mcap --world moved.world", folder).exit_code, 0);
  fs::rename(folder / "moved.world", folder / "demo.world");
  const Outcome tree = shell("lumbrical run in_world.json --broadphase tree", folder);
  EXPECT_EQ(tree.exit_code, 2);
  EXPECT_NE(tree.error.find("use auto or grid"), std::string::npos) << tree.error;
  EXPECT_EQ(shell("lumbrical run in_world.json --record demo.world", folder).exit_code, 2);
  EXPECT_EQ(shell("lumbrical world in_world.json --output other.world", folder).exit_code, 2);
  EXPECT_FALSE(fs::exists(folder / "other.world"));
}

TEST(CommandLine, AWorldFileThatChangesWhileItIsReadIsAnErrorAndNoSignal) {
  const fs::path folder = folder_with_demo();
  nlohmann::json scene = nlohmann::json::parse(read_file(folder / "demo.json"));
  scene.erase("objects");
  scene["world"] = "demo.world";
  scene["motion"] = {{"grasp", {{"seconds", 60}}}};
  write_file("in_world.json", scene.dump());
  fs::rename(own_folder() / "in_world.json", folder / "in_world.json");
  for (const std::string change : {"truncate -s 8192 demo.world", "truncate -s 0 demo.world",
                                   "printf x | dd of=demo.world bs=1 seek=100 conv=notrunc 2>dd.err"}) {
    fs::remove(folder / "demo.world");
    const Outcome made = shell("lumbrical world demo.json --output demo.world", folder);
    ASSERT_EQ(made.exit_code, 0) << made.error;
    const Outcome run = shell(
        "rm -f w.mcap; lumbrical run in_world.json --rate 200 --record w.mcap & run=$!; "
        "for i in $(seq 600); do [ -s w.mcap ] || [ -s w.mcap.part ] && break; sleep 0.05; done; sleep "
        "0.3; " +
            change + "; wait $run",
        folder);
    EXPECT_EQ(run.exit_code, 2) << change;
    EXPECT_NE(run.error.find("demo.world: was changed while it was read"), std::string::npos) << run.error;
    const Outcome verified = shell("lumbrical verify w.mcap", folder);
    EXPECT_EQ(verified.exit_code, 0) << "what was felt before is kept: " << verified.error;
  }
}

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
  EXPECT_NE(text.output.find(" N, "), std::string::npos) << text.output;
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
  // An archive is a ZIP file of arrays whose headers Python can evaluate.
  if (shell("python3 --version", folder).exit_code != 0) GTEST_SKIP() << "no python3";
  std::ofstream(folder / "read.py") << R"(
import ast, struct, sys, zipfile
archive = zipfile.ZipFile('a.npz')
assert archive.testzip() is None
def array(name):
    data = archive.read(name + '.npy')
    assert data[:8] == b'\x93NUMPY\x01\x00'
    size = struct.unpack('<H', data[8:10])[0]
    assert (10 + size) % 64 == 0
    header, body = ast.literal_eval(data[10:10 + size].decode()), data[10 + size:]
    count, kind = header['shape'][0], header['descr']
    if kind[1] == 'S':
        width = int(kind[2:])
        return [body[i * width:(i + 1) * width].rstrip(b'\0').decode() for i in range(count)]
    return struct.unpack('<%d%s' % (count, 'd' if kind == '<f8' else 'Q'), body)
columns, units = array('columns'), array('units')
assert len(columns) == len(units) == len(archive.namelist()) - 2
rows = [line.rstrip('\n').split(',') for line in open('a.csv')]
for i, (name, unit) in enumerate(zip(columns, units)):
    assert rows[0][i] == name + (' [%s]' % unit if unit else ''), rows[0][i]
    values = array(name)
    assert len(values) == len(rows) - 1
    for row, value in zip(rows[1:], values):
        assert abs(float(row[i]) - value) <= 1e-5 * abs(value), (name, row[i], value)
)";
  const Outcome read = shell("python3 read.py", folder);
  EXPECT_EQ(read.exit_code, 0) << read.error;
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
  };
  for (const auto& [arguments, suggestion] : cases) {
    const Outcome outcome = shell("lumbrical " + arguments, folder);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.error.find(suggestion), std::string::npos) << arguments << "\n" << outcome.error;
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
        "replay a.mcap --trace - --trace-tick 5"}) {
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

TEST(CommandLine, NeitherThreadsNorBroadphaseChangeARecording) {
  const fs::path folder = folder_with_demo();
  const std::string run = "lumbrical run demo.json --ticks 300 ";
  ASSERT_EQ(shell(run + "--record a.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell(run + "--threads 2 --record b.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell(run + "--broadphase brute --record c.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell(run + "--broadphase grid --record d.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical diff a.mcap b.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical diff a.mcap c.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical diff a.mcap d.mcap", folder).exit_code, 0);
  if (!available(Broadphase::voxel))
    GTEST_SKIP() << "this build has no OpenVDB; install libopenvdb-dev and build again";
  ASSERT_EQ(shell(run + "--broadphase voxel --record e.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical diff a.mcap e.mcap", folder).exit_code, 0);
}

TEST(CommandLine, VoxelIndexIsReportedAndKeptInItsFolder) {
  if (!available(Broadphase::voxel))
    GTEST_SKIP() << "this build has no OpenVDB; install libopenvdb-dev and build again";
  const fs::path folder = folder_with_demo();
  const std::string run = "lumbrical run demo.json --ticks 20 --broadphase voxel --voxel-cache kept --json";
  const nlohmann::json first = shell(run, folder).json(), second = shell(run, folder).json();
  expect_keys(first["voxel_index"], {"voxel_size", "voxels", "entries", "bytes", "build_seconds", "note"});
  EXPECT_EQ(first["voxel_index"]["from_cache"], false);
  EXPECT_EQ(second["voxel_index"]["from_cache"], true);
  std::ofstream(folder / "square.obj") << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
  const Outcome inspected = shell("lumbrical inspect square.obj --unit m --broadphase voxel --json", folder);
  ASSERT_EQ(inspected.exit_code, 0) << inspected.error;
  EXPECT_EQ(inspected.json()["voxel_index"]["has_distance"], false);
}

TEST(CommandLine, PacedRunKeepsItsRate) {
  const Outcome run = shell("lumbrical run demo.json --rate 500 --ticks 250 --json", folder_with_demo());
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_GT(run.json()["rate_hz"], 300);
  EXPECT_LT(run.json()["rate_hz"], 510);
}

TEST(CommandLine, LateTicksSayWhatTookTheTimeAndWhatWouldHelp) {
  const fs::path folder = folder_with_demo();
  // A mesh of 170,000 triangles cannot be felt exactly 5000 times a second.
  std::ofstream(folder / "large.json")
      << R"({"objects": [{"sphere": {"radius": 0.037, "cells": 120}, "position": [0, 0, 0.045]}],
    "motion": {"grasp": {"seconds": 0.5}}, "settings": {"precision": 0, "seconds": 0.5}})";
  const Outcome run = shell("lumbrical run large.json --rate 5000 --ticks 600 --json", folder);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const nlohmann::json json = run.json(), late = json["late"];
  EXPECT_GT(json["deadline_misses"], 0);
  EXPECT_GT(late["slow"], 0);
  EXPECT_GT(late["tick_us"], 100);
  EXPECT_GT(late["stage_share"]["search"].get<double>() + late["stage_share"]["contacts"].get<double>(), 0.5);
  bool precision = false;
  for (const nlohmann::json& remedy : late["remedies"]) {
    precision |= remedy["change"] == "--precision 0.0001";
    EXPECT_LT(remedy["tick_us"], late["tick_us"]);
  }
  EXPECT_TRUE(precision) << late;
  const Outcome text = shell("lumbrical run large.json --rate 5000 --ticks 600", folder);
  EXPECT_NE(text.output.find("since the tick took long"), std::string::npos) << text.output;
  EXPECT_NE(text.output.find("--precision 0.0001: "), std::string::npos) << text.output;
  EXPECT_EQ(shell("lumbrical run demo.json --ticks 20", folder).output.find("deadline"), std::string::npos);
}

TEST(CommandLine, FullDiskIsAnError) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "square.obj") << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  EXPECT_EQ(shell("lumbrical inspect square.obj --unit m --json >/dev/full", folder).exit_code, 2);
  EXPECT_EQ(shell("lumbrical run demo.json --ticks 10 --json >/dev/full", folder).exit_code, 2);
}

TEST(CommandLine, RunDoesNotTouchItsInputs) {
  const fs::path folder = folder_with_demo();
  const std::string scene = read_file((folder / "demo.json").string());
  const Outcome run = shell("lumbrical run demo.json --ticks 10 --record ./demo.json", folder);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(read_file((folder / "demo.json").string()), scene);
  EXPECT_EQ(shell("lumbrical run demo.json --ticks 10 --record no/such/folder.mcap", folder).exit_code, 2);
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

TEST(CommandLine, AnEmptyNameIsNoNameOfARecording) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 10 --record a.mcap", folder).exit_code, 0);
  for (const char* const command :
       {"lumbrical run demo.json --ticks 5 --record ''", "lumbrical run demo.json --ticks 5 --record=''",
        "lumbrical run demo.json --ticks 5 --record=", "lumbrical recover a.mcap -o ''",
        "lumbrical compress a.mcap -o ''", "lumbrical export a.mcap --output ''"}) {
    const Outcome refused = shell(command, folder);
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_NE(refused.error, "") << command;
  }
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

  std::string bytes = read_file((folder / "a.mcap").string());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);  // in a chunk
  std::ofstream(folder / "flipped.mcap", std::ios::binary) << bytes;
  const Outcome recover = shell("lumbrical recover flipped.mcap -o whole.mcap --json", folder);
  EXPECT_EQ(recover.exit_code, 5) << recover.error;
  EXPECT_EQ(recover.json()["recovered"].get<int>() + recover.json()["lost"].get<int>(), 600);
  ASSERT_EQ(recover.json()["missing"].size(), 1u);
  const auto range = recover.json()["missing"][0];
  EXPECT_EQ(range[1].get<int>() - range[0].get<int>() + 1, recover.json()["lost"]);
  EXPECT_EQ(range[0].get<int>() % 20, 0) << "one chunk: a fifth of a second";
  EXPECT_EQ(recover.json()["lost"], 20);
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

TEST(CommandLine, OfTwoRunsToOneFileTheSecondIsRefused) {
  const fs::path folder = folder_with_demo();
  const Outcome runs = shell(
      "lumbrical run demo.json --rate 100 --ticks 60 --record a.mcap & "
      "until [ -e a.mcap.part ]; do sleep 0.01; done; "
      "lumbrical run demo.json --ticks 5 --record a.mcap; echo $? >second; wait $!",
      folder);
  EXPECT_EQ(runs.exit_code, 0) << runs.error;
  EXPECT_EQ(read_file((folder / "second").string()), "2\n");
  EXPECT_NE(runs.error.find("is being written by another process"), std::string::npos) << runs.error;
  EXPECT_EQ(shell("lumbrical verify a.mcap --json", folder).json()["ticks"], 60);
}

// A file system of its own, half full of the recording: the real thing, where the system lets us have one.
TEST(CommandLine, ARecordingOnAFullFileSystemStaysReadable) {
  const fs::path folder = folder_with_demo();
  if (shell("unshare -Urm true", folder).exit_code != 0)
    GTEST_SKIP() << "no permission to mount a file system of our own";
  const Outcome run = shell(
      "unshare -Urm sh -c 'mkdir small && mount -t tmpfs -o size=1m none small && "
      "( lumbrical run demo.json --ticks 4000 --record small/a.mcap --on-record-error continue "
      "--json; echo $? >exit_code; df --output=avail small | tail -n 1 >left; "
      "lumbrical recover small/a.mcap -o whole.mcap )'",
      folder);
  EXPECT_EQ(read_file((folder / "exit_code").string()), "2\n") << run.error;
  EXPECT_NE(run.error.find("small/a.mcap.part: cannot be written: No space left on device"),
            std::string::npos)
      << run.error;
  EXPECT_LT(std::stoul(read_file((folder / "left").string())), 400u) << "it was not full";  // [KiB]
  EXPECT_EQ(shell("lumbrical verify whole.mcap", folder).exit_code, 0);
  const Outcome replay = shell("lumbrical replay whole.mcap --json", folder);
  EXPECT_EQ(replay.exit_code, 0) << replay.error;
  EXPECT_GT(replay.json()["ticks"], 250);
  EXPECT_LT(replay.json()["ticks"], 4000);
}

TEST(CommandLine, ForcesAreLeftOutAsAsked) {
  const fs::path folder = folder_with_demo();
  for (const char* const forces : {"all", "10", "none"}) {
    const std::string name = std::string(forces) + ".mcap";
    ASSERT_EQ(
        shell("lumbrical run demo.json --ticks 700 --record " + name + " --record-forces " + forces, folder)
            .exit_code,
        0);
    EXPECT_EQ(shell("lumbrical replay " + name, folder).exit_code, 0);
    EXPECT_EQ(shell("lumbrical diff all.mcap " + name, folder).exit_code, 0);
  }
  EXPECT_LT(fs::file_size(folder / "none.mcap"), fs::file_size(folder / "10.mcap"));
  const auto about = shell("lumbrical info none.mcap --json", folder).json();
  EXPECT_EQ(about["version"], 1);
  EXPECT_EQ(about["metadata"]["force_interval"], "0");
  for (const char* const wrong : {"0", "1.5", "some", "-1", "''"})
    EXPECT_EQ(shell(std::string("lumbrical run demo.json --record x.mcap --record-forces ") + wrong, folder)
                  .exit_code,
              2)
        << wrong;
}

TEST(CommandLine, AFailedRecordingEndsTheSessionOrNotAsAsked) {
  const fs::path folder = folder_with_demo();
  // A file-size limit stands in for the full disk.
  const std::string run = "( ulimit -f 200; lumbrical run demo.json --ticks 3000 --record a.mcap --json";
  const Outcome stopped = shell(run + " )", folder);
  EXPECT_EQ(stopped.exit_code, 2);
  EXPECT_NE(stopped.error.find("a.mcap.part: cannot be written: File too large"), std::string::npos)
      << stopped.error;
  fs::remove(folder / "a.mcap.part");
  const Outcome continued = shell(run + " --on-record-error continue )", folder);
  EXPECT_EQ(continued.exit_code, 2);
  EXPECT_NE(continued.error.find("cannot be written: File too large"), std::string::npos) << continued.error;
  EXPECT_EQ(continued.json()["ticks"], 3000);
  EXPECT_GT(continued.json()["not_recorded"], 0);
  EXPECT_LT(continued.json()["not_recorded"], 3000);
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
  ASSERT_EQ(shell("lumbrical compress a.mcap -o z.mcap", folder).exit_code, 0);
  ASSERT_EQ(shell("lumbrical compress z.mcap --with lz4 -o b.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("cmp a.mcap b.mcap", folder).exit_code, 0);
  EXPECT_EQ(shell("lumbrical trim a.mcap --from 20 -o none.mcap", folder).exit_code, 2);
  EXPECT_FALSE(fs::exists(folder / "none.mcap"));
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
}

TEST(CommandLine, ASignalEndsARunWithAWholeRecording) {
  const fs::path folder = folder_with_demo();
  // The signal comes when the first ticks are in the file, and twice, as from a terminal that sends it to
  // the process and to its group. (A shell lets its background jobs ignore SIGINT, hence SIGTERM.)
  const Outcome run = shell(
      "lumbrical run demo.json --rate 100 --record a.mcap --json & "
      "until [ -s a.mcap.part ]; do sleep 0.05; done; sleep 0.5; kill -TERM $!; sleep 0.002; kill -TERM $!; "
      "wait "
      "$!",
      folder);
  ASSERT_EQ(run.exit_code, 130) << run.error;
  EXPECT_EQ(run.json()["interrupted"], true);
  EXPECT_LT(run.json()["ticks"], 1000);
  const Outcome replay = shell("lumbrical replay a.mcap --json", folder);
  EXPECT_EQ(replay.exit_code, 0) << replay.error;
  EXPECT_EQ(replay.json()["ticks"], run.json()["ticks"]);
  EXPECT_EQ(shell("lumbrical verify a.mcap", folder).exit_code, 0);
}

}  // namespace
}  // namespace lumbrical::test
