// Replay and comparison: the recording is the device, the recorded output is what the engine has to give
// again.
#include <algorithm>
#include <string>
#include <vector>

#include "hash.h"
#include "lumbrical/recording.h"
#include "record_fields.h"
#include "session_message.h"

namespace lumbrical {
namespace {

constexpr std::uint64_t kProgressInterval = 1000;  // ticks between reports

Scene scene_for(const RecordingReader& reader, const ReplayOptions& options) {
  Scene scene = reader.scene();
  if (options.law) scene.settings.law.fill(*options.law);
  if (options.tolerance) scene.settings.tolerance = *options.tolerance;
  if (options.stiffness) scene.settings.stiffness = *options.stiffness;
  return scene;
}

Status broken(const RecordingReader& reader, const std::string& what) {
  return Status::error(reader.info().path + ": " + what);
}

Status missing(const RecordingReader& reader, std::uint64_t expected, std::uint64_t found) {
  return broken(reader, "tick " + std::to_string(expected) + " is missing (the next one recorded is " +
                            std::to_string(found) +
                            "): what the engine carried over from it is unknown, so no tick from " +
                            "there on can be replayed; record without gaps (not paced by the clock)");
}

TickRecord run_tick(const Model& model, State& state, Scratch& scratch, const DeviceFrame& device) {
  TickRecord result;
  result.device = device;
  result.output = tick(model, state, scratch, device);
  result.stage_hash = scratch.stage_hash;
  result.state_hash = hash_state(state);
  return result;
}

/// The first input field in which two records differ.
std::optional<Divergence> compare_inputs(const TickRecord& a, const TickRecord& b) {
  const InputFields fields_a = input_fields(a), fields_b = input_fields(b);
  const auto [at_a, at_b] = std::mismatch(fields_a.begin(), fields_a.end(), fields_b.begin());
  if (at_a == fields_a.end()) return std::nullopt;
  const int field = static_cast<int>(at_a - fields_a.begin());
  return Divergence{std::min(a.output.tick, b.output.tick), "input", input_field_name(field),
                    input_field_text(field, *at_a), input_field_text(field, *at_b)};
}

Status session_hash(const Scene& scene, std::uint64_t& hash) {
  std::vector<std::uint8_t> session;
  if (Status status = encode_session(scene, session); !status.ok()) return status;
  Hasher hasher;
  hasher.array(session);
  hash = hasher.digest();
  return {};
}

// Where all ticks agree, the worlds may still differ where nothing was touched.
Status compare_scenes(const RecordingReader& a, const RecordingReader& b, ReplayResult& result) {
  std::uint64_t hash_a = 0, hash_b = 0;
  if (Status status = session_hash(a.scene(), hash_a); !status.ok()) return status;
  if (Status status = session_hash(b.scene(), hash_b); !status.ok()) return status;
  if (hash_a != hash_b)
    result.first_divergence = {a.info().first_tick, "scene", "hash", hash_text(hash_a), hash_text(hash_b)};
  return {};
}

}  // namespace

Status replay(RecordingReader& reader, const ReplayOptions& options, ReplayResult& result) {
  result = {};
  Model model;
  if (Status status = build_model(scene_for(reader, options), options.execution, model); !status.ok())
    return broken(reader, status.message());
  if (Status status = reader.seek(0); !status.ok()) return status;
  if (reader.info().ticks == 0)
    return broken(reader, "the recording holds no tick; there is nothing to replay");

  State state;
  Scratch scratch = make_scratch(model);
  TickRecord recorded;
  for (;;) {
    bool end = false;
    if (Status status = reader.next(recorded, end); !status.ok()) return status;
    if (end) break;
    ++result.ticks;
    // An altered input is named as such, before its consequences: a changed tick number, for one, looks like
    // a gap.
    result.first_divergence = reader.altered_input();
    if (result.first_divergence) return {};
    if (recorded.output.tick != state.tick) return missing(reader, state.tick, recorded.output.tick);
    result.first_divergence = compare_results(recorded, run_tick(model, state, scratch, recorded.device));
    if (result.first_divergence) return {};
    if (options.progress && result.ticks % kProgressInterval == 0)
      options.progress(result.ticks, reader.info().ticks);
  }
  if (result.ticks != reader.info().ticks)
    return broken(reader, "the recording declares " + std::to_string(reader.info().ticks) +
                              " ticks but holds " + std::to_string(result.ticks) +
                              "; the file is damaged, run recover");
  return {};
}

Status diff_recordings(RecordingReader& a, RecordingReader& b, ReplayResult& result) {
  result = {};
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

}  // namespace lumbrical
