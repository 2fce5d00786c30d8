// Clocks and percentiles of the benchmarks.
#pragma once

#include <algorithm>
#include <ctime>
#include <vector>

namespace lumbrical::bench {

/// [us]
inline double microseconds(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return 1e6 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_nsec);
}

/// [us] that this thread has had of a processor: what other programs take of a busy machine is not in it.
inline double thread_microseconds() { return microseconds(CLOCK_THREAD_CPUTIME_ID); }

/// The value that `share` of the others don't exceed; 1 is for the largest. Puts `values` in another order.
inline double percentile(std::vector<double>& values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace lumbrical::bench
