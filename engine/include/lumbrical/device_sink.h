// The sink that carries commands to a device and its angles back over some wire: behind the safety envelope,
// of commands the newest only, on a thread of its own if asked.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lumbrical/device_link.h"
#include "lumbrical/device_wire.h"
#include "lumbrical/status.h"

namespace lumbrical {

struct SinkEvent {
  double time = 0;  ///< [s] since the sink was opened
  std::string text;
};

struct SinkReport {
  SafetyState state = SafetyState::disconnected;
  std::uint32_t flags = 0;
  double rate = 0;           ///< [Hz] acknowledged commands in the last second
  double age = 0;            ///< [s] since the last acknowledged command; infinite before the first
  std::uint64_t cycles = 0;  ///< commands sent
  std::uint64_t acknowledged = 0;
  std::uint64_t refused = 0;      ///< answered by an exception
  std::uint64_t broken = 0;       ///< not answered, or not by a reply one could trust
  std::uint64_t connections = 0;  ///< opened so far
  std::uint64_t losses = 0;       ///< of a device that was armed
  std::uint64_t lapses = 0;       ///< times one that was armed was not ready any more
  std::uint64_t faults = 0;       ///< latched so far
  std::string trouble;            ///< what last kept forces from the device, in words; empty: nothing yet
};

struct SinkOptions {
  /// Cycles on a thread of its own, so that a wire that takes its time never holds up the ticks, and forces
  /// fade when the ticks stop. Without it each cycle() exchanges, and when no one calls it any more only the
  /// device's own watchdog lets go.
  bool thread = false;
  bool arm = true;  ///< arm by itself when the device is first ready (arm_when_ready)
  /// And again after a lost link, or when it is ready again; otherwise stay idle until request_arm.
  bool continue_after_loss = true;
  bool dry_run = false;  ///< everything but forces: only safe values are written
  /// Begins at what the device was told last, as far as that can be read, and without its handshake: to fade
  /// what another left.
  bool take_over = false;
  int priority = 0;  ///< SCHED_FIFO of that thread, 0: leave it alone
  int cpu = -1;      ///< to pin it to, -1: any
};

class DeviceSink final : public DeviceLink {
 public:
  DeviceSink();
  ~DeviceSink();  ///< closes
  DeviceSink(const DeviceSink&) = delete;
  DeviceSink& operator=(const DeviceSink&) = delete;

  /// A device that is not there (yet) is no error: the sink keeps trying. Refuses a profile whose parts
  /// don't agree, and forces on a device that would not notice the end of them (check_attended). Once closed
  /// it may be opened again: as a new one, without events, requests and pressed stop of the one before.
  Status open(const DeviceProfile& profile, std::unique_ptr<DeviceWire> wire, const SinkOptions& options);
  /// Without a thread: one exchange, unless the profile's rate says that it is too early for it. Takes as
  /// long as the wire does.
  void cycle();
  /// Forces to their safe values, tells the device so if it can be reached, ends the thread. True: the device
  /// acknowledged safe values. Takes at most fade, answer and response times and a little, but as long as the
  /// system does where a host is being looked for by its name.
  bool close();

  // For the thread that ticks (one thread): no lock, allocation or system call but the clock.
  [[nodiscard]] std::int64_t now() const noexcept override;
  void publish(const DeviceCommand& command) noexcept override;
  bool feedback(DeviceFeedback& feedback) noexcept override;
  bool sent(SentCommand& command) noexcept override;

  // From any thread.
  /// As soon as there is a device that is ready and a fresh tick; once, and no longer if it is disarmed or a
  /// fault latches before. What resets a fault is asked for first.
  void arm_when_ready() noexcept;
  void request_arm() noexcept;
  void request_disarm() noexcept;
  void request_reset() noexcept;
  void press_stop(bool pressed) noexcept;  ///< safe in a signal handler
  void hold_dead_man(bool held) noexcept;  ///< counts where the device has no such switch; held at first
  [[nodiscard]] SafetyState state() const noexcept;
  [[nodiscard]] bool is_safe() const noexcept;  ///< the device has acknowledged safe values last
  [[nodiscard]] SinkReport report() const;
  void tell(std::string text);  ///< an event of whoever drives it, among its own
  /// What happened since the last call: connections, losses, transitions. At most 1000 are kept.
  std::vector<SinkEvent> events();

 private:
  struct Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace lumbrical
