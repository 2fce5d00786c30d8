// Results of tick_bench, pair_bench, broadphase_bench and build_bench in Google Benchmark's own JSON.
#pragma once

#include "output.h"
#include "report_results.h"

namespace lumbrical::tool {

/// Figures of what these measure; a table of everything. Throws std::runtime_error with the place of
/// what is wrong.
void read_google(const Json& json, Results& results);

}  // namespace lumbrical::tool
