// A simulated device behind a real socket or terminal, a sink in front of it, and a thread that ticks.
#pragma once

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "device_fixture.h"
#include "eventually.h"
#include "lumbrical/device_sink.h"
#include "lumbrical/modbus_server.h"
#include "lumbrical/modbus_wire.h"
#include "reserved_port.h"

namespace lumbrical::test {

using namespace std::chrono_literals;

/// The exoskeleton with time-outs for machines that are slow and busy.
inline DeviceProfile patient_profile() {
  DeviceProfile profile = shipped_profile("exoskeleton");
  profile.rate = 200;
  profile.response_timeout = 0.4;
  profile.first_retry = 0.02;
  profile.last_retry = 0.1;
  profile.safety.soft_start = 0.05;
  profile.safety.tick_hold = 0.5;
  profile.safety.tick_timeout = 2;
  profile.safety.answer_timeout = 1;
  return profile;
}

/// A plain TCP connection to the device; -1: none.
inline int connect_to(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int file = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return file;
  close(file);
  return -1;
}

/// Sends requests as fast as they go and takes no reply, again and again, until it is `enough`.
inline void flood(std::uint16_t port, const std::atomic<bool>& enough) {
  const std::array<std::uint8_t, 12> request = {0, 7, 0, 0, 0, 6, 1, 3, 0, 100, 0, 22};
  std::vector<std::uint8_t> many;
  for (int i = 0; i < 500; ++i) many.insert(many.end(), request.begin(), request.end());
  while (!enough) {
    const int file = connect_to(port);
    while (!enough && send(file, many.data(), many.size(), MSG_NOSIGNAL | MSG_DONTWAIT) != 0) {
      if (errno != EAGAIN && errno != EINTR) break;
      std::this_thread::sleep_for(1ms);
    }
    close(file);
  }
}

/// Another master: writes a register every millisecond until it is `enough`.
inline void write_again_and_again(std::uint16_t port, std::uint8_t address, std::uint16_t value,
                                  const std::atomic<bool>& enough) {
  const int file = connect_to(port);
  const std::array<std::uint8_t, 12> request = {0,
                                                7,
                                                0,
                                                0,
                                                0,
                                                6,
                                                1,
                                                6,
                                                0,
                                                address,
                                                static_cast<std::uint8_t>(value >> 8),
                                                static_cast<std::uint8_t>(value)};
  std::array<std::uint8_t, 12> reply{};
  while (!enough && send(file, request.data(), request.size(), MSG_NOSIGNAL) > 0 &&
         recv(file, reply.data(), reply.size(), 0) > 0) {
    std::this_thread::sleep_for(1ms);
  }
  close(file);
}

/// A simulated device that a thread serves. What the test reads of it is copied after each step.
class ServedDevice {
 public:
  explicit ServedDevice(const DeviceProfile& profile) : profile_(profile) {
    options_.watchdog = 1.5;
    fresh();
  }
  ~ServedDevice() { stop(); }

  /// At a port of its own, which it keeps while it is switched off.
  void listen() { listen(reserved_.number(), "127.0.0.1"); }
  void listen(std::uint16_t port, const std::string& host) {
    const Status status = server_->listen(host, port);
    ASSERT_TRUE(status.ok()) << status.message();
    port_ = server_->port();
    start();
  }
  void open_terminal() {
    const Status status = server_->open_terminal("");
    ASSERT_TRUE(status.ok()) << status.message();
    start();
  }
  void open_line(const std::string& path) {
    const Status status = server_->open_line(path, 115200);
    ASSERT_TRUE(status.ok()) << status.message();
    start();
  }
  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
    server_->close();
  }
  /// As after a power cut: a new device on the same port.
  void restart() {
    stop();
    fresh();
    listen();
  }
  [[nodiscard]] double torque() const { return torque_; }    ///< of the index' first joint
  [[nodiscard]] double largest() const { return largest_; }  ///< ever
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] const std::string& name() const { return server_->name(); }
  [[nodiscard]] std::uint64_t requests() const { return server_->requests(); }
  std::atomic<bool> press_stop{false}, break_down{false}, hang{false}, release_dead_man{false};
  std::atomic<SensorFault> sensors{SensorFault::none};
  ServerFaults faults;

 private:
  void fresh() {
    server_ = std::make_unique<ModbusServer>();
    device_ = std::make_unique<SimulatedDevice>(profile_, options_);
    stopping_ = false;
    torque_ = 0;
  }
  void start() {
    thread_ = std::thread([this] {
      server_->serve(
          *device_, faults, [this] { return stopping_.load(); },
          [this](SimulatedDevice& device) {
            device.press_stop(press_stop);
            device.break_down(break_down);
            device.hang(hang);
            device.break_sensors(sensors);
            device.hold_dead_man(!release_dead_man);
            torque_ = device.torque()[3];
            largest_ = std::max(largest_.load(), device.torque()[3]);
          });
    });
  }
  const ReservedPort reserved_;
  std::uint16_t port_ = reserved_.number();
  DeviceProfile profile_;
  SimulationOptions options_;
  std::unique_ptr<ModbusServer> server_;
  std::unique_ptr<SimulatedDevice> device_;
  std::thread thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<double> torque_{0}, largest_{0};
};

/// A sink with a thread of its own, on a Modbus wire.
inline Status open_modbus(const DeviceProfile& profile, SinkOptions options, DeviceSink& sink) {
  options.thread = true;
  std::unique_ptr<DeviceWire> wire;
  if (Status status = make_modbus_wire(profile, wire); !status.ok()) return status;
  return sink.open(profile, std::move(wire), options);
}

/// A sink and a thread that publishes 0.1 N m for every joint, a thousand times a second.
class TickingSink {
 public:
  void open(const DeviceProfile& profile, const SinkOptions& options = {}) {
    const Status status = open_modbus(profile, options, sink);
    ASSERT_TRUE(status.ok()) << status.message();
    thread_ = std::thread([this] {
      DeviceCommand command;
      DeviceFeedback feedback;
      SentCommand sent;
      while (!ending_) {
        if (!stalled) {
          ++command.tick;
          while (sink.feedback(feedback)) command.feedback_time = feedback.asked;
          doubts = feedback.flags;
          command.wanted.fill(wanted);
          sink.publish(command);
          while (sink.sent(sent)) {
            cycles += sent.sent != 0 ? 1 : 0;
            if (sent.acknowledged == 0) continue;
            ++acknowledged;
            const double exchanges =
                static_cast<double>(sent.loop_delay) / static_cast<double>(sent.acknowledged - sent.sent);
            if (sent.loop_delay != 0) ++(exchanges < 2.5 ? two_exchanges : three_exchanges);
          }
        }
        std::this_thread::sleep_for(1ms);
      }
    });
  }
  ~TickingSink() { close(); }
  bool close() {
    const bool safe = sink.close();
    ending_ = true;
    if (thread_.joinable()) thread_.join();
    return safe;
  }
  /// Everything the sink has told so far, one line each.
  std::string log() {
    const std::lock_guard lock(mutex_);
    for (const SinkEvent& event : sink.events()) log_ += event.text + "\n";
    return log_;
  }
  bool told(const std::string& text) {
    return eventually([&] { return log().find(text) != std::string::npos; });
  }
  bool reaches(SafetyState state) {
    return eventually([&] { return sink.report().state == state; });
  }

  DeviceSink sink;
  std::atomic<bool> stalled{false};
  std::atomic<double> wanted{0.1};
  std::atomic<int> cycles{0}, acknowledged{0};
  /// From asking for angles to the reply to the command made of them: about so many exchanges.
  std::atomic<int> two_exchanges{0}, three_exchanges{0};
  std::atomic<std::uint32_t> doubts{0};  ///< flags of the newest feedback

 private:
  std::thread thread_;
  std::mutex mutex_;
  std::string log_;
  std::atomic<bool> ending_{false};
};

}  // namespace lumbrical::test
