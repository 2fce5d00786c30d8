// What a sink does cycle after cycle: connection, handshake, safety envelope and exchange.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/newest.h"
#include "base/ring.h"
#include "base/steady_clock.h"
#include "device/feedback_check.h"
#include "device/sensor_pace.h"
#include "loop/running_time.h"
#include "lumbrical/device_sink.h"

namespace lumbrical {

struct PublishedCommand {
  DeviceCommand command;
  std::int64_t time = 0;
};

/// Samples that wait for ticks that stand still: twice as many as come until all forces have faded, within
/// reason.
inline std::uint32_t feedback_room(const DeviceProfile& profile) {
  const double time = profile.safety.tick_hold + profile.safety.fade;
  return static_cast<std::uint32_t>(std::clamp(std::ceil(2 * profile.rate * time), 256.0, 4096.0));
}

enum SinkRequest : unsigned { kArm = 1, kDisarm = 2, kReset = 4, kArmWhenReady = 8 };

struct DeviceSink::Worker {
  DeviceProfile profile;
  SinkOptions options;
  std::unique_ptr<DeviceWire> wire;
  SafetyMemory safety;

  // Between threads.
  Newest<PublishedCommand> commands;
  Ring<DeviceFeedback> feedbacks;
  Newest<DeviceFeedback> newest_feedback;  // where the ring has no room for it
  Ring<SentCommand> history{4096};
  std::atomic<unsigned> requests{0};
  std::atomic<bool> stop{false}, dead_man{true}, closing{false}, safe{false};
  std::atomic<SafetyState> state{SafetyState::disconnected};
  mutable std::mutex mutex;  // of `report` and `events`; the ticking thread never asks for it
  SinkReport report;
  std::vector<SinkEvent> events;
  std::thread thread;

  // Of the ticking thread.
  std::int64_t taken_feedback = 0;  // `time` of the newest

  // Of whoever makes the cycles.
  PublishedCommand newest;
  bool arms_when_ready;         // kArmWhenReady that waits
  std::int64_t next_cycle = 0;  // when it is due
  std::int64_t opened = 0, last_step = 0, next_try = 0, last_echo_change = 0;
  std::int64_t told_at = 0;   // when the newest command left that was acknowledged; 0: none yet
  std::int64_t asked_at = 0;  // when the request for the newest angles left
  double exchange = 0;        // [s] the last one acknowledged
  RunningTime running;
  RunningAge age;            // of the newest command
  double lost_answered = 0;  // when the device answered last, or time was counted although it did not
  double retry = 0;
  bool connected = false, handshaken = false;
  std::int64_t held_since = 0;  // when the device answered first since it has let go last
  bool has_answered = false;    // on this connection: the device there may be another than before
  WireAnswer answer;
  FeedbackMemory feedback_memory{};
  std::array<AnglePace, kAngleCount> pace{};
  std::uint32_t slow_told = 0;  // bit i: that angle i is told slowly
  bool standing = false;        // what was sent in the cycle before was acknowledged on this connection
  bool other_master = false;
  bool looks_back = true;    // as far as is known of this connection
  std::string not_noticed;   // why another master would not be, as told of this connection
  std::uint32_t doubts = 0;  // DeviceFlag bits of the newest feedback
  std::uint16_t last_echo = 0;
  bool last_ready = false;              // as the newest answer said
  ActuatorArray commanded{}, acting{};  // by this cycle's request, and by the last one acknowledged
  std::uint64_t cycle_count = 0;
  std::array<std::int64_t, 2> rate_start{};
  std::array<std::uint64_t, 2> rate_count{};
  std::string last_problem;
  bool has_worked = false;         // since then
  std::uint64_t times_untold = 0;  // that it came again
  std::int64_t problem_told = 0;   // when
  std::int64_t connected_at = 0;   // when this connection, or the last one, was opened
  SafetyState remembered_state = SafetyState::disconnected;
  std::uint32_t remembered_flags = 0;

  Worker(const DeviceProfile& wanted, std::unique_ptr<DeviceWire> way, const SinkOptions& chosen)
      : profile(wanted),
        options(chosen),
        wire(std::move(way)),
        safety(start_safety(wanted)),
        feedbacks(feedback_room(wanted)),
        arms_when_ready(chosen.arm),
        running{1 / wanted.rate} {
    wire->patience.usual = wanted.response_timeout;
    wire->patience.hurry = [this] { return stop && !safe; };
    last_step = opened = next_cycle = steady_ns();
    rate_start.fill(opened);
  }

  void run();
  bool step();
  bool cycle();
  void let_go();
  void await_cycle() const;
  void set_up_thread();
  void tell(std::string text);
  void problem(std::string text);
  [[nodiscard]] double longer_retry() const;
  void connect();
  bool greet();
  void disconnect();
  void lose(std::string why);
  bool answered(WireResult result);
  void tell_transition(SafetyState before, std::uint32_t flags);
  void take_command();
  void await_tick();
  [[nodiscard]] bool silent(std::int64_t now) const;
  SafetyOutput decide(std::int64_t now);
  void look_back();
  bool exchange_with(const SafetyOutput& output);
  bool exchange_and_note(const SafetyOutput& output);
  void tell_doubts(const DeviceFeedback& feedback);
  void take_angles(DeviceFeedback& feedback) const;
  void note_pace(const DeviceFeedback& feedback);
  void take_feedback(std::int64_t sent, std::int64_t now);
  void hand_over(const DeviceFeedback& feedback);
  bool next_feedback(DeviceFeedback& feedback);
  SentCommand* claim_slot(std::uint32_t flags);
  void remember(const SafetyOutput& output, std::int64_t sent, std::int64_t acknowledged);
  void remember_change(std::uint32_t flags);
  void count(bool acknowledged, std::int64_t now);
};

}  // namespace lumbrical
