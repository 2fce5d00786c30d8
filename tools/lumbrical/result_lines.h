// Many recordings, on one machine or many: a list of them, a share of it, and a line of JSON for each that is
// done.
#pragma once

#include <cstdint>
#include <fstream>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "lumbrical/status.h"
#include "output.h"

namespace lumbrical::tool {

/// Reads a path per line ("-": standard input); empty lines are none.
Status read_list(const std::string& file, std::vector<std::string>& paths);

/// Share `index` of `count`, counted from 1: entries index - 1, index - 1 + count, ... of a list.
struct Shard {
  std::size_t index = 1, count = 1;
};
/// "I/N", 1 <= I <= N <= 1000000. False: it is none.
bool parse_shard(const std::string& text, Shard& shard);
std::vector<std::string> share_of(const std::vector<std::string>& paths, const Shard& shard);

/// Results in a file, a line each as soon as it is there, so that work that was cut short goes on where it
/// ended: a line is whole or counts as none.
class ResultLines {
 public:
  /// Keeps what the file has; a torn last line is cut off.
  Status open(const std::string& path);
  /// Whether the file already has a result of that recording.
  [[nodiscard]] bool has(const std::string& recording) const { return done_.contains(recording); }
  /// From any thread. `result` names its "recording".
  Status add(const Json& result);

 private:
  std::string path_;
  std::ofstream file_;
  std::set<std::string> done_;
  std::mutex mutex_;
};

/// Reads results, the newest of each recording, in the order of the recordings' names. Names file and line of
/// what is no result; a torn last line is left out.
Status read_results(const std::vector<std::string>& files, std::vector<Json>& results);

}  // namespace lumbrical::tool
