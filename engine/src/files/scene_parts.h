// The parts of a scene file that take some building: objects and hand.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "files/json_file.h"
#include "lumbrical/scene_file.h"
#include "scene_generated.h"

namespace lumbrical {

/// `path` as seen from the folder of `file`.
std::string beside(const std::string& file, std::string_view path);

Side read_side(const flatbuffers::String* text, const std::string& path, FieldReader& read);
Unit read_unit(const flatbuffers::String* text, const std::string& path, FieldReader& read);

/// Loads or builds one object after the other, puts it in its place, and hands it and its path over. The
/// files read are added to `files`, of which the first is the scene's.
Status read_objects(const scene_format::Scene& scene, FieldReader& read, std::vector<std::string>& files,
                    const std::function<Status(SceneObject&&, ObjectPath&&)>& take);

/// A hand of the given side as `table` describes it; null: the default hand. `at` stands before the fields'
/// names.
Hand read_hand(const scene_format::Hand* table, const std::string& at, Side side, FieldReader& read);

/// Only the radii and the palm, over those of `hand`.
void read_flesh(const scene_format::Hand* table, const std::string& at, FieldReader& read, Hand& hand);

}  // namespace lumbrical
