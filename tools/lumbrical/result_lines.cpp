// See result_lines.h.
#include "result_lines.h"

#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>

namespace lumbrical::tool {
namespace {

// Up to the end of its last whole line.
Status read_whole_lines(const std::string& path, std::string& text) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Status::error(path + ": can't be read");
  text.assign(std::istreambuf_iterator<char>(file), {});
  text.erase(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  return {};
}

Status read_lines(const std::string& path, std::map<std::string, Json>& results) {
  std::string text, line;
  if (Status status = read_whole_lines(path, text); !status.ok()) return status;
  std::istringstream lines(text);
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    Json result = Json::parse(line, nullptr, false);
    const std::string entry = entry_of(result);
    if (entry.empty())
      return Status::error(path + ":" + std::to_string(number) + ": is no result of a recording or scene");
    results[entry] = std::move(result);
  }
  return {};
}

}  // namespace

std::string entry_of(const Json& result) {
  for (const char* const key : {"scene", "recording"})
    if (result.is_object() && result.contains(key) && result[key].is_string()) return result[key];
  return {};
}

Status ResultLines::open(const std::string& path) {
  path_ = path;
  if (std::filesystem::exists(path)) {
    std::string text;
    std::map<std::string, Json> before;
    if (Status status = read_whole_lines(path, text); !status.ok()) return status;
    if (Status status = read_lines(path, before); !status.ok()) return status;
    for (const auto& [entry, result] : before) done_.insert(entry);
    std::error_code error;
    std::filesystem::resize_file(path, text.size(), error);
    if (error) return Status::error(path + ": " + error.message());
  }
  file_.open(path, std::ios::binary | std::ios::app);
  return file_ ? Status() : Status::error(path + ": can't be written");
}

Status ResultLines::add(const Json& result) {
  const std::lock_guard lock(mutex_);
  file_ << result.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n' << std::flush;
  return file_ ? Status() : Status::error(path_ + ": can't be written");
}

Status read_results(const std::vector<std::string>& files, std::vector<Json>& results) {
  std::map<std::string, Json> newest;
  for (const std::string& file : files)
    if (Status status = read_lines(file, newest); !status.ok()) return status;
  for (auto& [entry, result] : newest) results.push_back(std::move(result));
  return {};
}

}  // namespace lumbrical::tool
