// What a device session carries from tick to tick beside its loop; device_session.cpp runs it,
// device_figures.cpp tells of it.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "device_session.h"
#include "lumbrical/device_guard.h"
#include "sink_uri.h"

namespace lumbrical::tool {

/// What a certificate is besides the bus's, as the end of a sentence about the index's proximal joint.
std::string own_delay_text(const DeviceProfile& profile);

struct DeviceSession::Told {
  SinkUri uri;
  DeviceProfile profile;
  const Model* model = nullptr;
  DeviceGuard guard;
  DeviceLoop loop;
  TickTimes loop_delays;

  // Tells people what happens while it happens.
  std::atomic<double> period{0}, jitter{0}, delay{0};  // of the certificate, for the reporter
  std::atomic<std::uint64_t> renewals{0};              // of the certificate, by a tenth or more
  std::uint64_t renewals_told = 0;
  std::int64_t opened = 0, timing_told = 0;
  std::thread reporter;
  std::atomic<bool> ending{false};
  std::vector<SinkEvent> events;

  void report();
  void tell(SinkEvent event);
  void tell_timing();
};

}  // namespace lumbrical::tool
