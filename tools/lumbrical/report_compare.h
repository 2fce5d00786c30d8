// Two folders of results held against each other: what became slower or less accurate.
#pragma once

#include <string>
#include <vector>

#include "report_results.h"

namespace lumbrical::tool {

struct Comparison {
  std::vector<std::string> words;  ///< a sentence each, the bad news first
  ResultTable table;  ///< benchmark, both times and their ratio, both errors; the worst ratios first
};

/// What both folders measured, by the benchmarks' names. Times count as different beyond 15 %, which is what
/// machines differ by from hour to hour; errors beyond 30 %.
Comparison compare_results(const std::vector<Results>& before, const std::vector<Results>& after);

}  // namespace lumbrical::tool
