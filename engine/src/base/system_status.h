// What the operating system refuses, and why.
#pragma once

#include <cerrno>
#include <string>
#include <system_error>

#include "lumbrical/status.h"

namespace lumbrical {

/// An error of the file `path`: what failed ("cannot be written") and the system's reason for it, an errno.
inline Status system_status(const std::string& path, const std::string& what, int error) {
  return Status::error(path + ": " + what + ": " + std::generic_category().message(error));
}

/// Of a file that was to be read; of one that is not there in plain words.
inline Status unreadable(const std::string& path, int error) {
  if (error == ENOENT) return Status::error(path + ": there is no such file; check the path");
  return Status::error(path + ": can't be read (" + std::generic_category().message(error) +
                       "); check the name and your permission to read it");
}

}  // namespace lumbrical
