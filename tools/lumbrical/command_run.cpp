// lumbrical run: a hand motion meets a scene, tick by tick.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "approach_text.h"
#include "commands.h"
#include "device_loop.h"
#include "live_view.h"
#include "lumbrical/recording.h"
#include "lumbrical/scene_file.h"
#include "output.h"
#include "print_comparison.h"
#include "run_session.h"
#include "switches.h"
#include "version.h"
#include "ways_out.h"
#include "winding_text.h"

namespace lumbrical::tool {
namespace {

struct RunOptions {
  std::string scene, motion, side, unit, align, record, law, broadphase, voxel_cache, precision;
  std::string rate = "max", on_record_error = "stop", record_forces = "all", sink = "null";
  std::optional<double> motion_rate, stiffness;
  std::optional<std::uint64_t> ticks;
  std::optional<std::uint32_t> threads;
  std::string isa = "auto";
  std::optional<std::uint32_t> effort;
  bool json = false, compare_precision = false, view = false;
};

// How long a device and the ticks exchange before forces are let through [s].
constexpr double kMeasuring = 0.5;

struct FlagText {
  TickFlag flag;
  const char* name;
  const char* remedy;
};

constexpr FlagText kFlagTexts[] = {
    {kInputNotFinite, "input not finite", "NaN or infinity in the device frame; check the driver"},
    {kInputImplausible, "input implausible", "a joint far from its wrist; check the motion's unit"},
    {kInputLost, "input lost", "no tracking, or the motion has ended; use fewer ticks"},
    {kInputExtrapolated, "input extrapolated", "beyond or far between samples; track at a higher rate"},
    {kSegmentMissing, "segment missing", "some joints are not tracked: those segments feel nothing"},
    {kSegmentDegenerate, "segment degenerate", "a phalanx of zero length was felt as a sphere"},
    {kAngleClamped, "angle clamped", "a joint angle beyond the hand's limits; widen them"},
    {kCandidateOverflow, "candidate overflow", "raise settings.max_candidates"},
    {kForceLimited, "force limited", "a segment came near settings.max_force, and its force saturates"},
    {kCoarsened, "coarsened", "samples were coarser than asked, to stay within settings.effort"},
    {kFading, "fading", "forces faded to zero or rose again: their input could not be trusted for a while"},
};

std::optional<Side> parse_side(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return text == "left" ? Side::left : Side::right;
}

double parse_metres(const std::string& unit) {
  return unit.empty() ? 0 : unit == "mm" ? 0.001 : unit == "cm" ? 0.01 : 1;
}

Status load(const RunOptions& options, SceneFile& scene_file) {
  MotionOverride motion;
  motion.file = options.motion;
  motion.rate = options.motion_rate.value_or(0);
  motion.side = parse_side(options.side);
  motion.unit = parse_metres(options.unit);
  motion.align = parse_alignment(options.align);
  if (Status status = load_scene_file(options.scene, scene_file, motion); !status.ok()) return status;
  Settings& settings = scene_file.scene.settings;
  if (options.effort) settings.effort = *options.effort;
  if (!options.precision.empty()) settings.precision.fill(*parse_precision(options.precision));
  if (!options.law.empty()) settings.law.fill(*parse_law(options.law));
  if (options.stiffness) settings.stiffness = *options.stiffness;
  if (options.rate != "max") settings.rate = std::stod(options.rate);
  if (options.view && options.rate == "max")
    return Status::error("--view shows a session at the rate of the clock; give it one, --rate 1000 say");
  if (!options.broadphase.empty()) scene_file.execution.broadphase = *parse_broadphase(options.broadphase);
  scene_file.execution.voxel_cache = options.voxel_cache;
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

std::string law_of(const Settings& settings) {
  for (const Law law : settings.law) {
    if (law != settings.law[0]) return "mixed";
  }
  return std::string(law_name(settings.law[0]));
}

double microseconds(const TickTimes& times, double share) { return times.percentile(share) / 1000; }

double rate_reached(const RunStatistics& run) {
  return run.wall_seconds > 0 ? static_cast<double>(run.ticks) / run.wall_seconds : 0;
}

double mean_contacts(const RunStatistics& run) {
  return run.ticks > 0 ? static_cast<double>(run.contacts) / static_cast<double>(run.ticks) : 0;
}

// The joint that moves segment s: the one at its base.
std::string moving_joint(int s) {
  return std::string(
      joint_name(s == kPalmSegment ? kWrist : kPhalanxJoints[static_cast<std::size_t>(s)].base));
}

std::string finger_or_palm(int f) { return f < kFingerCount ? std::string(finger_name(f)) : "palm"; }

std::uint64_t ticks_with(const RunStatistics& run, TickFlag flag) {
  std::size_t bit = 0;
  while ((1u << bit) != flag) ++bit;
  return run.flag_ticks[bit] - (flag == kFading ? run.starting_ticks : 0);
}

std::pair<int, double> largest_segment_force(const RunStatistics& run) {
  const auto largest = std::max_element(run.peak_segment.begin(), run.peak_segment.end());
  return {static_cast<int>(largest - run.peak_segment.begin()), *largest};
}

Json times_json(const TickTimes& times) {
  return {{"p50", microseconds(times, 0.5)},
          {"p99", microseconds(times, 0.99)},
          {"p999", microseconds(times, 0.999)},
          {"max", times.max() / 1000.0}};
}

std::string times_text(const TickTimes& times) {
  return "p50 " + brief(microseconds(times, 0.5)) + "   p99 " + brief(microseconds(times, 0.99)) +
         "   p99.9 " + brief(microseconds(times, 0.999)) + "   max " + brief(times.max() / 1000.0) + " us";
}

// What Settings::effort may be for samples to leave half of a period to the rest, as fast as they were here;
// 0 where nothing was felt by them.
double effort_for(double rate, const RunStatistics& run) {
  return run.evaluations > 0 ? std::floor(0.5e9 / rate / (run.evaluating_ns / run.evaluations)) : 0;
}

// Before any figure: what a person must know who reads one line.
std::vector<std::string> trouble_of(const RunStatistics& run, const DeviceLoop* device) {
  std::vector<std::string> lines = device != nullptr ? device->trouble() : std::vector<std::string>();
  if (!run.recording_error.ok()) lines.push_back("the recording failed: " + run.recording_error.message());
  if (run.not_recorded > 0) lines.push_back(grouped(run.not_recorded) + " ticks are not in the recording");
  lines.insert(lines.end(), run.untouched.begin(), run.untouched.end());
  return lines;
}

// Of a flag: what is missing is the device's, not the motion's, where the device moves the hand.
std::string remedy_of(const FlagText& text, std::uint64_t count, const DeviceLoop* device) {
  if (text.flag != kInputLost || device == nullptr || device->ticks_without_angles() == 0) return text.remedy;
  return device->ticks_without_angles() < count
             ? "angles of the device missing or not believed, no tracking, or the motion has ended"
             : "angles of the device missing or not believed";
}

Json run_json(const RunOptions& options, const SceneFile& scene_file, const Model& model,
              const RunStatistics& run, const LateReport& late, const DeviceLoop* device) {
  Json json;
  json["trouble"] = trouble_of(run, device);
  json["ticks"] = run.ticks;
  json["rate_hz"] = rate_reached(run);
  json["tick_us"] = times_json(run.tick_times);
  const auto side_text = [](Side side) { return side == Side::left ? "left" : "right"; };
  json["hand"] = {{"side", side_text(scene_file.motion.side)},
                  {"other_side", side_text(scene_file.motion.other_side)},
                  {"other_frames", scene_file.motion.other_frames}};
  json["contacts"] = {{"mean", mean_contacts(run)}, {"max", run.max_contacts}};
  json["deadline_misses"] = run.deadline_misses;
  json["effort"] = {{"max_evaluations", run.max_evaluations},
                    {"fits_half_a_period", effort_for(model.settings.rate, run)}};
  json["isa"] = isa_name(model.execution.isa);
  json["threads"] = model.execution.threads;
  json["broadphase"] = broadphase_name(model.execution.broadphase);
  if (const auto report = voxel_report(model)) json["voxel_index"] = to_json(*report);
  json["law"] = law_of(model.settings);
  json["recording"] = options.record.empty() ? Json(nullptr) : Json(options.record);
  json["not_recorded"] = run.not_recorded;
  json["session_rate_hz"] = model.settings.rate;
  json["triangles"] = model.triangles.size();
  for (const World::Object& object : model.objects) {
    json["objects"].push_back(
        {{"name", object.name}, {"triangles", object.triangle_count}, {"winding", to_json(object.winding)}});
  }
  if (model.world)
    json["world"] = {
        {"file", model.world->path}, {"bytes", model.world->byte_count}, {"held_bytes", run.world_held}};
  for (int f = 0; f <= kFingerCount; ++f) {
    json["peak_force"][finger_or_palm(f)] = run.peak_force[static_cast<std::size_t>(f)];
  }
  for (int s = 0; s < kSegmentCount; ++s) {
    json["peak_torque"][moving_joint(s)] = run.peak_torque[static_cast<std::size_t>(s)];
  }
  const auto [segment, force] = largest_segment_force(run);
  json["peak_segment"] = {{"segment", segment_name(segment)}, {"force", force}};
  json["max_force"] = model.settings.max_force;
  json["starting_ticks"] = run.starting_ticks;
  json["flags"] = Json::object();
  for (const FlagText& text : kFlagTexts) {
    if (const std::uint64_t count = ticks_with(run, text.flag)) json["flags"][text.name] = count;
  }
  json["interrupted"] = run.interrupted;
  if (!run.clearance.is_null()) json["clearance"] = run.clearance;
  if (scene_file.aligned) json["aligned"] = pose_json(scene_file.placement.pose);
  if (options.rate != "max") {
    json["late"] = late_json(run.late, late);
    json["wake_up_us"] = times_json(run.wake_ups);
    json["page_faults"] = run.page_faults;
    json["real_time"] = {{"memory_locked", run.real_time.memory_locked},
                         {"priority", run.real_time.priority},
                         {"cpu", run.real_time.cpu},
                         {"refused", run.real_time.refused}};
  }
  if (device != nullptr) {
    json["loop_us"] = times_json(run.loop_times);
    json["device"] = device->json();
  }
  return json;
}

void add_peaks(const RunStatistics& run, double max_force, Table& table) {
  std::string forces;
  for (int f = 0; f <= kFingerCount; ++f) {
    forces +=
        (f > 0 ? "   " : "") + finger_or_palm(f) + " " + brief(run.peak_force[static_cast<std::size_t>(f)]);
  }
  table.add("peak force [N]", forces);
  const auto [segment, force] = largest_segment_force(run);
  table.add("", "of a finger's three segments together; of one segment " + brief(force) +
                    (force > 0 ? " (" + std::string(segment_name(segment)) + ")" : std::string()) +
                    ", at most max_force " + brief(max_force));
  for (int first = 0; first < kSegmentCount; first += 3) {
    std::string torques;
    for (int s = first; s < std::min(first + 3, kSegmentCount); ++s) {
      const double torque = 1e3 * run.peak_torque[static_cast<std::size_t>(s)];
      torques += (s > first ? "   " : "") + moving_joint(s) + " " + brief(torque);
    }
    table.add(first == 0 ? "peak torque [N mm]" : "", torques);
  }
}

void add_flags(const RunStatistics& run, const DeviceLoop* device, Table& table) {
  if (run.starting_ticks > 0)
    table.add("starting", "in " + grouped(run.starting_ticks) +
                              " ticks: forces rise from zero within settings.fade_time, as at every start");
  for (const FlagText& text : kFlagTexts) {
    const std::uint64_t count = ticks_with(run, text.flag);
    if (count > 0) table.add(text.name, "in " + grouped(count) + " ticks: " + remedy_of(text, count, device));
  }
}

std::string execution_text(const Execution& execution) {
  return std::string(isa_name(execution.isa)) + ", " + std::string(broadphase_name(execution.broadphase)) +
         ", " + std::to_string(execution.threads) + " thread(s)";
}

void add_real_time(const RunStatistics& run, Table& table) {
  const RealTime& real_time = run.real_time;
  table.add("wake-up late by", times_text(run.wake_ups));
  std::string got = real_time.memory_locked ? "memory locked" : "memory not locked";
  got +=
      real_time.priority > 0 ? ", SCHED_FIFO " + std::to_string(real_time.priority) : ", ordinary priority";
  if (real_time.cpu >= 0) got += ", on processor " + std::to_string(real_time.cpu);
  table.add("real time", got + ", " + grouped(run.page_faults) + " page faults");
  for (const std::string& line : real_time.refused) table.add("", line);
}

void add_effort(const Model& model, const RunStatistics& run, Table& table) {
  const double fits = effort_for(model.settings.rate, run);
  if (!(fits > 0)) return;
  std::string text = "at most " + grouped(run.max_evaluations) + " evaluations a tick";
  if (model.settings.effort > 0) text += ", " + grouped(model.settings.effort) + " allowed";
  table.add("effort", text);
  table.add("", "\"effort\": " + std::to_string(static_cast<std::uint64_t>(fits)) +
                    " bounds them to half a period, by this session's times");
}

std::string run_text(const RunOptions& options, const SceneFile& scene_file, const Model& model,
                     const RunStatistics& run, const LateReport& late, const DeviceLoop* device) {
  Table table;
  for (const std::string& line : trouble_of(run, device))
    table.add(table.rows.empty() ? "trouble" : "", line);
  table.add("ticks", grouped(run.ticks) + " of " + brief(1e3 / model.settings.rate) + " ms" +
                         (run.interrupted ? ", stopped by a signal" : ""));
  const bool paced = options.rate != "max";
  table.add("rate", grouped(static_cast<std::uint64_t>(rate_reached(run))) + " Hz reached" +
                        (paced ? ", " + grouped(run.deadline_misses) + " ticks missed their deadline" : ""));
  if (paced) add_late(run.late, late, 1e6 / model.settings.rate, table);
  table.add("tick time", times_text(run.tick_times));
  if (device != nullptr) table.add("with the device", times_text(run.loop_times));
  if (paced) {
    add_real_time(run, table);
    add_effort(model, run, table);
  }
  table.add("hand", hand_text(scene_file.motion));
  table.add("contacts", "mean " + brief(mean_contacts(run)) + "   max " + grouped(run.max_contacts) +
                            "   of " + grouped(model.triangles.size()) + " triangles");
  table.add("computed with", std::string(broadphase_name(model.execution.broadphase)) + ", law " +
                                 law_of(model.settings) + ", " + std::string(isa_name(model.execution.isa)) +
                                 ", " + std::to_string(model.execution.threads) + " thread(s)");
  if (const auto report = voxel_report(model)) add_voxels(*report, table);
  add_windings(model.objects, table);
  if (scene_file.aligned) table.add("aligned", "write into the scene's motion, in the place of align:");
  if (scene_file.aligned) table.add("", pose_text(scene_file.placement.pose));
  if (model.world)
    table.add("world file", model.world->path + ", " + grouped(model.world->byte_count) + " bytes, at most " +
                                grouped(run.world_held) + " in memory");
  add_peaks(run, model.settings.max_force, table);
  add_flags(run, device, table);
  if (device != nullptr) device->add_rows(table);
  if (!options.record.empty()) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(options.record, error);
    table.add("recording", options.record + (error ? "" : ", " + grouped(size) + " bytes"));
    if (run.not_recorded > 0)
      table.add("", grouped(run.not_recorded) + (run.recording_error.ok()
                                                     ? " ticks not kept: the disk is too slow"
                                                     : " ticks not kept: the recording failed"));
  }
  return table.text();
}

int run_comparison(const RunOptions& options, const SceneFile& scene_file) {
  double seconds = scene_file.seconds;
  if (options.ticks) seconds = static_cast<double>(*options.ticks) / scene_file.scene.settings.rate;
  PrecisionComparison comparison;
  const Status status =
      compare_precision(scene_file.scene, scene_file.execution, scene_file.motion, seconds, comparison);
  return status.ok() ? print_comparison(comparison, options.json)
                     : fail(options.scene + ": " + status.message());
}

// A session without a contact is most often a motion that passes by, or a wrong unit.
void explain_untouched(const SceneFile& scene_file, RunStatistics& statistics) {
  const double seconds = static_cast<double>(statistics.ticks) / scene_file.scene.settings.rate;
  const Clearance clearance = find_clearance(scene_file.scene, scene_file.motion, seconds);
  statistics.clearance = to_json(clearance, scene_file.scene);
  statistics.untouched = approach_sentences(clearance, scene_file.scene);
  statistics.untouched.insert(statistics.untouched.begin(),
                              "nothing was touched; --align contact moves the hand to the first object");
}

int run(const RunOptions& options) {
  SceneFile scene_file;
  if (Status status = load(options, scene_file); !status.ok()) return fail(status);
  if (options.compare_precision) return run_comparison(options, scene_file);
  Model model;
  Status status = build_model(scene_file.scene, scene_file.execution, model);
  if (!status.ok()) return fail(options.scene + ": " + status.message());

  const bool paced = options.rate != "max";
  const bool with_device = options.sink != "null";
  const StopSignals stop_signals;
  LiveView live_view;
  if (options.view) {
    if (status = live_view.start(model); !status.ok()) return fail(status);
  }
  DeviceLoop device;
  if (with_device) {
    if (status = device.open(options.sink, model); !status.ok()) return fail(status);
    if (!measure_device(model, scene_file.motion, kMeasuring, device)) {
      return fail(options.scene + ": stopped by a signal before the first tick");
    }
    device.certify();
  }
  const double planned = std::ceil(scene_file.seconds * model.settings.rate - 1e-6);
  const std::uint64_t ticks = options.ticks.value_or(static_cast<std::uint64_t>(std::max(planned, 1.0)));
  Recorder recorder;
  const bool recording = !options.record.empty();
  if (recording) {
    RecorderOptions recorder_options;
    recorder_options.wait_when_full = !paced;
    recorder_options.force_interval = force_interval(options.record_forces);
    recorder_options.metadata = {{"scene_file", options.scene},
                                 {"program", version_text()},
                                 {"execution", execution_text(model.execution)},
                                 {"start_utc", utc_text()},
                                 {"start_monotonic_ns", std::to_string(clock_ns())}};
    if (with_device) recorder_options.metadata["certificate"] = device.certificate_text();
    status = recorder.open(options.record, scene_of(model), recorder_options);
    if (!status.ok()) return fail(status);
  }
  const bool unrecorded = options.on_record_error == "continue";
  RunStatistics statistics =
      run_session(model, scene_file.motion, ticks,
                  {paced, recording ? &recorder : nullptr, unrecorded, with_device ? &device : nullptr,
                   options.view ? &live_view : nullptr});
  device.close();  // forces end before anything else is done
  const bool told = !statistics.recording_error.ok();
  if (recording) {
    status = recorder.close();
    statistics.not_recorded = statistics.ticks - recorder.kept();
    if (!status.ok() && !told) return fail(status);
    if (!status.ok() && !unrecorded) return kUnreadable;
  }
  if (!statistics.world_error.ok()) return fail(statistics.world_error);
  if (statistics.contacts == 0 && statistics.ticks > 0) explain_untouched(scene_file, statistics);
  const DeviceLoop* const shown = with_device ? &device : nullptr;
  const LateReport late = study(statistics.late, scene_file.scene, model);
  const int printed = options.json
                          ? print_json(run_json(options, scene_file, model, statistics, late, shown))
                          : print_text(run_text(options, scene_file, model, statistics, late, shown));
  if (printed != kDone || told) return kUnreadable;
  if (with_device && !device.forces_flow()) return kNoForces;
  return statistics.interrupted ? kInterrupted : kDone;
}

std::string check_record_forces(std::string& text) {
  const bool whole = text.find_first_not_of("0123456789") == std::string::npos;
  if (text == "all" || text == "none" || (whole && number_in(1, 1000000).fault(text).empty())) return {};
  return "\"" + text + "\" is none of all, none and whole numbers of ticks, 1 to 1000000";
}

std::string check_rate(std::string& text) {
  return text == "max" ? std::string() : number_in(1, 100000).fault(text);
}

}  // namespace

void add_run(Command& app, int& exit_code) {
  const auto options = std::make_shared<RunOptions>();
  Command* const command =
      app.add_subcommand("run", "Let a hand motion meet a scene; print figures, record ticks");
  command->add_option("scene", options->scene, "Scene file (JSON, see schemas/scene.fbs)")->required();
  command->add_option("--motion", options->motion, "Hand motion in the place of the scene's")
      ->type_name("FILE");
  command->add_option("--motion-rate", options->motion_rate, "Of motion files without time stamps [Hz]")
      ->check(number_in(1e-3, 1e6));
  command
      ->add_option("--side", options->side,
                   "Which hand of a motion file, or what it is where it does not say")
      ->check(one_of({"left", "right"}));
  command->add_option("--unit", options->unit, "Of the motion file's numbers")->check(is_unit());
  command->add_option("--align", options->align, "Move the motion to an object, and tell where to")
      ->check(is_alignment())
      ->type_name("[OBJECT:]centre|top|...|contact|x,y,z");
  command->add_option("--ticks", options->ticks, "Length of the session; default: the motion's")
      ->check(number_in(1, 1e9));
  command->add_option("--rate", options->rate, "Ticks per second by the clock, or max: as fast as it goes")
      ->check(Check{check_rate, "HZ|max"})
      ->capture_default_str();
  command->add_option("--record", options->record, "Recording to write, where no file is yet")
      ->check(is_path())
      ->type_name("OUT.mcap");
  command
      ->add_option(
          "--record-forces", options->record_forces,
          "Ticks whose forces the recording holds, every Nth or none; a replay checks all by their hashes")
      ->check(Check{check_record_forces, "all|none|N"})
      ->capture_default_str();
  command
      ->add_option(
          "--on-record-error", options->on_record_error,
          "When the recording fails (disk full): stop, or continue unrecorded; exit code 2 either way")
      ->check(one_of({"stop", "continue"}))
      ->capture_default_str();
  command
      ->add_option(
          "--sink", options->sink,
          "Where forces go: null, modbus-tcp://HOST:PORT?profile=FILE, modbus-rtu:///dev/ttyX?profile=FILE")
      ->check(Check{check_sink_uri, "URI"});
  command->add_option("--broadphase", options->broadphase, "Search for candidate triangles")
      ->check(is_broadphase());
  command->add_option("--voxel-cache", options->voxel_cache, kVoxelCacheHelp)->type_name("FOLDER");
  command->add_option("--law", options->law, "Contact law of the whole hand")->check(is_law());
  command->add_option("--precision", options->precision, kPrecisionHelp)->check(is_precision());
  command->add_option("--effort", options->effort,
                      "Most evaluations a tick may spend on samples; 0: no bound");
  command->add_flag(
      "--compare-precision", options->compare_precision,
      "Instead of a session: each precision's error and time on this scene and motion, and advice");
  command->add_flag("--view", options->view, "Show the session in the browser while it runs (with a --rate)");
  command->add_option("--stiffness", options->stiffness, "K_s [N/m^3]")->check(number_in(1e-6, 1e15));
  command->add_option("--isa", options->isa, "Instruction set; never changes a result")->check(is_isa());
  command->add_option("--threads", options->threads, "1 .. 64; never changes a result")
      ->check(number_in(1, 64));
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace lumbrical::tool
