// What runs on a sink's own thread: connection, handshake, safety envelope and exchange, cycle after cycle.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/newest.h"
#include "base/ring.h"
#include "device/feedback_check.h"
#include "lumbrical/modbus_sink.h"
#include "modbus/exchange_words.h"
#include "modbus/modbus_link.h"
#include "modbus/running_time.h"

namespace lumbrical {

/// The steady clock [ns].
inline std::int64_t now_ns() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

struct PublishedCommand {
  DeviceCommand command;
  std::int64_t time = 0;
};

enum SinkRequest : unsigned { kArm = 1, kDisarm = 2, kReset = 4 };

struct ModbusSink::Worker {
  DeviceProfile profile;
  SinkOptions options;
  ExchangeWords words;
  ModbusLink link;
  SafetyMemory safety;

  // Between threads.
  Newest<PublishedCommand> commands;
  Newest<DeviceFeedback> feedbacks;
  Ring<SentCommand> history{4096};
  std::atomic<unsigned> requests{0};
  std::atomic<bool> auto_arm{false}, stop{false}, dead_man{true}, closing{false}, safe{false};
  std::atomic<SafetyState> state{SafetyState::disconnected};
  mutable std::mutex mutex;  // of `report` and `events`; the ticking thread never asks for it
  SinkReport report;
  std::vector<SinkEvent> events;
  std::thread thread;

  // The thread's own.
  PublishedCommand newest;
  std::int64_t opened = 0, last_step = 0, last_answer = 0, next_try = 0, last_echo_change = 0;
  std::int64_t asked_at = 0;  // when the request for the newest angles left
  double exchange = 0;        // [s] the last one acknowledged
  RunningTime running;
  double lost_before = 0;  // of running.lost, when the newest command came
  double retry = 0;
  bool any_answer = false, handshaken = false;
  DeviceStatus device;
  FeedbackMemory feedback_memory{};
  bool standing = false;  // what `words` wrote in the cycle before was acknowledged on this connection
  bool other_master = false;
  std::int64_t last_look = 0;
  std::size_t look = 0;
  std::uint32_t doubts = 0;  // DeviceFlag bits of the newest feedback
  std::uint16_t last_echo = 0;
  ActuatorArray commanded{}, acting{};  // by this cycle's request, and by the last one acknowledged
  std::uint64_t cycle = 0;
  std::array<std::int64_t, 2> rate_start{};
  std::array<std::uint64_t, 2> rate_count{};
  std::string last_problem;

  explicit Worker(const DeviceProfile& wanted, const SinkOptions& chosen)
      : profile(wanted),
        options(chosen),
        words(wanted),
        safety(start_safety(wanted)),
        auto_arm(chosen.arm),
        running{1 / wanted.rate} {
    link.patience.usual = wanted.response_timeout;
    link.patience.hurry = [this] { return stop && !safe; };
  }

  void run();
  void set_up_thread();
  void tell(std::string text);
  void problem(std::string text);
  void connect();
  bool shake_hands();
  bool take_over();
  void lose(std::string why);
  bool answered(const LinkResult& result, const char* doing, const RegisterBlock& block);
  void tell_transition(SafetyState before, std::uint32_t flags);
  void take_command();
  void await_tick();
  SafetyOutput decide(std::int64_t now);
  void look_back();
  bool transfer();
  void tell_doubts(const DeviceFeedback& feedback);
  void take_feedback(std::int64_t now);
  void remember(const SafetyOutput& output, std::int64_t sent, std::int64_t acknowledged);
  void count(bool acknowledged, std::int64_t now);
  bool step();
};

}  // namespace lumbrical
