// The address of a device as users write it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lumbrical/device_profile.h"
#include "lumbrical/status.h"

namespace lumbrical::tool {

struct SinkUri {
  std::string profile;       ///< file
  std::optional<Side> side;  ///< none: the profile's
  bool serial = false;
  std::string host, line;
  int port = -1, baud = -1, unit = -1;  ///< -1: the profile's
  double rate = 0;                      ///< [Hz] 0: the profile's
  bool anywhere = false;                ///< network=any; or the profile says so
  bool feedback = true, stop_on_loss = false, dry_run = false, limiter = true, observer = true, local = true;
  bool guard = true;        ///< a process that lets go of the device when this one is killed
  bool unattended = false;  ///< unattended=accepted; or the profile says so
};

/// Parts "host:port", "host", "[::1]:port" or, if `alone_is_port`, "port" into host, which stays as it is
/// where there is none, and port, which may be any text. False: no such form.
bool split_host(std::string_view text, bool alone_is_port, std::string& host, std::string_view& port);

Status parse_sink_uri(const std::string& text, SinkUri& uri);

/// Reads the profile and puts in what the URI says.
Status load_profile(const SinkUri& uri, DeviceProfile& profile);

}  // namespace lumbrical::tool
