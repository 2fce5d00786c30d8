// lumbrical info, verify, recover: what is in a recording, and whether it is whole.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "fail_to_write.h"
#include "lumbrical/recording.h"
#include "output.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

struct RecordingOptions {
  std::string recording, output;
  bool json = false;
};

Json info_json(const RecordingInfo& info) {
  Json json;
  json["recording"] = info.path;
  json["hands"] = Json::array();
  for (const Side side : info.hands) json["hands"].push_back(side_name(side));
  json["complete"] = info.complete;
  json["growing"] = info.growing;
  json["ticks"] = info.ticks;
  json["first_tick"] = info.first_tick;
  json["last_tick"] = info.last_tick;
  json["missing_ticks"] = info.missing_ticks;
  json["seconds"] = info.seconds;
  json["posed_hands"] = info.has_poses;
  json["contact_points"] = info.has_contacts;
  json["drawn_scene"] = info.has_scene;
  json["bytes"] = info.bytes;
  json["chunks"] = info.chunks;
  json["compression"] = info.compression;
  json["library"] = info.library;
  json["version"] = info.version;
  json["metadata"] = Json::object();
  for (const auto& [key, value] : info.metadata) json["metadata"][key] = value;
  return json;
}

Json scene_json(const Scene& scene) {
  Json json;
  json["hand"] = side_name(scene.hand.side);
  json["rate_hz"] = scene.settings.rate;
  json["stiffness"] = scene.settings.stiffness;
  json["law"] = Json::object();
  for (int s = 0; s < kSegmentCount; ++s)
    json["law"][std::string(segment_name(s))] = law_name(scene.settings.law[s]);
  json["objects"] = Json::array();
  for (const SceneObject& object : scene.objects)
    json["objects"].push_back({{"name", object.name},
                               {"vertices", object.mesh.vertices.size()},
                               {"triangles", object.mesh.triangles.size()}});
  if (scene.world) json["world"] = {{"file", scene.world->path}, {"bytes", scene.world->byte_count}};
  return json;
}

std::string laws(const Settings& settings) {
  for (const Law law : settings.law)
    if (law != settings.law[0]) return "mixed";
  return std::string(law_name(settings.law[0]));
}

const char* completeness(const RecordingInfo& info) {
  if (info.growing) return "not yet: it is being recorded, and this is what it holds so far";
  return info.complete ? "yes" : "no: its writer was killed, or its disk full; recover completes it";
}

void add_views(const RecordingInfo& info, const char* interval, const char* what, bool has, Table& table) {
  if (!has) return;
  const auto found = info.metadata.find(interval);
  table.add(what, found == info.metadata.end() ? "of some ticks" : "of one tick in " + found->second);
}

void add_info_rows(const RecordingInfo& info, Table& table) {
  table.add("recording", info.path + ", " + grouped(info.bytes) + " bytes");
  table.add("written by", info.library);
  table.add("format", "version " + std::to_string(info.version));
  if (info.metadata.contains("force_interval"))
    table.add("forces", "of some ticks are left out, their hashes are not");
  add_views(info, "pose_interval", "posed hands", info.has_poses, table);
  add_views(info, "contact_interval", "contact points", info.has_contacts, table);
  add_views(info, "scene_interval", "drawn scene", info.has_scene, table);
  table.add("complete", completeness(info));
  table.add("ticks", info.ticks == 0 ? "none"
                                     : grouped(info.ticks) + ", from " + grouped(info.first_tick) + " to " +
                                           grouped(info.last_tick) + ", " + grouped(info.missing_ticks) +
                                           " missing in between");
  std::string hands;
  for (const Side side : info.hands) hands += (hands.empty() ? "" : " and ") + std::string(side_name(side));
  table.add(info.hands.size() > 1 ? "hands" : "hand",
            hands + (info.hands.size() > 1 ? ", each with its ticks" : ""));
  table.add("session time", brief(info.seconds, 6) + " s");
  table.add("chunks",
            grouped(info.chunks) + (info.compression.empty() ? ", not compressed" : ", " + info.compression));
  for (const auto& [key, value] : info.metadata) table.add(key, value);
}

void add_scene_rows(const Scene& scene, Table& table) {
  table.add("rate", brief(scene.settings.rate, 6) + " Hz");
  table.add("law", laws(scene.settings) + ", stiffness " + brief(scene.settings.stiffness) + " N/m^3");
  for (const SceneObject& object : scene.objects)
    table.add("object", object.name + ", " + grouped(object.mesh.triangles.size()) + " triangles");
  if (scene.world)
    table.add("world file",
              scene.world->path + ", " + grouped(scene.world->byte_count) + " bytes; a replay needs it");
}

// So many are told people, and scripts, for a session may have as many as ticks; export has all.
constexpr std::size_t kMostEvents = 20, kMostEventsInJson = 10000;

/// What became of a session's device, its first events, and how many more there are.
struct ToldHistory : DeviceHistory {
  std::uint64_t more = 0;
};

Json device_json(const ToldHistory& history, const std::string& certificate) {
  Json json;
  json["commands"] = history.commands;
  json["acknowledged"] = history.acknowledged;
  json["delay"] = {{"mean", history.mean_delay}, {"max", history.largest_delay}};
  json["certificate"] = parse_json(certificate);
  if (json["certificate"].is_discarded()) json["certificate"] = certificate;
  json["events"] = Json::array();
  for (const DeviceEvent& event : history.events)
    json["events"].push_back(
        {{"tick", event.tick}, {"time", event.time}, {"kind", event.kind}, {"text", event.text}});
  json["more_events"] = history.more;
  return json;
}

void add_device_rows(const ToldHistory& history, Table& table) {
  table.add("device", grouped(history.commands) + " commands, " + grouped(history.acknowledged) +
                          " acknowledged; delay mean " + brief(1e3 * history.mean_delay) + "   max " +
                          brief(1e3 * history.largest_delay) + " ms");
  for (const DeviceEvent& event : history.events)
    table.add("", brief(event.time, 6) + " s  " + event.kind + ": " + event.text);
  if (history.more > 0) table.add("", "and " + grouped(history.more) + " more: lumbrical export --events");
}

/// Nothing where there was no device, which takes no reading of all ticks.
Status device_history(std::vector<RecordingReader>& readers, std::size_t most,
                      std::optional<ToldHistory>& history) {
  if (!readers[0].info().metadata.contains("certificate")) return {};
  ToldHistory& told = history.emplace();
  std::vector<DeviceEvent> events;
  const auto keep = [&](const DeviceEvent& event) {
    if (events.size() < most)
      events.push_back(event);
    else
      ++told.more;
    return Status();
  };
  Status status = read_device_history(readers, told, keep);
  told.events = std::move(events);
  return status;
}

int info(const RecordingOptions& options) {
  std::vector<RecordingReader> readers;
  if (Status status = open_hands(options.recording, readers); !status.ok()) return fail(status);
  std::optional<ToldHistory> device;
  const std::size_t most = options.json ? kMostEventsInJson : kMostEvents;
  if (Status status = device_history(readers, most, device); !status.ok()) return fail(status);
  const RecordingReader& reader = readers[0];
  if (options.json) {
    Json json = info_json(reader.info());
    json["scene"] = scene_json(reader.scene());
    if (device) json["device"] = device_json(*device, reader.info().metadata.at("certificate"));
    return print_json(json);
  }
  Table table;
  add_info_rows(reader.info(), table);
  add_scene_rows(reader.scene(), table);
  if (device) add_device_rows(*device, table);
  return print_text(table.text());
}

/// ": ticks 5 to 9, 20 to 31"; the first few.
std::string ranges_text(const std::vector<TickRange>& ranges) {
  constexpr std::size_t kMost = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(ranges.size(), kMost); ++i)
    text += (i == 0 ? ": ticks " : ", ") + grouped(ranges[i].first) + " to " + grouped(ranges[i].last);
  return ranges.size() > kMost ? text + " ..." : text;
}

std::uint64_t count_of(const std::vector<TickRange>& ranges) {
  std::uint64_t count = 0;
  for (const TickRange& range : ranges) count += range.last - range.first + 1;
  return count;
}

Json ranges_json(const std::vector<TickRange>& ranges) {
  Json json = Json::array();
  for (const TickRange& range : ranges) json.push_back({range.first, range.last});
  return json;
}

int verify(const RecordingOptions& options) {
  RecordingInfo info;
  std::vector<TickRange> missing;
  const Status status = verify_recording(options.recording, info, &missing);
  if (options.json) {
    Json json;
    json["whole"] = status.ok();
    json["error"] = status.ok() ? Json(nullptr) : Json(status.message());
    if (!status.ok()) json["exit_code"] = kUnreadable;  // as every failure has it
    json.update(info_json(info));
    json["missing"] = ranges_json(missing);
    json["recording"] = options.recording;
    const int printed = print_json(json);
    if (printed != kDone) return printed;
  }
  if (!status.ok()) return fail(status);
  const int verdict = missing.empty() ? kDone : kTicksMissing;
  if (options.json) return verdict;
  std::string text = "Whole: " + grouped(info.ticks) + " ticks in " + grouped(info.chunks) +
                     " chunks; every checksum, length, index and hash is right.\n";
  if (!missing.empty())
    text += "But " + grouped(count_of(missing)) + " are missing" + ranges_text(missing) + ".\n";
  const int printed = print_text(text);
  return printed == kDone ? verdict : printed;
}

/// grasp.mcap becomes grasp.recovered.mcap.
std::string recovered_name(const std::string& recording) {
  const std::filesystem::path path(recording);
  return (path.parent_path() / (path.stem().string() + ".recovered.mcap")).string();
}

/// Then nothing is lost of it, but more will come.
bool is_growing(const std::string& recording) {
  RecordingReader reader;
  return reader.open(recording).ok() && reader.info().growing;
}

/// Of a session of two hands a tick of each is counted.
const char* hands_text(const std::string& recording) {
  std::vector<RecordingReader> readers;
  return open_hands(recording, readers).ok() && readers.size() > 1 ? " of both hands" : "";
}

int recover(const RecordingOptions& options) {
  const std::string output = options.output.empty() ? recovered_name(options.recording) : options.output;
  std::uint64_t recovered = 0, lost = 0;
  std::vector<TickRange> missing;
  const bool growing = is_growing(options.recording);
  const StopSignals stop_signals;
  const Status status =
      recover_recording(options.recording, output, recovered, lost, &missing, stop_requested);
  if (!status.ok()) return fail_to_write(output, status);
  if (options.json) {
    Json json;
    json["recovered"] = recovered;
    json["lost"] = lost;
    json["missing"] = ranges_json(missing);
    json["growing"] = growing;
    json["output"] = output;
    const int printed = print_json(json);
    return printed == kDone && lost > 0 ? kTicksMissing : printed;
  }
  const int printed =
      print_text(grouped(recovered) + " ticks" + hands_text(output) + " recovered to " + output + ", " +
                 grouped(lost) + " known to be lost" + ranges_text(missing) + ".\n" +
                 (growing ? "It is still being recorded: this is what it held so far.\n" : ""));
  return printed == kDone && lost > 0 ? kTicksMissing : printed;
}

using Run = int (*)(const RecordingOptions&);

/// A subcommand with the one argument they all have.
Command* add_command(Command& app, int& exit_code, const char* name, const char* what,
                     const std::shared_ptr<RecordingOptions>& options, Run run) {
  Command* const command = app.add_subcommand(name, what);
  command->add_option("recording", options->recording, "Recording to read")
      ->required()
      ->type_name("REC.mcap");
  command->callback([options, run, &exit_code] { exit_code = run(*options); });
  return command;
}

}  // namespace

void add_info(Command& app, int& exit_code) {
  const auto options = std::make_shared<RecordingOptions>();
  Command* const command = add_command(app, exit_code, "info", "Tell what a recording holds", options, info);
  command->add_flag("--json", options->json, "Print one JSON object");
}

void add_verify(Command& app, int& exit_code) {
  const auto options = std::make_shared<RecordingOptions>();
  Command* const command =
      add_command(app, exit_code, "verify",
                  "Check every checksum, length, index and hash (exit code 2: damaged, 5: ticks are missing)",
                  options, verify);
  command->add_flag("--json", options->json, "Print one JSON object");
}

void add_recover(Command& app, int& exit_code) {
  const auto options = std::make_shared<RecordingOptions>();
  Command* const command = add_command(
      app, exit_code, "recover",
      "Rewrite what is whole of a torn or damaged recording (exit code 5: not all ticks)", options, recover);
  command->add_option("--output,-o", options->output, "Recording to write; default: REC.recovered.mcap")
      ->check(is_file())
      ->type_name("OUT.mcap");
  command->add_flag("--json", options->json, "Print one JSON object");
}

}  // namespace lumbrical::tool
