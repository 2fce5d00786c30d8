// What `lumbrical inspect` says of a scene file: how its meshes are wound, where everything is, and how near
// the hand comes, without a run.
#pragma once

#include <string>

namespace lumbrical::tool {

/// Is it a scene file, by its name?
bool is_scene(const std::string& path);

/// Prints; answers the program's exit code.
int inspect_scene(const std::string& path, bool json);

}  // namespace lumbrical::tool
