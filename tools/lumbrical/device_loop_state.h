// What a device loop carries from tick to tick; device_loop.cpp runs it, device_figures.cpp tells of it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "device_guard.h"
#include "device_loop.h"
#include "lumbrical/haptic_loop.h"
#include "lumbrical/modbus_sink.h"
#include "sink_uri.h"

namespace lumbrical::tool {

struct DeviceLoop::Loop {
  SinkUri uri;
  DeviceProfile profile;
  const Model* model = nullptr;
  HapticLoop control;

  DeviceGuard guard;
  ModbusSink sink;

  // Figures.
  TickTimes loop_delays;
  std::int64_t last_acknowledged = 0;
  bool was_active = false, other_master = false;
  std::int64_t armed_at = 0;
  std::uint64_t blind_ticks = 0;    // since then, without angles to go by
  std::uint64_t doubted_ticks = 0;  // of them, with angles that could not be
  std::uint32_t doubts = 0;         // DeviceFlag bits of those
  double oldest = 0;

  // Tells people what happens while it happens.
  std::atomic<double> period{0}, jitter{0}, delay{0};  // of the certificate, for the reporter
  std::atomic<std::uint64_t> renewals{0};              // of the certificate, by a tenth or more
  std::uint64_t renewals_told = 0;
  std::int64_t opened = 0, timing_told = 0;
  std::thread reporter;
  std::atomic<bool> ending{false};
  std::vector<SinkEvent> events;
  SinkReport last;
  bool safe_at_end = false;

  void report();
  void tell(SinkEvent event);
  void tell_timing();
  void note(const SentCommand& sent);
  bool lost(SafetyState now) const;
};

}  // namespace lumbrical::tool
