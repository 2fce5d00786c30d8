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
  hash_of_stage(Stage::narrowphase) = hash_rows(found.contacts);
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

// Is there anything left to the exact rung?
bool leaves_exact(const Model& model) {
  if (!model.patches || !model.patches->exact.empty()) return true;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (!is_sampled(model.settings, i)) return true;
  }
  return false;
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

  SampledForces sampled;
  std::uint32_t flags = check_input(frame);
  if ((frame.flags & kTrackingLost) != 0) flags |= kInputLost;
  if ((frame.flags & kExtrapolated) != 0) flags |= kInputExtrapolated;
  hand.flags = flags;
  if ((flags & kUntrusted) == 0) {
    flags = hand.flags |= place_hand(model.hand, model.settings, frame, hand);
    hand.out_of_reach = !may_meet(model.hand, hand, model.extent);  // and needs no shape
    if (!hand.out_of_reach) {
      tile_hand(model.hand, model.settings, hand);
      if (model.patches && !sample_forces(model, hand, *scratch.samples, sampled))
        flags |= kCandidateOverflow;
      if (leaves_exact(model) && !find_candidates(model, hand, scratch)) flags |= kCandidateOverflow;
    }
  }
  const std::span<const std::uint64_t> candidates(scratch.candidates.data(), scratch.candidate_count);
  scratch.contact_count = find_contacts(model, hand, candidates, scratch.contacts);
  const std::span<const Contact> contacts(scratch.contacts.data(), scratch.contact_count);
  HandForces forces = sum_forces(model.settings, hand, contacts);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    forces.segment[i].force += sampled.segment[i].force;
    forces.segment[i].torque += sampled.segment[i].torque;
  }
  ActuatorFrame output = limit_forces(model.settings, hand, forces, (flags & kUntrusted) == 0, flags, state);
  output.contact_count = scratch.contact_count + sampled.contact_count;
  output.force_error = force_error(model.settings, contacts);

  if (scratch.hash_stages)
    hash_stages({frame, hand, candidates, contacts, forces, output}, scratch.stage_hash);
  return output;
}

std::uint64_t hash_state(const State& state) { return hash_fields(state); }

}  // namespace lumbrical
