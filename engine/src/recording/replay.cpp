// Replay and comparison: the recording is the device, the recorded output is what the engine has to give
// again.
#include <algorithm>
#include <chrono>
#include <new>
#include <string>
#include <vector>

#include "base/check_stop.h"
#include "base/hash.h"
#include "lumbrical/recording.h"
#include "recording/record_fields.h"
#include "recording/replay.h"
#include "recording/replay_trace.h"
#include "recording/session_message.h"

namespace lumbrical {
namespace {

Status broken(const RecordingReader& reader, const std::string& what) {
  return Status::error(reader.info().path + ": " + what);
}

void run_tick(const Model& model, State& state, Scratch& scratch, TickRecord& result) {
  result.output = tick(model, state, scratch, result.device, given_of(result));
  take_results(state, scratch, result);
}

std::string build_of(const RecordingReader& reader) {
  const auto build = reader.info().metadata.find("build");
  return build == reader.info().metadata.end() ? "unknown" : build->second;
}

void name_builds(const RecordingReader& reader, Divergence& divergence) {
  divergence.recorded_build = build_of(reader);
  divergence.replayed_build = build_text();
}

Status session_hash(const Scene& scene, std::uint64_t& hash) {
  std::vector<std::uint8_t> session;
  if (Status status = encode_session(scene, session); !status.ok()) return status;
  hash = hash_of_bytes(session.data(), session.size());
  return {};
}

// Where all ticks agree, the worlds may still differ where nothing was touched.
Status compare_scenes(const RecordingReader& a, const RecordingReader& b, ReplayResult& result) {
  std::uint64_t hash_a = 0, hash_b = 0;
  if (Status status = session_hash(a.scene(), hash_a); !status.ok()) return status;
  if (Status status = session_hash(b.scene(), hash_b); !status.ok()) return status;
  if (hash_a == hash_b) return {};
  const std::uint64_t tick = a.info().first_tick;
  result.first_divergence = compare_settings(tick, a.scene().settings, b.scene().settings);
  if (!result.first_divergence)
    result.first_divergence = {tick, "scene", "hash", hash_text(hash_a), hash_text(hash_b)};
  return {};
}

// A mesh in the world frame takes an object's place. Nobody has asked yet which way it is wound.
Status replace_mesh(const Mesh& mesh, SceneObject& object) {
  const std::size_t factors = object.surface.friction_factor.size();
  if (factors > 0 && factors != mesh.triangles.size())
    return Status::error("object \"" + object.name + "\" has a friction factor for each of its " +
                         std::to_string(factors) + " triangles, and the mesh in its place has " +
                         std::to_string(mesh.triangles.size()) +
                         "; give one of as many, in the same order, or record a scene without friction_file");
  object.mesh = mesh;
  object.winding = Winding::automatic;
  if (is_apart(object))
    place_mesh(inverse({object.pose.position, normalized(object.pose.orientation)}), object.mesh);
  return {};
}

}  // namespace

Status scene_for(RecordingReader& reader, const ReplayOptions& options, Scene& scene) {
  if (Status status = reader.find_world(options.world); !status.ok()) return status;
  scene = reader.scene();
  if (scene.world && !options.mesh.empty())
    return Status::error(reader.info().path +
                         ": its world is a file, of which no object can be replaced; build another world");
  if (options.law) scene.settings.law.fill(*options.law);
  if (options.precision) scene.settings.precision.fill(*options.precision);
  if (options.stiffness) scene.settings.stiffness = *options.stiffness;
  for (const auto& other : options.mesh) {
    const std::string& name = other.first;  // no structured binding: clang 14 does not capture those
    const auto is_meant = [&name](const SceneObject& o) { return o.name == name; };
    const auto object = std::find_if(scene.objects.begin(), scene.objects.end(), is_meant);
    if (object == scene.objects.end())
      return Status::error(reader.info().path + ": the scene has no object \"" + name +
                           "\"; lumbrical info lists them");
    if (std::find_if(object + 1, scene.objects.end(), is_meant) != scene.objects.end())
      return Status::error(
          reader.info().path + ": the scene has several objects \"" + name +
          "\", of which none can be meant alone; give them names of their own and record anew");
    if (Status status = replace_mesh(other.second, *object); !status.ok())
      return broken(reader, status.message());
  }
  return {};
}

// Whether a disk was too slow or the file was damaged, parts of what is there can be replayed.
Status missing_tick(const RecordingReader& reader, std::uint64_t expected, std::uint64_t found) {
  const RecordingInfo& info = reader.info();
  std::string remedy = "trim makes recordings that can: ";
  if (expected > info.first_tick)
    remedy += "of the ticks before it (--to-tick " + std::to_string(expected) + "), and ";
  return Status::error(
      info.path + ": tick " + std::to_string(expected) + " is missing (the next one recorded is " +
      std::to_string(found) + "): what the engine carried over from it is unknown, so no tick from " +
      "there on can be replayed; " + remedy + "of those from some hundred behind it (--from-tick)");
}

namespace {

Status input_was_altered() { return Status::error("an input up to it was altered"); }

/// One replay: what stays the same from tick to tick.
struct Run {
  RecordingReader& reader;
  const ReplayOptions& options;
  ReplayResult& result;
  Model model;
  State state;
  Scratch scratch;
  bool traced = false;

  Status tick_of(const TickRecord& recorded);
  Status compare(const TickRecord& recorded, const TickRecord& replayed, const State& before,
                 const TickRun& run);
  Status trace(const TickRun& run);
  Status trace_behind();
  [[nodiscard]] bool awaits_trace() const { return !options.trace.empty() && options.trace_tick && !traced; }
};

// What differs is named in the result.
Status Run::compare(const TickRecord& recorded, const TickRecord& replayed, const State& before,
                    const TickRun& run) {
  result.first_divergence = compare_results(recorded, replayed);
  if (!result.first_divergence) return {};
  return name_difference(reader.scene(), before, recorded, run, *result.first_divergence);
}

Status Run::trace(const TickRun& run) {
  const bool is_asked_for = options.trace_tick.has_value();
  const bool wanted =
      is_asked_for ? *options.trace_tick == run.output.tick : result.first_divergence.has_value();
  if (options.trace.empty() || !wanted) return {};
  traced = true;
  const std::string stage = options.trace_stage ? std::string(stage_name(*options.trace_stage))
                            : is_asked_for      ? std::string()
                                                : result.first_divergence->stage;
  return write_trace(options.trace, run, stage);
}

// Compares one tick, unless an earlier one has differed, and traces it where that was asked for.
Status Run::tick_of(const TickRecord& recorded) {
  // An altered input is named as such, before its consequences: a changed tick number, for one, looks like
  // a gap.
  const bool compares = !result.first_divergence;
  if (compares) ++result.ticks;
  if (const std::optional<Divergence> altered = reader.altered_input()) {
    if (!compares) return input_was_altered();
    result.first_divergence = altered;
    return {};
  }
  if (recorded.output.tick != state.tick) return missing_tick(reader, state.tick, recorded.output.tick);
  const State before = state;
  TickRecord replayed;
  take_input(recorded.device, given_of(recorded), replayed);
  const auto start = std::chrono::steady_clock::now();
  run_tick(model, state, scratch, replayed);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const TickRun run{model.execution, state, scratch, replayed.device, given_of(replayed), replayed.output};
  if (compares) {
    result.replayed_time += seconds;
    result.recorded_time += 1e-9 * recorded.duration_ns;
    if (Status status = compare(recorded, replayed, before, run); !status.ok()) return status;
  }
  return trace(run);
}

// A tick behind the first difference, which stands whatever becomes of this.
Status Run::trace_behind() {
  const bool has_run = state.tick > result.first_divergence->tick;
  if (awaits_trace() && !has_run) return input_was_altered();
  for (TickRecord recorded; awaits_trace();) {
    bool end = false;
    if (Status status = reader.next(recorded, end); !status.ok()) return status;
    if (end) return Status::error("tick " + std::to_string(*options.trace_tick) + " is not behind it");
    if (Status status = tick_of(recorded); !status.ok()) return status;
  }
  return {};
}

Status replay_ticks(RecordingReader& reader, const ReplayOptions& options, ReplayResult& result) {
  Run run{reader, options, result, {}, {}, {}};
  Scene scene;
  Status status = scene_for(reader, options, scene);
  if (!status.ok()) return status;
  status = build_model(scene, options.execution, run.model);
  if (!status.ok()) return broken(reader, status.message());
  result.broadphase = run.model.execution.broadphase;
  if (status = reader.seek(0); !status.ok()) return status;
  if (reader.info().ticks == 0)
    return broken(reader, "the recording holds no tick; there is nothing to replay");

  run.state = reader.initial_state(run.model);
  run.scratch = make_scratch(run.model);
  TickRecord recorded;
  while (!result.first_divergence) {
    bool end = false;
    if (status = check_stop(options.stop); !status.ok()) return status;
    if (status = reader.next(recorded, end); !status.ok()) return status;
    if (end) break;
    if (status = run.tick_of(recorded); !status.ok()) return status;
    if (options.progress && result.ticks % kProgressInterval == 0)
      options.progress(result.ticks, reader.info().ticks);
  }
  if (result.first_divergence) {
    name_builds(reader, *result.first_divergence);
    if (status = run.trace_behind(); !status.ok()) result.not_traced = status.message();
    return {};
  }
  if (result.ticks != reader.info().ticks)
    return broken(reader, "the recording declares " + std::to_string(reader.info().ticks) +
                              " ticks but holds " + std::to_string(result.ticks) +
                              "; the file is damaged, run recover");
  if (run.awaits_trace())
    return broken(reader,
                  "tick " + std::to_string(*options.trace_tick) + " is not in it; nothing was traced");
  return {};
}

// Ticks that come out as recorded say nothing about the rest of the file.
std::string damage_of(const RecordingReader& reader) {
  RecordingInfo info;
  return reader.info().growing ? std::string() : verify_recording(reader.info().path, info).message();
}

}  // namespace

Status replay(RecordingReader& reader, const ReplayOptions& options, ReplayResult& result) try {
  result = {};
  if (Status status = replay_ticks(reader, options, result); !status.ok()) return status;
  result.damage = damage_of(reader);
  return {};
} catch (const std::bad_alloc&) {
  return broken(reader, "not enough memory to replay the recording");
}

Status replay_hands(const std::string& path, const ReplayOptions& options, ReplayResult& result) try {
  result = {};
  std::vector<RecordingReader> readers;
  if (Status status = open_hands(path, readers); !status.ok()) return status;
  for (RecordingReader& reader : readers) {
    ReplayResult one;
    if (Status status = replay_ticks(reader, options, one); !status.ok()) return status;
    one.ticks += result.ticks;
    one.recorded_time += result.recorded_time;
    one.replayed_time += result.replayed_time;
    result = one;
    if (result.first_divergence) break;
  }
  result.damage = damage_of(readers[0]);
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to replay the recording");
}

namespace {

Status compare_recordings(RecordingReader& a, RecordingReader& b, ReplayResult& result) {
  if (Status status = a.seek(0); !status.ok()) return status;
  if (Status status = b.seek(0); !status.ok()) return status;
  for (;;) {
    TickRecord record_a, record_b;
    bool end_a = false, end_b = false;
    if (Status status = a.next(record_a, end_a); !status.ok()) return status;
    if (Status status = b.next(record_b, end_b); !status.ok()) return status;
    if (end_a && end_b) return compare_scenes(a, b, result);
    ++result.ticks;
    if (end_a || end_b) {
      const std::string tick = std::to_string((end_a ? record_b : record_a).output.tick);
      result.first_divergence = {(end_a ? record_b : record_a).output.tick, "input", "tick",
                                 end_a ? "none" : tick, end_b ? "none" : tick};
      return {};
    }
    result.first_divergence = compare_inputs(record_a, record_b);
    if (!result.first_divergence) result.first_divergence = compare_results(record_a, record_b);
    if (result.first_divergence) return {};
  }
}

}  // namespace

Status diff_recordings(RecordingReader& a, RecordingReader& b, ReplayResult& result) try {
  result = {};
  Status status = compare_recordings(a, b, result);
  if (result.first_divergence) {
    result.first_divergence->recorded_build = build_of(a);
    result.first_divergence->replayed_build = build_of(b);
  }
  return status;
} catch (const std::bad_alloc&) {
  return broken(a, "not enough memory to compare the recordings");
}

}  // namespace lumbrical
