// What came of many recordings or scenes: files with a line of JSON for each that is done.
#pragma once

#include <fstream>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "lumbrical/status.h"
#include "output.h"

namespace lumbrical::tool {

/// The entry of a list that a result is of: a replay's "recording", a session's "scene". Empty: it is none.
std::string entry_of(const Json& result);

/// An entry as results name it: JSON is UTF-8, so bytes of a path that are none are replaced.
std::string told_entry(const std::string& entry);

/// What became of an entry, by its result. A difference where bits are promised outweighs damage: what was
/// read there is not what was recorded.
struct Verdict {
  bool diverged = false, failed = false;
};
Verdict verdict_of(const Json& result);

/// Results in a file, a line each as soon as it is there, so that work that was cut short goes on where it
/// ended: a line is whole or counts as none.
class ResultLines {
 public:
  /// Keeps what the file has; a torn last line is cut off. Refuses a file that holds anything else, which
  /// stays as it is.
  Status open(const std::string& path);
  /// What the file already had of that entry; null: no result.
  [[nodiscard]] const Verdict* find(const std::string& entry) const;
  /// From any thread. `result` names its entry.
  Status add(const Json& result);

 private:
  std::string path_;
  std::ofstream file_;
  std::map<std::string, Verdict> done_;
  Status failure_;  // the first; nothing is written after it
  std::mutex mutex_;
};

/// Reads results, the newest of each entry, in the order of the entries' texts. Names file and line of
/// what is no result; a torn last line is left out.
Status read_results(const std::vector<std::string>& files, std::vector<Json>& results);

}  // namespace lumbrical::tool
