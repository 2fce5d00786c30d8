// Triangles in the order of their cells, however many: runs that fit in memory are sorted and written to a
// file, then merged (Knuth, The art of computer programming 3, section 5.4).
#pragma once

#include <cstdint>
#include <vector>

#include "files/spill_file.h"

namespace lumbrical {

struct CellEntry {
  std::uint64_t cell = 0;
  std::uint32_t triangle = 0, unused = 0;
};

class CellSort {
 public:
  /// Keeps up to `memory` [bytes, at least 64 KiB] of entries; more go to a spill file at `path`.
  Status open(const std::string& path, std::size_t memory);
  Status add(const CellEntry& entry);
  /// Once all are added, before the first next().
  Status merge();
  /// By cell, then by triangle. `end`: there was none left.
  Status next(CellEntry& entry, bool& end);

 private:
  struct Run {
    std::uint64_t offset = 0;  // in the file, of what is not in `entries` yet
    std::uint64_t left = 0;    // entries there
    std::vector<CellEntry> entries;
    std::size_t at = 0;
  };
  Status spill();
  Status refill(Run& run);
  [[nodiscard]] bool is_later(std::size_t a, std::size_t b) const;  // of two runs, for the heap

  std::size_t capacity_ = 0;  // entries
  std::vector<CellEntry> entries_;
  SpillFile file_;
  std::vector<Run> runs_;
  std::vector<std::size_t> heap_;  // runs that are not at their end, the one with the least entry first
};

}  // namespace lumbrical
