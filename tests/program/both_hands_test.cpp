// Both hands of a capture through the whole program: felt, recorded, replayed, compared, cut, told.
#include <fstream>
#include <string>

#include "motion/motion_samples.h"
#include "program.h"
#include "read_archive.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

const std::string kScene = std::string(LUMBRICAL_SOURCE_DIR) + "/examples/two_hands.json";

Outcome lumbrical(const std::string& arguments, const fs::path& folder) {
  return shell("lumbrical " + arguments, folder);
}

// The shipped capture at 100 Hz, felt with both hands.
fs::path folder_with_both() {
  const fs::path folder = fresh_folder();
  fs::copy_file(kScene, folder / "scene.json");
  for (const char* const name : {"cup.obj", "hold.json"})
    fs::copy_file(fs::path(kScene).parent_path() / name, folder / name);
  return folder;
}

TEST(BothHands, AreFeltInOneSessionAndReplayedBitForBit) {
  const fs::path folder = folder_with_both();
  const nlohmann::json run = lumbrical("run scene.json --record a.mcap --json", folder).json();
  ASSERT_EQ(run["hands"].size(), 2u);
  EXPECT_EQ(run["hands"][0]["side"], "right");
  EXPECT_EQ(run["hands"][1]["side"], "left");
  for (const nlohmann::json& hand : run["hands"]) EXPECT_GT(hand["peak_force"]["ring"], 1) << hand;
  EXPECT_EQ(run["not_recorded"], 0);
  EXPECT_EQ(run["trouble"].size(), 0u);

  const Outcome replay = lumbrical("replay a.mcap --threads 2 --json", folder);
  EXPECT_EQ(replay.exit_code, 0) << replay.output << replay.error;
  EXPECT_EQ(replay.json()["hands"].size(), 2u);
  EXPECT_EQ(lumbrical("verify a.mcap", folder).exit_code, 0);
  EXPECT_EQ(lumbrical("info a.mcap --json", folder).json()["hands"], (nlohmann::json{"right", "left"}));
  EXPECT_NE(lumbrical("info a.mcap", folder).output.find("right and left"), std::string::npos);
}

// What a hand feels does not depend on whether the other is felt too.
TEST(BothHands, EachFeelsWhatItFeelsAlone) {
  const fs::path folder = folder_with_both();
  const nlohmann::json both = lumbrical("run scene.json --json", folder).json();
  for (const auto& [i, side] : {std::pair(0, "right"), std::pair(1, "left")}) {
    const nlohmann::json alone =
        lumbrical(std::string("run scene.json --json --side ") + side, folder).json();
    EXPECT_EQ(alone["hand"]["side"], side);
    for (const char* const key : {"contacts", "peak_force", "peak_torque", "flags"})
      EXPECT_EQ(alone[key], both["hands"][static_cast<std::size_t>(i)][key]) << side << ' ' << key;
  }
}

TEST(BothHands, AreTrimmedExportedAndComparedTogether) {
  const fs::path folder = folder_with_both();
  ASSERT_EQ(lumbrical("run scene.json --record a.mcap", folder).exit_code, 0);
  ASSERT_EQ(lumbrical("run scene.json --stiffness 1e7 --record b.mcap", folder).exit_code, 0);
  EXPECT_EQ(lumbrical("trim a.mcap --from 0.5 --to 0.7 -o part.mcap", folder).exit_code, 0);
  EXPECT_EQ(lumbrical("replay part.mcap", folder).exit_code, 0);
  EXPECT_EQ(lumbrical("compress a.mcap -o small.mcap", folder).exit_code, 0);
  const Outcome small = lumbrical("replay small.mcap", folder);
  EXPECT_EQ(small.exit_code, 0) << small.error;
  EXPECT_EQ(lumbrical("diff a.mcap a.mcap", folder).exit_code, 0);
  EXPECT_EQ(lumbrical("diff a.mcap b.mcap", folder).exit_code, 3);
  const std::string head = lumbrical("export part.mcap", folder).output.substr(0, 4000);
  EXPECT_NE(head.find("right.ring_distal.force.x [N]"), std::string::npos) << head;
  EXPECT_NE(head.find("left.ring_distal.force.x [N]"), std::string::npos) << head;
  EXPECT_EQ(lumbrical("export part.mcap --side left", folder).output.find("right."), std::string::npos);
  EXPECT_EQ(lumbrical("replay a.mcap --stiffness 1e7", folder).exit_code, 0) << "a question";
  const Outcome traced = lumbrical("replay a.mcap --trace - --trace-tick 5", folder);
  EXPECT_EQ(traced.exit_code, 2);
  EXPECT_NE(traced.error.find("--side"), std::string::npos) << traced.error;
  EXPECT_EQ(lumbrical("replay a.mcap --side left --trace - --trace-tick 5", folder).exit_code, 0);
}

TEST(BothHands, AreComparedNameTheHandThatDiffers) {
  const fs::path folder = folder_with_both();
  ASSERT_EQ(lumbrical("run scene.json --ticks 900 --record a.mcap", folder).exit_code, 0);
  // The same right hand, and a left one whose wrist is a millimetre off at first.
  std::string frames = read_file(folder / "hold.json");
  const std::size_t left = frames.find("\"left\",[0,1,0],[1,0,0],[");
  ASSERT_NE(left, std::string::npos);
  char& digit = frames[frames.find('.', left) - 1];
  digit = digit == '1' ? '2' : '1';
  std::ofstream(folder / "moved.json") << frames;
  const Outcome run =
      lumbrical("run scene.json --motion moved.json --side both --ticks 900 --record b.mcap", folder);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const Outcome diff = lumbrical("diff a.mcap b.mcap", folder);
  EXPECT_EQ(diff.exit_code, 3);
  EXPECT_EQ(diff.output.find("The left hand:"), 0u) << diff.output;
}

// A cup that the right hand, which comes first, does not reach.
TEST(BothHands, AreIdenticalOnlyWhereEachIsAndTicksAreThoseOfBoth) {
  const fs::path folder = folder_with_both();
  nlohmann::json scene = nlohmann::json::parse(read_file(folder / "scene.json"));
  scene["objects"][0]["position"] = {-0.03, 0, 0};
  std::ofstream(folder / "moved.json") << scene;
  ASSERT_EQ(lumbrical("run moved.json --ticks 600 --record a.mcap", folder).exit_code, 0);
  const nlohmann::json what_if = lumbrical("replay a.mcap --stiffness 1e7 --json", folder).json();
  EXPECT_EQ(what_if["hands"][0]["identical"], true);
  EXPECT_EQ(what_if["hands"][1]["identical"], false);
  EXPECT_EQ(what_if["identical"], false);
  EXPECT_EQ(what_if["first_divergence"], what_if["hands"][1]["first_divergence"]);
  EXPECT_EQ(what_if["ticks"], 600 + what_if["hands"][1]["ticks"].get<int>());
  EXPECT_EQ(lumbrical("replay a.mcap --json", folder).json()["ticks"], 1200);
  EXPECT_EQ(lumbrical("diff a.mcap a.mcap --json", folder).json()["ticks"], 1200);
  EXPECT_EQ(lumbrical("diff a.mcap a.mcap", folder).output.find("Identical: 1,200 ticks of both hands"), 0u);
  const Outcome recovered = lumbrical("recover a.mcap", folder);
  EXPECT_EQ(recovered.output.find("1,200 ticks of both hands recovered"), 0u) << recovered.output;
}

TEST(BothHands, WhatIsNotSupportedIsRefusedWithAWayOut) {
  const fs::path folder = folder_with_both();
  std::ofstream(folder / "grasp.json") << R"({"objects": [{"sphere": {}}], "motion": {"grasp": {}}})";
  std::ofstream(folder / "one.json") << leap_file(
      {leap_frame(0, leap_hand(3, Side::right), leap_fingers(bent_hand(Side::right, 0.2), 3))});
  const auto error_of = [&folder](const std::string& arguments) {
    const Outcome outcome = lumbrical("run " + arguments, folder);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    return outcome.error;
  };
  EXPECT_NE(error_of("grasp.json --side both").find("capture of both"), std::string::npos);
  EXPECT_NE(error_of("scene.json --motion one.json").find("shows one hand, not two"), std::string::npos);
  std::ofstream(folder / "left.json")
      << leap_file({leap_frame(0, leap_hand(3, Side::left), leap_fingers(bent_hand(Side::left, 0.2), 3))});
  EXPECT_NE(error_of("scene.json --motion left.json").find("shows one hand, not two"), std::string::npos);
  // Two of the same side, as of two people.
  std::ofstream(folder / "same.json") << leap_file({leap_frame(
      0, leap_hand(3, Side::left) + "," + leap_hand(4, Side::left),
      leap_fingers(bent_hand(Side::left, 0.2), 3) + "," + leap_fingers(bent_hand(Side::left, 0.2), 4))});
  EXPECT_NE(error_of("scene.json --motion same.json").find("same.json"), std::string::npos);
  EXPECT_NE(error_of("scene.json --side neither").find("both"), std::string::npos);
}

TEST(BothHands, PushWhatMovesByItselfAndReplayTheSame) {
  const fs::path folder = folder_with_both();
  nlohmann::json scene = nlohmann::json::parse(read_file(folder / "scene.json"));
  scene["objects"][0]["moves"] = "free";
  scene["objects"][0]["mass"] = 0.2;
  std::ofstream(folder / "free.json") << scene;
  const Outcome run = lumbrical("run free.json --record free.mcap", folder);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const Outcome replay = lumbrical("replay free.mcap", folder);
  EXPECT_EQ(replay.exit_code, 0) << replay.error;
}

TEST(BothHands, PrecisionsAreComparedHandByHand) {
  const fs::path folder = folder_with_both();
  const nlohmann::json both =
      lumbrical("run scene.json --compare-precision --ticks 2000 --json", folder).json()["hands"];
  ASSERT_EQ(both.size(), 2u);
  for (const nlohmann::json& hand : both) {
    const std::string side = hand["side"];
    const nlohmann::json alone =
        lumbrical("run scene.json --compare-precision --ticks 2000 --json --side " + side, folder).json();
    EXPECT_GT(hand["ticks"], 0);
    EXPECT_EQ(hand["ticks"], alone["ticks"]);
    for (std::size_t rung = 0; rung < hand["rungs"].size(); ++rung)
      EXPECT_EQ(hand["rungs"][rung]["hand_error"], alone["rungs"][rung]["hand_error"]) << side;
  }
  EXPECT_EQ(lumbrical("run scene.json --compare-precision --record a.mcap", folder).exit_code, 2);
  const std::string text = lumbrical("run scene.json --compare-precision --ticks 2000", folder).output;
  EXPECT_NE(text.find("right"), std::string::npos) << text;
  EXPECT_NE(text.find("left"), std::string::npos) << text;
  EXPECT_NE(text.find("\n1e-4 "), std::string::npos) << text;
}

// By one hand alone it would be knocked away.
TEST(BothHands, PrecisionsAreComparedWhereBothHoldWhatMoves) {
  const fs::path folder = folder_with_both();
  nlohmann::json scene = nlohmann::json::parse(read_file(folder / "scene.json"));
  scene["objects"][0].update({{"moves", "free"}, {"mass", 0.2}, {"friction", 0.8}});
  std::ofstream(folder / "free.json") << scene;
  ASSERT_EQ(lumbrical("run free.json --ticks 2000 --record free.mcap", folder).exit_code, 0);
  const nlohmann::json both =
      lumbrical("run free.json --compare-precision --ticks 2000 --json", folder).json()["hands"];
  ASSERT_EQ(both.size(), 2u);
  for (const nlohmann::json& hand : both) {
    const std::string side = hand["side"];
    const Outcome ticks = lumbrical("export free.mcap --format json --side " + side, folder);
    std::istringstream lines(ticks.output);
    int felt = 0;
    for (std::string line; std::getline(lines, line);) {
      double force = 0;
      const nlohmann::json record = nlohmann::json::parse(line);
      for (const nlohmann::json& segment : record["output"]["segment"]) {
        const std::array<double, 3> its = segment["force"];
        force += norm(Vec3{its[0], its[1], its[2]});
      }
      felt += force > 0.05 ? 1 : 0;
    }
    EXPECT_NEAR(hand["ticks"], felt, 0.02 * felt) << side;
  }
}

TEST(BothHands, AreFeltOnAWorldFileAsOnItsObjects) {
  const fs::path folder = folder_with_both();
  ASSERT_EQ(lumbrical("world scene.json -o cup.world", folder).exit_code, 0);
  std::ofstream(folder / "world.json")
      << R"({"world": "cup.world", "motion": {"file": "hold.json", "side": "both"}})";
  const Outcome run = lumbrical("run world.json --precision exact --record a.mcap --json", folder);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const nlohmann::json on_objects = lumbrical("run scene.json --precision exact --json", folder).json();
  ASSERT_EQ(run.json()["hands"].size(), 2u);
  for (std::size_t hand = 0; hand < 2; ++hand)
    for (const char* const key : {"contacts", "peak_force", "peak_torque", "flags"})
      EXPECT_EQ(run.json()["hands"][hand][key], on_objects["hands"][hand][key]) << key;
  EXPECT_EQ(lumbrical("replay a.mcap", folder).exit_code, 0);
}

TEST(BothHands, AlignmentMovesThemTogether) {
  const fs::path folder = folder_with_both();
  nlohmann::json scene = nlohmann::json::parse(read_file(folder / "scene.json"));
  scene["motion"]["position"] = {1, 2, 3};
  std::ofstream(folder / "off.json") << scene;
  const Outcome missed = lumbrical("run off.json", folder);
  EXPECT_EQ(missed.output.find("trouble"), 0u) << missed.output;
  EXPECT_NE(missed.output.find("nothing was touched"), std::string::npos);
  const nlohmann::json met = lumbrical("run off.json --align contact --json", folder).json();
  EXPECT_GT(met["hands"][0]["contacts"]["max"].get<int>() + met["hands"][1]["contacts"]["max"].get<int>(), 0);
  // Between the hands, as they were made.
  const nlohmann::json centred = lumbrical("run off.json --align centre --json", folder).json();
  EXPECT_NEAR(centred["aligned"]["position"][0], 0, 0.002);
  const std::string inspected = lumbrical("inspect off.json", folder).output;
  EXPECT_NE(inspected.find("right"), std::string::npos);
  EXPECT_NE(inspected.find("left"), std::string::npos);
}

TEST(BothHands, PosesAndContactsAreKeptForOthersAtAChosenRate) {
  const fs::path folder = folder_with_both();
  const std::string run = "run scene.json --record-poses 50 --record-contacts 20";
  EXPECT_EQ(lumbrical(run, folder).exit_code, 2) << "there is no recording to put them into";
  ASSERT_EQ(lumbrical(run + " --record a.mcap", folder).exit_code, 0);
  EXPECT_EQ(lumbrical("replay a.mcap", folder).exit_code, 0);
  const std::string info = lumbrical("info a.mcap", folder).output;
  EXPECT_NE(info.find("of one tick in 20"), std::string::npos) << info;
  EXPECT_NE(info.find("of one tick in 50"), std::string::npos) << info;
  const std::string poses = lumbrical("export a.mcap --poses --ticks 1000", folder).output;
  for (const char* const hand : {"right", "left"})
    EXPECT_NE(poses.find(std::string("1000,1,") + hand + ",index tip,"), std::string::npos) << poses;
  const std::string contacts = lumbrical("export a.mcap --contacts --ticks 1000", folder).output;
  EXPECT_NE(contacts.find("1000,1,left,ring "), std::string::npos) << contacts;
  EXPECT_EQ(lumbrical("export a.mcap --contacts --poses", folder).exit_code, 2);
  EXPECT_EQ(lumbrical("export a.mcap --poses --columns x", folder).exit_code, 2);
  const std::string left = lumbrical("export a.mcap --poses --ticks 1000 --side left", folder).output;
  EXPECT_NE(left.find(",left,"), std::string::npos);
  EXPECT_EQ(left.find(",right,"), std::string::npos);
  // The first point's segment alone: its points, and no other's.
  const std::size_t first = contacts.find("1000,1,");
  const std::size_t name = contacts.find(',', first + 7) + 1;
  const std::string segment = contacts.substr(name, contacts.find(',', name) - name);
  const std::string chosen =
      lumbrical("export a.mcap --contacts --ticks 1000 --segments '" + segment + "'", folder).output;
  const auto count = [](const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count(chosen, "\n1000,"), count(contacts, "," + segment + ",")) << chosen;
  EXPECT_EQ(count(chosen, "," + segment + ","), count(chosen, "\n1000,"));
}

TEST(BothHands, EverythingThatCanBeKeptOfBothIsReadAgain) {
  const fs::path folder = folder_with_both();
  const std::string run = "run scene.json --record-poses 50 --record-contacts 20 --record-scene 50 ";
  ASSERT_EQ(lumbrical(run + "--record a.mcap", folder).exit_code, 0);
  for (const char* const command : {"info a.mcap", "verify a.mcap", "replay a.mcap",
                                    "trim a.mcap --from 0.5 --to 1 -o b.mcap", "verify b.mcap"}) {
    const Outcome outcome = lumbrical(command, folder);
    EXPECT_EQ(outcome.exit_code, 0) << command << outcome.error;
  }
}

TEST(BothHands, NumPyReadsTheArchivesOfPosesAndContacts) {
  const fs::path folder = folder_with_both();
  ASSERT_EQ(
      lumbrical("run scene.json --record-poses 50 --record-contacts 20 --record a.mcap", folder).exit_code,
      0);
  if (shell("python3 --version", folder).exit_code != 0) GTEST_SKIP() << "no python3";
  std::ofstream(folder / "read.py") << kReadArchive;
  for (const char* const kind : {"poses", "contacts"}) {
    const std::string name = kind, table = "export a.mcap --" + name;
    ASSERT_EQ(lumbrical(table + " -o " + name + ".csv", folder).exit_code, 0);
    const Outcome made = lumbrical(table + " --format npz -o " + name + ".npz", folder);
    ASSERT_EQ(made.exit_code, 0) << made.error;
    EXPECT_GT(fs::file_size(folder / (name + ".csv")), 10'000u);
    const Outcome read = shell("python3 read.py " + name + ".npz " + name + ".csv", folder);
    EXPECT_EQ(read.exit_code, 0) << read.error;
    EXPECT_EQ(lumbrical(table + " --format npz", folder).exit_code, 2) << "not to standard output";
  }
}

// Torques of one hand must never reach a glove on the other.
TEST(BothHands, ADeviceDrivesTheHandItNames) {
  const fs::path folder = folder_with_both();
  const std::string profile = std::string(LUMBRICAL_SOURCE_DIR) + "/examples/devices/exoskeleton.json";
  const auto run = [&](const std::string& side, const std::string& more) {
    return lumbrical("run scene.json --rate 200 --ticks 20 --side " + side +
                         " --json --sink 'modbus-tcp://127.0.0.1:1?guard=off&profile=" + profile + more + "'",
                     folder);
  };
  const Outcome unnamed = run("both", "");
  if (unnamed.error.find("without libmodbus") != std::string::npos) GTEST_SKIP() << "no libmodbus";
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_NE(unnamed.error.find("side=left"), std::string::npos) << unnamed.error;
  EXPECT_EQ(run("both", "&side=left").exit_code, 4) << "the session runs; there is no device";
  const Outcome other = run("right", "&side=left");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.error.find("drives a left hand"), std::string::npos) << other.error;
  EXPECT_EQ(run("right", "&side=right").exit_code, 4);
  EXPECT_EQ(run("right", "&side=both").exit_code, 2);
}

}  // namespace
}  // namespace lumbrical::test
