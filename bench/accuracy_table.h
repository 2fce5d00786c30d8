// What an accuracy run has found out, as a table for people and as JSON.
#pragma once

#include <string>
#include <vector>

namespace lumbrical::bench {

/// Of many errors.
struct Spread {
  double median = 0, most = 0, worst = 0;  ///< most: 98 % are not larger
};

/// Sorts in part; all zero where there is none.
Spread spread_of(std::vector<float>& errors);

/// Errors of one quantity over the pairs of one shape and angle class.
struct Row {
  std::string shape, angle, precision, law, quantity;
  std::string unit;  ///< of absolute errors: a power of R
  std::size_t pairs = 0;
  Spread absolute, relative;  ///< relative to the value itself; of no meaning for first moments
  bool has_relative = false;
  std::string worst_pair;  ///< of the largest absolute error
};

struct Speed {
  std::string shape, angle, precision, law;
  double nanoseconds = 0;  ///< per pair
};

struct Report {
  std::string cpu, isa, compiler, flags, command;
  std::string origin;  ///< of the build: origin_members()
  std::size_t pairs = 0, missed = 0;
  double largest_missed = 0;  ///< [R^2] contacted area of a pair the engine holds for apart
  /// The reference's own errors: what it estimates, and against fifty digits.
  double estimated_area = 0, estimated_field = 0, estimated_column = 0;
  std::size_t checked = 0;
  double checked_area = 0, checked_field = 0, checked_column = 0, checked_depth = 0;
  std::vector<Row> rows;
  std::vector<Speed> speeds;
};

std::string to_markdown(const Report& report);
std::string to_json(const Report& report);

}  // namespace lumbrical::bench
