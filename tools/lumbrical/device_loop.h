// A device in the loop of `lumbrical run`: its angles in, torques out, limited to what the certificate
// allows.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lumbrical/recording.h"
#include "lumbrical/tick.h"
#include "output.h"

namespace lumbrical::tool {

/// What is wrong with a sink's URI; empty if nothing is.
///   null
///   modbus-tcp://HOST[:PORT]?profile=FILE&...
///   modbus-rtu:///dev/ttyX?profile=FILE&baud=N&...
/// with feedback=on|off (do the device's angles move the hand?), on-loss=continue|stop, dry-run=on|off,
/// limiter=on|off, observer=on|off, local=on|off (where the device has a local model), rate=HZ, unit=ID.
std::string check_sink_uri(std::string& uri);

class DeviceLoop {
 public:
  DeviceLoop();
  ~DeviceLoop();
  DeviceLoop(const DeviceLoop&) = delete;
  DeviceLoop& operator=(const DeviceLoop&) = delete;

  /// Reads the profile, starts the sink. Does not wait for the device. It drives one hand of the session,
  /// that of `models[hand]`; refused where that can't be told, or is of the wrong side.
  Status open(const std::string& uri, const std::vector<Model>& models, std::size_t& hand);

  /// Before a tick: `frame` comes from the motion; the device's angles take the place of the motion's.
  void before(DeviceFrame& frame);
  /// After it: forces to the device, and what was sent meanwhile into the record. False: the session shall
  /// end (on-loss=stop, or another master drives the device). Neither locks, allocates nor calls the system
  /// except for the clock.
  bool after(const Scratch& scratch, const DeviceFrame& frame, const ActuatorFrame& output,
             TickRecord& record);

  /// Makes the certificate of what was measured since open(), or assumed if no device answered.
  void certify();
  /// Lets the device be armed; after everything else that may take its time.
  void arm();
  /// Forgets what was measured: until now nothing had real-time priority.
  void measure_again();
  /// The certificate and the profile's name as text for a recording's metadata.
  [[nodiscard]] std::string certificate_text() const;

  /// Fades, tells the device, ends the sink's thread. Call before json() and add_rows().
  void close();
  /// Whether the session ended with forces reaching the device, where they were meant to.
  [[nodiscard]] bool forces_flow() const;
  /// What went wrong with the device, a sentence each, the worst first; empty if nothing did.
  [[nodiscard]] std::vector<std::string> trouble() const;
  /// Ticks since arm() whose angles were missing, or not believed.
  [[nodiscard]] std::uint64_t ticks_without_angles() const;
  [[nodiscard]] Json json() const;
  void add_rows(Table& table) const;

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace lumbrical::tool
