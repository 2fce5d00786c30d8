// See result_lines.h.
#include "result_lines.h"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>
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
    if (!result.is_object() || !result.contains("recording") || !result["recording"].is_string())
      return Status::error(path + ":" + std::to_string(number) + ": is no result of a recording");
    const std::string recording = result["recording"];
    results[recording] = std::move(result);
  }
  return {};
}

}  // namespace

Status read_list(const std::string& file, std::vector<std::string>& paths) {
  std::ifstream opened;
  if (file != "-") opened.open(file);
  std::istream& list = file == "-" ? std::cin : opened;
  if (!list) return Status::error(file + ": can't be read");
  for (std::string line; std::getline(list, line);)
    if (!line.empty()) paths.push_back(line);
  return {};
}

bool parse_shard(const std::string& text, Shard& shard) {
  const char *const first = text.data(), *const last = first + text.size();
  const auto [middle, error] = std::from_chars(first, last, shard.index);
  if (error != std::errc() || middle == last || *middle != '/') return false;
  const auto [end, second] = std::from_chars(middle + 1, last, shard.count);
  return second == std::errc() && end == last && shard.index >= 1 && shard.index <= shard.count &&
         shard.count <= 1000000;
}

std::vector<std::string> share_of(const std::vector<std::string>& paths, const Shard& shard) {
  std::vector<std::string> share;
  for (std::size_t i = shard.index - 1; i < paths.size(); i += shard.count) share.push_back(paths[i]);
  return share;
}

Status ResultLines::open(const std::string& path) {
  path_ = path;
  if (std::filesystem::exists(path)) {
    std::string text;
    std::map<std::string, Json> before;
    if (Status status = read_whole_lines(path, text); !status.ok()) return status;
    if (Status status = read_lines(path, before); !status.ok()) return status;
    for (const auto& [recording, result] : before) done_.insert(recording);
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
  for (auto& [recording, result] : newest) results.push_back(std::move(result));
  return {};
}

}  // namespace lumbrical::tool
