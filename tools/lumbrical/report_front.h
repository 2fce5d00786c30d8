// The report's first picture: how fast at which error, and beside whom.
#pragma once

#include <string>
#include <vector>

#include "report_results.h"

namespace lumbrical::tool {

/// A plot for each job that the results tell of: the hand, fingertips and one finger of bench_peers, our
/// rungs joined as lines, others as named points; the paper's Table 2; the largest world of tick_bench.
Figure front_figure(const std::vector<Results>& results);

/// The same in words: a sentence for each of the first three jobs, of the same hand of capsules for all.
std::vector<std::string> front_words(const std::vector<Results>& results);

}  // namespace lumbrical::tool
