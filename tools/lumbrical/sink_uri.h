// The address of a device as users write it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "lumbrical/device_profile.h"
#include "lumbrical/device_wire.h"
#include "lumbrical/status.h"

namespace lumbrical::tool {

struct SinkUri {
  std::string profile;       ///< file
  std::optional<Side> side;  ///< none: the profile's
  TransportKind kind = TransportKind::tcp;
  std::string host, line, region;
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

/// What is wrong with a sink's URI; empty if nothing is.
///   null
///   modbus-tcp://HOST[:PORT]?profile=FILE&...
///   modbus-rtu:///dev/ttyX?profile=FILE&baud=N&...
///   udp://HOST:PORT?profile=FILE&...
///   memory:///NAME?profile=FILE&...
/// with feedback=on|off (do the device's angles move the hand?), on-loss=continue|stop, dry-run=on|off,
/// limiter=on|off, observer=on|off, local=on|off (where the device has a local model), side=left|right,
/// network=any|private (whose address the device may have), guard=on|off (see SinkUri),
/// unattended=accepted|refused (a device that does not notice when its driver ends), rate=HZ, unit=ID.
std::string check_sink_uri(std::string& uri);

/// Reads the profile and puts in what the URI says.
Status load_profile(const SinkUri& uri, DeviceProfile& profile);

/// A profile on another transport than it was made for: it may lack what that one needs.
Status move_to_transport(TransportKind kind, DeviceProfile& profile);

/// The wire of a profile's transport.
Status make_wire(const DeviceProfile& profile, std::unique_ptr<DeviceWire>& wire);

}  // namespace lumbrical::tool
