// lumbrical replay: recordings once more through the engine, every bit compared; "what if" with other
// switches.
#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "divergence.h"
#include "fail_to_write.h"
#include "lumbrical/batch.h"
#include "lumbrical/recording.h"
#include "output.h"
#include "switches.h"
#include "what_if.h"
#include "work_list.h"

namespace lumbrical::tool {
namespace {

struct ReplaySwitches {
  std::vector<std::string> recordings;
  std::string law, broadphase, voxel_cache, world, side, record;
  std::optional<double> stiffness;
  std::string precision, unit = "m", trace, trace_stage;
  std::vector<std::string> meshes;  // NAME=FILE
  std::optional<std::uint64_t> trace_tick;
  std::optional<std::uint32_t> threads;
  std::string isa = "auto";
  bool json = false;
  WorkSwitches work;
};

std::optional<Stage> parse_stage(const std::string& text) {
  for (int stage = 0; stage < kStageCount; ++stage)
    if (text == stage_name(static_cast<Stage>(stage))) return static_cast<Stage>(stage);
  return std::nullopt;
}

Status load_meshes(const ReplaySwitches& switches, ReplayOptions& options) {
  for (const std::string& text : switches.meshes) {
    const std::size_t at = text.find('=');
    if (at == std::string::npos || at == 0)
      return Status::error("--mesh: \"" + text + "\" is not NAME=FILE; lumbrical info lists the names");
    const std::string name = text.substr(0, at);
    if (options.mesh.count(name) > 0)
      return Status::error("--mesh: \"" + name + "\" is named twice; keep one mesh for it");
    Mesh& mesh = options.mesh[name];
    if (Status status = load_mesh(text.substr(at + 1), *parse_unit(switches.unit), mesh); !status.ok())
      return status;
  }
  return {};
}

Status replay_options(const ReplaySwitches& switches, ReplayOptions& options) {
  if (!switches.law.empty()) options.law = parse_law(switches.law);
  if (!switches.broadphase.empty()) options.execution.broadphase = *parse_broadphase(switches.broadphase);
  options.execution.voxel_cache = switches.voxel_cache;
  if (Status status = check_voxel_cache(options.execution); !status.ok()) return status;
  options.world = switches.world;
  options.record = switches.record;
  options.stiffness = switches.stiffness;
  if (!switches.precision.empty()) options.precision = parse_precision(switches.precision);
  // Of several recordings each has one thread.
  options.execution.threads =
      switches.recordings.size() == 1 && switches.work.results.empty() ? switches.threads.value_or(1) : 1;
  options.execution.isa = *parse_isa(switches.isa);
  options.trace = switches.trace;
  options.trace_tick = switches.trace_tick;
  options.trace_stage = parse_stage(switches.trace_stage);
  return load_meshes(switches, options);
}

/// Whether something was changed that may change a force. Then a difference is what was asked for; otherwise
/// bits are promised.
bool asks_what_if(const ReplaySwitches& switches) {
  return !switches.law.empty() || switches.stiffness || !switches.precision.empty() ||
         !switches.meshes.empty();
}

/// The arithmetic of who recorded, where that is known not to be this program's.
std::optional<std::string> other_arithmetic(const RecordingInfo& info) {
  const auto found = info.metadata.find("arithmetic");
  if (found == info.metadata.end() || found->second == arithmetic_version()) return std::nullopt;
  return found->second;
}

// What there is to say about one recording; without an error JSON and text.
struct Replayed {
  Status error;
  bool diverged = false, damaged = false;
  Json json, hands = Json::array();
  std::string text;
};

Status replay_hand(RecordingReader& reader, const std::string& path, const ReplaySwitches& switches,
                   const ReplayOptions& options, Replayed& replayed) {
  ReplayResult result;
  WhatIfResult changes;
  const bool alone = switches.recordings.size() == 1;  // others may need it
  if (alone && !options.world.empty() && !reader.scene().world)
    return Status::error("--world: " + path + " holds its own meshes and names no world file; leave it out");
  if (Status status = replay(reader, options, result); !status.ok()) return status;
  const bool asked = asks_what_if(switches);
  const auto other = result.first_divergence && !asked ? other_arithmetic(reader.info()) : std::nullopt;
  const bool measured = asked || other || !switches.broadphase.empty();
  if (measured)
    if (Status status = what_if(reader, options, changes); !status.ok()) return status;
  if (result.first_divergence && (asked || other)) result.first_divergence->ulp.reset();
  replayed.diverged = result.first_divergence.has_value() && !asked;
  replayed.damaged = !result.damage.empty();
  Json& json = replayed.json = divergence_json(result);
  json["complete"] = reader.info().complete;
  json["diverged"] = replayed.diverged;
  json["damage"] = result.damage.empty() ? Json(nullptr) : Json(result.damage);
  if (!result.not_traced.empty()) json["not_traced"] = result.not_traced;
  json["isa"] = isa_name(options.execution.isa == Isa::automatic ? widest_isa() : options.execution.isa);
  json["threads"] = options.execution.threads;
  json["broadphase"] = broadphase_name(result.broadphase);
  json["recording"] = path;
  json["other_arithmetic"] = other ? Json(*other) : Json(nullptr);
  const double per_tick = 1e6 / static_cast<double>(std::max<std::uint64_t>(result.ticks, 1));
  json["mean_tick_us"] = {{"recorded", per_tick * result.recorded_time},
                          {"replayed", per_tick * result.replayed_time}};
  if (measured) json["what_if"] = what_if_json(changes);
  std::string& text = replayed.text;
  if (other)
    text += "Recorded by other arithmetic (" + *other + ", here " + std::string(arithmetic_version()) +
            "): the same bits are not promised.\n";
  if (asked || other) text += what_if_text(changes);
  if (other) text += "\n";
  if (!asked) text += divergence_text(result, "replayed");
  if (!asked && !result.first_divergence)
    text += "Mean tick time " + brief(per_tick * result.replayed_time) + " us, when recorded " +
            brief(per_tick * result.recorded_time) + " us.\n";
  if (measured && !asked && !other) text += "\n" + what_if_text(changes);
  if (!reader.info().complete)
    text +=
        std::string("The recording has no end (") +
        (reader.info().growing ? "it is still being recorded" : "its writer was killed, or its disk full") +
        "): all whole ticks were replayed.\n";
  if (!result.not_traced.empty()) text += "Nothing was traced: " + result.not_traced + "\n";
  if (replayed.damaged) text += "But the file is not whole: " + result.damage + "\n";
  return {};
}

// Of two hands both, one after the other: the ticks of both, the first difference of either, and what each
// gave.
Status replay_one(const std::string& path, const ReplaySwitches& switches, const ReplayOptions& options,
                  Replayed& replayed) {
  std::vector<RecordingReader> readers;
  if (Status status = open_hands(path, readers, parse_side(switches.side)); !status.ok()) return status;
  if (readers.size() == 1) return replay_hand(readers[0], path, switches, options, replayed);
  if (!switches.trace.empty() || !switches.record.empty())
    return Status::error(path + ": holds two hands, and " +
                         (switches.trace.empty() ? "--record" : "--trace") +
                         " takes one; choose it by --side");
  std::uint64_t ticks = 0;
  for (RecordingReader& reader : readers) {
    Replayed one;
    if (Status status = replay_hand(reader, path, switches, options, one); !status.ok()) return status;
    const std::string side(side_name(reader.scene().hand.side));
    replayed.text += (replayed.text.empty() ? "" : "\n") + ("The " + side + " hand:\n") + one.text;
    ticks += one.json["ticks"].get<std::uint64_t>();
    if (replayed.json.is_null() || (replayed.json["identical"] && !one.json["identical"]))
      replayed.json = one.json;
    replayed.diverged |= one.diverged;
    replayed.damaged |= one.damaged;
    one.json["side"] = side;
    replayed.hands.push_back(std::move(one.json));
  }
  replayed.json["ticks"] = ticks;
  replayed.json["hands"] = std::move(replayed.hands);
  return {};
}

int replay_single(const ReplaySwitches& switches, ReplayOptions& options) {
  Replayed replayed;
  std::optional<StopSignals> stop_signals;
  if (!switches.record.empty()) {
    stop_signals.emplace();
    options.stop = stop_requested;
  }
  {
    Progress progress("replaying");
    options.progress = [&progress](std::uint64_t done, std::uint64_t all) { progress.update(done, all); };
    replayed.error = replay_one(switches.recordings[0], switches, options, replayed);
  }
  if (!replayed.error.ok()) return fail_to_write(switches.record, replayed.error);
  const int printed = switches.json ? print_json(replayed.json) : print_text(replayed.text);
  if (printed != kDone) return printed;
  return replayed.diverged ? kDiverged : replayed.damaged ? kUnreadable : kDone;
}

std::uint32_t jobs_of(const ReplaySwitches& switches) {
  return switches.threads.value_or(std::min(core_count(), 64u));
}

// All of them, whatever becomes of one, and told in the order given.
int replay_batch(const ReplaySwitches& switches, const ReplayOptions& options) {
  const std::vector<std::string>& paths = switches.recordings;
  std::vector<Replayed> replayed(paths.size());
  {
    Progress progress("replaying");
    std::mutex mutex;
    std::uint64_t done = 0;
    run_jobs(paths.size(), jobs_of(switches), [&](std::size_t i) {
      replayed[i].error =
          by_itself(paths[i], [&] { return replay_one(paths[i], switches, options, replayed[i]); });
      const std::lock_guard lock(mutex);
      progress.update(++done, paths.size());
    });
  }
  Json all = Json::array();
  std::string text;
  bool diverged = false, failed = false;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    Replayed& one = replayed[i];
    diverged |= one.diverged;
    failed |= !one.error.ok() || one.damaged;
    if (!one.error.ok()) {
      fail(one.error);
      one.json = {{"recording", paths[i]}, {"error", one.error.message()}};
      one.text = "Not replayed: " + one.error.message() + "\n";
    }
    all.push_back(std::move(one.json));
    text += (i > 0 ? "\n" : "") + paths[i] + "\n" + one.text;
  }
  const int printed = switches.json ? print_json(all) : print_text(text);
  if (printed != kDone) return printed;
  return diverged ? kDiverged : failed ? kUnreadable : kDone;
}

// Lines are the result: nothing else is told but how many there were.
int replay_share(const ReplaySwitches& switches, const ReplayOptions& options) {
  const auto work = [&](const std::string& path) {
    Replayed one;
    one.error = by_itself(path, [&] { return replay_one(path, switches, options, one); });
    if (!one.error.ok()) one.json = {{"recording", path}, {"error", one.error.message()}};
    return WorkResult{std::move(one.json), one.diverged, !one.error.ok() || one.damaged};
  };
  WorkDone done;
  if (Status status = work_through(switches.recordings, switches.work.results, jobs_of(switches), "replaying",
                                   work, done);
      !status.ok())
    return fail(status);
  const Json json = {{"recordings", done.entries},
                     {"done_before", done.done_before},
                     {"diverged", done.diverged},
                     {"failed", done.failed}};
  if (const int printed = print_json(json); printed != kDone) return printed;
  return done.diverged > 0 ? kDiverged : done.failed > 0 ? kUnreadable : kDone;
}

int replay_recordings(ReplaySwitches switches) {
  if (switches.recordings.empty() && switches.work.list.empty())
    return fail("no recording is named; give paths, or --list FILE");
  if (Status status = choose_entries(switches.work, switches.recordings); !status.ok()) return fail(status);
  const bool single = switches.recordings.size() == 1;
  if (!single && !switches.trace.empty()) return fail("--trace: takes one recording at a time");
  if (switches.json && switches.trace == "-")
    return fail("--trace -: standard output has the JSON already; name a file for the trace");
  if (!single && !switches.record.empty()) return fail("--record: takes one recording at a time");
  if (!switches.record.empty() && !asks_what_if(switches))
    return fail("--record: nothing is changed; give --law, --precision, --stiffness or --mesh");
  ReplayOptions options;
  if (Status status = replay_options(switches, options); !status.ok()) return fail(status);
  if (!switches.work.results.empty()) return replay_share(switches, options);
  // There may be fewer than shards; and what a list gives is of one form, however long it is.
  if (switches.recordings.empty() && !switches.json) return kDone;
  return single && switches.work.list.empty() ? replay_single(switches, options)
                                              : replay_batch(switches, options);
}

}  // namespace

void add_replay(Command& app, int& exit_code) {
  const auto switches = std::make_shared<ReplaySwitches>();
  Command* const command = app.add_subcommand(
      "replay", "Run recordings again and compare every bit (exit code 3: they differ), or ask what if");
  command
      ->add_option("recording", switches->recordings,
                   "Recordings to replay; several share out all cores, one thread each")
      ->type_name("REC.mcap");
  add_work_switches("recording", "", switches->work, *command);
  command->add_option("--law", switches->law, "What if: contact law of the whole hand")->check(is_law());
  command->add_option("--precision", switches->precision, std::string("What if: ") + kPrecisionHelp)
      ->check(is_precision());
  command->add_option("--stiffness", switches->stiffness, "What if: K_s [N/m^3]")->check(is_stiffness());
  command
      ->add_option("--mesh", switches->meshes,
                   "What if: another mesh for an object, as it stands in the world at the start")
      ->repeatable()
      ->type_name("NAME=FILE");
  command->add_option("--unit", switches->unit, "Of the meshes' numbers")
      ->check(is_unit())
      ->needs("--mesh")
      ->capture_default_str();
  command
      ->add_option("--record", switches->record,
                   "What if: the changed session as a recording, which lumbrical view holds beside this one")
      ->check(is_file())
      ->type_name("OUT.mcap");
  command
      ->add_option("--broadphase", switches->broadphase,
                   "What if: search for candidate triangles; never changes a result, but a tick's time")
      ->check(is_broadphase());
  command->add_option("--side", switches->side, "Only this hand, of a session of two")
      ->check(one_of({"left", "right"}));
  command->add_option("--world", switches->world, kWorldHelp)->check(is_path())->type_name("FILE");
  command->add_option("--voxel-cache", switches->voxel_cache, kVoxelCacheHelp)->type_name("FOLDER");
  command->add_option("--isa", switches->isa, "Instruction set; never changes a result")->check(is_isa());
  command
      ->add_option("--threads", switches->threads,
                   "1 .. 64; never changes a result. Of several recordings: how many at a time, all cores "
                   "unless given")
      ->check(whole_number_in(1, 64));
  command
      ->add_option("--trace", switches->trace,
                   "Write all intermediate values of the first tick and stage that differ, as text")
      ->check(is_path())
      ->type_name("FILE|-");
  command->add_option("--trace-tick", switches->trace_tick, "Of this tick instead, whether it differs or not")
      ->check(whole_number_in(0, kLatestTick))
      ->type_name("TICK")
      ->needs("--trace");
  command
      ->add_option("--trace-stage", switches->trace_stage,
                   "This stage only; default: the one that differs, or all")
      ->check(one_of({"input", "hand_pose", "broadphase", "narrowphase", "contact_force", "limits"}))
      ->needs("--trace");
  command->add_flag("--json", switches->json,
                    "Print one JSON object, of several recordings or a list an array");
  command->callback([switches, &exit_code] { exit_code = replay_recordings(*switches); });
}

}  // namespace lumbrical::tool
