// Fuzzes one reader of meshes, the one of LUMBRICAL_MESH_FORMAT ("obj", "stl", "ply", "off" or "gltf").
#include <string>
#include <string_view>

#include "fuzz_input.h"
#include "lumbrical/mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  Mesh mesh;
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  if (!parse_mesh(content, "fuzz." LUMBRICAL_MESH_FORMAT, Unit::millimetre, mesh).ok()) return 0;
  if (mesh.triangles.empty()) __builtin_trap();
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= mesh.vertices.size()) __builtin_trap();
  for (const Vec3& vertex : mesh.vertices)
    if (!is_finite(vertex.x) || !is_finite(vertex.y) || !is_finite(vertex.z)) __builtin_trap();
  return 0;
}
