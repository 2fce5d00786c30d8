// See result_lines.h.
#include "result_lines.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <map>
#include <system_error>

namespace lumbrical::tool {
namespace {

// What a run that was killed leaves of a line: the start of a result, or all of it but the line's end.
bool is_torn(const std::string& line, const Json& parsed) {
  return line.starts_with('{') && (parsed.is_discarded() || !entry_of(parsed).empty());
}

// A file, or a pipe: devices have no end.
bool has_an_end(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::file_status kind = std::filesystem::status(path, ignored);
  return std::filesystem::is_regular_file(kind) || std::filesystem::is_fifo(kind);
}

// Of a result or a hand in it: whatever is there of what is counted has its type.
bool can_be_counted(const Json& result) {
  const auto is = [&result](const char* key, const auto& has_type) {
    const auto found = result.find(key);
    return found == result.end() || has_type(*found);
  };
  const auto is_count = [](const Json& ticks) { return ticks.is_number_unsigned(); };
  const auto is_flag = [](const Json& flag) { return flag.is_boolean(); };
  const auto are_hands = [](const Json& hands) {
    return hands.is_array() && std::all_of(hands.begin(), hands.end(), can_be_counted);
  };
  const auto is_what_if = [](const Json& what_if) { return what_if.is_object() && can_be_counted(what_if); };
  return result.is_object() && is("ticks", is_count) && is("identical", is_flag) && is("hands", are_hands) &&
         is("what_if", is_what_if);
}

// `whole`: the bytes of the lines that have an end.
Status read_lines(const std::string& path, std::map<std::string, Json>& results, std::uintmax_t& whole) {
  std::ifstream file;
  if (has_an_end(path)) file.open(path, std::ios::binary);
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    Json result = parse_json(line);
    if (file.eof() && is_torn(line, result)) return {};
    const std::string entry = entry_of(result);
    if (file.eof() || entry.empty() || !can_be_counted(result))
      return Status::error(path + ":" + std::to_string(number) +
                           ": is no result of a recording or scene; name a file of results");
    results[entry] = std::move(result);
    whole += line.size() + 1;
  }
  return file.is_open() && !file.bad() ? Status()
                                       : Status::error(path + ": can't be read; name a file of results");
}

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Status not_written(const std::string& path) {
  return Status::error(path + ": can't be written: " + std::generic_category().message(errno));
}

}  // namespace

std::string told_entry(const std::string& entry) {
  return Json::parse(dumped(Json(entry))).get<std::string>();
}

Verdict verdict_of(const Json& result) {
  const bool error = result.contains("error");
  const bool diverged = !error && result.value("diverged", Json()) == true;
  return {diverged, error || (!diverged && !result.value("damage", Json()).is_null())};
}

std::string entry_of(const Json& result) {
  for (const char* const key : {"scene", "recording"})
    if (result.is_object() && result.contains(key) && result[key].is_string()) return result[key];
  return {};
}

Status ResultLines::open(const std::string& path) {
  path_ = path;
  if (std::filesystem::exists(path)) {
    std::map<std::string, Json> before;
    std::uintmax_t whole = 0;
    if (Status status = read_lines(path, before, whole); !status.ok()) return status;
    for (const auto& [entry, result] : before) done_[entry] = verdict_of(result);
    std::error_code error;
    std::filesystem::resize_file(path, whole, error);
    if (error) return Status::error(path + ": " + error.message());
  }
  errno = 0;
  file_.open(path, std::ios::binary | std::ios::app);
  return file_ ? Status() : not_written(path);
}

const Verdict* ResultLines::find(const std::string& entry) const {
  const auto found = done_.find(told_entry(entry));
  return found == done_.end() ? nullptr : &found->second;
}

Status ResultLines::add(const Json& result) {
  const std::lock_guard lock(mutex_);
  if (!failure_.ok()) return failure_;
  errno = 0;
  file_ << dumped(result) << '\n' << std::flush;
  if (!file_) failure_ = not_written(path_);
  return failure_;
}

Status read_results(const std::vector<std::string>& files, std::vector<Json>& results) {
  std::map<std::string, Json> newest;
  std::uintmax_t whole = 0;
  for (const std::string& file : files)
    if (Status status = read_lines(file, newest, whole); !status.ok()) return status;
  for (auto& [entry, result] : newest) results.push_back(std::move(result));
  return {};
}

}  // namespace lumbrical::tool
