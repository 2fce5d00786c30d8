// lumbrical run: a hand motion meets a scene, tick by tick.
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "approach_text.h"
#include "commands.h"
#include "device_session.h"
#include "live_view.h"
#include "lumbrical/batch.h"
#include "lumbrical/real_time.h"
#include "lumbrical/recording.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/ways_out.h"
#include "output.h"
#include "print_comparison.h"
#include "run_session.h"
#include "run_summary.h"
#include "sink_uri.h"
#include "switches.h"
#include "version.h"
#include "work_list.h"

namespace lumbrical::tool {
namespace {

struct RunOptions {
  std::string scene, motion, side, unit, align, record, law, broadphase, voxel_cache, precision;
  std::string rate = "max", on_record_error = "stop", record_forces = "all", sink = "null";
  std::optional<double> motion_rate, stiffness, record_poses, record_contacts, record_scene;
  std::optional<std::uint64_t> ticks;
  std::optional<std::uint32_t> threads;
  std::string isa = "auto";
  std::optional<std::uint32_t> effort;
  bool json = false, compare_precision = false, view = false, stages = false;
  WorkSwitches work;
};

// How long a device and the ticks exchange before forces are let through [s].
constexpr double kMeasuring = 0.5;

// The time of day, "2026-03-01T12:34:56.123456789Z".
std::string utc_text() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  tm parts{};
  gmtime_r(&now.tv_sec, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::array<char, 16> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%09ldZ", now.tv_nsec);
  return std::string(text.data()) + fraction.data();
}

bool is_paced(const RunOptions& options) { return options.rate != "max"; }

Status load(const RunOptions& options, SceneFile& scene_file) {
  if (options.scene == "-" && options.motion == "-")
    return Status::error("--motion -: standard input is the scene already; name a file for one of the two");
  MotionOverride motion;
  motion.file = options.motion;
  motion.rate = options.motion_rate.value_or(0);
  motion.both = options.side == "both";
  if (!motion.both) motion.side = parse_side(options.side);
  if (const auto unit = parse_unit(options.unit)) motion.unit = metres_per(*unit);
  motion.align = parse_alignment(options.align);
  if (Status status = load_scene_file(options.scene, scene_file, motion); !status.ok()) return status;
  Settings& settings = scene_file.scene.settings;
  if (options.effort) settings.effort = *options.effort;
  if (!options.precision.empty()) settings.precision.fill(*parse_precision(options.precision));
  if (!options.law.empty()) settings.law.fill(*parse_law(options.law));
  if (options.stiffness) settings.stiffness = *options.stiffness;
  if (is_paced(options)) settings.rate = std::stod(options.rate);
  if (options.view && !is_paced(options))
    return Status::error("--view shows a session at the rate of the clock; give it one, --rate 1000 say");
  if (options.sink != "null" && !is_paced(options))
    return Status::error("--sink moves a hand at the rate of the clock; give it one, --rate 1000 say");
  if (!options.broadphase.empty()) scene_file.execution.broadphase = *parse_broadphase(options.broadphase);
  scene_file.execution.voxel_cache = options.voxel_cache;
  if (Status status = check_voxel_cache(scene_file.execution); !status.ok()) return status;
  // Helpers of a real-time thread have no real-time priority: it would wait for them.
  if (options.sink != "null") scene_file.execution.threads = 1;
  if (options.threads) scene_file.execution.threads = *options.threads;
  scene_file.execution.isa = *parse_isa(options.isa);
  return {};
}

std::uint32_t force_interval(const std::string& text) {
  if (text == "all") return 1;
  return text == "none" ? 0 : static_cast<std::uint32_t>(std::stoul(text));
}

// Ticks from one to the next, at this many a second of session time.
std::uint32_t interval_of(const std::optional<double>& wanted, double rate) {
  return wanted ? static_cast<std::uint32_t>(std::max(1.0, std::round(rate / *wanted))) : 0;
}

std::string execution_text(const Execution& execution) {
  return std::string(isa_name(execution.isa)) + ", " + std::string(broadphase_name(execution.broadphase)) +
         ", " + std::to_string(execution.threads) + " thread(s)";
}

/// A hand that moves objects, too, while another one is compared.
struct HandBeside {
  Motion motion;
  Model model;
  Scratch scratch;
  State state;
};

Status set_beside(const Model& world, const SecondHand& hand, std::optional<HandBeside>& beside) {
  HandBeside& made = beside.emplace();
  made.motion = hand.motion;
  if (Status status = share_world(world, hand.hand, made.model); !status.ok()) return status;
  made.scratch = make_scratch(made.model);
  made.state = make_state(made.model);
  return {};
}

// One hand of a session, and objects that move as they do in one, by the other hand, too.
Status compare_hand(const SceneFile& scene_file, const SecondHand& compared, const SecondHand* other,
                    double seconds, PrecisionComparison& comparison) {
  Scene scene = felt_scene(scene_file);
  scene.hand = compared.hand;
  Model model;
  GivenObjects given;
  std::optional<HandBeside> beside;
  Status status = build_model(scene, scene_file.execution, model);
  if (status.ok()) status = start_given(scene_file, model, given);
  if (status.ok() && other != nullptr) status = set_beside(model, *other, beside);
  if (!status.ok()) return status;
  const auto given_at = [&](double time, const Model& felt, Scratch* last) -> std::span<const ObjectFrame> {
    if (last != nullptr) {
      push_given(felt, *last, given);
      if (beside) push_given(beside->model, beside->scratch, given);
      move_given(time, felt, given);
    }
    if (beside)
      tick(beside->model, beside->state, beside->scratch, resample(beside->motion, time), given.frames);
    return given.frames;
  };
  return compare_precision(scene, scene_file.execution, compared.motion, seconds, given_at, comparison);
}

int run_comparison(const RunOptions& options, const SceneFile& scene_file) {
  if (options.view || options.stages || !options.record.empty() || options.sink != "null")
    return fail("--compare-precision: runs no session; leave out --record, --sink, --stages and --view");
  double seconds = scene_file.seconds;
  if (options.ticks) seconds = static_cast<double>(*options.ticks) / scene_file.scene.settings.rate;
  std::vector<HandComparison> hands;
  const auto compare = [&](const SecondHand& hand, const SecondHand* other) {
    HandComparison& added = hands.emplace_back();
    added.side = hand.hand.side;
    return compare_hand(scene_file, hand, other, seconds, added.comparison);
  };
  const SecondHand first{scene_file.scene.hand, scene_file.motion};
  const SecondHand* const second = scene_file.second ? &*scene_file.second : nullptr;
  Status status = compare(first, second);
  if (status.ok() && second != nullptr) status = compare(*second, &first);
  if (!status.ok()) return fail(options.scene + ": " + status.message());
  const double rate = scene_file.scene.settings.rate;
  return print_comparison(hands, is_paced(options) ? std::optional(rate) : std::nullopt, options.json);
}

// A hand without a contact is most often a motion that passes by, or a wrong unit.
void explain_untouched(const SceneFile& scene_file, RunStatistics& statistics) {
  const double seconds = static_cast<double>(statistics.ticks) / scene_file.scene.settings.rate;
  for (std::size_t i = 0; i < statistics.hands.size() && statistics.ticks > 0; ++i) {
    HandFigures& hand = statistics.hands[i];
    if (hand.contacts > 0 || lost_throughout(statistics, hand)) continue;
    Scene scene = scene_file.scene;
    if (i > 0) scene.hand = scene_file.second->hand;
    const Clearance clearance =
        find_clearance(scene, i > 0 ? scene_file.second->motion : scene_file.motion, seconds);
    hand.clearance = to_json(clearance, scene);
    hand.untouched = approach_sentences(clearance, scene);
  }
}

// What the ticks of a session need; its parts refer to each other.
struct Session {
  SceneFile scene_file;
  std::vector<Model> models;
  GivenObjects given;
  std::vector<SessionHand> hands;
  std::uint64_t ticks = 0;
};

Status build_models(const SceneFile& scene_file, std::vector<Model>& models) {
  models.resize(scene_file.second ? 2 : 1);
  Status status = build_model(felt_scene(scene_file), scene_file.execution, models[0]);
  if (status.ok() && scene_file.second) status = share_world(models[0], scene_file.second->hand, models[1]);
  return status;
}

// Of a scene that is loaded.
Status open_session(const RunOptions& options, Session& session) {
  auto& [scene_file, models, given, hands, ticks] = session;
  Status status = build_models(scene_file, models);
  if (status.ok()) status = start_given(scene_file, models[0], given);
  if (!status.ok()) return Status::error(options.scene + ": " + status.message());
  hands.push_back({models[0], scene_file.motion});
  if (scene_file.second) hands.push_back({models[1], scene_file.second->motion});
  ticks = options.ticks.value_or(tick_count(scene_file.seconds, models[0].settings.rate));
  return {};
}

// Of a recording that failed: what is there.
void tell_what_is_kept(const std::string& path, std::uint64_t ticks) {
  std::error_code error;
  if (ticks == 0 || !std::filesystem::exists(path + ".part", error)) return;
  warn(path + ".part: holds " + grouped(ticks) + " ticks; `lumbrical recover " + path +
       ".part -o OTHER.mcap` makes a whole recording of them, where there is room");
}

Status open_recorder(const RunOptions& options, const std::vector<Model>& models, const DeviceSession* device,
                     Recorder& recorder) {
  RecorderOptions recorder_options;
  recorder_options.wait_when_full = !is_paced(options);
  recorder_options.force_interval = force_interval(options.record_forces);
  recorder_options.pose_interval = interval_of(options.record_poses, models[0].settings.rate);
  recorder_options.contact_interval = interval_of(options.record_contacts, models[0].settings.rate);
  recorder_options.scene_interval = interval_of(options.record_scene, models[0].settings.rate);
  for (const Model& model : models) recorder_options.models.push_back(&model);
  if (models.size() > 1) recorder_options.second_hand = models[1].hand;
  recorder_options.metadata = {{"scene_file", options.scene},
                               {"program", version_text()},
                               {"execution", execution_text(models[0].execution)},
                               {"start_utc", utc_text()},
                               {"start_monotonic_ns", std::to_string(clock_ns())}};
  if (device != nullptr) recorder_options.metadata["certificate"] = device->certificate_text();
  return recorder.open(options.record, scene_of(models[0]), recorder_options);
}

// Before a device is spoken to: a name that is taken, or a folder that is not there, is known without it.
Status check_recordable(const RunOptions& options, const std::vector<Model>& models) {
  if (options.record.empty()) return {};
  Recorder trial;
  Status status = open_recorder(options, models, nullptr, trial);
  if (status.ok()) trial.discard();
  return status;
}

int run(const RunOptions& options) {
  Session session;
  auto& [scene_file, models, given, hands, ticks] = session;
  Status status = load(options, scene_file);
  if (!status.ok()) return fail(status);
  if (options.compare_precision) return run_comparison(options, scene_file);
  if (status = open_session(options, session); !status.ok()) return fail(status);

  const bool paced = is_paced(options);
  const bool with_device = options.sink != "null";
  const StopSignals stop_signals;
  LiveView live_view;
  if (options.view) {
    if (status = live_view.start(models); !status.ok()) return fail(status);
  }
  DeviceSession device;
  std::size_t device_hand = 0;
  if (with_device) {
    if (status = check_recordable(options, models); !status.ok()) return fail(status);
    if (status = device.open(options.sink, models, device_hand); !status.ok()) return fail(status);
    if (!measure_device(hands[device_hand], kMeasuring, device)) {
      fail(options.scene + ": stopped by a signal before the first tick");
      return kInterrupted;
    }
  }
  const DeviceSession* const shown = with_device ? &device : nullptr;
  Recorder recorder;
  const bool recording = !options.record.empty();
  if (recording)
    if (status = open_recorder(options, models, shown, recorder); !status.ok()) return fail(status);
  const bool unrecorded = options.on_record_error == "continue";
  RunStatistics statistics =
      run_session(hands, ticks,
                  {paced, recording ? &recorder : nullptr, unrecorded, with_device ? &device : nullptr,
                   device_hand, options.view ? &live_view : nullptr, &given, false, options.stages});
  const bool told = !statistics.recording_error.ok();
  if (recording) {
    status = recorder.close();
    statistics.not_recorded = statistics.ticks * hands.size() - recorder.kept();
    if (!status.ok()) tell_what_is_kept(options.record, recorder.kept());
    if (!status.ok() && !told) return fail(status);
    if (!status.ok() && !unrecorded) return kUnreadable;
  }
  if (!statistics.world_error.ok()) return fail(statistics.world_error);
  explain_untouched(scene_file, statistics);
  LateReport late;
  if (statistics.late.slowest.kept > 0)
    late = study(statistics.late, felt_scene(scene_file), models, with_device);
  const EffortReport effort = study_effort(statistics.slowest_by_samples, models[0].settings.rate, models);
  const RunSummary summary{scene_file, models, statistics, late, effort, shown, paced, options.record};
  const int printed = options.json ? print_json(run_json(summary)) : print_text(run_text(summary));
  if (printed != kDone || told) return kUnreadable;
  if (with_device && !device.forces_flow()) return kNoForces;
  return statistics.interrupted ? kInterrupted : kDone;
}

// What is computed: switches that a line of a list may have as well.
void add_scene_switches(RunOptions& options, Command& command) {
  command.add_option("scene", options.scene,
                     "Scene file (JSON; schemas/scene.fbs, installed in share/lumbrical, lists its fields)");
  command.add_option("--motion", options.motion, "Hand motion in the place of the scene's")
      ->check(is_path())
      ->type_name("FILE");
  command.add_option("--motion-rate", options.motion_rate, "Of motion files without time stamps [Hz]")
      ->check(number_in(1e-3, 1e6));
  command
      .add_option("--side", options.side,
                  "Which hand of a motion file, or what it is where it does not say; both: each is felt")
      ->check(one_of({"left", "right", "both"}));
  command.add_option("--unit", options.unit, "Of the motion file's numbers")->check(is_unit());
  command.add_option("--align", options.align, "Move the motion to an object, and tell where to")
      ->check(is_alignment())
      ->type_name("[OBJECT:]centre|top|...|contact|x,y,z");
  command.add_option("--ticks", options.ticks, "Length of the session; default: the motion's")
      ->check(whole_number_in(1, 1000000000));
  command.add_option("--broadphase", options.broadphase, "Search for candidate triangles")
      ->check(is_broadphase());
  command.add_option("--voxel-cache", options.voxel_cache, kVoxelCacheHelp)->type_name("FOLDER");
  command.add_option("--law", options.law, "Contact law of the whole hand")->check(is_law());
  command.add_option("--precision", options.precision, kPrecisionHelp)->check(is_precision());
  command
      .add_option(
          "--effort", options.effort,
          "Most evaluations a tick may spend on samples, but one cell a patch is the least; 0: no bound")
      ->check(whole_number_in(0, 1000000000));
  command.add_option("--stiffness", options.stiffness, "K_s [N/m^3]")->check(is_stiffness());
  command.add_option("--isa", options.isa, "Instruction set; never changes a result")->check(is_isa());
}

// A session of a list: the line names a scene and may have switches of its own behind it.
Status run_line(const std::string& line, const RunOptions& common, Json& json) {
  RunOptions options = common;
  const auto add = [&options](Command& command) { add_scene_switches(options, command); };
  if (const std::string fault = parse_line(line, add); !fault.empty())
    return Status::error(line + ": " + fault);
  Session session;
  Status status = load(options, session.scene_file);
  if (status.ok()) status = open_session(options, session);
  if (!status.ok()) return status;
  SessionParts parts;
  parts.given = &session.given;
  parts.silent = true;
  RunStatistics statistics = run_session(session.hands, session.ticks, parts);
  if (!statistics.world_error.ok()) return statistics.world_error;
  explain_untouched(session.scene_file, statistics);
  json.update(run_json({session.scene_file, session.models, statistics, {}, {}, nullptr, false, {}}));
  return {};
}

// Every session by itself, as fast as it goes and on one thread.
int run_list(RunOptions options) {
  if (options.work.results.empty()) return fail("--list: what comes of it needs a file; add --results");
  if (options.view || options.stages || options.compare_precision)
    return fail("--list: runs sessions only; leave out --view, --stages and --compare-precision");
  std::vector<std::string> lines;
  if (Status status = choose_entries(options.work, lines); !status.ok()) return fail(status);
  const std::uint32_t jobs = options.threads.value_or(std::min(core_count(), 64u));
  options.threads = 1;
  const auto work = [&options](const std::string& line) {
    Json json = {{"scene", line}};
    const Status status = by_itself(line, [&] { return run_line(line, options, json); });
    if (!status.ok()) json["error"] = status.message();
    return WorkResult{std::move(json), false, !status.ok()};
  };
  WorkDone done;
  if (Status status = work_through(lines, options.work.results, jobs, "running", work, done); !status.ok())
    return fail(status);
  const int printed =
      print_json({{"sessions", done.entries}, {"done_before", done.done_before}, {"failed", done.failed}});
  return printed != kDone ? printed : done.failed > 0 ? kUnreadable : kDone;
}

std::string check_record_forces(std::string& text) {
  if (text == "all" || text == "none" || whole_number_in(1, 1000000).fault(text).empty()) return {};
  return "\"" + text + "\" is none of all, none and whole numbers of ticks, 1 to 1000000";
}

std::string check_rate(std::string& text) {
  return text == "max" ? std::string() : number_in(1, 100000).fault(text);
}

void add_record_switches(RunOptions& options, Command& command) {
  command.add_option("--record", options.record, "Recording to write, where no file is yet")
      ->check(is_file())
      ->excludes("--list")
      ->type_name("OUT.mcap");
  command
      .add_option(
          "--record-forces", options.record_forces,
          "Ticks whose forces the recording holds, every Nth or none; a replay checks all by their hashes")
      ->check(Check{check_record_forces, "all|none|N"})
      ->needs("--record")
      ->capture_default_str();
  struct View {
    const char* name;
    std::optional<double>& rate;
    const char* help;
  };
  const View views[] = {
      {"--record-poses", options.record_poses,
       "Posed hands a second of session time, recorded as foxglove.PosesInFrame"},
      {"--record-contacts", options.record_contacts,
       "Likewise contact points, as foxglove.PointCloud: where, how hard, which segment and triangle"},
      {"--record-scene", options.record_scene,
       "Likewise hand, forces and objects for Foxglove's 3D panel, as foxglove.SceneUpdate; 60 is smooth"}};
  for (const View& view : views) {
    command.add_option(view.name, view.rate, view.help)
        ->check(number_in(0.01, 100000))
        ->needs("--record")
        ->type_name("RATE");
  }
  command
      .add_option(
          "--on-record-error", options.on_record_error,
          "When the recording fails (disk full): stop, or continue unrecorded; exit code 2 either way")
      ->check(one_of({"stop", "continue"}))
      ->needs("--record")
      ->capture_default_str();
}

}  // namespace

void add_run(Command& app, int& exit_code) {
  const auto options = std::make_shared<RunOptions>();
  Command* const command =
      app.add_subcommand("run", "Let a hand motion meet a scene; print figures, record ticks");
  add_scene_switches(*options, *command);
  add_work_switches("scene", ", and switches for it alone,", options->work, *command);
  command->add_option("--rate", options->rate, "Ticks per second by the clock, or max: as fast as it goes")
      ->check(Check{check_rate, "HZ|max"})
      ->excludes("--list")
      ->capture_default_str();
  add_record_switches(*options, *command);
  command
      ->add_option("--sink", options->sink,
                   "Where forces go (with a --rate): null, modbus-tcp://HOST:PORT?profile=FILE, "
                   "modbus-rtu:///dev/ttyX?profile=FILE, "
                   "udp://HOST:PORT?profile=FILE, memory:///NAME?profile=FILE")
      ->check(Check{check_sink_uri, "URI"})
      ->excludes("--list");
  command->add_flag(
      "--compare-precision", options->compare_precision,
      "Instead of a session: each precision's error and processor time on this scene and motion, and advice; "
      "with a --rate, whether that is kept");
  command->add_flag("--stages", options->stages, "Tell where the time of ticks goes, stage by stage");
  command->add_flag("--view", options->view, "Show the session in the browser while it runs (with a --rate)");
  command
      ->add_option(
          "--threads", options->threads,
          "1 .. 64; never changes a result. Of a list: how many sessions at a time, all cores unless "
          "given")
      ->check(whole_number_in(1, 64));
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &exit_code] {
    const WorkSwitches& work = options->work;
    if (!options->scene.empty() && !work.list.empty())
      refuse_option("--list", "stands beside a scene; keep one of the two");
    if (options->scene.empty() && work.list.empty()) demand_option("Either a scene or --list LIST");
    if (work.list.empty() && !(work.shard.empty() && work.results.empty()))
      refuse_option(work.results.empty() ? "--shard" : "--results", "is for a --list of scenes");
    // Whoever stops a device in an emergency must not end a session that has none.
    if (options->sink == "null")
      for (const int signal : {SIGUSR1, SIGUSR2}) std::signal(signal, SIG_IGN);
    exit_code = options->scene.empty() ? run_list(*options) : run(*options);
  });
}

}  // namespace lumbrical::tool
