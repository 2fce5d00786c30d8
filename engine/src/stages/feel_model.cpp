// One model after the other is felt like this: the world, then each object apart from it.
#include "stages/feel_model.h"

#include "base/set_bits.h"
#include "base/wrench.h"
#include "samples/sampled_forces.h"
#include "stages/broadphase.h"
#include "stages/contact_force.h"
#include "stages/exact_overlaps.h"
#include "stages/hand_pose.h"
#include "stages/narrowphase.h"

namespace lumbrical {
namespace {

// Candidates of segments that are not felt by samples. False where there are too many.
bool find_exact_candidates(const Model& model, const Primitives& hand, Scratch& scratch) {
  const std::uint32_t sampled = sampled_segments(model);
  if (sampled == kAllSegments) return true;
  if (!find_candidates(model, hand, scratch)) return false;
  if (sampled == 0) return true;
  const auto is_left = [&](std::uint64_t pair) {
    return !has_bit(sampled, hand.primitive[pair >> 32].segment);
  };
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scratch.candidate_count; ++i) {
    scratch.candidates[count] = scratch.candidates[i];
    count += is_left(scratch.candidates[i]) ? 1 : 0;
  }
  scratch.candidate_count = count;
  return true;
}

HandForces sum_up(const Model& model, Scratch& scratch, bool all_found) {
  tell(scratch.watch, Stage::broadphase);
  find_all_contacts(model, scratch, all_found);
  tell(scratch.watch, Stage::narrowphase);
  if (!scratch.primitives->in_reach) return {};  // nothing is felt, and such a hand's axes are not set
  const std::span<const Contact> contacts(scratch.contacts.data(), scratch.contact_count);
  return sum_forces(model.settings, *scratch.primitives, contacts, scratch.samples->forces.segment);
}

void add(const HandForces& more, HandForces& forces) {
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    forces.segment[i] += more.segment[i];
    forces.joint_torque[i] += more.joint_torque[i];
    forces.flexion_torque[i] += more.flexion_torque[i];
  }
}

// Where no finger has a part in what the palm feels, it is felt alone.
Joints joints_the_palm_asks_for(const Model& model, const Joints& all) {
  Joints joints = all;
  const bool shared = has_bit(segments_felt_once(model), kPalmSegment);
  if (!shared) joints.valid &= 1u << kPalm | 1u << kWrist;
  return joints;
}

Vec3 palm_force_by_samples(const Model& model, Scratch& scratch, std::uint32_t& flags) {
  SampleMemory& samples = *scratch.samples;
  const SampledForces before = samples.forces;
  shape_hand(model.hand, *scratch.primitives);
  if (!sample_forces(model, *scratch.primitives, 1u << kPalmSegment, samples, samples.forces,
                     fineness_of(before)))
    flags |= kCandidateOverflow;
  tell(scratch.watch, Stage::narrowphase);
  return model.settings.stiffness * samples.forces.segment[kPalmSegment].force;
}

}  // namespace

bool is_made_for(const Model& model, const Scratch& scratch) {
  return scratch.build != 0 && scratch.build == model.build;
}

std::uint32_t segments_felt_once(const Model& model) {
  switch (model.settings.felt_once) {
    case FeltOnce::never:
      return 0;
    case FeltOnce::by_samples:
      return sampled_segments(model);
    case FeltOnce::always:
      return kAllSegments;
  }
  return 0;
}

void make_room(const Model& model, Scratch& scratch) {
  if (!scratch.primitives) scratch.primitives = std::make_shared<Primitives>();
  if (!scratch.samples) scratch.samples = std::make_shared<SampleMemory>();
  size_candidates(model, scratch);
  size_samples(model, *scratch.samples);
  scratch.contacts.resize(scratch.candidates.size());
  if (scratch.layers.size() < model.layers.size()) scratch.layers.resize(model.layers.size());
  for (std::size_t i = 0; i < model.layers.size(); ++i) {
    scratch.layers[i].keep_near = scratch.keep_near;
    make_room(*model.layers[i], scratch.layers[i]);
    scratch.layers[i].build = model.layers[i]->build;
  }
}

void find_all_contacts(const Model& model, Scratch& scratch, bool all_found) {
  const std::span<const std::uint64_t> candidates(scratch.candidates.data(), scratch.candidate_count);
  scratch.contact_count = collide_pairs(model, *scratch.primitives, candidates, scratch.contacts);
  const std::uint32_t shared =
      take_off_overlaps(model, *scratch.primitives, segments_felt_once(model),
                        {scratch.contacts.data(), scratch.contact_count}, scratch.sorting);
  scratch.no_jacobian = all_found ? shared : kAllSegments;
}

HandForces feel(const Model& model, Scratch& scratch, std::uint64_t spent, std::uint32_t& flags) {
  Primitives& hand = *scratch.primitives;
  scratch.samples->spent = spent;
  SampledForces& sampled = scratch.samples->forces;
  sampled = {};
  scratch.candidate_count = 0;
  bool all_found = true;
  hand.in_reach = may_meet(model.hand, hand, model.extent);
  hand.out_of_reach = !hand.in_reach;  // and needs no shape
  if (hand.in_reach) {
    shape_hand(model.hand, hand);
    if (sampled_segments(model) != kAllSegments) tile_hand(model.settings, hand);
    tell(scratch.watch, Stage::hand_pose);
    if (model.patches && !sample_forces(model, hand, sampled_segments(model), *scratch.samples, sampled))
      flags |= kCandidateOverflow;
    if (sampled.coarsened) flags |= kCoarsened;
    tell(scratch.watch, Stage::narrowphase);
    all_found = find_exact_candidates(model, hand, scratch);
    if (!all_found) flags |= kCandidateOverflow;
  }
  return sum_up(model, scratch, all_found);
}

HandForces feel_nothing(const Model& model, Scratch& scratch) {
  scratch.primitives->in_reach = false;
  scratch.samples->forces = {};
  scratch.candidate_count = 0;
  return sum_up(model, scratch, true);
}

void forget_hand(Primitives& hand) {
  hand.count = 0;
  hand.in_reach = hand.out_of_reach = false;
  hand.base_joint = hand.flexion_axis = {};
  hand.palm.corner_count = 0;
}

void add_layers(const Model& model, Scratch& scratch, std::uint64_t spent, std::uint32_t& flags,
                HandForces& forces) {
  spent += scratch.samples->forces.evaluations;
  const bool touches = scratch.contact_count > 0 || scratch.samples->forces.contact_count > 0;
  for (std::size_t i = 0; i < model.layers.size(); ++i) {
    const Model& layer = *model.layers[i];
    Scratch& own = scratch.layers[i];
    if (!touches) {
      feel_nothing(layer, own);
      continue;
    }
    forget_hand(*own.primitives);
    place_hand(layer.hand, layer.settings, scratch.primitives->joints, {}, *own.primitives);
    add(feel(layer, own, spent, flags), forces);
    spent += own.samples->forces.evaluations;
  }
}

Vec3 palm_force_moved(const Model& model, Vec3 by, Scratch& scratch, std::uint64_t& evaluations,
                      std::uint32_t& flags) {
  Primitives& hand = *scratch.primitives;
  const bool layers_felt = scratch.contact_count > 0 || scratch.samples->forces.contact_count > 0;
  const Joints joints = joints_the_palm_asks_for(model, hand.joints);
  forget_hand(hand);
  place_hand(model.hand, model.settings, joints, {by, {}}, hand);
  scratch.samples->spent = evaluations;
  Vec3 force;
  if (has_bit(sampled_segments(model), kPalmSegment)) {
    force = palm_force_by_samples(model, scratch, flags);
  } else {
    force = feel(model, scratch, evaluations, flags).segment[kPalmSegment].force;
  }
  evaluations += scratch.samples->forces.evaluations;
  for (std::size_t i = 0; layers_felt && i < model.layers.size(); ++i)
    force += palm_force_moved(*model.layers[i], by, scratch.layers[i], evaluations, flags);
  return force;
}

void operator+=(Findings& to, const Findings& more) {
  to.contact_count += more.contact_count;
  to.evaluations += more.evaluations;
  to.error_estimate += more.error_estimate;
  to.force_error += more.force_error;
}

Findings findings_of(const Model& model, const Scratch& scratch) {
  const SampledForces& sampled = scratch.samples->forces;
  const std::span<const Contact> contacts(scratch.contacts.data(), scratch.contact_count);
  Findings findings{scratch.contact_count + sampled.contact_count, sampled.evaluations,
                    error_estimate(model.settings, sampled), force_error(model.settings, contacts)};
  for (std::size_t i = 0; i < model.layers.size(); ++i) {
    const Findings more = findings_of(*model.layers[i], scratch.layers[i]);
    findings += {0, more.evaluations, more.error_estimate, more.force_error};
  }
  return findings;
}

}  // namespace lumbrical
