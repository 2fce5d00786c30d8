// Runs the lumbrical program for tests, and keeps what it said.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "files.h"

namespace lumbrical::test {

struct Outcome {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string output, error;
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(output); }
};

/// Runs a shell command line; "lumbrical" at its start, or after a space, is the program under test. What it
/// still has in the background when it ends, however it does, is killed.
inline Outcome shell(std::string command, const std::filesystem::path& folder) {
  constexpr std::string_view kName = "lumbrical ";
  for (std::size_t at = command.find(kName); at != std::string::npos; at = command.find(kName, at)) {
    const std::string program = std::string("'") + LUMBRICAL_PROGRAM + "' ";
    command.replace(at, kName.size(), program);
    at += program.size();
  }
  const std::string output = (folder / "stdout").string();
  const std::string error = (folder / "stderr").string();
  const int status =
      std::system(("cd '" + folder.string() + "' && { trap 'kill -KILL $(jobs -p) 2>/dev/null; wait' EXIT; " +
                   command + "; } >stdout 2>stderr </dev/null")
                      .c_str());
  Outcome outcome;
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  outcome.output = read_file(output);
  outcome.error = read_file(error);
  return outcome;
}

/// For shell(): waits until a command succeeds, 30 s at most.
inline std::string wait_until(const std::string& command) {
  return "for i in $(seq 600); do " + command + " && break; sleep 0.05; done; ";
}
/// For shell(): waits until the file is there and ticks are in it.
inline std::string wait_for_ticks(const std::string& recording) {
  return wait_until("lumbrical info " + recording + " --json 2>/dev/null | grep -q '\"ticks\": *[1-9]'");
}

/// More than any session in the background needs: it is ended, or killed with its test. (At 100 ticks per
/// second it would end by itself after four minutes, should the test be killed.)
inline const std::string kManyTicks = "--ticks 25000 ";

}  // namespace lumbrical::test
