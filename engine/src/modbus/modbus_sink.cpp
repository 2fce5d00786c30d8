// See lumbrical/modbus_sink.h. What the thread does is in modbus_worker.cpp.
#include "lumbrical/modbus_sink.h"

#include <system_error>
#include <utility>

#include "modbus/modbus_network.h"
#include "modbus/modbus_worker.h"

namespace lumbrical {

ModbusSink::ModbusSink() = default;
ModbusSink::~ModbusSink() { close(); }

Status ModbusSink::open(const DeviceProfile& profile, const SinkOptions& options) {
  if (worker_) return Status::error(profile.name + ": the sink is still open; close it first");
  if (Status status = check_profile(profile); !status.ok()) return status;
  if (!options.dry_run && !options.take_over) {
    if (Status status = check_attended(profile); !status.ok()) return status;
  }
  const Transport& transport = profile.transport;
  if (!transport.serial) {
    if (Status status = check_host(transport.host, transport.anywhere); !status.ok()) return status;
  }
  auto worker = std::make_unique<Worker>(profile, options);
  try {
    worker->thread = std::thread([raw = worker.get()] { raw->run(); });
  } catch (const std::system_error&) {
    return Status::error(profile.name + ": no thread for the sink; the system has reached its limit");
  }
  worker_ = std::move(worker);
  return {};
}

bool ModbusSink::close() {
  if (!worker_) return false;
  if (worker_->thread.joinable()) {
    worker_->closing = true;
    worker_->thread.join();
  }
  return worker_->safe;
}

void ModbusSink::publish(const DeviceCommand& command) noexcept {
  if (worker_) worker_->commands.put({command, now_ns()});
}

bool ModbusSink::feedback(DeviceFeedback& feedback) noexcept {
  return worker_ && worker_->feedbacks.take(feedback);
}

bool ModbusSink::sent(SentCommand& command) noexcept {
  if (!worker_) return false;
  const SentCommand* const front = worker_->history.front();
  if (front == nullptr) return false;
  command = *front;
  worker_->history.pop();
  return true;
}

void ModbusSink::arm_when_ready() noexcept {
  if (worker_) worker_->auto_arm = true;
}
void ModbusSink::request_arm() noexcept {
  if (worker_) worker_->requests |= kArm;
}
void ModbusSink::request_disarm() noexcept {
  if (worker_) worker_->requests |= kDisarm;
}
void ModbusSink::request_reset() noexcept {
  if (worker_) worker_->requests |= kReset;
}
void ModbusSink::press_stop(bool pressed) noexcept {
  if (worker_) worker_->stop = pressed;
}
void ModbusSink::hold_dead_man(bool held) noexcept {
  if (worker_) worker_->dead_man = held;
}
SafetyState ModbusSink::state() const noexcept {
  return worker_ ? worker_->state.load() : SafetyState::disconnected;
}
bool ModbusSink::is_safe() const noexcept { return worker_ && worker_->safe; }

SinkReport ModbusSink::report() const {
  if (!worker_) return {};
  const std::lock_guard lock(worker_->mutex);
  return worker_->report;
}

std::vector<SinkEvent> ModbusSink::events() {
  if (!worker_) return {};
  const std::lock_guard lock(worker_->mutex);
  return std::exchange(worker_->events, {});
}

double bus_cycle(const DeviceProfile& profile) { return line_time(profile); }

}  // namespace lumbrical
