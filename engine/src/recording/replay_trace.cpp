// See replay_trace.h.
#include "recording/replay_trace.h"

#include <vector>

#include "files/text_output.h"
#include "recording/record_fields.h"
#include "tick/tick_trace.h"

namespace lumbrical {
namespace {

constexpr int kStateStage = kStageCount;  // behind the stages of a tick

int stage_number(const std::string& name) {
  for (int stage = 0; stage < kStageCount; ++stage)
    if (name == stage_name(static_cast<Stage>(stage))) return stage;
  return name == "output" ? static_cast<int>(Stage::limits) : kStateStage;
}

std::vector<TraceValue> values_of(const TickRun& run, int stage) {
  return stage == kStateStage
             ? trace_state(run.after)
             : trace_stage(run.scratch, run.device, run.given, run.output, static_cast<Stage>(stage));
}

std::string value_text(const TraceValue& value) { return number_text(value.type, value.bits); }

void name_owner(const TraceValue& value, Divergence& divergence) {
  divergence.field = value.field;
  if (value.primitive >= 0) divergence.primitive = static_cast<std::uint32_t>(value.primitive);
  if (value.triangle >= 0) divergence.triangle = static_cast<std::uint32_t>(value.triangle);
}

/// Whether a comes before b where both lists are sorted by primitive and triangle.
bool precedes(const TraceValue& a, const TraceValue& b) {
  return a.primitive != b.primitive ? a.primitive < b.primitive : a.triangle < b.triangle;
}

/// The first difference between two lists of the same stage.
void compare(const std::vector<TraceValue>& recorded, const std::vector<TraceValue>& replayed,
             Divergence& divergence) {
  for (std::size_t i = 0; i < recorded.size() || i < replayed.size(); ++i) {
    const TraceValue* const a = i < recorded.size() ? &recorded[i] : nullptr;
    const TraceValue* const b = i < replayed.size() ? &replayed[i] : nullptr;
    if (a != nullptr && b != nullptr && a->same_place(*b)) {
      if (a->bits == b->bits) continue;
      name_owner(*a, divergence);
      divergence.recorded = value_text(*a);
      divergence.replayed = value_text(*b);
      divergence.ulp = ulps_between(a->type, a->bits, b->bits);
      return;
    }
    // One side has a pair that the other has not.
    const bool only_recorded = b == nullptr || (a != nullptr && precedes(*a, *b));
    name_owner(only_recorded ? *a : *b, divergence);
    divergence.recorded = only_recorded ? value_text(*a) : "none";
    divergence.replayed = only_recorded ? "none" : value_text(*b);
    return;
  }
}

std::string hexadecimal_bits(const TraceValue& value) {
  const std::string text = hash_text(value.bits);
  return value.type == NumberType::real32 ? "0x" + text.substr(10) : text;
}

std::string line_of(std::uint64_t tick, const std::string& stage, const TraceValue& value) {
  std::string line = std::to_string(tick) + ' ' + stage;
  if (value.primitive >= 0) line += " primitive " + std::to_string(value.primitive);
  if (value.triangle >= 0) line += " triangle " + std::to_string(value.triangle);
  line += ' ' + value.field + ' ' + value_text(value);
  return is_real(value.type) ? line + ' ' + hexadecimal_bits(value) : line;
}

Status write_stage(const TickRun& run, int stage, TextOutput& out) {
  const std::string name =
      stage == kStateStage ? "state" : std::string(stage_name(static_cast<Stage>(stage)));
  for (const TraceValue& value : values_of(run, stage))
    if (Status status = out.line(line_of(run.output.tick, name, value)); !status.ok()) return status;
  return {};
}

Status write_stages(const TickRun& run, const std::string& stage, TextOutput& out) {
  const Execution& execution = run.execution;
  Status status = out.line("# " + build_text());
  if (status.ok())
    status = out.line("# " + std::string(isa_name(execution.isa)) + ", " +
                      std::string(broadphase_name(execution.broadphase)) + ", " +
                      std::to_string(execution.threads) + " thread(s)");
  for (int number = 0; status.ok() && number <= kStateStage; ++number)
    if (stage.empty() || number == stage_number(stage)) status = write_stage(run, number, out);
  return status;
}

}  // namespace

Status name_difference(const Scene& recorded_scene, const State& before, const TickRecord& recorded,
                       const TickRun& replayed, Divergence& divergence) {
  Execution plain;
  plain.broadphase = Broadphase::brute;
  plain.isa = Isa::scalar;
  Model model;
  if (Status status = build_model(recorded_scene, plain, model); !status.ok()) return status;
  State state = before;
  Scratch scratch = make_scratch(model);
  const ActuatorFrame output = tick(model, state, scratch, recorded.device, given_of(recorded));
  const int stage = stage_number(divergence.stage);
  const bool reproduced = stage == kStateStage ? hash_state(state) == recorded.state_hash
                                               : scratch.stage_hash[static_cast<std::size_t>(stage)] ==
                                                     recorded.stage_hash[static_cast<std::size_t>(stage)];
  // What the file holds of the output may have been changed there; then the engine has nothing to say.
  if (!reproduced || divergence.stage == "output") return {};
  compare(values_of({plain, state, scratch, recorded.device, given_of(recorded), output}, stage),
          values_of(replayed, stage), divergence);
  return {};
}

Status write_trace(const std::string& path, const TickRun& run, const std::string& stage) {
  return write_whole<TextOutput>(path, [&](TextOutput& out) { return write_stages(run, stage, out); });
}

}  // namespace lumbrical
