// See report_origin.h.
#include "report_origin.h"

#include <map>
#include <utility>

#include "lumbrical/recording.h"
#include "report_json.h"

namespace lumbrical::tool {
namespace {

constexpr const char* kUnknown = "unknown";

// Files by what they say of `key`, in the order of their values.
std::map<std::string, std::string> files_by(const std::vector<Results>& all, const char* key) {
  std::map<std::string, std::string> files;
  for (const Results& results : all) {
    const std::string value = origin_value(results, key);
    std::string& names = files[value.empty() ? kUnknown : value];
    names += (names.empty() ? "" : ", ") + results.file;
  }
  return files;
}

std::string joined(const std::map<std::string, std::string>& files) {
  std::string text;
  for (const auto& [value, names] : files) text += (text.empty() ? "" : ", ") + value;
  return text;
}

void warn_of_arithmetic(const ResultFolder& folder, std::vector<std::string>& warnings) {
  const auto files = files_by(folder.results, "arithmetic");
  const std::string ours(arithmetic_version());
  if (files.size() > 1) {
    std::string text = folder.name + ": its files are of different arithmetic:";
    const char* separator = " ";
    for (const auto& [arithmetic, names] : files)
      text += std::exchange(separator, "; ") + arithmetic + " (" + names + ")";
    warnings.push_back(text +
                       ". Their errors are not of the same forces; measure the older ones again "
                       "(tools/bench FOLDER --only PART).");
  } else if (files.begin()->first != ours) {
    warnings.push_back(folder.name + ": is of arithmetic " + files.begin()->first + ", this program of " +
                       ours + ": errors may be others today; measure again (tools/bench FOLDER).");
  }
}

void warn_of_quick(const ResultFolder& folder, std::vector<std::string>& warnings) {
  std::string names;
  for (const Results& results : folder.results)
    if (results.is_quick) names += (names.empty() ? "" : ", ") + results.file;
  if (!names.empty())
    warnings.push_back(folder.name + ": of --quick, only to try it out, is " + names +
                       ": no target is met or missed by it.");
}

void warn_of_twice(const ResultFolder& folder, std::vector<std::string>& warnings) {
  std::map<std::string, std::string> first;  // file of each benchmark
  std::map<std::pair<std::string, std::string>, std::string> twice;
  for (const Results& results : folder.results) {
    for (const auto& [name, counters] : results.counters) {
      const auto [known, is_new] = first.emplace(name, results.file);
      if (!is_new) twice.emplace(std::pair(known->second, results.file), name);
    }
  }
  for (const auto& [files, name] : twice)
    warnings.push_back(folder.name + ": " + files.first + " and " + files.second +
                       " have the same benchmarks (" + name + "); take one of them out of the folder.");
}

std::string load_text(const Json& load) {
  std::string text;
  for (const Json& one : load)
    if (one.is_number()) text += (text.empty() ? "" : ", ") + brief(one.get<double>());
  return text + " (over 1, 5 and 15 minutes, before it)";
}

}  // namespace

void add_build(const Json& json, Results& results) {
  for (const char* const key : {"commit", "arithmetic"})
    results.origin.emplace_back(key, json.contains(key) ? text_at(json, key, "") : kUnknown);
  if (json.contains("load_avg")) results.origin.emplace_back("load", load_text(array_at(json, "load_avg")));
  results.is_quick = json.contains("quick");
}

std::string builds_of(const std::vector<Results>& all) {
  return "commit " + joined(files_by(all, "commit")) + ", arithmetic " + joined(files_by(all, "arithmetic"));
}

std::vector<std::string> origin_warnings(const std::vector<ResultFolder>& folders) {
  std::vector<std::string> warnings;
  for (const ResultFolder& folder : folders) {
    warn_of_arithmetic(folder, warnings);
    warn_of_quick(folder, warnings);
    warn_of_twice(folder, warnings);
  }
  for (std::size_t i = 1; i < folders.size(); ++i) {
    const std::string before = joined(files_by(folders[i - 1].results, "arithmetic"));
    const std::string after = joined(files_by(folders[i].results, "arithmetic"));
    if (before != after)
      warnings.push_back(folders[i - 1].name + " and " + folders[i].name + " are of different arithmetic (" +
                         before + " and " + after +
                         "): what changed between their errors may be the forces themselves.");
  }
  return warnings;
}

}  // namespace lumbrical::tool
