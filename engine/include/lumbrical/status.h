// What a function answers when outside data or the machine may be at fault.
#pragma once

#include <string>
#include <utility>

namespace lumbrical {

/// Success, or one sentence that says where, what is wrong and what to do
/// ("mug.obj:17: vertex index 99 is out of range 1..8; re-export the mesh").
/// Must not be ignored; beside std::bad_alloc it is the engine's only error channel outside a tick.
class [[nodiscard]] Status {
 public:
  Status() = default;
  static Status error(std::string message) {
    Status status;
    status.message_ = message.empty() ? "unknown error" : std::move(message);
    return status;
  }
  [[nodiscard]] bool ok() const { return message_.empty(); }
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  std::string message_;  // empty means success
};

}  // namespace lumbrical
