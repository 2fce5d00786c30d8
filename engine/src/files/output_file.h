// A file being written: straight to the system without a buffer, by one writer, in the place of none that is
// there.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "lumbrical/status.h"

namespace lumbrical {

/// Whether an OutputFile, here or in another process, has the open file open. False where the file system has
/// no locks.
bool is_being_written(int descriptor);

/// What a file is called until it is complete: its path and this.
inline constexpr const char* kPartSuffix = ".part";

/// Grows as path.part and takes its path when it is complete. A path that exists is refused, and so is one
/// whose .part exists: another writer is at it, or was killed and left all there is of its work.
class OutputFile {
 public:
  OutputFile() = default;
  ~OutputFile();  ///< closes; what was written so far stays where it grew
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  Status open(const std::string& path);
  /// All of the bytes or an error; after an error an unknown part of them is in the file.
  Status write(std::span<const std::uint8_t> bytes);
  /// Cuts the file, which goes on from there.
  Status cut(std::uint64_t size);
  /// What was written so far, and the name it has, outlive a power cut.
  Status sync();
  /// Puts the file at its path, on the disk before it has that name. An error where another has come there.
  /// After any other the file may stand at its path all the same, whole: then only the name may not outlive a
  /// power cut.
  Status commit();
  /// Removes what was written, unless it has been committed.
  void discard();

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::string& growing_at() const { return growing_at_; }

 private:
  std::string path_, growing_at_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  bool name_synced_ = false;
};

/// Opens an Output at `path`, lets `write(out)` fill it and closes it; where any of that fails, or memory is
/// wanting, nothing is left of it but what stands at `path` whole (OutputFile::commit).
template <class Output, class Write>
Status write_whole(const std::string& path, const Write& write) {
  Output out;
  if (Status status = out.open(path); !status.ok()) return status;
  try {
    Status status = write(out);
    if (status.ok()) status = out.close();
    if (!status.ok()) out.discard();
    return status;
  } catch (...) {
    out.discard();
    throw;
  }
}

}  // namespace lumbrical
