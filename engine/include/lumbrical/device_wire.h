// The way to a device: three functions that carry commands there and angles back. Modbus is one, datagrams
// and shared memory are others, a device's own library may be another. What is sent is decided in front of
// it, by the safety envelope of DeviceSink, so a wire has no limits of its own to keep.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "lumbrical/device_link.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// What a device is told in one cycle.
struct WireCommand {
  std::uint64_t cycle = 0;       ///< counts from 1; by it a device may notice that no one drives it any more
  const SafetyOutput& output;    ///< what it may do, and whether it is switched on
  const DeviceCommand& made_of;  ///< the tick's command behind it; of its local models only those count
                                 ///< whose command is `output`'s (local_model_of)
};

/// What a device says of itself.
struct DeviceStatus {
  bool ready = true, fault = false, stop = false;  ///< ready: takes forces; without it they are let go of
  bool has_dead_man = false, dead_man = true;      ///< a switch of its own, and whether it is held
  bool echoes = false;                             ///< it repeats in `echo` a number that every cycle changes
  std::uint16_t echo = 0;
  /// Another number whenever its program has begun anew, which a wire takes for a connection that is broken;
  /// 0: it does not say.
  std::uint64_t boot = 0;
};

struct WireAnswer {
  std::int64_t asked = 0;  ///< [ns] steady clock: when the request for the angles left
  DeviceStatus status;
  std::array<float, kAngleCount> angle{};  ///< [rad] in the order of hand.h
  std::uint32_t valid = 0;                 ///< bit i: angle i was measured
};

enum class WireOutcome : std::uint8_t {
  done,
  waiting,  ///< of greet and look_back: the device is not ready for it, and is asked again
  refused,  ///< the device lives and said no
  missed,   ///< no answer, which on this wire says nothing about the next one
  broken,   ///< what comes next on this connection can't be trusted: it is closed and opened again
};

struct WireResult {
  WireOutcome outcome = WireOutcome::done;
  std::string text;  ///< what went wrong
  [[nodiscard]] bool ok() const { return outcome == WireOutcome::done; }
};

/// How long an answer may take [s], counted from its request, whatever arrives in the meantime.
struct Patience {
  double usual = 0.05;
  double hurried = 0.05;        ///< once `hurry` says so, from then on
  std::function<bool()> hurry;  ///< asked every millisecond; may be empty
  [[nodiscard]] double limit() const { return hurry && hurry() ? hurried : usual; }
};

/// Called by one thread, that of the sink. Nothing may throw but std::bad_alloc.
class DeviceWire {
 public:
  virtual ~DeviceWire() = default;

  /// Connects. Where no device is (yet) it is called again, ever more seldom.
  virtual Status open() = 0;
  /// Tells the device, and waits for its answer no longer than `patience` says.
  virtual WireResult exchange(const WireCommand& command, WireAnswer& answer) = 0;
  virtual void close() = 0;

  // What a wire may do besides.

  /// After each open, again and again until it is done: what has to come before commands.
  virtual WireResult greet() { return {}; }
  /// What the device was told last, by whomever; those that can't be read stay as they are.
  virtual WireResult read_commands(ActuatorArray&) { return {}; }
  /// Between two exchanges: `foreign` if the device's commands are not those of the last one. Refused: it can
  /// never be told on this connection.
  virtual WireResult look_back(bool& foreign) {
    foreign = false;
    return {};
  }

  Patience patience;  ///< set by the sink, before every cycle
};

/// A local model's numbers (local_model.h).
struct LocalModel {
  double angle = 0, stiffness = 0, radius = 0;
};
/// Of actuator i. What the envelope has cut must not come back through the stiffness, and round an angle that
/// is no number there is none.
LocalModel local_model_of(const WireCommand& command, std::size_t i);

}  // namespace lumbrical
