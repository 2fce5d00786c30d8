// Runs the lumbrical program for tests, and keeps what it said.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace lumbrical::test {

inline std::string read_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A folder of the running test's own, empty at its start and gone when the program ends. Its name has the
/// process in it: other builds may run the same tests.
inline std::filesystem::path fresh_folder() {
  static struct Cleaner {
    std::vector<std::filesystem::path> folders;
    ~Cleaner() {
      std::error_code ignored;
      for (const std::filesystem::path& folder : folders) std::filesystem::remove_all(folder, ignored);
    }
  } cleaner;
  const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) /
      ("lumbrical_" + std::to_string(::getpid()) + "_" + test->test_suite_name() + "_" + test->name());
  cleaner.folders.push_back(folder);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

struct Outcome {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string output, error;
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(output); }
};

/// Runs a shell command line; "lumbrical" at its start, or after a space, is the program under test.
inline Outcome shell(std::string command, const std::filesystem::path& folder) {
  constexpr std::string_view kName = "lumbrical ";
  for (std::size_t at = command.find(kName); at != std::string::npos; at = command.find(kName, at)) {
    const std::string program = std::string("'") + LUMBRICAL_PROGRAM + "' ";
    command.replace(at, kName.size(), program);
    at += program.size();
  }
  const std::string output = (folder / "stdout").string();
  const std::string error = (folder / "stderr").string();
  const int status = std::system(
      ("cd '" + folder.string() + "' && { " + command + "; } >stdout 2>stderr </dev/null").c_str());
  Outcome outcome;
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  outcome.output = read_file(output);
  outcome.error = read_file(error);
  return outcome;
}

}  // namespace lumbrical::test
