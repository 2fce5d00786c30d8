// The loop with a device, for whoever ticks: what `lumbrical run --sink` does, and its only way of doing it.
//
//   DeviceLoop loop;
//   loop.open(model, profile, wire, settings)     the device may be there or come later
//   loop.measure(model, scratch, frame, 0.5)      without forces: how slow is the bus, how stiff may it be?
//   loop.start(model, scratch, frame)             after enter_real_time: forces may flow
//   while (loop.step(model, state, scratch, step))  a tick, at the moments of a Pace (real_time.h)
//   loop.close()                                  forces fade, the device says so
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "lumbrical/device_sink.h"
#include "lumbrical/haptic_loop.h"
#include "lumbrical/tick.h"

namespace lumbrical {

struct LoopSettings {
  LoopOptions control;
  /// Its thread: with one, forces fade when the ticks stop; without one, step() makes the exchanges. `arm`
  /// is start()'s.
  SinkOptions sink;
  bool stop_on_loss = false;  ///< a device that is lost, or never came, ends the session
};

/// What is worth telling of a session.
struct LoopFigures {
  bool was_active = false;             ///< forces reached the device
  bool other_master = false;           ///< someone else commands it
  bool never_measured = false;         ///< it has no sensors, so the limiter lets no force of angles through
  std::int64_t armed_at = 0;           ///< [ns] 0: not yet
  std::uint64_t renewals = 0;          ///< of the certificate, by a tenth or more
  std::uint64_t blind_steps = 0;       ///< since start(), without angles to go by
  std::uint64_t doubted_steps = 0;     ///< of them, with angles that could not be
  std::uint32_t doubts = 0;            ///< DeviceFlag bits of those
  double oldest = 0;                   ///< [s] age of the newest acknowledged command, at most
  std::int64_t last_acknowledged = 0;  ///< [ns]
  SinkReport last;                     ///< when close() was called
  bool safe_at_end = false;            ///< the device has acknowledged safe values
};

class DeviceLoop {
 public:
  DeviceLoop() = default;
  ~DeviceLoop() { close(); }
  DeviceLoop(const DeviceLoop&) = delete;
  DeviceLoop& operator=(const DeviceLoop&) = delete;

  /// Starts the sink; does not wait for the device. Once closed it may be opened again. Refused: a device
  /// that drives the other hand (DeviceProfile::side), and one that a sink with a thread would tell nothing,
  /// since commands fade before the next tick (SafetyTimes::tick_hold).
  Status open(const Model& model, const DeviceProfile& profile, std::unique_ptr<DeviceWire> wire,
              const LoopSettings& settings);

  /// Steps without forces for `seconds`, by the clock, with the hand as `frame` has it; then makes the
  /// certificate, of what was measured or for want of a device of what has to be assumed. False: a stop was
  /// requested (ways_out.h).
  bool measure(const Model& model, Scratch& scratch, const DeviceFrame& frame, double seconds);

  /// Last of all, after everything else that may take its time: from now on a tick that does not come is a
  /// fault. Forgets what was measured (nothing had real-time priority yet), computes the first ticks, which
  /// meet cold caches, and lets the device be armed. False as above.
  bool start(const Model& model, Scratch& scratch, const DeviceFrame& frame);

  /// One step (haptic_loop.h). False: the session shall end, because `tick` says so, the device is lost and
  /// LoopSettings::stop_on_loss, or another master drives it.
  template <class Tick>
  bool step(const Model& model, Scratch& scratch, Tick&& tick, LoopStep& step) {
    return step_loop(model, scratch, tick, sink, control, step) && look_after(step);
  }
  bool step(const Model& model, State& state, Scratch& scratch, LoopStep& step);

  /// Whether start() has let the device be armed; from any thread. Who arms it before makes the start of the
  /// session, which takes its time, a loss of ticks.
  [[nodiscard]] bool started() const { return started_; }

  /// Fades, tells the device, ends the sink's thread. True: the device has acknowledged safe values.
  bool close();

  // To be read; the sink's requests may be made by any thread.
  HapticLoop control;
  DeviceSink sink;
  LoopFigures figures;

 private:
  bool look_after(const LoopStep& step);
  bool lost(SafetyState now) const;
  bool step_unarmed(const Model& model, Scratch& scratch, const DeviceFrame& frame, double seconds);

  LoopSettings settings_;
  bool open_ = false;
  std::atomic<bool> started_{false};
};

}  // namespace lumbrical
