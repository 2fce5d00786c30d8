// How the surfaces of a scene file's objects feel.
#pragma once

#include <string>
#include <vector>

#include "files/json_file.h"
#include "lumbrical/model.h"
#include "scene_generated.h"

namespace lumbrical {

/// The surface of an object whose mesh is there. The files read are added to `files`, of which the first is
/// the scene's.
Status read_surface(const scene_format::Object& table, const std::string& at, FieldReader& read,
                    std::vector<std::string>& files, SceneObject& object);

}  // namespace lumbrical
