// How the objects of a scene file rub and move.
#pragma once

#include <string>

#include "files/json_file.h"
#include "lumbrical/scene_file.h"
#include "scene_generated.h"

namespace lumbrical {

/// Material, mechanism and path (empty: none) of an object whose mesh is there, in its own frame, and whose
/// pose is read.
void read_mechanics(const scene_format::Object& table, const std::string& at, FieldReader& read,
                    SceneObject& object, ObjectPath& path);

/// What opens what, once all objects are there.
void read_latches(const scene_format::Scene& table, FieldReader& read, std::vector<SceneObject>& objects);

void read_physics(const scene_format::Scene& table, FieldReader& read, std::optional<PhysicsChoice>& physics);

/// Gravity and ground.
void read_surroundings(const scene_format::Scene& table, FieldReader& read, Scene& scene);

}  // namespace lumbrical
