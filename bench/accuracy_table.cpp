#include "accuracy_table.h"

#include <algorithm>

#include "origin.h"
#include "print.h"

namespace lumbrical::bench {
namespace {

std::string three(const Spread& spread) {
  return print("%.0e / %.0e / %.0e", spread.median, spread.most, spread.worst);
}

/// The issue's: 98 % to 1e-12, the worst to 1e-9 of the section's scale.
bool meets_target(const Row& row) { return row.absolute.most <= 1e-12 && row.absolute.worst <= 1e-9; }

bool is_total(const Row& row) { return row.angle == "all"; }

double mean_speed(const Report& report, const Row& row) {
  double sum = 0;
  int count = 0;
  for (const Speed& speed : report.speeds) {
    if (speed.shape != row.shape || speed.precision != row.precision || speed.law != row.law) continue;
    if (!is_total(row) && speed.angle != row.angle) continue;
    sum += speed.nanoseconds;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

void add_row(const Report& report, const Row& row, std::string& text) {
  const double speed = row.quantity == "volume" ? mean_speed(report, row) : 0;
  text += print("| %s | %s | %s | %s | %s | %s | %s | %s | %s | %s |\n", row.law.c_str(),
                row.precision.c_str(), row.shape.c_str(), row.angle.c_str(), row.quantity.c_str(),
                speed > 0 ? print("%.0f", speed).c_str() : "", row.unit.c_str(), three(row.absolute).c_str(),
                row.has_relative ? three(row.relative).c_str() : "", meets_target(row) ? "met" : "missed");
}

std::string json_of(const Spread& spread) {
  return print("{\"median\": %.3e, \"p98\": %.3e, \"worst\": %.3e}", spread.median, spread.most,
               spread.worst);
}

}  // namespace

Spread spread_of(std::vector<float>& errors) {
  if (errors.empty()) return {};
  const auto at = [&](double fraction) {
    const auto place =
        errors.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), place, errors.end());
    return static_cast<double>(*place);
  };
  return {at(0.5), at(0.98), at(1)};
}

std::string to_markdown(const Report& report) {
  std::string text = "# Accuracy against the reference\n\n";
  text += print("%zu touching pairs, on %s (%s), %s with `%s`, %s. Repeat it with\n\n```\n%s\n```\n\n",
                report.pairs, report.cpu.c_str(), report.isa.c_str(), report.compiler.c_str(),
                report.flags.c_str(), origin_words().c_str(), report.command.c_str());
  text +=
      "Errors are median / 98 % / worst, absolute ones in powers of the larger radius R; the target is 1e-12 "
      "for 98 % "
      "and 1e-9 for the worst. Times are per pair, one thread, the median of five runs over up to 4000 of "
      "the pairs, the mean of the angle "
      "classes where they are taken together. "
      "Triangles measure 1e-3 to 1e3 R, depths 1e-6 to 2 R; a third of the triangles has an edge and a third "
      "a corner "
      "next to or in the section. \"lying\" and \"upright\" are axes within 1e-2 to 1e-15 of along and "
      "across the "
      "plane, a quarter of them exactly.\n\n";
  text += print(
      "The reference (tests/reference, long double) estimates its own error at %.0e R^2 in area, %.0e R^3 in "
      "the field's "
      "and %.0e R^3 in the column's volume at worst. Against fifty digits, over %zu of the pairs, it is off "
      "by %.0e, "
      "%.0e and %.0e, and by %.0e R in dl_max.\n\n",
      report.estimated_area, report.estimated_field, report.estimated_column, report.checked,
      report.checked_area, report.checked_field, report.checked_column, report.checked_depth);
  text += print(
      "Pairs held for apart although they touch: %zu, the largest contacted area among them %.0e R^2.\n\n",
      report.missed, report.largest_missed);
  const std::string head =
      "| law | precision | shape | angles | quantity | ns | unit | absolute | relative | target |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  text += "## All angles\n\n" + head;
  for (const Row& row : report.rows) {
    if (is_total(row)) add_row(report, row, text);
  }
  text += "\n## By angle\n\n" + head;
  for (const Row& row : report.rows) {
    if (!is_total(row)) add_row(report, row, text);
  }
  text += "\n## Pairs that miss the worst case's target\n\n";
  for (const Row& row : report.rows) {
    if (is_total(row) || row.absolute.worst <= 1e-9) continue;
    text += print("- %s, %s, %s, %s, %s: %.1e %s: %s\n", row.law.c_str(), row.precision.c_str(),
                  row.shape.c_str(), row.angle.c_str(), row.quantity.c_str(), row.absolute.worst,
                  row.unit.c_str(), row.worst_pair.c_str());
  }
  return text;
}

std::string to_json(const Report& report) {
  std::string text = "{" + report.origin;
  for (const auto& [key, value] : {std::pair{"cpu", &report.cpu},
                                   {"isa", &report.isa},
                                   {"compiler", &report.compiler},
                                   {"flags", &report.flags},
                                   {"command", &report.command}}) {
    text += "  " + quoted(key) + ": " + quoted(*value) + ",\n";
  }
  text += print("  \"pairs\": %zu,\n  \"missed\": {\"pairs\": %zu, \"largest_area\": %.3e},\n", report.pairs,
                report.missed, report.largest_missed);
  text += print("  \"reference\": {\"estimated\": {\"area\": %.3e, \"field\": %.3e, \"column\": %.3e},\n",
                report.estimated_area, report.estimated_field, report.estimated_column);
  text += print(
      "    \"against_fifty_digits\": {\"pairs\": %zu, \"area\": %.3e, \"field\": %.3e, \"column\": %.3e, "
      "\"dl_max\": "
      "%.3e}},\n",
      report.checked, report.checked_area, report.checked_field, report.checked_column, report.checked_depth);
  text += "  \"speeds\": [";
  for (const Speed& speed : report.speeds) {
    text += &speed == report.speeds.data() ? "\n" : ",\n";
    text += print("    {\"law\": %s, \"precision\": %s, \"shape\": %s, \"angle\": %s, \"ns_per_pair\": %.1f}",
                  quoted(speed.law).c_str(), quoted(speed.precision).c_str(), quoted(speed.shape).c_str(),
                  quoted(speed.angle).c_str(), speed.nanoseconds);
  }
  text += "\n  ],\n  \"errors\": [";
  for (const Row& row : report.rows) {
    text += &row == report.rows.data() ? "\n" : ",\n";
    text += print("    {\"law\": %s, \"precision\": %s, \"shape\": %s, \"angle\": %s, \"quantity\": %s, ",
                  quoted(row.law).c_str(), quoted(row.precision).c_str(), quoted(row.shape).c_str(),
                  quoted(row.angle).c_str(), quoted(row.quantity).c_str());
    text +=
        print("\"pairs\": %zu, \"unit\": %s, \"absolute\": %s, \"relative\": %s,\n     \"worst_pair\": %s}",
              row.pairs, quoted(row.unit).c_str(), json_of(row.absolute).c_str(),
              row.has_relative ? json_of(row.relative).c_str() : "null", quoted(row.worst_pair).c_str());
  }
  return text + "\n  ]\n}\n";
}

}  // namespace lumbrical::bench
