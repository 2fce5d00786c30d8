// Tells people and scripts what compare_precision found.
#pragma once

#include <vector>

#include "compare_precision.h"

namespace lumbrical::tool {

struct HandComparison {
  Side side = Side::right;
  PrecisionComparison comparison;
};

/// Of one hand, or of both, one behind the other. Answers what print_text answers.
int print_comparison(const std::vector<HandComparison>& hands, bool json);

}  // namespace lumbrical::tool
