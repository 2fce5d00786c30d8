// Real meshes and a real hand capture through the whole program: run, record, replay. Skipped where the data
// is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "lumbrical/motion.h"
#include "program.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> sorted_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// The unit only matters to inspect: the scene fits every mesh to a graspable size.
TEST(RealData, ALeapGrabOnEveryMeshReplaysIdentical) {
  const fs::path data = data_folder();
  if (!fs::exists(data / "meshes")) GTEST_SKIP() << "no real meshes at " << data << "; set LUMBRICAL_DATA";
  const fs::path folder = fresh_folder();
  int accepted = 0;
  for (const fs::path& mesh : sorted_files(data / "meshes")) {
    const std::string path = fs::absolute(mesh).string();
    if (shell("lumbrical inspect '" + path + "' --unit m", folder).exit_code != 0) continue;
    ++accepted;
    const nlohmann::json scene = {
        {"objects", {{{"mesh", path}, {"fit", {{"size", 0.08}}}, {"position", {0.075, 0.16, 0.0}}}}},
        {"motion", {{"file", fs::absolute(data / "hands/leap_grab.json").string()}}},
        {"settings", {{"rate", 100}, {"max_candidates", 1000000}}}};
    std::ofstream(folder / "scene.json") << scene;
    fs::remove(folder / "a.mcap");
    const Outcome run = shell("lumbrical run scene.json --ticks 120 --record a.mcap --json", folder);
    ASSERT_EQ(run.exit_code, 0) << mesh << "\n" << run.error;
    const Outcome replay = shell("lumbrical replay a.mcap --threads 2 --json", folder);
    EXPECT_EQ(replay.exit_code, 0) << mesh << "\n" << replay.output << replay.error;
    const nlohmann::json json = run.json();
    EXPECT_GT(json["contacts"]["max"], 0) << mesh;
    std::cout << mesh.filename().string() << ": contacts mean " << json["contacts"]["mean"] << " max "
              << json["contacts"]["max"] << ", tick [us] p50 " << json["tick_us"]["p50"] << " p99 "
              << json["tick_us"]["p99"] << "\n";
  }
  EXPECT_GE(accepted, 14);
}

TEST(RealData, EveryHandCaptureRunsAndReplaysIdentical) {
  const fs::path data = data_folder();
  if (!fs::exists(data / "hands")) GTEST_SKIP() << "no real hands at " << data << "; set LUMBRICAL_DATA";
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "scene.json") << R"({"objects": [{"sphere": {"radius": 0.1}}]})";
  std::size_t count = 0;
  std::string replay = "lumbrical replay --json";
  for (const fs::directory_entry& entry : fs::directory_iterator(data / "hands")) {
    const std::string path = fs::absolute(entry.path()).string();
    const std::string name = std::to_string(count++) + ".mcap";
    const std::string command =
        "lumbrical run scene.json --motion '" + path + "' --ticks 150 --record " + name;
    Outcome run = shell(command + " --side right", folder);
    if (run.exit_code != 0)
      run = shell(command + " --side left", folder);  // a capture that shows it is of a left hand
    ASSERT_EQ(run.exit_code, 0) << path << "\n" << run.error;
    replay += " " + name;
  }
  const Outcome all = shell(replay, folder);
  EXPECT_EQ(all.exit_code, 0) << all.output << all.error;
  EXPECT_EQ(all.json().size(), count);
}

// ---- Every mesh meets every hand ----

struct Hands {
  std::string name;
  nlohmann::json motion;  // of the scene
  Vec3 place;             // where a thing in this hand would be
  double seconds = 1;
};

Vec3 at(const DeviceFrame& frame, int joint) {
  const auto& p = frame.joint[static_cast<std::size_t>(joint)].position;
  return {p[0], p[1], p[2]};
}

// In front of the palm, half-way through the capture.
Hands captured(const fs::path& file) {
  Hands hands;
  hands.name = file.filename().string();
  Motion motion;
  MotionOptions options;
  if (Status status = load_motion(file.string(), options, motion); !status.ok())
    ADD_FAILURE() << status.message();
  if (motion.samples.empty()) return hands;
  hands.seconds = std::clamp(duration(motion), 0.5, 4.0);
  const DeviceFrame frame = resample(motion, 0.5 * duration(motion));
  const Vec3 tips = 0.5 * (at(frame, kThumbTip) + at(frame, kMiddleTip));
  hands.place = 0.5 * (tips + at(frame, kPalm));
  hands.motion = {{"file", fs::absolute(file).string()}};
  return hands;
}

// One word on what a run gave: the largest force of a finger or the palm, or that nothing was touched.
std::string outcome_of(const nlohmann::json& run) {
  double peak = 0;
  for (const auto& [part, force] : run["peak_force"].items()) peak = std::max(peak, force.get<double>());
  if (run["contacts"]["max"] == 0) return "not touched";
  std::ostringstream text;
  text << std::fixed << std::setprecision(peak < 1 ? 2 : 1) << peak << " N";
  for (const char* const flag : {"force limited", "candidate overflow", "input lost"})
    if (run["flags"].contains(flag)) text << ", " << flag;
  return text.str();
}

// The table of docs/trials.md; LUMBRICAL_TRIALS names the file to write it to.
TEST(RealData, EveryMeshMeetsEveryHand) {
  const fs::path data = data_folder();
  if (!fs::exists(data / "meshes")) GTEST_SKIP() << "no real meshes at " << data << "; set LUMBRICAL_DATA";
  const fs::path folder = fresh_folder();
  std::vector<Hands> hands = {{"the built-in grasp", {{"grasp", {{"seconds", 2}}}}, {0, 0, 0.04}, 2}};
  for (const fs::path& file : sorted_files(data / "hands")) hands.push_back(captured(file));
  std::string table = "| mesh |";
  for (const Hands& hand : hands) table += " " + hand.name + " |";
  table += "\n|---|";
  for (std::size_t i = 0; i < hands.size(); ++i) table += "---|";
  std::size_t runs = 0, touched = 0;
  for (const fs::path& mesh : sorted_files(data / "meshes")) {
    table += "\n| " + mesh.filename().string() + " |";
    std::string replay = "lumbrical replay --json";
    for (std::size_t h = 0; h < hands.size(); ++h) {
      const Vec3 p = hands[h].place;
      const nlohmann::json scene = {{"objects",
                                     {{{"mesh", fs::absolute(mesh).string()},
                                       {"fit", {{"size", 0.08}}},
                                       {"position", {p.x, p.y, p.z}}}}},
                                    {"motion", hands[h].motion},
                                    {"settings", {{"rate", 50}, {"seconds", hands[h].seconds}}}};
      std::ofstream(folder / "scene.json") << scene;
      const std::string name = mesh.filename().string() + "." + std::to_string(h) + ".mcap";
      const Outcome run = shell("lumbrical run scene.json --json --record '" + name + "'", folder);
      ASSERT_EQ(run.exit_code, 0) << mesh << ", " << hands[h].name << "\n" << run.error;
      const std::string outcome = outcome_of(run.json());
      table += " " + outcome + " |";
      replay += " '" + name + "'";
      ++runs;
      touched += outcome == "not touched" ? 0 : 1;
    }
    const Outcome replayed = shell(replay, folder);
    EXPECT_EQ(replayed.exit_code, 0) << mesh << "\n" << replayed.output << replayed.error;
    for (std::size_t h = 0; h < hands.size(); ++h)
      fs::remove(folder / (mesh.filename().string() + "." + std::to_string(h) + ".mcap"));
  }
  EXPECT_GT(touched, runs / 2);
  if (const char* const path = std::getenv("LUMBRICAL_TRIALS")) {
    std::ofstream(path)
        << "# Every mesh in every hand\n\n"
           "Meshes and captures of others, none of which is in this repository, each fitted to 8 cm and put "
           "where a thing in that hand would be: the\nlargest force that a finger or the palm felt. Every "
           "run exited with 0, and its recording replayed bit for bit. The captures were not made of\nthese "
           "meshes, so fingers may be deep inside, where forces saturate (20 N a segment, of which a finger "
           "has three). Made by\n\n"
           "    LUMBRICAL_DATA=DATA LUMBRICAL_TRIALS=docs/trials.md build/dev/tests/program_test "
           "--gtest_filter=RealData.EveryMeshMeetsEveryHand\n\n"
        << table << "\n";
  }
}

}  // namespace
}  // namespace lumbrical::test
