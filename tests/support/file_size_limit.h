// A limit of the system's own to the size of files, which is as good as a full disk.
#pragma once

#include <sys/resource.h>

#include <csignal>

namespace lumbrical::test {

/// While it lives this process may write no file longer than that.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    is_set_ = ::setrlimit(RLIMIT_FSIZE, &limit) == 0;
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  [[nodiscard]] bool is_set() const { return is_set_; }

 private:
  void (*handler_)(int);
  rlimit before_{};
  bool is_set_ = false;
};

}  // namespace lumbrical::test
