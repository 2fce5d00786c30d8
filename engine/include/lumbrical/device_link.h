// What crosses between the thread that ticks and a device's sink. Times are nanoseconds of the steady clock
// (clock_ns of real_time.h).
#pragma once

#include <array>
#include <cstdint>

#include "lumbrical/safety.h"

namespace lumbrical {

struct DeviceCommand {
  std::uint64_t tick = 0;
  std::int64_t feedback_time = 0;                ///< DeviceFeedback::asked of the angles behind it; 0: none
  ActuatorArray wanted{};                        ///< in the actuators' units
  ActuatorArray angle{}, stiffness{}, radius{};  ///< local model, for actuators that have one
};

struct DeviceFeedback {
  std::int64_t asked = 0;                  ///< when the request left: the angles may be as old as that
  std::int64_t time = 0;                   ///< when the reply came: they are no newer
  std::int64_t held_since = 0;             ///< `time` of the first one since the device let go last; 0: never
  std::array<float, kAngleCount> angle{};  ///< [rad] in the order of hand.h
  std::uint32_t valid = 0;                 ///< bit i: angle i was measured and is plausible
  std::uint32_t flags = 0;                 ///< DeviceFlag bits: why others are not
  /// What the device did while it came to these angles: the command acknowledged before, or its safe values
  /// where it had let go of that.
  ActuatorArray acted{};
};

/// What became of one cycle: what was sent, when, and when the device said so. A cycle in which
/// nothing could be sent is reported only if state or flags changed in it; it has no values and `sent` is 0.
struct SentCommand {
  std::uint64_t cycle = 0;        ///< counts from 1, those that sent something
  std::uint64_t tick = 0;         ///< of the newest command behind it
  std::int64_t sent = 0;          ///< when the request left; 0: nothing was sent
  std::int64_t acknowledged = 0;  ///< when its reply came; 0: never
  std::int64_t loop_delay = 0;    ///< [ns] from asking for the angles behind it to its reply; 0: unknown
  SafetyState state = SafetyState::disconnected;
  std::uint32_t flags = 0;  ///< SafetyFlag bits
  std::uint32_t actuator_count = 0;
  ActuatorArray value{};  ///< as sent
};

/// Most exchanges that a tick keeps for its recording, the newest; the loop notes all of them.
inline constexpr std::uint32_t kMaxSentPerTick = 4;

/// What a loop has of a device: a sink (DeviceSink), or a simulation in its own time. None of these waits.
class DeviceLink {
 public:
  [[nodiscard]] virtual std::int64_t now() const noexcept = 0;  ///< [ns] by the clock of the times above
  /// The next one not yet asked for; false: none. Ask until then: the last one is the newest.
  virtual bool feedback(DeviceFeedback& feedback) noexcept = 0;
  virtual bool sent(SentCommand& command) noexcept = 0;  ///< likewise
  virtual void publish(const DeviceCommand& command) noexcept = 0;

 protected:
  DeviceLink() = default;
  ~DeviceLink() = default;
  DeviceLink(const DeviceLink&) = default;
  DeviceLink& operator=(const DeviceLink&) = default;
};

}  // namespace lumbrical
