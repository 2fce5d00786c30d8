// lumbrical export: a recording as a table, for other programs.
#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "commands.h"
#include "fail_to_write.h"
#include "lumbrical/nearest_name.h"
#include "lumbrical/recording.h"
#include "output.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

struct ExportSwitches {
  std::string recording, output = "-", format, ticks, side;
  std::vector<std::string> columns, segments;
  bool events = false, poses = false, contacts = false, exact = false;
};

std::string check_segment(std::string& text) {
  if (parse_segment(text)) return {};
  std::vector<std::string> names;
  for (int segment = 0; segment < kSegmentCount; ++segment) names.emplace_back(segment_name(segment));
  return '"' + text + "\" is no hand segment; use \"index distal\", palm or the like" +
         did_you_mean(text, names);
}

// "5", "5:9", "5:", ":9", each with a step behind it, "5:9:2"
bool parse_ticks(const std::string& text, ExportOptions& options) {
  std::uint64_t* const targets[] = {&options.first, &options.last, &options.step};
  std::size_t at = 0, part = 0;
  for (; part < 3; ++part) {
    const std::size_t end = std::min(text.find(':', at), text.size());
    if (end > at) {
      const auto [stop, error] = std::from_chars(text.data() + at, text.data() + end, *targets[part]);
      if (error != std::errc() || stop != text.data() + end) return false;
    }
    if (end == text.size()) break;
    at = end + 1;
  }
  if (part == 0) options.last = options.first;
  return part < 3 && options.step > 0 && options.first <= options.last;
}

std::string check_ticks(std::string& text) {
  ExportOptions ignored;
  if (!text.empty() && parse_ticks(text, ignored)) return {};
  return '"' + text + "\" is no range of ticks; use FIRST:BEHIND or FIRST:BEHIND:STEP";
}

// The format that a file's ending names; empty where it names none.
std::string format_of(const std::string& path) {
  if (path.ends_with(".npz")) return "npz";
  if (path.ends_with(".json") || path.ends_with(".jsonl")) return "json";
  return path.ends_with(".csv") ? "csv" : "";
}

ExportFormat export_format(const std::string& name) {
  if (name == "npz") return ExportFormat::npz;
  return name == "json" ? ExportFormat::json : ExportFormat::csv;
}

Status export_to_file(std::span<RecordingReader> readers, const ExportSwitches& switches,
                      const ExportOptions& wanted) {
  if (switches.events + switches.poses + switches.contacts > 1)
    return Status::error("--events, --poses and --contacts are tables of their own; choose one");
  if (switches.poses) return export_views(readers, MessageKind::pose, wanted, switches.output);
  if (switches.contacts) return export_views(readers, MessageKind::contacts, wanted, switches.output);
  if (switches.events) return export_device_events(readers, wanted, switches.output);
  return export_recording(readers, wanted, switches.output);
}

int export_as_table(const ExportSwitches& switches) {
  if (std::count(switches.columns.begin(), switches.columns.end(), "") > 0)
    return fail("--columns: a word is empty, and every name holds it; use all, or leave it out");
  std::vector<RecordingReader> readers;
  if (Status status = open_hands(switches.recording, readers, parse_side(switches.side)); !status.ok())
    return fail(status);
  const std::string ending = format_of(switches.output);
  if (!switches.format.empty() && !ending.empty() && switches.format != ending)
    return fail("--format " + switches.format + ": the ending of " + switches.output + " says " + ending +
                "; leave --format out, or give the file another ending");
  ExportOptions wanted;
  wanted.format = export_format(switches.format.empty() ? ending : switches.format);
  wanted.columns = switches.columns;
  for (const std::string& name : switches.segments) wanted.segments.push_back(*parse_segment(name));
  wanted.exact = switches.exact;
  if (!switches.ticks.empty()) parse_ticks(switches.ticks, wanted);
  // A file that was begun must not be left; of standard output nothing is, and a stop ends it as ever.
  std::optional<StopSignals> stop_signals;
  if (switches.output != "-") {
    stop_signals.emplace();
    wanted.stop = stop_requested;
  }
  const Status status = export_to_file(readers, switches, wanted);
  return status.ok() ? kDone : fail_to_write(switches.output, status);
}

}  // namespace

void add_export(Command& app, int& exit_code) {
  const auto switches = std::make_shared<ExportSwitches>();
  Command* const command = app.add_subcommand("export", "Write a recording as a table, one line per tick");
  command->add_option("recording", switches->recording, "Recording to read")
      ->required()
      ->type_name("REC.mcap");
  command
      ->add_option("--format", switches->format,
                   "csv, npz (NumPy), or json: one object per line, all of it; default: what the ending of "
                   "--output says (.csv, .npz, .json, .jsonl), or else csv")
      ->check(one_of({"csv", "npz", "json"}));
  command
      ->add_option(
          "--columns", switches->columns,
          "Columns with one of these words in their names, such as force, angle, all; default: of pose, "
          "forces, flexion torques, flags, contacts and where objects are those that vary")
      ->list()
      ->type_name("WORD[,WORD]");
  command->add_option("--segments", switches->segments, "Only these segments, such as \"index distal\",palm")
      ->list()
      ->check(Check{check_segment, "SEGMENT[,SEGMENT]"});
  command->add_option("--side", switches->side, "Only this hand, of a session of two")
      ->check(one_of({"left", "right"}));
  command->add_option("--ticks", switches->ticks, "Only these ticks, up to before BEHIND")
      ->check(Check{check_ticks, "FIRST:BEHIND[:STEP]"});
  command->add_flag("--exact", switches->exact, "csv: all digits, not six");
  command->add_flag(
      "--events", switches->events,
      "Instead: one line per event of the session's device (states, flags, delays, certificate)");
  command->add_flag("--poses", switches->poses,
                    "Instead: one line per joint of the posed hands that run --record-poses keeps");
  command->add_flag("--contacts", switches->contacts,
                    "Instead: one line per contact point that run --record-contacts keeps");
  command->add_option("--output,-o", switches->output, "File to write; -: standard output")
      ->check(is_path())
      ->capture_default_str();
  command->callback([switches, &exit_code] { exit_code = export_as_table(*switches); });
}

}  // namespace lumbrical::tool
