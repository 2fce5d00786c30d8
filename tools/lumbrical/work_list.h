// Many recordings to replay or scenes to run, on one machine or many: a list of them, a share of it, and what
// is left of that to do.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "command_line.h"
#include "lumbrical/status.h"
#include "output.h"

namespace lumbrical::tool {

struct WorkSwitches {
  std::string list, shard, results;
};

/// Adds --list, --shard and --results; `entry` is what a line of the list is: "recording", "scene"; `beside`
/// what may stand there too.
void add_work_switches(const std::string& entry, const std::string& beside, WorkSwitches& switches,
                       Command& command);

/// Adds the entries of a file, one per line ("-": standard input); empty lines are none.
Status read_list(const std::string& file, std::vector<std::string>& entries);

/// Adds those of the list to the entries that are there already, and leaves the shard's of them all.
Status choose_entries(const WorkSwitches& switches, std::vector<std::string>& entries);

/// What the work on an entry ends with, if need be the exception that ended it: one that takes more memory
/// than there is must not end the others.
template <class Work>
Status by_itself(const std::string& entry, const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return Status::error(entry + ": there is not enough memory for it");
  } catch (const std::exception& error) {
    return Status::error(entry + ": " + error.what());
  }
}

/// What came of one entry: a line of the results.
struct WorkResult {
  Json json;
  bool diverged = false, failed = false;
};

/// `entries` are those of this run; diverged and failed count what has a line from before, too: the answer is
/// of the whole share, however often it was begun.
struct WorkDone {
  std::uint64_t entries = 0, done_before = 0, diverged = 0, failed = 0;
};

/// Does, `jobs` at a time, what has no line among the results yet, and adds one for each as soon as it is
/// there. `doing` is what Progress shows. An error: the results can't be read or written, and what was still
/// to do is left.
Status work_through(const std::vector<std::string>& entries, const std::string& results, std::uint32_t jobs,
                    const std::string& doing, const std::function<WorkResult(const std::string&)>& work,
                    WorkDone& done);

}  // namespace lumbrical::tool
