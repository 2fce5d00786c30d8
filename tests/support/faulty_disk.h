// A disk that fails or stalls on command: the program's own write, ftruncate, fsync and renameat2 stand
// before the system's, for files under a chosen path.
#pragma once

#include <cstdint>
#include <string>

namespace lumbrical::test {

/// What of the files outlives a power cut: what the disk was told to keep.
struct Kept {
  std::uint64_t bytes = 0;           ///< of the file, at the last order to keep it
  std::uint64_t syncs = 0;           ///< such orders
  bool part = false, whole = false;  ///< names: path.part, path
  bool renamed_unsynced = false;     ///< it took its path when its last bytes might still have been lost
};

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
  [[nodiscard]] Kept kept() const;
  /// Bytes written so far.
  [[nodiscard]] std::uint64_t written() const;
};

}  // namespace lumbrical::test
