#include "objects/pushing_hands.h"

#include <cassert>

#include "objects/palm_stiffness.h"
#include "stages/feel_model.h"
#include "stages/hand_pose.h"
#include "stages/segment_speeds.h"

namespace lumbrical {
namespace {

// A hand that takes an object as given does not ask how stiffly its palm presses, for it moves nothing.
void ask_palm(const Model& shape, const Mechanism& mechanism, const Pose& X_WO, double dt, Scratch& scratch,
              Touch& touch) {
  if (!(touch.guess > 0)) return;
  Scratch& felt = *scratch.apart;
  Primitives& hand = *felt.primitives;
  place_hand(shape.hand, shape.settings, scratch.primitives->joints, inverse(X_WO), hand);
  shape_hand(shape.hand, hand);
  if (!asks_for_palm_stiffness(shape, mechanism, hand, dt)) return;
  std::uint32_t flags = 0;
  const HandForces field = feel(shape, felt, 0, flags);
  HandForces forces = field;
  add_layers(shape, felt, 0, flags, forces);
  std::uint64_t evaluations = 0;
  add_palm(palm_stiffness(shape, field.segment[kPalmSegment].force, forces.segment[kPalmSegment].force,
                          rotate(conjugate(X_WO.orientation), touch.spring.normal), felt, evaluations),
           touch);
}

// What the hand did not know of an object that was given to it: where its centre of mass is, and that skin
// takes it along.
void hang_on(const SegmentSpeeds& speeds, Vec3 centre, Touch& touch) {
  touch.spring.arm = touch.joint + touch.arm - centre;
  touch.spring.anchor = skin_speed(speeds, touch.segment, touch.arm);
}

}  // namespace

void add_hand(const Model& moved, const Model& model, Scratch& scratch, PushingHands& hands) {
  const bool own = hands.count < kMostHands && scratch.touches->object.size() == hands.touches.size();
  assert(own && "each hand of the same objects, and what moves them after all hands");
  if (!own) return;
  const double rate = moved.settings.rate;
  const SegmentSpeeds speeds =
      speeds_of(rate, scratch.touches->trusted, *scratch.primitives, hands.motion[hands.count++]);
  for (std::size_t i = 0; i < hands.touches.size(); ++i) {
    const Mechanism& mechanism = moved.apart[i].mechanism;
    if (!(mechanism.body.mass > 0)) continue;
    const Pose& X_WO = scratch.object_output[i].pose;
    for (const Touch& kept : scratch.touches->object[i]) {
      Touch& touch = hands.touches[i].push_back(kept);
      hang_on(speeds, transform(X_WO, mechanism.body.centre), touch);
      ask_palm(*model.apart[i].shape, mechanism, X_WO, 1 / rate, scratch, touch);
    }
  }
}

void forget_hands(PushingHands& hands) {
  hands.count = 0;
  for (PushingHands::OfAll& of_object : hands.touches) of_object.clear();
}

}  // namespace lumbrical
