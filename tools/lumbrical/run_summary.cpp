// See run_summary.h.
#include "run_summary.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <utility>

#include "approach_text.h"
#include "stage_clock.h"
#include "winding_text.h"

namespace lumbrical::tool {
namespace {

std::size_t all_triangles(const Model& model) {
  std::size_t count = model.triangles.size();
  for (const ApartObject& object : model.apart) count += object.shape->triangles.size();
  return count;
}

struct FlagText {
  TickFlag flag;
  const char* name;
  const char* remedy;
};

constexpr FlagText kFlagTexts[] = {
    {kInputNotFinite, "input not finite", "NaN or infinity in the device frame; check the driver"},
    {kInputImplausible, "input implausible", "a joint far from its wrist; check the motion's unit"},
    {kInputLost, "input lost",
     "no tracking, samples more than 0.1 s apart (check the unit of times), or the motion has ended"},
    {kInputExtrapolated, "input extrapolated", "beyond or far between samples; track at a higher rate"},
    {kSegmentMissing, "segment missing", "some joints are not tracked: those segments feel nothing"},
    {kSegmentDegenerate, "segment degenerate", "a phalanx of zero length was felt as a sphere"},
    {kAngleClamped, "angle clamped", "a joint angle beyond the hand's limits; widen them"},
    {kCandidateOverflow, "candidate overflow", "raise settings.max_candidates"},
    {kForceLimited, "force limited", "a segment came near settings.max_force, and its force saturates"},
    {kCoarsened, "coarsened", "samples were coarser than asked, to stay within settings.effort"},
    {kObjectMissing, "object missing", "objects that are given were not told where they are, and stayed"},
    {kObjectImplausible, "object implausible",
     "poses of given objects were not finite or jumped: forces faded"},
    {kMemoryForeign, "memory foreign",
     "a tick was given memory of another model, and computed nothing: please report it"},
    {kHandJumped, "hand jumped",
     "farther in a tick than a hand can go; check the tracker, or mark frames as lost where its frame moves"},
    {kFading, "fading",
     "forces faded or rose again: their input could not be trusted for a while, joints came or went, the "
     "hand "
     "jumped, or a finger slipped off what held it back"},
};

// What all segments have in common.
template <class NameOf>
std::string common_name(const NameOf& name_of) {
  const std::string first = name_of(0);
  for (std::size_t i = 1; i < kSegmentCount; ++i) {
    if (name_of(i) != first) return "mixed";
  }
  return first;
}

std::string law_of(const Settings& settings) {
  return common_name([&](std::size_t i) { return std::string(law_name(settings.law[i])); });
}

// All laws but the field's are felt exactly.
std::string precision_of(const Settings& settings) {
  return common_name([&](std::size_t i) {
    const bool exactly = settings.law[i] != Law::field;
    return precision_name(exactly ? 0 : settings.precision[i]);
  });
}

double microseconds(const TickTimes& times, double share) { return times.percentile(share) / 1000; }

double rate_reached(const RunStatistics& run) {
  return run.wall_seconds > 0 ? static_cast<double>(run.ticks) / run.wall_seconds : 0;
}

// What a stall or two can't explain.
bool is_far_too_slow(const RunStatistics& run, double wanted) {
  return run.wall_seconds > 0.5 && rate_reached(run) < 0.8 * wanted;
}

double mean_contacts(const RunStatistics& run, const HandFigures& hand) {
  return run.ticks > 0 ? static_cast<double>(hand.contacts) / static_cast<double>(run.ticks) : 0;
}

// The joint that moves segment s: the one at its base.
std::string moving_joint(int s) {
  return std::string(
      joint_name(s == kPalmSegment ? kWrist : kPhalanxJoints[static_cast<std::size_t>(s)].base));
}

std::string finger_or_palm(int f) { return f < kFingerCount ? std::string(finger_name(f)) : "palm"; }

std::uint64_t ticks_with(const HandFigures& hand, TickFlag flag) {
  std::size_t bit = 0;
  while ((1u << bit) != flag) ++bit;
  return hand.flag_ticks[bit] - (flag == kFading ? hand.starting_ticks : 0);
}

std::pair<int, double> largest_segment_force(const HandFigures& hand) {
  const auto largest = std::max_element(hand.peak_segment.begin(), hand.peak_segment.end());
  return {static_cast<int>(largest - hand.peak_segment.begin()), *largest};
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

bool has_stages(const RunStatistics& run) { return run.stage_times[0].max() > 0; }

double stage_share(const RunStatistics& run, std::size_t stage) {
  return run.stage_sums[stage] / std::accumulate(run.stage_sums.begin(), run.stage_sums.end(), 0.0);
}

Json stages_json(const RunStatistics& run) {
  Json json;
  for (std::size_t i = 0; i < kStageCount; ++i) {
    Json stage = times_json(run.stage_times[i]);
    stage["share"] = stage_share(run, i);
    json[kStageWords[i]] = std::move(stage);
  }
  return json;
}

void add_stages(const RunStatistics& run, Table& table) {
  for (std::size_t i = 0; i < kStageCount; ++i) {
    std::string name = kStageWords[i];
    name.resize(9, ' ');
    table.add(i == 0 ? "of that" : "", name + "  " + times_text(run.stage_times[i]) + "   " +
                                           brief(100 * stage_share(run, i), 3) + " % of all");
  }
}

// Of ticks with all that is in them; 0 where nothing was felt by samples.
double ns_per_evaluation(const RunStatistics& run) {
  return run.evaluations > 0 ? run.evaluating_ns / run.evaluations : 0;
}

std::string way_to_touch(const RunStatistics& run, const SceneFile& scene_file) {
  const std::uint64_t all = tick_count(scene_file.seconds, scene_file.scene.settings.rate);
  if (scene_file.aligned && run.ticks < all)
    return " in the first " + grouped(run.ticks) + " of " + grouped(all) +
           " ticks; the alignment is by all of them, so run them all";
  if (scene_file.aligned) return " where the hand was moved to; --align x,y,z moves it elsewhere";
  return scene_file.scene.objects.empty() ? "; --align x,y,z moves the hand to a place in the world"
                                          : "; --align contact moves the hand to the first object";
}

// Before any figure: what a person must know who reads one line.
std::vector<std::string> trouble_of(const RunStatistics& run, const SceneFile& scene_file, bool paced,
                                    const DeviceSession* device) {
  std::vector<std::string> lines = device != nullptr ? device->trouble() : std::vector<std::string>();
  if (!run.recording_error.ok()) lines.push_back("the recording failed: " + run.recording_error.message());
  if (run.not_recorded > 0) lines.push_back(grouped(run.not_recorded) + " ticks are not in the recording");
  if (const double wanted = scene_file.scene.settings.rate; paced && is_far_too_slow(run, wanted))
    lines.push_back("ticks came at " + grouped(static_cast<std::uint64_t>(rate_reached(run))) + " Hz of " +
                    grouped(static_cast<std::uint64_t>(wanted)) +
                    ": everything took longer than it was to; lower --rate, or see docs/tuning.md");
  const auto touched = [](const HandFigures& hand) { return hand.contacts > 0; };
  const auto lost = [&run](const HandFigures& hand) { return lost_throughout(run, hand); };
  const auto overflowed = [](const HandFigures& hand) { return ticks_with(hand, kCandidateOverflow) > 0; };
  if (run.ticks == 0 || std::any_of(run.hands.begin(), run.hands.end(), touched)) return lines;
  if (std::any_of(run.hands.begin(), run.hands.end(), overflowed)) {
    lines.push_back("nothing was felt where more was near than settings.max_candidates; raise it");
    return lines;
  }
  if (std::all_of(run.hands.begin(), run.hands.end(), lost)) {
    lines.push_back("nothing was felt: in no tick was it known where the hand is");
    return lines;
  }
  lines.push_back("nothing was touched" + way_to_touch(run, scene_file));
  for (const HandFigures& hand : run.hands)
    lines.insert(lines.end(), hand.untouched.begin(), hand.untouched.end());
  return lines;
}

// Of a flag: what is missing is the device's, not the motion's, where the device moves the hand.
std::string remedy_of(const FlagText& text, std::uint64_t count, const DeviceSession* device) {
  if (text.flag != kInputLost || device == nullptr || device->ticks_without_angles() == 0) return text.remedy;
  return device->ticks_without_angles() < count
             ? "angles of the device missing or not believed, no tracking, or the motion has ended"
             : "angles of the device missing or not believed";
}

Json hand_json(const RunStatistics& run, const HandFigures& hand, double max_force) {
  Json json;
  json["contacts"] = {{"mean", mean_contacts(run, hand)}, {"max", hand.max_contacts}};
  for (int f = 0; f <= kFingerCount; ++f) {
    json["peak_force"][finger_or_palm(f)] = hand.peak_force[static_cast<std::size_t>(f)];
  }
  for (int s = 0; s < kSegmentCount; ++s) {
    json["peak_torque"][moving_joint(s)] = hand.peak_torque[static_cast<std::size_t>(s)];
  }
  const auto [segment, force] = largest_segment_force(hand);
  json["peak_segment"] = {{"segment", segment_name(segment)}, {"force", force}};
  json["max_force"] = max_force;
  json["starting_ticks"] = hand.starting_ticks;
  json["flags"] = Json::object();
  for (const FlagText& text : kFlagTexts) {
    if (const std::uint64_t count = ticks_with(hand, text.flag)) json["flags"][text.name] = count;
  }
  if (!hand.clearance.is_null()) json["clearance"] = hand.clearance;
  return json;
}

Json side_json(const Motion& motion) {
  return {{"side", side_name(motion.side)},
          {"other_side", side_name(motion.other_side)},
          {"other_frames", motion.other_frames}};
}

// Of one hand its figures stand beside the session's, of two each hand's stand in "hands".
void add_hands(const RunSummary& summary, Json& json) {
  const double max_force = summary.models[0].settings.max_force;
  const std::vector<HandFigures>& hands = summary.run.hands;
  if (hands.size() == 1) {
    json["hand"] = side_json(summary.scene_file.motion);
    json.update(hand_json(summary.run, hands[0], max_force));
    return;
  }
  for (std::size_t i = 0; i < hands.size(); ++i) {
    Json hand = {{"side", side_name(summary.models[i].hand.side)}};
    hand.update(hand_json(summary.run, hands[i], max_force));
    json["hands"].push_back(std::move(hand));
  }
}

void add_objects(const Model& model, std::size_t world_held, Json& json) {
  json["triangles"] = all_triangles(model);
  for (const World::Object& object : all_objects(model)) {
    json["objects"].push_back(
        {{"name", object.name}, {"triangles", object.triangle_count}, {"winding", to_json(object.winding)}});
  }
  if (model.world)
    json["world"] = {
        {"file", model.world->path}, {"bytes", model.world->byte_count}, {"held_bytes", world_held}};
}

void add_peaks(const HandFigures& hand, double max_force, Table& table) {
  std::string forces;
  for (int f = 0; f <= kFingerCount; ++f) {
    forces +=
        (f > 0 ? "   " : "") + finger_or_palm(f) + " " + brief(hand.peak_force[static_cast<std::size_t>(f)]);
  }
  table.add("peak force [N]", forces);
  const auto [segment, force] = largest_segment_force(hand);
  table.add("", "of a finger's three segments together; of one segment " + brief(force) +
                    (force > 0 ? " (" + std::string(segment_name(segment)) + ")" : std::string()) +
                    ", at most max_force " + brief(max_force));
  for (int first = 0; first < kSegmentCount; first += 3) {
    std::string torques;
    for (int s = first; s < std::min(first + 3, kSegmentCount); ++s) {
      const double torque = 1e3 * hand.peak_torque[static_cast<std::size_t>(s)];
      torques += (s > first ? "   " : "") + moving_joint(s) + " " + brief(torque);
    }
    table.add(first == 0 ? "peak torque [N mm]" : "", torques);
  }
}

void add_flags(const HandFigures& hand, const DeviceSession* device, Table& table) {
  if (hand.starting_ticks > 0)
    table.add("starting", "in " + grouped(hand.starting_ticks) +
                              " ticks: forces rise from zero within settings.fade_time, as at every start");
  for (const FlagText& text : kFlagTexts) {
    const std::uint64_t count = ticks_with(hand, text.flag);
    if (count > 0) table.add(text.name, "in " + grouped(count) + " ticks: " + remedy_of(text, count, device));
  }
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

void add_effort(const Model& model, const RunStatistics& run, const EffortReport& effort, Table& table) {
  if (run.slowest_by_samples.kept == 0) return;
  std::string text = "at most " + grouped(run.max_evaluations) + " evaluations a tick";
  if (model.settings.effort > 0) text += ", " + grouped(model.settings.effort) + " allowed";
  table.add("effort", text);
  if (effort.fits) {
    table.add("", "\"effort\": " + std::to_string(static_cast<std::uint64_t>(*effort.fits)) +
                      " keeps ticks within half a period, by the slowest of them");
    return;
  }
  table.add("", "no bound on it keeps ticks within half a period: with the least effort there is one takes " +
                    brief(effort.least_microseconds) + " us");
}

void add_effort_exceeded(const Model& model, const RunStatistics& run, Table& table) {
  if (model.settings.effort == 0 || run.max_evaluations <= model.settings.effort) return;
  table.add("bound on effort", "was not held: " + grouped(run.max_evaluations) + " evaluations in a tick, " +
                                   grouped(model.settings.effort) + " allowed");
  table.add("", "coarser than one cell a patch no tick can be; a coarser precision makes fewer patches");
}

void add_hand(const RunSummary& summary, std::size_t i, Table& table) {
  const RunStatistics& run = summary.run;
  const HandFigures& hand = run.hands[i];
  const Model& model = summary.models[i];
  table.add("hand", run.hands.size() > 1 ? std::string(side_name(model.hand.side))
                                         : hand_text(summary.scene_file.motion));
  table.add("contacts", "mean " + brief(mean_contacts(run, hand)) + "   max " + grouped(hand.max_contacts) +
                            "   of " + grouped(all_triangles(model)) + " triangles");
  for (std::size_t line = 0; run.hands.size() > 1 && line < hand.untouched.size(); ++line)
    table.add(line == 0 ? "not touched" : "", hand.untouched[line]);
  add_peaks(hand, model.settings.max_force, table);
  add_flags(hand, summary.device, table);
}

void add_computed_with(const RunSummary& summary, Table& table) {
  const Model& model = summary.models[0];
  table.add("computed with", std::string(broadphase_name(model.execution.broadphase)) + ", law " +
                                 law_of(model.settings) + ", precision " + precision_of(model.settings) +
                                 ", " + std::string(isa_name(model.execution.isa)) + ", " +
                                 std::to_string(model.execution.threads) + " thread(s)");
  if (const auto report = voxel_report(model)) add_voxels(*report, table);
  add_windings(all_objects(model), table);
  const SceneFile& scene_file = summary.scene_file;
  if (scene_file.aligned) table.add("aligned", "write into the scene's motion, in the place of align:");
  if (scene_file.aligned) table.add("", pose_text(scene_file.placement.pose));
  if (scene_file.touching) table.add("", kTouching);
  if (model.world)
    table.add("world file", model.world->path + ", " + grouped(model.world->byte_count) + " bytes, at most " +
                                grouped(std::min(summary.run.world_held, model.world->byte_count)) +
                                " in memory");
}

void add_recording(const RunSummary& summary, Table& table) {
  if (summary.recording.empty()) return;
  const RunStatistics& run = summary.run;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(summary.recording, error);
  table.add("recording", summary.recording + (error ? "" : ", " + grouped(size) + " bytes"));
  if (run.not_recorded > 0)
    table.add(
        "", grouped(run.not_recorded) + (run.recording_error.ok() ? " ticks not kept: the disk is too slow"
                                                                  : " ticks not kept: the recording failed"));
}

}  // namespace

Json run_json(const RunSummary& summary) {
  const auto& [scene_file, models, run, late, effort, device, paced, recording] = summary;
  const Model& model = models[0];
  Json json;
  json["trouble"] = trouble_of(run, scene_file, paced, device);
  json["ticks"] = run.ticks;
  json["rate_hz"] = rate_reached(run);
  json["tick_us"] = times_json(run.tick_times);
  json["deadline_misses"] = paced ? Json(run.deadline_misses) : Json(nullptr);
  if (has_stages(run)) json["stage_us"] = stages_json(run);
  json["effort"] = {{"max_evaluations", run.max_evaluations},
                    {"ns_per_evaluation", ns_per_evaluation(run)},
                    {"fits_half_a_period", effort.fits ? Json(*effort.fits) : Json(nullptr)}};
  json["isa"] = isa_name(model.execution.isa);
  json["threads"] = model.execution.threads;
  json["broadphase"] = broadphase_name(model.execution.broadphase);
  if (const auto report = voxel_report(model)) json["voxel_index"] = to_json(*report);
  json["law"] = law_of(model.settings);
  json["precision"] = precision_of(model.settings);
  json["recording"] = recording.empty() ? Json(nullptr) : Json(recording);
  json["not_recorded"] = run.not_recorded;
  json["session_rate_hz"] = model.settings.rate;
  add_objects(model, run.world_held, json);
  add_hands(summary, json);
  json["moved"] = moved_json(model, run.objects);
  json["interrupted"] = run.interrupted;
  if (scene_file.aligned) json["aligned"] = pose_json(scene_file.placement.pose);
  if (scene_file.touching) json["touching"] = true;
  if (paced) {
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

std::string run_text(const RunSummary& summary) {
  const auto& [scene_file, models, run, late, effort, device, paced, recording] = summary;
  const Model& model = models[0];
  Table table;
  for (const std::string& line : trouble_of(run, scene_file, paced, device))
    table.add(table.rows.empty() ? "trouble" : "", line);
  table.add("ticks", grouped(run.ticks) + " of " + brief(1e3 / model.settings.rate) + " ms" +
                         (run.interrupted ? ", stopped by a signal" : ""));
  table.add("rate", grouped(static_cast<std::uint64_t>(rate_reached(run))) + " Hz reached" +
                        (paced ? ", " + grouped(run.deadline_misses) + " ticks missed their deadline" : ""));
  if (paced) add_late(run.late, late, 1e6 / model.settings.rate, table);
  table.add("tick time", times_text(run.tick_times));
  if (has_stages(run)) add_stages(run, table);
  if (device != nullptr) table.add("with the device", times_text(run.loop_times));
  if (paced) {
    add_real_time(run, table);
    add_effort(model, run, effort, table);
  }
  add_effort_exceeded(model, run, table);
  add_computed_with(summary, table);
  for (std::size_t i = 0; i < run.hands.size(); ++i) add_hand(summary, i, table);
  add_moved(model, run.objects, table);
  if (device != nullptr) device->add_rows(table);
  add_recording(summary, table);
  return table.text();
}

}  // namespace lumbrical::tool
