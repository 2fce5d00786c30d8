// Tells people and scripts what compare_precision found.
#pragma once

#include <optional>
#include <vector>

#include "compare_precision.h"

namespace lumbrical::tool {

struct HandComparison {
  Side side = Side::right;
  PrecisionComparison comparison;
};

/// Of one hand, or of both, one behind the other, with whether they keep a rate [Hz] that is asked for.
/// Answers what print_text answers.
int print_comparison(const std::vector<HandComparison>& hands, std::optional<double> rate, bool json);

}  // namespace lumbrical::tool
