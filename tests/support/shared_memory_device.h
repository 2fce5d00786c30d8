// A region of shared memory with a device's thread on it (lumbrical/shared_device.h).
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "lumbrical/shared_device.h"

namespace lumbrical::test {

class SharedDevice {
 public:
  static constexpr std::size_t kIndex = 3;  ///< the actuator whose value is kept
  static constexpr std::size_t kAngle = 5;  ///< the angle that is told

  explicit SharedDevice(const std::string& name, mode_t mode = 0600, off_t size = sizeof(Region))
      : name_(name) {
    shm_unlink(name.c_str());
    const int file = shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
    EXPECT_GE(file, 0);
    EXPECT_EQ(fchmod(file, mode), 0);
    EXPECT_EQ(ftruncate(file, size), 0);
    if (size == sizeof(Region)) {
      region_ =
          static_cast<Region*>(mmap(nullptr, sizeof(Region), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
      lumbrical_shared_init(region_);
      thread_ = std::thread([this] { serve(); });
    }
    close(file);
  }
  ~SharedDevice() {
    ending_ = true;
    if (thread_.joinable()) thread_.join();
    if (region_ != nullptr) munmap(region_, sizeof(Region));
    shm_unlink(name_.c_str());
  }
  SharedDevice(const SharedDevice&) = delete;
  SharedDevice& operator=(const SharedDevice&) = delete;

  std::atomic<double> value{0}, angle{0.3};
  std::atomic<std::uint64_t> dead_man{0};
  std::atomic<bool> silent{false};

 private:
  using Region = lumbrical_shared_device;
  void serve() {
    lumbrical_shared_command command{};
    while (!ending_) {
      if (!silent && lumbrical_shared_take(region_, &command)) {
        value = command.value[kIndex];
        answer(command);
      }
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  }
  void answer(const lumbrical_shared_command& command) {
    lumbrical_shared_feedback feedback{};
    feedback.session = command.session;
    feedback.cycle = command.cycle;
    feedback.dead_man = dead_man;
    feedback.angle[kAngle] = angle;
    feedback.valid = 1u << kAngle;
    lumbrical_shared_answer(region_, &feedback);
  }
  std::string name_;
  Region* region_ = nullptr;
  std::thread thread_;
  std::atomic<bool> ending_{false};
};

/// Of a region that no other process uses.
inline std::string own_region(const char* what) {
  return "/lumbrical_test_" + std::string(what) + std::to_string(getpid());
}

}  // namespace lumbrical::test
