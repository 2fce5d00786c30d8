// Child processes of a test.
#pragma once

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace lumbrical::test {

/// How many threads of this process do not sleep, the calling one among them.
inline int awake_threads() {
  int awake = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string stat;
    std::getline(std::ifstream(thread.path() / "stat"), stat);
    const std::size_t name_end = stat.rfind(") ");
    awake += name_end != std::string::npos && stat.compare(name_end + 2, 1, "S") != 0;
  }
  return awake;
}

/// fork(), once all other threads sleep. A child has none of them but every lock they hold, the allocator's
/// too under a sanitizer, and would wait for it forever; and libraries start threads when they are loaded, as
/// OpenVDB's logger does.
inline pid_t fork_alone() {
  while (awake_threads() > 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return ::fork();
}

}  // namespace lumbrical::test
