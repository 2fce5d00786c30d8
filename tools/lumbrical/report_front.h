// The report's first picture: how fast at which error, and beside whom.
#pragma once

#include <vector>

#include "report_results.h"

namespace lumbrical::tool {

/// Our rungs as lines and the other libraries as named points, for the dense drape and the fingertips of
/// bench_peers; without plots where no file is of bench_peers.
Figure front_figure(const std::vector<Results>& results);

}  // namespace lumbrical::tool
