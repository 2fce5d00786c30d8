#include "lumbrical/shared_objects.h"

#include "base/floating_point.h"
#include "objects/move_on.h"
#include "objects/pushing_hands.h"

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

Status share_objects(const Scene& scene, const Execution& execution, SharedObjects& shared) {
  if (Status status = build_model(scene, execution, shared.model); !status.ok()) return status;
  shared.state = make_state(shared.model);
  shared.hands = std::make_shared<PushingHands>();
  shared.hands->touches = std::vector<PushingHands::OfAll>(shared.model.apart.size());
  return {};
}

void push_objects(SharedObjects& shared, const Model& model, Scratch& scratch) {
  if (!shared.hands || !scratch.touches) return;
  const FloatingPointGuard guard;
  add_hand(shared.model, model, scratch, *shared.hands);
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
      move_on(shared.model, object, shared.state.objects[object.latch], 1 / shared.model.settings.rate,
              shared.hands->touches[i], state);
      if (next < given.size()) given[next].pose = state.pose;
    }
    ++next;
  }
  forget_hands(*shared.hands);
}

}  // namespace lumbrical
