// Stands in for mesh_gltf.cpp in a build without nlohmann-json.
#include "model/mesh_formats.h"

namespace lumbrical {

Status parse_gltf(std::string_view, const std::string& name, const std::string&, Mesh&) {
  return Status::error(name +
                       ": this build reads no glTF, since it is without nlohmann-json; export the mesh as " +
                       "OBJ, PLY, STL or OFF");
}

}  // namespace lumbrical
