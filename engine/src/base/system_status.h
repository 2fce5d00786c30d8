// What the operating system refuses, in its own words.
#pragma once

#include <string>
#include <system_error>

#include "lumbrical/status.h"

namespace lumbrical {

/// An error of the file `path`: what failed ("cannot be opened") and the system's reason for it, an errno.
inline Status system_status(const std::string& path, const std::string& what, int error) {
  return Status::error(path + ": " + what + ": " + std::generic_category().message(error));
}

}  // namespace lumbrical
