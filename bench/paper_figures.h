// The paper's Figures 9 and 11 to 15 as curves, under its own law and under the exact one, for the report.
#pragma once

#include <string>

namespace lumbrical::bench {

/// JSON as `lumbrical report` reads it. Takes some seconds; every force comes out of tick().
std::string paper_figures_json(const std::string& command);

}  // namespace lumbrical::bench
