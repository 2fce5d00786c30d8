// Checks that several subcommands make on their switches. A check's message is printed behind the switch's
// name.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>

#include "command_line.h"
#include "lumbrical/clearance.h"
#include "lumbrical/model.h"

namespace lumbrical::tool {

/// A number, the whole of it, within low .. high. It refuses NaN and doesn't ask the
/// locale.
inline Check number_in(double low, double high) {
  return {[low, high](std::string& text) -> std::string {
            double number = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
            if (error == std::errc() && end == text.data() + text.size() && number >= low && number <= high) {
              return {};
            }
            std::ostringstream fault;
            fault << '"' << text << "\" is not a number in " << low << " .. " << high;
            return fault.str();
          },
          "NUMBER"};
}

/// A whole number within low .. high, however it is written: 2e6 is rewritten to its digits, and 010 to 10,
/// which would else be read as octal.
inline Check whole_number_in(std::uint64_t low, std::uint64_t high) {
  return {[low, high](std::string& text) -> std::string {
            double number = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
            const bool is_number = error == std::errc() && end == text.data() + text.size();
            if (is_number && number >= static_cast<double>(low) && number <= static_cast<double>(high) &&
                number == std::floor(number)) {
              text = std::to_string(static_cast<std::uint64_t>(number));
              return {};
            }
            return '"' + text + "\" is no whole number in " + std::to_string(low) + " .. " +
                   std::to_string(high);
          },
          "NUMBER"};
}

/// Of ticks that a switch names: far beyond any session, and exact as a double.
inline constexpr std::uint64_t kLatestTick = 1000000000000;

/// The name of a file: an empty one, as of a variable that is not set, must not pass for none.
inline Check is_path() {
  return {[](std::string& text) -> std::string { return text.empty() ? "is empty; name a file" : ""; },
          "FILE"};
}

/// As is_path, of a file that standard output can't stand for.
inline Check is_file() {
  return {[](std::string& text) -> std::string {
            if (text == "-") return "standard output is for the report; name a file";
            return is_path().fault(text);
          },
          "FILE"};
}

inline std::optional<Side> parse_side(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return text == "left" ? Side::left : Side::right;
}

inline Check is_unit() { return one_of({"m", "cm", "mm"}); }
inline Check is_alignment() {
  return {[](std::string& text) -> std::string {
            if (parse_alignment(text)) return {};
            return "\"" + text + "\" is none of " + kAlignmentForms;
          },
          "ALIGNMENT"};
}
inline Check is_stiffness() { return number_in(0.001, 1e15); }
inline Check is_law() { return one_of({"field", "column", "max-depth", "centroid", "point"}); }

/// Searches that this build has.
inline Check is_broadphase() {
  return {[](std::string& text) -> std::string {
            const std::optional<Broadphase> broadphase = parse_broadphase(text);
            if (!broadphase) return "\"" + text + "\" is not a search; use auto, tree, grid, voxel or brute";
            if (!available(*broadphase))
              return text + " needs OpenVDB, which this build or this machine is without; use tree or grid";
            return {};
          },
          "auto|tree|grid|voxel|brute"};
}

inline const char* const kWorldHelp =
    "World file, where the recording has its world in one; unless given, beside the recording";
/// A cache without an index would be ignored.
inline Status check_voxel_cache(const Execution& execution) {
  if (execution.voxel_cache.empty() || execution.broadphase == Broadphase::voxel) return {};
  return Status::error("--voxel-cache: needs --broadphase voxel");
}

inline const char* const kVoxelCacheHelp = "Folder that keeps voxel indices from one run to the next";

/// Settings::precision: a number, or "exact" for 0.
inline std::optional<double> parse_precision(const std::string& text) {
  if (text == "exact") return 0.0;
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && (number == 0 || (number >= 1e-6 && number <= 0.1)) ? std::optional(number) : std::nullopt;
}
inline Check is_precision() {
  return {[](std::string& text) -> std::string {
            if (parse_precision(text)) return {};
            return "\"" + text + "\" is no precision; use exact, or a share of the hand's force, 1e-6 .. 0.1";
          },
          "exact|1e-3|1e-4|..."};
}
inline const char* const kPrecisionHelp = "The error wanted, as a share of the hand's force (law field)";

/// Instruction sets that this build on this machine has.
inline Check is_isa() {
  return {[](std::string& text) -> std::string {
            const std::optional<Isa> isa = parse_isa(text);
            if (!isa) return "\"" + text + "\" is not an instruction set; use auto";
            if (!available(*isa)) return text + " is not available on this machine; use auto";
            return {};
          },
          "auto|scalar|sse2|avx2|avx512|neon"};
}

}  // namespace lumbrical::tool
