// What is said of a file that could not be written, or not to its end.
#pragma once

#include <string>

#include "commands.h"
#include "lumbrical/ways_out.h"
#include "output.h"

namespace lumbrical::tool {

/// Answers kInterrupted where a signal has ended the work on `output`, and says so.
inline int fail_to_write(const std::string& output, const Status& status) {
  if (!stop_requested()) return fail(status);
  fail(output + ": stopped by a signal, and not written");
  return kInterrupted;
}

}  // namespace lumbrical::tool
