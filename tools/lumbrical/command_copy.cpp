// lumbrical trim, split, merge, compress: copies of recordings in which no message is changed.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "fail_to_write.h"
#include "lumbrical/recording.h"
#include "output.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

struct CopySwitches {
  std::vector<std::string> recordings;
  std::string output, world, with = "zstd";
  std::optional<std::uint64_t> from_tick, to_tick, ticks;
  std::optional<double> from_second, to_second, seconds;
  bool json = false;
};

constexpr double kLatest = 1e12;  // [s] of switches

// With as many digits as the last may have, so that names sort as parts follow each other.
std::string numbered(const std::string& output, std::size_t number, std::size_t digit_count) {
  const std::filesystem::path path(output);
  const std::string digits = std::to_string(number);
  const std::string zeros(digit_count - std::min(digit_count, digits.size()), '0');
  const std::string name = path.stem().string() + "." + zeros + digits;
  return (path.parent_path() / (name + path.extension().string())).string();
}

Json copied_json(const std::string& output, const CopyResult& result) {
  return {{"output", output}, {"ticks", result.ticks}, {"replayable", result.replayable}};
}

// Of a part the state before it is computed, for which there may be more missing than in what it is of.
constexpr const char* kWhyParts =
    " (a gap, a build that computes otherwise, or a world file that is not beside the recording: --world "
    "FILE)";
constexpr const char* kWhyWholes = ", as in what was copied";

std::string copied_text(const std::string& output, const CopyResult& result, const std::string& why) {
  const std::string text = grouped(result.ticks) + " ticks to " + output + ".";
  if (result.replayable) return text + "\n";
  return text + " Not all of them can be replayed: ticks are missing, or the state before them is unknown" +
         why + ".\n";
}

int copy(const CopySwitches& switches, CopyOptions options, const char* why = kWhyWholes) {
  const StopSignals stop_signals;
  options.stop = stop_requested;
  CopyResult result;
  const Status status = copy_recordings(switches.recordings, switches.output, options, result);
  if (!status.ok()) return fail_to_write(switches.output, status);
  return switches.json ? print_json(copied_json(switches.output, result))
                       : print_text(copied_text(switches.output, result, why));
}

std::uint64_t tick_at(double second, const RecordingReader& reader) {
  return static_cast<std::uint64_t>(std::ceil(second * reader.scene().settings.rate - 1e-6));
}

/// The first tick of either hand that is not below `from`, if there is one.
Status find_tick(RecordingReader& reader, std::uint64_t from, std::uint64_t& tick, bool& found) {
  found = false;
  if (Status status = reader.seek(from); !status.ok()) return status;
  for (bool end = false; !found;) {
    RecordedMessage message;
    if (Status status = reader.next_message(message, end); !status.ok() || end) return status;
    found = message.kind == MessageKind::tick;
    tick = message.tick;
  }
  return {};
}

int trim(const CopySwitches& switches) {
  RecordingReader reader;
  if (Status status = reader.open(switches.recordings.front()); !status.ok()) return fail(status);
  CopyOptions options;
  options.world = switches.world;
  if (switches.from_tick) options.from = *switches.from_tick;
  if (switches.to_tick) options.to = *switches.to_tick;
  if (switches.from_second) options.from = tick_at(*switches.from_second, reader);
  if (switches.to_second) options.to = tick_at(*switches.to_second, reader);
  const RecordingInfo& info = reader.info();
  std::uint64_t first = 0;
  bool found = false;
  if (Status status = find_tick(reader, options.from, first, found); !status.ok()) return fail(status);
  if (!found || first >= options.to)
    return fail(info.path + ": no tick is in that range; it holds " + std::to_string(info.first_tick) +
                " to " + std::to_string(info.last_tick) + (info.missing_ticks > 0 ? ", with gaps" : ""));
  return copy(switches, options, kWhyParts);
}

// Of the number of the last part, at least three: where ticks are missing there may be fewer parts.
std::size_t digits_of_parts(const RecordingInfo& info, std::uint64_t ticks) {
  const std::uint64_t others = std::min(info.ticks, (info.last_tick - info.first_tick) / ticks);
  return std::max<std::size_t>(3, std::to_string(others + 1).size());
}

Status part_length(const CopySwitches& switches, const RecordingReader& reader, std::uint64_t& ticks) {
  if (!switches.ticks && !switches.seconds)
    return Status::error("split: say how long a part is, by --ticks or --seconds");
  const double rate = reader.scene().settings.rate;
  if (switches.seconds && *switches.seconds * rate < 1 - 1e-6)
    return Status::error("--seconds: " + brief(*switches.seconds) + " is less than a tick, which takes " +
                         brief(1 / rate) + " s");
  ticks = switches.ticks ? *switches.ticks : tick_at(*switches.seconds, reader);
  return {};
}

int split(const CopySwitches& switches) {
  RecordingReader reader;
  if (Status status = reader.open(switches.recordings.front()); !status.ok()) return fail(status);
  std::uint64_t ticks = 0;
  if (Status status = part_length(switches, reader, ticks); !status.ok()) return fail(status);
  const std::size_t digits = digits_of_parts(reader.info(), ticks);
  const StopSignals stop_signals;
  Json parts = Json::array();
  std::string text;
  std::uint64_t first = 0, tick = 0;
  bool found = false;
  for (CopyOptions part; part.from < UINT64_MAX; part.from = part.to) {
    if (Status status = find_tick(reader, part.from, tick, found); !status.ok()) return fail(status);
    if (!found) break;
    if (parts.empty()) first = tick;
    // Parts begin at whole multiples of their length, but where there are no ticks there is no part.
    part.from = tick - (tick - first) % ticks;
    part.to = part.from + std::min(ticks, UINT64_MAX - part.from);
    const std::string output = numbered(switches.output, parts.size() + 1, digits);
    part.world = switches.world;
    part.stop = stop_requested;
    CopyResult result;
    if (Status status = copy_recordings(switches.recordings, output, part, result); !status.ok())
      return fail_to_write(output, status);
    parts.push_back(copied_json(output, result));
    text += copied_text(output, result, kWhyParts);
  }
  return switches.json ? print_json({{"parts", parts}}) : print_text(text);
}

int merge(const CopySwitches& switches) { return copy(switches, {}); }

int compress(const CopySwitches& switches) {
  CopyOptions options;
  options.compression = switches.with == "zstd"  ? Compression::zstd
                        : switches.with == "lz4" ? Compression::lz4
                                                 : Compression::none;
  return copy(switches, options);
}

Command* add_command(Command& app, int& exit_code, const char* name, const char* what,
                     const std::shared_ptr<CopySwitches>& switches, int (*run)(const CopySwitches&)) {
  Command* const command = app.add_subcommand(name, what);
  command->add_option("--output,-o", switches->output, "Recording to write")
      ->required()
      ->check(is_file())
      ->type_name("OUT.mcap");
  command->add_flag("--json", switches->json, "Print one JSON object");
  command->callback([switches, run, &exit_code] { exit_code = run(*switches); });
  return command;
}

Option* add_recordings(Command* command, const std::shared_ptr<CopySwitches>& switches, int count) {
  return command->add_option("recording", switches->recordings, "Recording to read")
      ->required()
      ->expected(count)
      ->type_name("REC.mcap");
}

void add_world(Command* command, const std::shared_ptr<CopySwitches>& switches) {
  command->add_option("--world", switches->world, kWorldHelp)->check(is_path())->type_name("FILE");
}

}  // namespace

void add_trim(Command& app, int& exit_code) {
  const auto switches = std::make_shared<CopySwitches>();
  Command* const command = add_command(app, exit_code, "trim",
                                       "Copy a part of a recording, which can be replayed", switches, trim);
  add_recordings(command, switches, 1);
  command->add_option("--from-tick", switches->from_tick, "First tick")
      ->check(whole_number_in(0, kLatestTick));
  command->add_option("--to-tick", switches->to_tick, "Tick behind the last")
      ->check(whole_number_in(0, kLatestTick));
  command->add_option("--from", switches->from_second, "First moment [s of session time]")
      ->check(number_in(0, kLatest))
      ->excludes("--from-tick");
  command->add_option("--to", switches->to_second, "Moment behind the last [s]")
      ->check(number_in(0, kLatest))
      ->excludes("--to-tick");
  add_world(command, switches);
}

void add_split(Command& app, int& exit_code) {
  const auto switches = std::make_shared<CopySwitches>();
  Command* const command = add_command(
      app, exit_code, "split", "Copy a recording in parts: OUT.001.mcap, OUT.002.mcap ...", switches, split);
  add_recordings(command, switches, 1);
  command->add_option("--ticks", switches->ticks, "Of a part")->check(whole_number_in(1, kLatestTick));
  command->add_option("--seconds", switches->seconds, "Of a part")
      ->check(number_in(1e-6, kLatest))
      ->excludes("--ticks");
  add_world(command, switches);
}

void add_merge(Command& app, int& exit_code) {
  const auto switches = std::make_shared<CopySwitches>();
  Command* const command =
      add_command(app, exit_code, "merge", "Put parts of a session, named in their order, into one file",
                  switches, merge);
  add_recordings(command, switches, -1);
}

void add_compress(Command& app, int& exit_code) {
  const auto switches = std::make_shared<CopySwitches>();
  Command* const command = add_command(
      app, exit_code, "compress", "Compress a recording otherwise: zstd for archives", switches, compress);
  add_recordings(command, switches, 1);
  command->add_option("--with", switches->with, "zstd, lz4 or none")
      ->check(one_of({"zstd", "lz4", "none"}))
      ->capture_default_str();
}

}  // namespace lumbrical::tool
