// The table of targets: what a whole run of the benchmarks should reach, and what it reached.
#pragma once

#include <string>
#include <vector>

#include "report_results.h"

namespace lumbrical::tool {

/// One row per target that these results say something about: what, target, reached, met, benchmark.
ResultTable targets_of(const std::vector<Results>& results);

/// How many of them results count for: those of a --quick run, to try it out, say "quick" in the place of
/// met.
std::size_t judged_targets(const ResultTable& targets);

/// How many of them were reached.
std::size_t met_targets(const ResultTable& targets);

/// The table in Markdown; `title` as its heading, `builds` below it. Empty where it has no row.
std::string table_markdown(const std::string& title, const std::string& builds, const ResultTable& table);

}  // namespace lumbrical::tool
