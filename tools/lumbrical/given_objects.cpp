// See given_objects.h.
#include "given_objects.h"

#include <algorithm>

#include "lumbrical/tick.h"

namespace lumbrical::tool {
namespace {

bool is_shared(const SceneFile& scene_file) {
  const auto& objects = scene_file.scene.objects;
  return scene_file.second && std::any_of(objects.begin(), objects.end(), [](const SceneObject& object) {
           return moves_by_itself(object.mechanism);
         });
}

// Of the objects that are given to the hands, shared ones included.
std::vector<ObjectPath> paths_of(const SceneFile& scene_file, bool shared) {
  std::vector<ObjectPath> paths;
  std::size_t next = 0;
  for (const SceneObject& object : scene_file.scene.objects) {
    if (object.mechanism.mobility == Mobility::given)
      paths.push_back(scene_file.paths[next++]);
    else if (shared && moves_by_itself(object.mechanism))
      paths.emplace_back();
  }
  return paths;
}

void follow_paths(double time, GivenObjects& given) {
  for (std::size_t i = 0; i < given.paths.size(); ++i)
    if (!given.paths[i].empty()) given.frames[i].pose = resample(given.paths[i], time);
}

}  // namespace

Scene felt_scene(const SceneFile& scene_file) {
  return is_shared(scene_file) ? given_objects(scene_file.scene) : scene_file.scene;
}

Status start_given(const SceneFile& scene_file, const Model& model, GivenObjects& given) {
  const bool shared = is_shared(scene_file);
  given.paths = paths_of(scene_file, shared);
  given.frames = start_frames(model);
  follow_paths(0, given);
  if (shared)
    if (Status status = share_objects(scene_file.scene, scene_file.execution, given.shared); !status.ok())
      return status;
  if (!scene_file.physics) return {};
  return make_bullet_world(model, {scene_file.physics->friction}, given.physics);
}

void push_given(const Model& model, Scratch& scratch, GivenObjects& given) {
  if (given.physics.bodies) push_bodies(given.physics, model, scratch);
  push_objects(given.shared, model, scratch);
}

void move_given(double time, const Model& model, GivenObjects& given) {
  follow_paths(time, given);
  if (given.physics.bodies) move_bodies(given.physics, model, given.frames);
  move_objects(given.shared, given.frames);
}

}  // namespace lumbrical::tool
