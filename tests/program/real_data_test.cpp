// Real meshes and a real hand capture through the whole program: run, record, replay. Skipped where the data
// is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "program.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

// The unit only matters to inspect: the scene fits every mesh to a graspable size.
TEST(RealData, ALeapGrabOnEveryMeshReplaysIdentical) {
  const fs::path data = data_folder();
  if (!fs::exists(data / "meshes")) GTEST_SKIP() << "no real meshes at " << data << "; set LUMBRICAL_DATA";
  const fs::path folder = fresh_folder();
  std::vector<fs::path> meshes;
  for (const fs::directory_entry& entry : fs::directory_iterator(data / "meshes"))
    meshes.push_back(entry.path());
  std::sort(meshes.begin(), meshes.end());
  int accepted = 0;
  for (const fs::path& mesh : meshes) {
    const std::string path = fs::absolute(mesh).string();
    if (shell("lumbrical inspect '" + path + "' --unit m", folder).exit_code != 0) continue;
    ++accepted;
    const nlohmann::json scene = {
        {"objects", {{{"mesh", path}, {"fit", {{"size", 0.08}}}, {"position", {0.075, 0.16, 0.0}}}}},
        {"motion", {{"file", fs::absolute(data / "hands/leap_grab.json").string()}}},
        {"settings", {{"rate", 100}, {"max_candidates", 1000000}}}};
    std::ofstream(folder / "scene.json") << scene;
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

}  // namespace
}  // namespace lumbrical::test
