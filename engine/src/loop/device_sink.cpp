// See lumbrical/device_sink.h. What a cycle does is in sink_worker.cpp.
#include "lumbrical/device_sink.h"

#include <cassert>
#include <system_error>
#include <utility>

#include "loop/sink_worker.h"

namespace lumbrical {

DeviceSink::DeviceSink() = default;
DeviceSink::~DeviceSink() { close(); }

Status DeviceSink::open(const DeviceProfile& profile, std::unique_ptr<DeviceWire> wire,
                        const SinkOptions& options) {
  assert(wire != nullptr);
  if (worker_ && !worker_->closing)
    return Status::error(profile.name + ": the sink is still open; close it first");
  if (Status status = check_profile(profile); !status.ok()) return status;
  if (!options.dry_run && !options.take_over) {
    if (Status status = check_attended(profile); !status.ok()) return status;
  }
  auto worker = std::make_unique<Worker>(profile, std::move(wire), options);
  if (options.thread) {
    try {
      worker->thread = std::thread([raw = worker.get()] { raw->run(); });
    } catch (const std::system_error&) {
      return Status::error(profile.name + ": no thread for the sink; the system has reached its limit");
    }
  }
  worker_ = std::move(worker);
  return {};
}

void DeviceSink::cycle() {
  assert(worker_ && !worker_->options.thread);
  // Ticks may come a little early: those at the rate of the profile shall not miss every second exchange.
  const double early = 0.5 / worker_->profile.rate;
  if (steady_ns() >= worker_->next_cycle - in_ns(early)) worker_->step();
}

bool DeviceSink::close() {
  if (!worker_) return false;
  if (!worker_->closing.exchange(true)) {
    if (worker_->thread.joinable()) {
      worker_->thread.join();
    } else {
      worker_->let_go();
    }
    worker_->wire->close();
  }
  return worker_->safe;
}

std::int64_t DeviceSink::now() const noexcept { return steady_ns(); }

void DeviceSink::publish(const DeviceCommand& command) noexcept {
  if (worker_) worker_->commands.put({command, steady_ns()});
}

bool DeviceSink::feedback(DeviceFeedback& feedback) noexcept {
  return worker_ && worker_->next_feedback(feedback);
}

bool DeviceSink::sent(SentCommand& command) noexcept {
  if (!worker_) return false;
  const SentCommand* const front = worker_->history.front();
  if (front == nullptr) return false;
  command = *front;
  worker_->history.pop();
  return true;
}

void DeviceSink::arm_when_ready() noexcept {
  if (worker_) worker_->requests |= kArmWhenReady;
}
void DeviceSink::request_arm() noexcept {
  if (worker_) worker_->requests |= kArm;
}
void DeviceSink::request_disarm() noexcept {
  if (worker_) worker_->requests |= kDisarm;
}
void DeviceSink::request_reset() noexcept {
  if (worker_) worker_->requests |= kReset;
}
void DeviceSink::press_stop(bool pressed) noexcept {
  if (worker_) worker_->stop = pressed;
}
void DeviceSink::hold_dead_man(bool held) noexcept {
  if (worker_) worker_->dead_man = held;
}
SafetyState DeviceSink::state() const noexcept {
  return worker_ ? worker_->state.load() : SafetyState::disconnected;
}
bool DeviceSink::is_safe() const noexcept { return worker_ && worker_->safe; }

SinkReport DeviceSink::report() const {
  if (!worker_) return {};
  const std::lock_guard lock(worker_->mutex);
  return worker_->report;
}

void DeviceSink::tell(std::string text) {
  if (worker_) worker_->tell(std::move(text));
}

std::vector<SinkEvent> DeviceSink::events() {
  if (!worker_) return {};
  const std::lock_guard lock(worker_->mutex);
  return std::exchange(worker_->events, {});
}

}  // namespace lumbrical
