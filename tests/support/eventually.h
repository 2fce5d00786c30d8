// Waits in tests for what another thread or process does.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace lumbrical::test {

/// Waits until it holds; 30 s are more than anything here takes on the slowest machine.
inline bool eventually(const std::function<bool()>& holds) {
  for (int i = 0; i < 6000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace lumbrical::test
