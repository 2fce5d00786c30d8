// Where a session's given objects are: on the paths of its scene, or where a physics engine has moved them;
// and what two hands move together.
#pragma once

#include <vector>

#include "lumbrical/bullet.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/shared_objects.h"

namespace lumbrical::tool {

struct GivenObjects {
  std::vector<ObjectPath> paths;    ///< of each; empty: it has none
  std::vector<ObjectFrame> frames;  ///< for the tick to come
  BulletWorld physics;              ///< none: nothing but paths moves them
  SharedObjects shared;             ///< of two hands, where something moves by itself; else empty
};

/// The scene as its hands feel it.
Scene felt_scene(const SceneFile& scene_file);

/// For a session of this scene, of which `model` is one hand's. An error where it wants a physics engine that
/// this build has not.
Status start_given(const SceneFile& scene_file, const Model& model, GivenObjects& given);

/// Moves them on to `time` [s], a tick of `model` after the last one, which is one hand's. Before that,
/// push_given what each hand has done.
void push_given(const Model& model, Scratch& scratch, GivenObjects& given);
void move_given(double time, const Model& model, GivenObjects& given);

}  // namespace lumbrical::tool
