#include "peer_table.h"

#include "origin.h"
#include "print.h"

namespace lumbrical::bench {
namespace {

std::string percent(double share) {
  if (share < 0) return "none";
  return share == 0 ? "0" : print("%.2g %%", 100 * share);
}

std::string times(double ratio) { return print(ratio < 9.95 ? "%.1f" : "%.0f", ratio); }

std::string error_text(double error) { return error < 0 ? "none" : error == 0 ? "0" : print("%.0e", error); }

void add_row(const PeerRow& row, std::string& text) {
  text += print("| %s | %zu | %.0f | %s | %.1f | %.1f | %s | %s | %.0f | %s | %s | %s | %s | %.2g |\n",
                row.scene.c_str(), row.triangles, row.touched, row.contender.c_str(), row.median_us,
                row.p99_us, times(row.times_exact).c_str(), times(row.times_ours).c_str(), row.contacts,
                percent(row.missed).c_str(), percent(row.extra).c_str(), error_text(row.area_error).c_str(),
                (error_text(row.force_error) + (row.fitted ? " fitted" : "")).c_str(), row.build_ms);
}

std::string number_or_null(double value) { return value < 0 ? "null" : print("%.3e", value); }

}  // namespace

std::string to_markdown(const PeerReport& report) {
  std::string text = "# The hand's tick beside other libraries\n\n";
  text += print(
      "On %s, one thread, %s with `%s`, ours with %s, %s; the others as Debian builds them. Repeat it "
      "with\n\n```\n",
      report.cpu.c_str(), report.compiler.c_str(), report.flags.c_str(), report.isa.c_str(),
      origin_words().c_str());
  text += report.command + "\n```\n\n";
  text += print(
      "All contenders take turns of %d poses, in one run; a sample is one tick, in %s time. Ours is "
      "the whole tick: hand pose, search, volume and moments, forces, torques; its rungs of samples count "
      "contacts and list none. The others are given posed capsules and only find contacts; \"+ scalar area\" "
      "adds the exact area, its centroid and the depth there. Missed and extra are triangles, against brute "
      "force; those within 1 um of touching count as neither. Errors are of the hand's whole area and force "
      "in the worst pose, relative to our exact rung's. What has no area gets the sum of depth times "
      "normal, scaled by the constant that fits the scene's poses best.\n\n",
      report.poses, report.processor_time ? "processor" : "wall-clock");
  text +=
      "| scene | triangles | touched | contender | median us | p99 us | times exact | times 1e-4 | contacts "
      "| missed | extra | area error | force error | build ms |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const PeerRow& row : report.rows) add_row(row, text);
  return text;
}

std::string to_json(const PeerReport& report) {
  std::string text =
      "{" + report.origin + "  \"cpu\": " + quoted(report.cpu) +
      ",\n  \"compiler\": " + quoted(report.compiler) + ",\n  \"flags\": " + quoted(report.flags) +
      ",\n  \"isa\": " + quoted(report.isa) + ",\n  \"command\": " + quoted(report.command) +
      ",\n  \"poses\": " + std::to_string(report.poses) +
      ",\n  \"clock\": " + quoted(report.processor_time ? "processor" : "wall") + ",\n  \"rows\": [";
  const char* separator = "\n";
  for (const PeerRow& row : report.rows) {
    text += separator;
    text += "    {\"scene\": " + quoted(row.scene) + ", \"contender\": " + quoted(row.contender) +
            ", \"leaves_out\": " + quoted(row.leaves_out);
    text += print(
        ", \"triangles\": %zu, \"touched\": %.1f, \"median_us\": %.3f, \"p99_us\": %.3f, \"samples\": %zu",
        row.triangles, row.touched, row.median_us, row.p99_us, row.samples);
    text += print(", \"times_exact\": %.3f, \"times_1e-4\": %.3f, \"contacts\": %.1f", row.times_exact,
                  row.times_ours, row.contacts);
    text += ", \"missed\": " + number_or_null(row.missed) + ", \"extra\": " + number_or_null(row.extra) +
            ", \"area_error\": " + number_or_null(row.area_error);
    text += print(", \"force_error\": %.3e, \"fitted\": %s, \"build_ms\": %.3f}", row.force_error,
                  row.fitted ? "true" : "false", row.build_ms);
    separator = ",\n";
  }
  return text + "\n  ]\n}\n";
}

}  // namespace lumbrical::bench
