// A process of its own that outlives a session which is killed, and then lets go of the device.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "lumbrical/status.h"

namespace lumbrical {

/// Started before the device is. It waits for the end of the pipe that only this process holds: if that comes
/// without dismiss(), it opens a connection of its own and fades what the device was told last:
/// SinkOptions::take_over, as `lumbrical guard SINK` does. It is in a session of its own, so that what kills
/// this one's process group spares it.
class DeviceGuard {
 public:
  DeviceGuard() = default;
  ~DeviceGuard();  ///< without dismiss(): the guard acts
  DeviceGuard(const DeviceGuard&) = delete;
  DeviceGuard& operator=(const DeviceGuard&) = delete;

  /// `command`: the program, by its path, and its arguments. It reads the pipe as its standard input, and has
  /// 5 s to say there that it stands guard (bereaved); otherwise, or if it ends before, there is no guard.
  Status start(std::vector<std::string> command);
  void dismiss();  ///< the device is at safe values: the guard ends

 private:
  int pipe_ = -1;
  pid_t process_ = -1;
};

/// In that program, once it has all that it needs to reach the device: says so, by a byte written to its
/// standard input, which is a socket, and waits for the end of the pipe. True: it came without dismiss().
bool bereaved();

}  // namespace lumbrical
