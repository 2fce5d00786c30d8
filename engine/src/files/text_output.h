// Text on its way to a file that appears when it is complete, or to standard output.
#pragma once

#include <cerrno>
#include <cstdio>
#include <string>
#include <string_view>

#include "files/output_file.h"

namespace lumbrical {

class TextOutput {
 public:
  Status open(const std::string& path) {
    to_file_ = path != "-";
    return to_file_ ? file_.open(path) : Status{};
  }
  Status line(std::string_view text) {
    text_ += text;
    text_ += '\n';
    return text_.size() < kBufferSize ? Status{} : flush();
  }
  Status close() {
    if (Status status = flush(); !status.ok()) return status;
    if (to_file_) return file_.commit();
    return std::fflush(stdout) == 0 ? Status{} : standard_output_failed();
  }
  /// False once whoever read standard output through a pipe has closed it: that is no failure, and an end.
  [[nodiscard]] bool wanted() const { return wanted_; }
  void discard() { file_.discard(); }

 private:
  static constexpr std::size_t kBufferSize = 1u << 16;

  Status standard_output_failed() {
    wanted_ = errno != EPIPE;
    return wanted_ ? Status::error("standard output: cannot be written; is the disk full?") : Status{};
  }
  Status flush() {
    Status status;
    if (to_file_) {
      status = file_.write({reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size()});
    } else if (std::fwrite(text_.data(), 1, text_.size(), stdout) != text_.size()) {
      status = standard_output_failed();
    }
    text_.clear();
    return status;
  }

  bool to_file_ = false, wanted_ = true;
  OutputFile file_;
  std::string text_;
};

}  // namespace lumbrical
