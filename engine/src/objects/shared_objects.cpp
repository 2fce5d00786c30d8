#include "lumbrical/shared_objects.h"

#include "base/floating_point.h"
#include "objects/move_on.h"

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
  shared.pushed.assign(shared.model.apart.size(), {});
  return {};
}

void push_objects(SharedObjects& shared, std::span<const ObjectOutput> outputs) {
  for (std::size_t i = 0; i < shared.pushed.size(); ++i) {
    shared.pushed[i].force += outputs[i].wrench.force;
    shared.pushed[i].torque += outputs[i].wrench.torque;
  }
}

namespace {

void move_object(const Model& model, const ApartObject& object, const Wrench& pushed,
                 const ObjectState& handle, ObjectState& state) {
  const Vec3 arm = state.pose.position - transform(state.pose, object.mechanism.body.centre);
  Springs springs;
  move_on(model, object, {pushed.force, pushed.torque + cross(arm, pushed.force)}, handle, springs, state);
}

}  // namespace

void move_objects(SharedObjects& shared, std::span<ObjectFrame> given) {
  const FloatingPointGuard guard;
  std::size_t next = 0;
  for (std::size_t i = 0; i < shared.pushed.size(); ++i) {
    const ApartObject& object = shared.model.apart[i];
    ObjectState& state = shared.state.objects[i];
    const Mobility mobility = object.mechanism.mobility;
    if (mobility == Mobility::fixed) continue;
    if (mobility != Mobility::given) {
      move_object(shared.model, object, shared.pushed[i], shared.state.objects[object.latch], state);
      if (next < given.size()) given[next].pose = state.pose;
    }
    shared.pushed[i] = {};
    ++next;
  }
}

}  // namespace lumbrical
