#include "lumbrical/shared_objects.h"

#include <array>
#include <cassert>
#include <optional>

#include "base/floating_point.h"
#include "objects/move_on.h"
#include "objects/palm_stiffness.h"
#include "stages/hand_pose.h"
#include "stages/segment_speeds.h"
#include "tick/felt_forces.h"

namespace lumbrical {

std::vector<ObjectFrame> start_frames(const Model& model) {
  std::vector<ObjectFrame> frames;
  for (const ApartObject& apart : model.apart)
    if (apart.mechanism.mobility == Mobility::given) frames.push_back({apart.start});
  return frames;
}

Scene given_objects(Scene scene) {
  for (SceneObject& object : scene.objects) {
    if (!moves_by_itself(object.mechanism)) continue;
    object.mechanism = {};
    object.mechanism.mobility = Mobility::given;
  }
  return scene;
}

/// What hands have done to shared objects since these moved.
struct PushingHands {
  using OfAll = FixedList<Touch, kMostHands * kSegmentCount>;
  std::size_t count = 0;
  std::vector<OfAll> touches;  ///< of Model::apart
  std::array<std::optional<MotionState>, kMostHands> motion;
};

Status share_objects(const Scene& scene, const Execution& execution, SharedObjects& shared) {
  if (Status status = build_model(scene, execution, shared.model); !status.ok()) return status;
  shared.state = make_state(shared.model);
  shared.hands = std::make_shared<PushingHands>();
  shared.hands->touches = std::vector<PushingHands::OfAll>(shared.model.apart.size());
  return {};
}

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

void push_objects(SharedObjects& shared, const Model& model, Scratch& scratch) {
  if (!shared.hands || !scratch.touches) return;
  PushingHands& hands = *shared.hands;
  const bool own = hands.count < kMostHands && scratch.touches->object.size() == hands.touches.size();
  assert(own && "given_objects(scene), and move_objects after both hands");
  if (!own) return;
  const FloatingPointGuard guard;
  const SegmentSpeeds speeds =
      speeds_of(shared.model, scratch.touches->trusted, *scratch.primitives, hands.motion[hands.count++]);
  for (std::size_t i = 0; i < hands.touches.size(); ++i) {
    const Mechanism& mechanism = shared.model.apart[i].mechanism;
    if (!moves_by_itself(mechanism)) continue;
    const Pose& X_WO = scratch.object_output[i].pose;
    for (const Touch& kept : scratch.touches->object[i]) {
      Touch& touch = hands.touches[i].push_back(kept);
      hang_on(speeds, transform(X_WO, mechanism.body.centre), touch);
      ask_palm(*model.apart[i].shape, mechanism, X_WO, 1 / shared.model.settings.rate, scratch, touch);
    }
  }
}

void move_objects(SharedObjects& shared, std::span<ObjectFrame> given) {
  if (!shared.hands) return;
  const FloatingPointGuard guard;
  std::size_t next = 0;
  for (std::size_t i = 0; i < shared.model.apart.size(); ++i) {
    const ApartObject& object = shared.model.apart[i];
    ObjectState& state = shared.state.objects[i];
    if (object.mechanism.mobility == Mobility::fixed) continue;
    if (moves_by_itself(object.mechanism)) {
      move_on(shared.model, object, shared.state.objects[object.latch], shared.hands->touches[i], state);
      if (next < given.size()) given[next].pose = state.pose;
    }
    shared.hands->touches[i].clear();
    ++next;
  }
  shared.hands->count = 0;
}

}  // namespace lumbrical
