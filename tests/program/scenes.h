// Scenes that the program's tests share, each in a folder of its own, and what they expect of results.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "program.h"

namespace lumbrical::test {

inline const std::string kDemo = LUMBRICAL_SOURCE_DIR "/examples/demo.json";

// A folder with the demo at 100 ticks per second in demo.json: the whole motion, in a tenth of the ticks.
inline std::filesystem::path folder_with_demo() {
  const std::filesystem::path folder = fresh_folder();
  nlohmann::json demo = nlohmann::json::parse(read_file(kDemo));
  demo["settings"]["rate"] = 100;
  std::ofstream(folder / "demo.json") << demo.dump(1);
  return folder;
}

// The square of side 2 m in z = 0, facing up, in two triangles.
inline std::filesystem::path folder_with_square() {
  const std::filesystem::path folder = fresh_folder();
  std::ofstream(folder / "square.obj") << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
  return folder;
}

inline void expect_keys(const nlohmann::json& json, const std::vector<std::string>& keys) {
  for (const std::string& key : keys)
    EXPECT_TRUE(json.contains(key)) << key << " is missing in " << json.dump();
}

// A cube of 0.1 m round the origin; its triangles face inwards if so wished.
inline std::string cube_text(bool inside_out) {
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
inline void expect_same_peaks(const nlohmann::json& a, const nlohmann::json& b) {
  for (const auto& [name, force] : a["peak_force"].items())
    EXPECT_NEAR(force.get<double>(), b["peak_force"][name].get<double>(), 1e-9) << name;
}

// A ball that the demo's hand misses by about a metre; `more` stands in the motion.
inline std::filesystem::path folder_with_a_miss(const std::string& more) {
  const std::filesystem::path folder = fresh_folder();
  std::ofstream(folder / "scene.json")
      << R"({"objects": [{"name": "ball", "sphere": {}, "position": [1, 0.5, 0.2]}], "motion": {"grasp": {})"
      << more << R"(}, "settings": {"rate": 100}})";
  return folder;
}

}  // namespace lumbrical::test
