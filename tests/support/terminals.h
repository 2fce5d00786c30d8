// Whether this machine has pseudo-terminals, which serial lines are tested with.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>

namespace lumbrical::test {

inline constexpr const char* kNoTerminals =
    "no pseudo-terminals here; mount them: mount -t devpts devpts /dev/pts -o ptmxmode=0666";

inline bool have_terminals() {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master < 0) return false;
  const char* const name = grantpt(master) == 0 && unlockpt(master) == 0 ? ptsname(master) : nullptr;
  const int line = name != nullptr ? open(name, O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;
  if (line >= 0) close(line);
  close(master);
  return line >= 0;
}

}  // namespace lumbrical::test
