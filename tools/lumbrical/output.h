// What the subcommands share in talking to people and scripts: errors, tables, one JSON object, progress,
// tick times.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lumbrical/math.h"
#include "lumbrical/status.h"
#include "lumbrical/voxel.h"

namespace lumbrical::tool {

using Json = nlohmann::ordered_json;  ///< keeps the order in which keys are added

/// The JSON of a text that may come from anybody's file. Discarded where it is none, or where its brackets
/// are nested more than a hundred deep: printing them calls itself as deep.
Json parse_json(std::string_view text);

/// From now on a failure is also told as a JSON object on standard output, unless a result stands there.
void failures_as_json();

/// The exit code of the program, with whatever is left to say about a failure.
int finish(int exit_code);

/// The text for a terminal: names and messages may come from anybody's file, so control characters (ESC, line
/// ends, the C1 set) become what they are written as in C. Line ends stay where `lines` says so.
std::string printable(std::string_view text, bool lines = false);

/// Prints the message, as printable, to standard error and answers kUnreadable.
int fail(const Status& status);
int fail(std::string_view message);

/// Prints "warning: " and the message to standard error.
void warn(std::string_view message);

/// Prints one JSON object to standard output. Answers kDone, or kUnreadable where it can't be written (full
/// disk). Whoever has closed the other end of a pipe has read enough: that is no failure.
int print_json(const Json& object);

/// Prints text, as printable lines, to standard output under the same terms.
int print_text(std::string_view text);

Json to_json(Vec3 v);  ///< [x, y, z]

/// Two columns: names on the left, what they are on the right. A row without a name continues the one above.
struct Table {
  std::vector<std::pair<std::string, std::string>> rows;
  void add(const std::string& name, const std::string& value) {
    rows.emplace_back(printable(name), printable(value));
  }
  [[nodiscard]] std::string text() const;
};

Json to_json(const VoxelReport& report);
void add_voxels(const VoxelReport& report, Table& table);

/// "1,234,567"
std::string grouped(std::uint64_t number);
/// With `digits` significant digits, never in exponent notation between 1e-4 and 1e9: "0.0123", "27.4".
std::string brief(double number, int digits = 3);
/// As one would write it: "1e-4", "exact".
std::string precision_name(double precision);

/// A bar on standard error for work that takes long; silent where standard error is not a terminal.
class Progress {
 public:
  /// `what` is a verb in the present participle: "running", "replaying".
  explicit Progress(std::string what);
  ~Progress();  ///< clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Redraws at most ten times a second.
  void update(std::uint64_t done, std::uint64_t all);

 private:
  std::string what_;
  bool terminal_ = false;
  std::chrono::steady_clock::time_point next_draw_;
};

/// Counts durations in classes 1/64 of an octave wide: percentiles to 1.6 % from bounded memory, however long
/// the session.
class TickTimes {
 public:
  void add(std::uint32_t nanoseconds);
  /// Upper end of the class that holds the given share of all ticks, never above the maximum [ns]; 0 without
  /// ticks.
  [[nodiscard]] double percentile(double share) const;
  [[nodiscard]] std::uint32_t max() const { return max_; }

 private:
  static constexpr int kSubclassBits = 6;
  std::array<std::uint64_t, (32 - kSubclassBits + 1) << kSubclassBits> count_{};
  std::uint64_t total_ = 0;
  std::uint32_t max_ = 0;
};

}  // namespace lumbrical::tool
