// lumbrical run: what it says, what it writes, and what ends it.
#include <fstream>
#include <string>

#include "lumbrical/model.h"
#include "motion/motion_samples.h"
#include "scenes.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

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

TEST(CommandLine, InspectTellsWhatBeginsInTheGround) {
  const fs::path folder = own_folder();
  write_file("scene.json",
             R"({"objects": [{"name": "block", "box": {"size": [0.1, 0.1, 0.2]}, "moves": "free",
      "mass": 0.2, "position": [0, 0, 0.05]}], "ground": {"height": 0},
      "motion": {"grasp": {"radius": 0.03, "height": 0.1}}})");
  EXPECT_NE(
      shell("lumbrical inspect scene.json", folder).output.find("block begins 50.0 mm below the ground"),
      std::string::npos);
  const nlohmann::json json = shell("lumbrical inspect scene.json --json", folder).json();
  EXPECT_NEAR(json["objects"][0]["below_ground"], 0.05, 1e-12);
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
  EXPECT_NE(wrong.error.find("motion can't be aligned: the scene has no object \"cup\""), std::string::npos)
      << wrong.error;
  EXPECT_NE(wrong.error.find("; it has ball"), std::string::npos) << wrong.error;
  EXPECT_EQ(shell("lumbrical run scene.json --align sideways", folder_with_a_miss("")).exit_code, 2);
}

TEST(CommandLine, AHandThatIsInsideAlreadyIsNotMovedToContactAndThatIsSaid) {
  const fs::path folder = folder_with_demo();
  const std::string told = shell("lumbrical run demo.json --align contact", folder).output;
  EXPECT_NE(told.find("not moved: the hand is inside an object already"), std::string::npos) << told;
  nlohmann::json scene = nlohmann::json::parse(read_file(folder / "demo.json"));
  scene["motion"]["align"] = "contact";
  std::ofstream(folder / "aligned.json") << scene.dump();
  EXPECT_NE(shell("lumbrical inspect aligned.json", folder).output.find("not moved: the hand is inside"),
            std::string::npos);
  EXPECT_EQ(shell("lumbrical inspect aligned.json --json", folder).json()["touching"], true);
  EXPECT_EQ(shell("lumbrical run aligned.json --json", folder).json()["touching"], true);
  EXPECT_FALSE(shell("lumbrical run demo.json --align mug:top --json", folder).json().contains("touching"));
}

TEST(CommandLine, AnAlignmentThatIsInForceIsNotAdvised) {
  const fs::path folder = folder_with_a_miss("");
  const auto trouble = [&folder](const std::string& switches) {
    return shell("lumbrical run scene.json --json " + switches, folder)
        .json()["trouble"][0]
        .get<std::string>();
  };
  EXPECT_EQ(trouble(""), "nothing was touched; --align contact moves the hand to the first object");
  const std::string cut = trouble("--align contact --ticks 1");
  EXPECT_EQ(cut.substr(0, 36), "nothing was touched in the first 1 o") << cut;
  EXPECT_NE(cut.find("run them all"), std::string::npos) << cut;
  EXPECT_EQ(trouble("--align 5,5,5"),
            "nothing was touched where the hand was moved to; --align x,y,z moves it elsewhere");
}

TEST(CommandLine, AFolderThatIsNotThereIsToldOfTheFileThatWasAskedFor) {
  const fs::path folder = folder_with_demo();
  ASSERT_EQ(shell("lumbrical run demo.json --ticks 20 --record a.mcap", folder).exit_code, 0);
  std::ofstream(folder / "ball.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const std::string command :
       {"run demo.json --ticks 2 --record none/a.mcap", "export a.mcap -o none/a.csv",
        "trim a.mcap --from-tick 3 -o none/a.mcap", "inspect ball.obj --unit m --fix none/a.obj"}) {
    const Outcome outcome = shell("lumbrical " + command, folder);
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_NE(outcome.error.find("its folder is not there; make it or check the path"), std::string::npos)
        << outcome.error;
    EXPECT_EQ(outcome.error.find(".part"), std::string::npos) << outcome.error;
  }
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
  EXPECT_EQ(json["precision"], "1e-4");
  EXPECT_LE(json["tick_us"]["p50"], json["tick_us"]["p99"]);
  EXPECT_LE(json["tick_us"]["p999"], json["tick_us"]["max"]);

  const Outcome replay = shell("lumbrical replay a.mcap --json", folder);
  EXPECT_EQ(replay.exit_code, 0) << replay.error;
  EXPECT_EQ(replay.json()["identical"], true);
  EXPECT_EQ(replay.json()["ticks"], 1000);
  EXPECT_TRUE(replay.json()["first_divergence"].is_null());
}

TEST(CommandLine, AWorldTellsTheWindingsOfObjectsOfOneNameToo) {
  const fs::path folder = folder_with_demo();
  nlohmann::json scene = nlohmann::json::parse(read_file(folder / "demo.json"));
  scene["objects"] = {scene["objects"][0], scene["objects"][0]};
  std::ofstream(folder / "twins.json") << scene.dump();
  const Outcome made = shell("lumbrical world twins.json --output twins.world --json", folder);
  ASSERT_EQ(made.exit_code, 0) << made.error;
  const nlohmann::json windings = made.json()["windings"];
  ASSERT_EQ(windings.size(), 2u);
  for (const nlohmann::json& object : windings) {
    EXPECT_EQ(object["name"], windings[0]["name"]);
    EXPECT_TRUE(object["winding"].contains("parts"));
  }
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
  const Outcome exact = shell("lumbrical run in_world.json --precision exact --json", folder);
  EXPECT_EQ(exact.json()["precision"], "exact");
  EXPECT_EQ(exact.json()["peak_force"], before.json()["peak_force"]);
  EXPECT_EQ(exact.json()["contacts"], before.json()["contacts"]);
  const Outcome run = shell("lumbrical run in_world.json --record w.mcap --json", folder);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.json()["precision"], "1e-4");
  EXPECT_EQ(run.json()["broadphase"], "grid");
  EXPECT_EQ(run.json()["triangles"], world.json()["triangles"]);
  EXPECT_EQ(run.json()["world"]["bytes"], fs::file_size(folder / "demo.world"));
  EXPECT_EQ(shell("lumbrical replay w.mcap", folder).exit_code, 0);
  fs::rename(folder / "demo.world", folder / "moved.world");
  const Outcome lost = shell("lumbrical replay w.mcap", folder);
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_NE(lost.error.find("--world FILE"), std::string::npos) << lost.error;
  EXPECT_EQ(shell("lumbrical replay w.mcap --world moved.world", folder).exit_code, 0);
  const std::string trim = "lumbrical trim w.mcap --from-tick 40 --json ";
  const Outcome part = shell(trim + "-o alone.mcap", folder);
  ASSERT_EQ(part.exit_code, 0) << part.error;
  EXPECT_FALSE(part.json()["replayable"]) << "the state before it needs the world";
  EXPECT_EQ(shell(trim + "-o part.mcap --world gone.world", folder).exit_code, 2);
  EXPECT_TRUE(shell(trim + "-o part.mcap --world moved.world", folder).json()["replayable"]);
  EXPECT_EQ(shell("lumbrical replay part.mcap --world moved.world", folder).exit_code, 0);
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
    const Outcome run =
        shell("rm -f w.mcap; lumbrical run in_world.json --rate 200 --record w.mcap & run=$!; " +
                  wait_for_ticks("w.mcap.part") + change + "; wait $run",
              folder);
    EXPECT_EQ(run.exit_code, 2) << change;
    EXPECT_NE(run.error.find("demo.world: was changed while it was read"), std::string::npos) << run.error;
    const Outcome verified = shell("lumbrical verify w.mcap", folder);
    EXPECT_EQ(verified.exit_code, 0) << "what was felt before is kept: " << verified.error;
  }
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

// Where a mug goes that a hand lifts differs from rung to rung, and more with every tick.
TEST(CommandLine, PrecisionsAreComparedOnObjectsThatStandWhereTheSessionHasThem) {
  const fs::path folder = fresh_folder();
  fs::copy_file(LUMBRICAL_SOURCE_DIR "/examples/mug.json", folder / "mug.json");
  const nlohmann::json lifted =
      shell("lumbrical run mug.json --compare-precision --ticks 8000 --json", folder).json();
  EXPECT_GT(lifted["ticks"], 500);
  for (const nlohmann::json& rung : lifted["rungs"])
    EXPECT_LE(rung["hand_error"]["p98"], 2 * rung["precision"].get<double>()) << lifted;

  std::ofstream(folder / "path.json")
      << R"({"objects": [{"sphere": {"radius": 0.037}, "moves": "given", "path":
    [{"time": 0, "position": [0, 0, -0.5]}, {"time": 1, "position": [0, 0, 0.045]}]}],
    "motion": {"grasp": {"seconds": 2}}})";
  const nlohmann::json given = shell("lumbrical run path.json --compare-precision --json", folder).json();
  EXPECT_GT(given["ticks"], 100) << "it comes to the hand";
}

// Fingers that overlap feel more together than once: no error of a precision's.
TEST(CommandLine, PrecisionsOfMixedLawsAreComparedWithWhatFeelsTheSame) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "thin.json") << R"({"objects": [{"mug": {"radius": 0.02}}],
    "motion": {"grasp": {"seconds": 2, "radius": 0.02}},
    "settings": {"segments": [{"segment": "palm", "law": "max-depth"}]}})";
  const nlohmann::json mixed = shell("lumbrical run thin.json --compare-precision --json", folder).json();
  EXPECT_GT(mixed["ticks"], 100);
  for (const nlohmann::json& rung : mixed["rungs"])
    EXPECT_LE(rung["hand_error"]["p98"], 2 * rung["precision"].get<double>()) << mixed;
  const std::string exactly =
      "lumbrical run thin.json --compare-precision --law max-depth --ticks 1000 --json";
  EXPECT_EQ(shell(exactly, folder).json()["advised"], 0) << "no precision changes anything";
  const Outcome told =
      shell("lumbrical run thin.json --compare-precision --law max-depth --ticks 1000", folder);
  EXPECT_NE(told.output.find("other laws than field are always exact"), std::string::npos) << told.output;
}

// No rung keeps 1e-4 within 5,000 evaluations: exact was advised, which knows no bound.
TEST(CommandLine, AdviceOfAPrecisionKeepsTheEffortAndTellsWhetherTheRateIsKept) {
  const fs::path folder = folder_with_demo();
  const std::string bounded =
      "lumbrical run demo.json --threads 1 --ticks 4000 --compare-precision --effort 5000";
  const nlohmann::json json = shell(bounded + " --json", folder).json();
  EXPECT_TRUE(json["cut_by_effort"]) << json;
  EXPECT_GT(json["advised"], 0);
  EXPECT_FALSE(json.contains("keeps_rate"));
  const std::string cut = shell(bounded, folder).output;
  EXPECT_NE(cut.find("\"effort\" 5,000 lets none keep the precision wanted"), std::string::npos) << cut;
  const std::string free = "lumbrical run demo.json --threads 1 --compare-precision --rate ";
  EXPECT_FALSE(shell(free + "100000 --json", folder).json()["keeps_rate"]);
  const std::string kept = shell(free + "50", folder).output;
  EXPECT_NE(kept.find("keeps 50 Hz"), std::string::npos) << kept;
  EXPECT_NE(kept.find("times are processor time"), std::string::npos) << kept;
}

TEST(CommandLine, StagesTellWhereTheTimeOfTicksGoes) {
  const fs::path folder = folder_with_demo();
  const nlohmann::json json = shell("lumbrical run demo.json --ticks 3000 --stages --json", folder).json();
  double shares = 0;
  for (const nlohmann::json& stage : json["stage_us"]) {
    expect_keys(stage, {"p50", "p99", "max", "share"});
    shares += stage["share"].get<double>();
  }
  EXPECT_EQ(json["stage_us"].size(), 6u) << json;
  EXPECT_NEAR(shares, 1, 1e-9);
  EXPECT_GT(json["stage_us"]["contacts"]["max"], json["stage_us"]["input"]["p50"]);
  EXPECT_LE(json["stage_us"]["contacts"]["max"], json["tick_us"]["max"]);
  EXPECT_TRUE(json["deadline_misses"].is_null()) << "without a rate there are no deadlines";
  const std::string text = shell("lumbrical run demo.json --ticks 100 --stages", folder).output;
  EXPECT_NE(text.find("hand pose  p50"), std::string::npos) << text;
  EXPECT_EQ(shell("lumbrical run demo.json --stages --compare-precision", folder).exit_code, 2);
}

// The thumb and the fingers that a grasp of something thin brings together.
TEST(CommandLine, ExactIsComparedAsTheSceneWouldFeelItToo) {
  const fs::path folder = fresh_folder();
  const auto compared = [&](const std::string& settings, const std::string& form) {
    std::ofstream(folder / "thin.json") << R"({"objects": [{"mug": {"radius": 0.02}}],
    "motion": {"grasp": {"seconds": 2, "radius": 0.02}}, "settings": {)"
                                        << settings << "}}";
    return shell("lumbrical run thin.json --compare-precision --ticks 2000" + form, folder);
  };
  const nlohmann::json usual = compared("", " --json").json();
  ASSERT_TRUE(usual.contains("exact_for_each")) << usual;
  EXPECT_GT(usual["exact_for_each"]["hand_error"]["max"], 1e-3);
  EXPECT_EQ(usual["rungs"][0]["hand_error"]["max"], 0);
  EXPECT_FALSE(compared(R"("felt_once": "always")", " --json").json().contains("exact_for_each"));
  const std::string text = compared(R"("precision": 0)", "").output;
  EXPECT_NE(text.find("--precision exact and \"felt_once\": \"always\" in the scene"), std::string::npos)
      << text;
}

TEST(CommandLine, AdviceOfAPrecisionForASceneThatMixesThemSaysThatItIsForAllSegments) {
  const fs::path folder = fresh_folder();
  const auto advice = [&](const std::string& settings) {
    std::ofstream(folder / "scene.json")
        << R"({"objects": [{"mug": {}}], "motion": {"grasp": {}}, "settings": )" << settings << "}";
    return shell("lumbrical run scene.json --compare-precision --ticks 2000", folder).output;
  };
  const std::string words = ", of all segments alike: the scene's own are mixed";
  const std::string mixed = advice(R"({"segments": [{"segment": "index distal", "precision": 0}]})");
  for (const std::string& part : {words, std::string("exact only as it is"), std::string("as it is  tick ")})
    EXPECT_NE(mixed.find(part), std::string::npos) << mixed;
  EXPECT_EQ(advice("{}").find(words), std::string::npos);
}

TEST(CommandLine, FullDiskIsAnError) {
  const fs::path folder = folder_with_demo();
  std::ofstream(folder / "square.obj") << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  EXPECT_EQ(shell("lumbrical inspect square.obj --unit m --json >/dev/full", folder).exit_code, 2);
  EXPECT_EQ(shell("lumbrical run demo.json --ticks 10 --json >/dev/full", folder).exit_code, 2);
  for (const std::string text : {"--help", "--version", "run --help"}) {
    const Outcome full = shell("lumbrical " + text + " >/dev/full", folder);
    EXPECT_EQ(full.exit_code, 2) << text;
    EXPECT_NE(full.error.find("standard output: can't write"), std::string::npos) << text << full.error;
  }
}

TEST(CommandLine, RunDoesNotTouchItsInputs) {
  const fs::path folder = folder_with_demo();
  const std::string scene = read_file((folder / "demo.json").string());
  const Outcome run = shell("lumbrical run demo.json --ticks 10 --record ./demo.json", folder);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(read_file((folder / "demo.json").string()), scene);
  EXPECT_EQ(shell("lumbrical run demo.json --ticks 10 --record no/such/folder.mcap", folder).exit_code, 2);
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

TEST(CommandLine, OfTwoRunsToOneFileTheSecondIsRefused) {
  const fs::path folder = folder_with_demo();
  const Outcome runs = shell("lumbrical run demo.json --rate 100 " + kManyTicks +
                                 "--record a.mcap --json & first=$!; " + wait_for_ticks("a.mcap.part") +
                                 "lumbrical run demo.json --ticks 5 --record a.mcap; echo $? >second; "
                                 "kill -TERM $first; wait $first",
                             folder);
  EXPECT_EQ(runs.exit_code, 130) << runs.error;
  EXPECT_EQ(read_file((folder / "second").string()), "2\n");
  EXPECT_NE(runs.error.find("is being written by another process"), std::string::npos) << runs.error;
  EXPECT_EQ(shell("lumbrical verify a.mcap --json", folder).json()["ticks"], runs.json()["ticks"]);
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

TEST(CommandLine, ASignalEndsAWorldWithoutAFile) {
  const fs::path folder = folder_with_demo();
  write_file("wide.json",
             R"({"objects": [{"plane": {"extent": 1, "cells": 1000}}], "motion": {"grasp": {}}})");
  const Outcome stopped = shell("lumbrical world wide.json -o wide.world & world=$!; " +
                                    wait_until("test -e wide.world.part") + "kill -TERM $world; wait $world",
                                folder);
  EXPECT_EQ(stopped.exit_code, 130) << stopped.error;
  EXPECT_NE(stopped.error.find("wide.world: stopped by a signal"), std::string::npos) << stopped.error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    EXPECT_FALSE(entry.path().filename().string().starts_with("wide.world")) << entry.path();
}

TEST(CommandLine, AFullDiskIsNotBlamedOnTheSceneWhoseWorldIsWritten) {
  const fs::path folder = folder_with_demo();
  const Outcome full = shell("( ulimit -f 1; lumbrical world demo.json -o demo.world )", folder);
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_TRUE(full.error.starts_with("demo.world.part")) << full.error;
  EXPECT_NE(full.error.find("cannot be written: File too large"), std::string::npos) << full.error;
}

TEST(CommandLine, ABoundOnEffortThatCannotBeHeldIsTold) {
  const fs::path folder = folder_with_demo();
  const char* const told = "was not held: ";
  const Outcome least = shell("lumbrical run demo.json --effort 1", folder);
  EXPECT_EQ(least.exit_code, 0) << least.error;
  EXPECT_NE(least.output.find(told), std::string::npos) << least.output;
  EXPECT_EQ(shell("lumbrical run demo.json --effort 100000000", folder).output.find(told), std::string::npos);
}

TEST(CommandLine, AFailedRecordingEndsTheSessionOrNotAsAsked) {
  const fs::path folder = folder_with_demo();
  // A file-size limit stands in for the full disk.
  const std::string run = "( ulimit -f 200; lumbrical run demo.json --ticks 3000 --record a.mcap --json";
  const Outcome stopped = shell(run + " )", folder);
  EXPECT_EQ(stopped.exit_code, 2);
  EXPECT_NE(stopped.error.find("a.mcap.part: cannot be written: File too large"), std::string::npos)
      << stopped.error;
  const std::string holds = "warning: a.mcap.part: holds ";
  const std::size_t kept = stopped.error.find(holds);
  ASSERT_NE(kept, std::string::npos) << stopped.error;
  EXPECT_NE(stopped.error.find("`lumbrical recover a.mcap.part -o"), std::string::npos) << stopped.error;
  shell("lumbrical recover a.mcap.part -o whole.mcap", folder);
  std::string ticks = stopped.error.substr(kept + holds.size(), 9);
  std::erase(ticks, ',');
  EXPECT_EQ(shell("lumbrical info whole.mcap --json", folder).json()["ticks"], std::stoul(ticks));
  fs::remove(folder / "a.mcap.part");
  const Outcome continued = shell(run + " --on-record-error continue )", folder);
  EXPECT_EQ(continued.exit_code, 2);
  EXPECT_NE(continued.error.find("cannot be written: File too large"), std::string::npos) << continued.error;
  EXPECT_EQ(continued.json()["ticks"], 3000);
  EXPECT_GT(continued.json()["not_recorded"], 0);
  EXPECT_LT(continued.json()["not_recorded"], 3000);
}

TEST(CommandLine, ASignalEndsARunWithAWholeRecording) {
  const fs::path folder = folder_with_demo();
  // The signal comes when the first ticks are in the file, and twice, as from a terminal that sends it to
  // the process and to its group. (A shell lets its background jobs ignore SIGINT, hence SIGTERM.)
  const Outcome run =
      shell("lumbrical run demo.json --rate 100 " + kManyTicks + "--record a.mcap --json & run=$!; " +
                wait_for_ticks("a.mcap.part") + "kill -TERM $run; sleep 0.002; kill -TERM $run; wait $run",
            folder);
  ASSERT_EQ(run.exit_code, 130) << run.error;
  EXPECT_EQ(run.json()["interrupted"], true);
  EXPECT_LT(run.json()["ticks"], 25000);
  const Outcome replay = shell("lumbrical replay a.mcap --json", folder);
  EXPECT_EQ(replay.exit_code, 0) << replay.error;
  EXPECT_EQ(replay.json()["ticks"], run.json()["ticks"]);
  EXPECT_EQ(shell("lumbrical verify a.mcap", folder).exit_code, 0);
}

}  // namespace
}  // namespace lumbrical::test
