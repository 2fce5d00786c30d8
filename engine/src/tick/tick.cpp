// The tick: one stage after the other, each a function of the data before it.
#include "lumbrical/tick.h"

#include "base/floating_point.h"
#include "samples/sampled_forces.h"
#include "stages/broadphase.h"
#include "stages/contact_force.h"
#include "stages/force_limits.h"
#include "stages/hand_pose.h"
#include "stages/narrowphase.h"
#include "tick/field_lists.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kUntrusted = kInputNotFinite | kInputImplausible | kInputLost | kCandidateOverflow;

/// What the stages of one tick have found.
struct Findings {
  const DeviceFrame& frame;
  const Primitives& hand;
  const SampledForces& sampled;
  std::span<const std::uint64_t> candidates;
  std::span<const Contact> contacts;
  const HandForces& forces;
  const ActuatorFrame& output;
};

void hash_stages(const Findings& found, std::array<std::uint64_t, kStageCount>& stage_hash) {
  const auto hash_of_stage = [&stage_hash](Stage stage) -> std::uint64_t& {
    return stage_hash[static_cast<std::size_t>(stage)];
  };
  hash_of_stage(Stage::input) = hash_fields(found.frame);
  hash_of_stage(Stage::hand_pose) = hash_fields(found.hand);
  hash_of_stage(Stage::broadphase) = hash_rows(found.candidates);
  Hasher narrowphase;
  narrowphase.value(hash_rows(found.contacts));
  narrowphase.value(hash_fields(found.sampled));
  hash_of_stage(Stage::narrowphase) = narrowphase.digest();
  hash_of_stage(Stage::contact_force) = hash_fields(found.forces);
  hash_of_stage(Stage::limits) = hash_fields(found.output);
}

}  // namespace

std::string_view stage_name(Stage stage) {
  constexpr std::array<std::string_view, kStageCount> names = {"input",       "hand_pose",     "broadphase",
                                                               "narrowphase", "contact_force", "limits"};
  return names[static_cast<std::size_t>(stage)];
}

Scratch make_scratch(const Model& model) {
  Scratch scratch;
  scratch.primitives = std::make_shared<Primitives>();
  size_candidates(model, scratch);
  scratch.samples = std::make_shared<SampleMemory>();
  size_samples(model, *scratch.samples);
  scratch.contacts.resize(scratch.candidates.size());
  return scratch;
}

// Candidates of what is left to the exact rung: segments that are not felt by samples, and triangles too
// large for them. False where there are too many.
bool find_exact_candidates(const Model& model, const Primitives& hand, Scratch& scratch) {
  const std::uint32_t sampled = sampled_segments(model);
  if (sampled == kAllSegments) return !model.rest || find_candidates(*model.rest, hand, scratch);
  if (!find_candidates(model, hand, scratch)) return false;
  if (sampled == 0) return true;
  const auto is_left = [&](std::uint64_t pair) {
    return !felt_by_samples(model, hand.primitive[pair >> 32].segment, static_cast<std::uint32_t>(pair));
  };
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scratch.candidate_count; ++i) {
    scratch.candidates[count] = scratch.candidates[i];
    count += is_left(scratch.candidates[i]) ? 1 : 0;
  }
  scratch.candidate_count = count;
  return true;
}

void tell(const StageWatch& watch, Stage stage) {
  if (watch.ended != nullptr) watch.ended(watch.self, stage);
}

void find_all_contacts(const Model& model, const Primitives& hand, Scratch& scratch) {
  const std::span<const std::uint64_t> candidates(scratch.candidates.data(), scratch.candidate_count);
  scratch.contact_count = find_contacts(model, hand, candidates, scratch.contacts);
}

// [N] By experience: see Settings::precision.
double error_estimate(const Settings& settings, const SampledForces& sampled) {
  double estimate = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    estimate += min(1, sampled.error_factor * settings.precision[i]) * norm(sampled.segment[i].force);
  return settings.stiffness * estimate;
}

ActuatorFrame tick(const Model& model, State& state, Scratch& scratch, const DeviceFrame& frame) {
  const FloatingPointGuard guard;
  Primitives& hand = *scratch.primitives;
  hand.count = 0;
  hand.out_of_reach = false;
  // What this frame does not tell must not be left from another: a tick, hashes included, is a function of
  // model, state and frame. Even no force times an old axis has that axis' sign.
  hand.base_joint = hand.flexion_axis = {};
  hand.palm.corner_count = 0;
  scratch.candidate_count = scratch.contact_count = 0;

  SampledForces& sampled = scratch.samples->forces;
  sampled = {};
  std::uint32_t flags = check_input(frame);
  if ((frame.flags & kTrackingLost) != 0) flags |= kInputLost;
  if ((frame.flags & kExtrapolated) != 0) flags |= kInputExtrapolated;
  hand.flags = flags;
  tell(scratch.watch, Stage::input);
  if ((flags & kUntrusted) == 0) {
    flags = hand.flags |= place_hand(model.hand, model.settings, frame, hand);
    hand.out_of_reach = !may_meet(model.hand, hand, model.extent);  // and needs no shape
    if (!hand.out_of_reach) {
      tile_hand(model.hand, model.settings, hand);
      tell(scratch.watch, Stage::hand_pose);
      if (model.patches && !sample_forces(model, hand, sampled_segments(model), *scratch.samples, sampled))
        flags |= kCandidateOverflow;
      if (sampled.coarsened) flags |= kCoarsened;
      tell(scratch.watch, Stage::narrowphase);
      if (!find_exact_candidates(model, hand, scratch)) flags |= kCandidateOverflow;
    }
  }
  tell(scratch.watch, Stage::broadphase);
  find_all_contacts(model, hand, scratch);
  tell(scratch.watch, Stage::narrowphase);
  const std::span<const std::uint64_t> candidates(scratch.candidates.data(), scratch.candidate_count);
  const std::span<const Contact> contacts(scratch.contacts.data(), scratch.contact_count);
  const HandForces forces = sum_forces(model.settings, hand, contacts, sampled.segment);
  tell(scratch.watch, Stage::contact_force);
  ActuatorFrame output = limit_forces(model.settings, hand, forces, (flags & kUntrusted) == 0, flags, state);
  output.contact_count = scratch.contact_count + sampled.contact_count;
  output.evaluations = sampled.evaluations;
  output.force_error = force_error(model.settings, contacts);
  output.error_estimate = error_estimate(model.settings, sampled);
  tell(scratch.watch, Stage::limits);

  if (scratch.hash_stages)
    hash_stages({frame, hand, sampled, candidates, contacts, forces, output}, scratch.stage_hash);
  return output;
}

std::span<const Contact> find_contacts(const Model& model, Scratch& scratch) {
  const Primitives& hand = *scratch.primitives;
  if (sampled_segments(model) != 0 && hand.count > 0) {
    const FloatingPointGuard guard;
    if (!find_candidates(model, hand, scratch)) scratch.candidate_count = 0;
    find_all_contacts(model, hand, scratch);
  }
  for (std::uint32_t i = 0; i < scratch.contact_count; ++i)
    scratch.contacts[i].depth = contact_depth(model, scratch, scratch.contacts[i]);
  return {scratch.contacts.data(), scratch.contact_count};
}

double contact_depth(const Model& model, const Scratch& scratch, const Contact& contact) {
  const FloatingPointGuard guard;
  return depth_of(model, *scratch.primitives, contact);
}

std::uint64_t hash_state(const State& state) { return hash_fields(state); }

}  // namespace lumbrical
