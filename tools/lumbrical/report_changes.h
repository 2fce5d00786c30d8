// What changed between folders of results, for scripts: as JSON, and whether anything is slower.
#pragma once

#include <string>
#include <vector>

#include "output.h"
#include "report_compare.h"
#include "report_origin.h"

namespace lumbrical::tool {

/// From one folder to the next.
struct Step {
  std::string from, to;              ///< folders
  std::string from_build, to_build;  ///< builds_of()
  Comparison comparison;
};

std::vector<Step> steps_between(const std::vector<ResultFolder>& folders);

/// Every step with its machine factor and each benchmark that both folders have; `slower_from` is the ratio
/// of times, beside the machine's, beyond which one counts as slower.
Json changes_json(const std::vector<Step>& steps, double slower_from);

/// "NAME takes 2.10 times as long (from FOLDER to FOLDER)" of each that is slower.
std::vector<std::string> slower_benchmarks(const std::vector<Step>& steps, double slower_from);

}  // namespace lumbrical::tool
