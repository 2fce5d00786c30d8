// A file being written: straight to the system without a buffer, and never half of one in the place of a good
// one.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "lumbrical/status.h"

namespace lumbrical {

/// Whether an OutputFile, here or in another process, has the open file open. False where the file system has
/// no locks.
bool is_being_written(int descriptor);

class OutputFile {
 public:
  enum class Place : std::uint8_t {
    beside_existing,  ///< grows at the path itself, unless a file is there already
    beside,           ///< always grows at path.part
  };

  OutputFile() = default;
  ~OutputFile();  ///< closes; what was written so far stays where it grew
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  Status open(const std::string& path, Place place);
  /// All of the bytes or an error; after an error an unknown part of them is in the file.
  Status write(std::span<const std::uint8_t> bytes);
  /// Cuts the file, which goes on from there.
  Status cut(std::uint64_t size);
  /// Puts the file at its path. Where it replaces another, it is on the disk before.
  Status commit();
  /// Removes what was written, unless it has been committed. A good file at the path stays.
  void discard();

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::string& growing_at() const { return growing_at_; }

 private:
  std::string path_, growing_at_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace lumbrical
