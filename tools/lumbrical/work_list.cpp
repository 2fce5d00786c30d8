// See work_list.h.
#include "work_list.h"

#include <charconv>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>

#include "lumbrical/batch.h"
#include "result_lines.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

// Share `index` of `count`, counted from 1: entries index - 1, index - 1 + count, ... of a list.
struct Shard {
  std::size_t index = 1, count = 1;
};

bool parse_shard(const std::string& text, Shard& shard) {
  const char *const first = text.data(), *const last = first + text.size();
  const auto [middle, error] = std::from_chars(first, last, shard.index);
  if (error != std::errc() || middle == last || *middle != '/') return false;
  const auto [end, second] = std::from_chars(middle + 1, last, shard.count);
  return second == std::errc() && end == last && shard.index >= 1 && shard.index <= shard.count &&
         shard.count <= 1000000;
}

Check is_shard() {
  return {[](std::string& text) -> std::string {
            Shard shard;
            if (parse_shard(text, shard)) return {};
            return "\"" + text + "\" is not I/N with 1 <= I <= N, 3/100 say";
          },
          "I/N"};
}

// Results could not keep them apart.
Status check_told_apart(const std::vector<std::string>& entries) {
  std::map<std::string, std::string> named;
  for (const std::string& entry : entries) {
    const auto [other, is_new] = named.emplace(told_entry(entry), entry);
    if (!is_new && other->second != entry)
      return Status::error("two entries of the list are both told as \"" + other->first +
                           "\", since their names are no UTF-8; rename one");
  }
  return {};
}

std::vector<std::string> share_of(const std::vector<std::string>& entries, const Shard& shard) {
  std::vector<std::string> share;
  for (std::size_t i = shard.index - 1; i < entries.size(); i += shard.count) share.push_back(entries[i]);
  return share;
}

}  // namespace

void add_work_switches(const std::string& entry, const std::string& beside, WorkSwitches& switches,
                       Command& command) {
  command
      .add_option("--list", switches.list, "A file with a " + entry + beside + " per line, -: standard input")
      ->check(is_path())
      ->type_name("LIST|-");
  command.add_option("--shard", switches.shard, "Of all these only the Ith, I+Nth, ...: for many machines")
      ->check(is_shard())
      ->type_name("I/N");
  command
      .add_option("--results", switches.results,
                  "Write a line of JSON per " + entry + ", and leave out those that have one there already")
      ->check(is_file())
      ->type_name("RESULTS.jsonl");
}

Status read_list(const std::string& file, std::vector<std::string>& entries) {
  std::ifstream opened;
  if (file != "-") opened.open(file);
  std::istream& list = file == "-" ? std::cin : opened;
  if (!list) return Status::error(file + ": can't be read");
  for (std::string line; std::getline(list, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (!line.empty()) entries.push_back(line);
  }
  return list.bad() ? Status::error(file + ": can't be read to its end; name a file with an entry per line")
                    : Status();
}

Status choose_entries(const WorkSwitches& switches, std::vector<std::string>& entries) {
  if (!switches.list.empty())
    if (Status status = read_list(switches.list, entries); !status.ok()) return status;
  if (Status status = check_told_apart(entries); !status.ok()) return status;
  Shard shard;
  if (!switches.shard.empty()) parse_shard(switches.shard, shard);
  entries = share_of(entries, shard);
  return {};
}

Status work_through(const std::vector<std::string>& entries, const std::string& results, std::uint32_t jobs,
                    const std::string& doing, const std::function<WorkResult(const std::string&)>& work,
                    WorkDone& done) {
  ResultLines lines;
  if (Status status = lines.open(results); !status.ok()) return status;
  std::vector<std::string> left;
  for (const std::string& entry : entries) {
    if (const Verdict* const before = lines.find(entry)) {
      done.diverged += before->diverged ? 1 : 0;
      done.failed += before->failed ? 1 : 0;
    } else {
      left.push_back(entry);
    }
  }
  done.done_before = entries.size() - left.size();
  Progress progress(doing);
  std::mutex mutex;
  Status written;
  const auto can_be_kept = [&] {
    const std::lock_guard lock(mutex);
    return written.ok();
  };
  run_jobs(left.size(), jobs, [&](std::size_t i) {
    if (!can_be_kept()) return;
    const WorkResult result = work(left[i]);
    Status status = lines.add(result.json);
    const std::lock_guard lock(mutex);
    if (!status.ok()) written = std::move(status);
    done.diverged += result.diverged ? 1 : 0;
    done.failed += result.failed ? 1 : 0;
    progress.update(++done.entries, left.size());
  });
  return written;
}

}  // namespace lumbrical::tool
