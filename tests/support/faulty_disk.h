// A disk that fails or stalls on command: the program's own write, ftruncate, fsync and rename stand before
// the system's, for files under a chosen path.
#pragma once

#include <cstdint>
#include <string>

namespace lumbrical::test {

/// What happens to files whose path begins with `path`, while this lives. One at a time.
class FaultyDisk {
 public:
  explicit FaultyDisk(const std::string& path);
  ~FaultyDisk();  ///< releases what is held
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  /// The write that begins after `bytes` more bytes, and every later one, fails with `error`; one across that
  /// boundary is cut short.
  void fail_after(std::uint64_t bytes, int error);
  void fail_cuts(int error);
  void fail_syncs(int error);
  void fail_renames(int error);
  /// From now on no write returns before release().
  void hold();
  void release();
  /// Waits until a write is held.
  void wait_until_held() const;
  /// Bytes written so far.
  [[nodiscard]] std::uint64_t written() const;
};

}  // namespace lumbrical::test
