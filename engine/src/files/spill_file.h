// A file without a name for what does not fit in memory: gone with its owner, or with the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>

#include "lumbrical/status.h"

namespace lumbrical {

class SpillFile {
 public:
  /// Creates it in the folder of `path`, which names it in messages.
  Status open(const std::string& path);
  Status append(std::span<const std::byte> bytes);
  /// From anywhere in what was appended; nothing may be appended afterwards.
  Status read(std::uint64_t offset, std::span<std::byte> bytes);
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  [[nodiscard]] Status failed(const char* what) const;

  std::string path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, &std::fclose};
  std::uint64_t size_ = 0;
};

}  // namespace lumbrical
