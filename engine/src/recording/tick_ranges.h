// Sets of tick numbers as ranges.
#pragma once

#include <algorithm>
#include <vector>

#include "lumbrical/recording.h"

namespace lumbrical {

/// The numbers that are in one of the ranges or more, as ascending ranges that neither meet nor overlap.
inline std::vector<TickRange> united(std::vector<TickRange> ranges) {
  std::sort(ranges.begin(), ranges.end(), [](const TickRange& a, const TickRange& b) {
    return a.first != b.first ? a.first < b.first : a.last < b.last;
  });
  std::vector<TickRange> result;
  for (const TickRange& range : ranges) {
    if (!result.empty() && range.first <= result.back().last + 1)
      result.back().last = std::max(result.back().last, range.last);
    else
      result.push_back(range);
  }
  return result;
}

}  // namespace lumbrical
