// Tells people and scripts what compare_precision found.
#pragma once

#include "compare_precision.h"

namespace lumbrical::tool {

/// Answers what print_text answers.
int print_comparison(const PrecisionComparison& comparison, bool json);

}  // namespace lumbrical::tool
