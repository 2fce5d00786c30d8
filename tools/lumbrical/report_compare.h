// Two folders of results held against each other: what became slower or less accurate.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report_results.h"

namespace lumbrical::tool {

/// What one benchmark says of an implementation.
struct Measurement {
  double time = 0;  ///< [us]
  std::optional<double> error;
};

/// One benchmark that two folders have.
struct Change {
  std::string name;
  Measurement before, after;
  [[nodiscard]] double times() const { return after.time / before.time; }
};

/// How many times as long what is none of our code takes, other libraries and methods of bench_peers: what
/// the machine itself has become slower by. 1, of no rows, where folders have none in common.
struct MachineFactor {
  double times = 1;  ///< median
  std::size_t rows = 0;
};

struct Comparison {
  std::vector<Change> changes;  ///< the worst ratios of times first
  MachineFactor machine;
  std::vector<std::string> words;  ///< a sentence each, the bad news first
  ResultTable table;               ///< the changes: both times and their ratio, both errors
};

/// Over what the machine's factor explains, the time after in times of that before.
double times_beside_machine(const Change& change, const MachineFactor& machine);

/// Whether its error grew by more than what differs between runs.
bool is_less_accurate(const Change& change);

/// Beyond this ratio a time counts as another.
inline constexpr double kTimeNoise = 1.15;

/// What both folders measured, by the benchmarks' names. Times count as different beyond 15 %, which is what
/// machines differ by from hour to hour; errors beyond 30 %.
Comparison compare_results(const std::vector<Results>& before, const std::vector<Results>& after);

}  // namespace lumbrical::tool
