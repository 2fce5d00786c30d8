// One model after the other is felt like this: the world, then each object apart from it.
#include "tick/felt_forces.h"

#include "samples/sampled_forces.h"
#include "stages/broadphase.h"
#include "stages/contact_force.h"
#include "stages/hand_pose.h"
#include "stages/narrowphase.h"

namespace lumbrical {
namespace {

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

HandForces sum_up(const Model& model, Scratch& scratch) {
  tell(scratch.watch, Stage::broadphase);
  find_all_contacts(model, scratch);
  tell(scratch.watch, Stage::narrowphase);
  const std::span<const Contact> contacts(scratch.contacts.data(), scratch.contact_count);
  return sum_forces(model.settings, *scratch.primitives, contacts, scratch.samples->forces.segment);
}

}  // namespace

void make_room(const Model& model, Scratch& scratch) {
  if (!scratch.primitives) scratch.primitives = std::make_shared<Primitives>();
  if (!scratch.samples) scratch.samples = std::make_shared<SampleMemory>();
  size_candidates(model, scratch);
  size_samples(model, *scratch.samples);
  scratch.contacts.resize(scratch.candidates.size());
}

void find_all_contacts(const Model& model, Scratch& scratch) {
  const std::span<const std::uint64_t> candidates(scratch.candidates.data(), scratch.candidate_count);
  scratch.contact_count = find_contacts(model, *scratch.primitives, candidates, scratch.contacts);
}

HandForces feel(const Model& model, Scratch& scratch, std::uint32_t& flags) {
  Primitives& hand = *scratch.primitives;
  SampledForces& sampled = scratch.samples->forces;
  sampled = {};
  scratch.candidate_count = 0;
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
  return sum_up(model, scratch);
}

HandForces feel_nothing(const Model& model, Scratch& scratch) {
  scratch.samples->forces = {};
  scratch.candidate_count = 0;
  return sum_up(model, scratch);
}

}  // namespace lumbrical
