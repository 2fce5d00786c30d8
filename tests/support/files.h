// Folders and files of the running test's own, and the real data that some tests use.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace lumbrical::test {

inline std::string read_file(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// The running test's own folder, gone when the program ends. Its name has the process in it: other builds
/// may run the same tests.
inline std::filesystem::path own_folder() {
  static struct Cleaner {
    std::vector<std::filesystem::path> folders;
    ~Cleaner() {
      std::error_code ignored;
      for (const std::filesystem::path& folder : folders) std::filesystem::remove_all(folder, ignored);
    }
  } cleaner;
  const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name =
      "lumbrical_" + std::to_string(::getpid()) + "_" + test->test_suite_name() + "_" + test->name();
  std::replace(name.begin(), name.end(), '/', '_');
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / name;
  if (std::filesystem::create_directories(folder)) cleaner.folders.push_back(folder);
  return folder;
}

/// The same, empty.
inline std::filesystem::path fresh_folder() {
  std::filesystem::remove_all(own_folder());
  return own_folder();
}

/// Writes a file into the test's own folder; returns its path.
inline std::string write_file(const std::string& name, const std::string& text) {
  const std::string path = (own_folder() / name).string();
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

/// Where real meshes and hand captures are, if they are.
inline std::filesystem::path data_folder() {
  const char* const folder = std::getenv("LUMBRICAL_DATA");
  return folder != nullptr ? std::filesystem::path(folder)
                           : std::filesystem::path(LUMBRICAL_SOURCE_DIR) / "../shared/data";
}

}  // namespace lumbrical::test
