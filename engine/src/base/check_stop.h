// How whoever waits for a file ends the work on it.
#pragma once

#include <functional>

#include "lumbrical/status.h"

namespace lumbrical {

inline Status check_stop(const std::function<bool()>& stop) {
  return stop && stop() ? Status::error("stopped before all was done") : Status();
}

}  // namespace lumbrical
