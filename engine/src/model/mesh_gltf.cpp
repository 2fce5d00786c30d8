// Reads the triangles of a glTF 2.0 scene, .glb or .gltf: every mesh of its nodes, placed by them, as one
// mesh. Materials, morph targets, animations, cameras and lights are passed over.
// https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html; section numbers below are of that.
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/text_cursor.h"
#include "model/gltf_buffers.h"
#include "model/gltf_nodes.h"
#include "model/mesh_formats.h"

namespace lumbrical {
namespace {

using nlohmann::json;

// Nodes may share a mesh, so a small file can ask for any number of triangles: this many at most, or as many
// as it and the files beside it have bytes where that is more.
constexpr std::size_t kMostInstanced = std::size_t{1} << 22;
constexpr std::size_t kCornersOfPrimitive = 16;  // that take the time of finding a primitive

// Extensions that a file may require without another shape than we read, or that are refused where they are
// used, in words that help more.
constexpr std::array<std::string_view, 10> kHarmless = {"KHR_mesh_quantization",
                                                        "KHR_materials_",
                                                        "KHR_texture_",
                                                        "KHR_lights_punctual",
                                                        "EXT_texture_",
                                                        "EXT_lights_image_based",
                                                        "EXT_mesh_gpu_instancing",
                                                        "KHR_draco_mesh_compression",
                                                        "EXT_meshopt_compression",
                                                        "KHR_meshopt_compression"};

struct GltfReader {
  const json& root;
  const std::string& name;
  GltfBuffers& buffers;
  GltfSkins skins;
  std::size_t size;  // [bytes] of the file
  Mesh& mesh;
  std::size_t corners_read = 0;  // those that come to no triangle too

  // Triangles and vertices.
  [[nodiscard]] std::size_t most() const {
    return std::min(std::max(kMostInstanced, size + buffers.bytes_beside()), kMaxVertexCount);
  }
  [[nodiscard]] Status fault(const std::string& place, const std::string& what) const {
    return Status::error(name + ": " + place + ": " + what);
  }
};

enum Mode { kTriangles = 4, kStrip = 5, kFan = 6 };  // below: points and lines (3.7.2.1)

Status append_triangles(const GltfReader& reader, const std::string& place, std::int64_t mode,
                        const std::vector<std::uint32_t>& corners, Mesh& part) {
  if (mode == kStrip) {
    append_strips(corners, part);
  } else if (mode == kFan) {
    append_fan(corners, part);
  } else if (corners.size() % 3 != 0) {
    return reader.fault(place,
                        std::to_string(corners.size()) + " corners are no whole triangles; export again");
  } else {
    for (std::size_t i = 0; i < corners.size(); i += 3)
      part.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  }
  return {};
}

Status read_corners(GltfReader& reader, const std::string& place, const json& primitive,
                    std::size_t vertex_count, std::vector<std::uint32_t>& corners) {
  const json* const indices = gltf_member(primitive, "indices");
  if (indices != nullptr) {
    if (Status status = reader.buffers.read_indices(*indices, corners); !status.ok()) return status;
  } else {
    for (std::uint32_t i = 0; i < vertex_count; ++i) corners.push_back(i);
  }
  reader.corners_read += corners.size();
  for (const std::uint32_t corner : corners) {
    if (corner < vertex_count) continue;
    return reader.fault(place, "vertex index " + std::to_string(corner) + " is not one of the " +
                                   std::to_string(vertex_count) + " vertices (counted from 0); export again");
  }
  return {};
}

Status read_primitive(GltfReader& reader, const std::string& place, const json& primitive, Mesh& part) {
  reader.corners_read += kCornersOfPrimitive;
  if (reader.corners_read > 3 * reader.most())
    return reader.fault(place, "the nodes repeat their meshes until there are more than " +
                                   std::to_string(3 * reader.most()) + " corners to read; export fewer");
  const json* const extensions = gltf_member(primitive, "extensions");
  if (extensions != nullptr && gltf_member(*extensions, "KHR_draco_mesh_compression") != nullptr)
    return reader.fault(place, "the mesh is compressed with Draco; export without compression");
  std::int64_t mode = kTriangles;
  if (const json* const given = gltf_member(primitive, "mode")) {
    if (!given->is_number_integer()) return reader.fault(place, "mode must be a whole number");
    mode = given->get<std::int64_t>();
  }
  if (mode >= 0 && mode < kTriangles) return {};  // points and lines have no surface
  if (mode < 0 || mode > kFan) return reader.fault(place, "mode must be 0 to 6");
  const json* const attributes = gltf_member(primitive, "attributes");
  const json* const position = attributes == nullptr ? nullptr : gltf_member(*attributes, "POSITION");
  if (position == nullptr) return reader.fault(place, "it has no POSITION; export the mesh with vertices");
  if (Status status = reader.buffers.read_positions(*position, part.vertices); !status.ok()) return status;
  std::vector<std::uint32_t> corners;
  Status status = read_corners(reader, place, primitive, part.vertices.size(), corners);
  return status.ok() ? append_triangles(reader, place, mode, corners, part) : status;
}

// A node that mirrors turns its triangles round (3.7.4).
Status append_part(const GltfReader& reader, const std::string& place, const GltfMatrix& m, bool mirrored,
                   const Mesh& part) {
  Mesh& mesh = reader.mesh;
  if (mesh.vertices.size() + part.vertices.size() > reader.most() ||
      mesh.triangles.size() + part.triangles.size() > reader.most()) {
    return reader.fault(place, "the nodes repeat their meshes until there are more than " +
                                   std::to_string(reader.most()) + " triangles; export fewer");
  }
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& vertex : part.vertices) {
    mesh.vertices.push_back(transformed(m, vertex));
    if (!is_finite(mesh.vertices.back()))
      return reader.fault(place, "its transformation leads beyond all numbers");
  }
  for (Triangle triangle : part.triangles) {
    if (mirrored) std::swap(triangle[1], triangle[2]);
    for (std::uint32_t& corner : triangle) corner += first;
    mesh.triangles.push_back(triangle);
  }
  return {};
}

using SkinJoints = const std::vector<GltfMatrix>*;  // of a mesh's skin; null where it has none

Status append_mesh(GltfReader& reader, std::size_t number, const GltfMatrix& m, SkinJoints joints = nullptr) {
  const json& primitives = reader.root["meshes"][number].at("primitives");
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const std::string place = "mesh " + std::to_string(number) + ", primitive " + std::to_string(i);
    Mesh part;
    Status status = read_primitive(reader, place, primitives[i], part);
    if (status.ok() && joints != nullptr && !part.triangles.empty())
      status = pose_by_joints(reader.name + ": " + place, primitives[i].at("attributes"), *joints,
                              reader.buffers, part.vertices);
    const GltfMatrix& outside = joints != nullptr && !joints->empty() ? joints->front() : m;
    if (status.ok())
      status = append_part(reader, place, joints != nullptr ? kGltfIdentity : m, mirrors(outside), part);
    if (!status.ok()) return status;
  }
  return {};
}

Status find_roots(const GltfReader& reader, std::vector<std::size_t>& roots) {
  const json* const scenes = gltf_member(reader.root, "scenes");
  if (scenes != nullptr && scenes->is_array() && !scenes->empty()) {
    std::size_t number = 0;
    const json* const chosen = gltf_member(reader.root, "scene");
    if (chosen != nullptr && !gltf_reference(reader.root, *chosen, "scenes", number))
      return reader.fault("scene", "it is none of the file's scenes");
    return read_gltf_references(reader.name + ": scene " + std::to_string(number), reader.root,
                                (*scenes)[number], "nodes", "nodes", roots);
  }
  std::vector<bool> child(gltf_count(reader.root, "nodes"), false);
  for (std::size_t i = 0; i < child.size(); ++i) {
    std::vector<std::size_t> children;
    Status status = read_gltf_references(reader.name + ": node " + std::to_string(i), reader.root,
                                         reader.root["nodes"][i], "children", "nodes", children);
    if (!status.ok()) return status;
    for (const std::size_t c : children) child[c] = true;
  }
  for (std::size_t i = 0; i < child.size(); ++i)
    if (!child[i]) roots.push_back(i);
  return {};
}

// A mesh and its skin, where the node has them. Where it is to stand many times (EXT_mesh_gpu_instancing),
// once would be another shape.
Status read_mesh_of_node(GltfReader& reader, const std::string& place, const json& node,
                         const GltfMatrix& m) {
  const json* const extensions = gltf_member(node, "extensions");
  if (extensions != nullptr && gltf_member(*extensions, "EXT_mesh_gpu_instancing") != nullptr)
    return reader.fault(
        place,
        "its mesh stands in many places by EXT_mesh_gpu_instancing, which is not read; export "
        "without instancing");
  const json* const mesh = gltf_member(node, "mesh");
  if (mesh == nullptr) return {};
  std::size_t number = 0, skin_number = 0;
  if (!gltf_reference(reader.root, *mesh, "meshes", number))
    return reader.fault(place, "its mesh is none of the file's");
  const json* const skin = gltf_member(node, "skin");
  if (skin == nullptr) return append_mesh(reader, number, m);
  if (!gltf_reference(reader.root, *skin, "skins", skin_number))
    return reader.fault(place, "its skin is none of the file's");
  SkinJoints joints = nullptr;
  Status status = reader.skins.find_joints(skin_number, joints);
  return status.ok() ? append_mesh(reader, number, m, joints) : status;
}

struct Placed {
  std::size_t node;
  GltfMatrix parent;
};

// Every node below the roots once, parents first; each in the order of the file.
Status read_nodes(GltfReader& reader, const std::vector<std::size_t>& roots) {
  std::vector<bool> met(gltf_count(reader.root, "nodes"), false);
  std::vector<Placed> waiting;
  for (std::size_t i = roots.size(); i-- > 0;) waiting.push_back({roots[i], kGltfIdentity});
  while (!waiting.empty()) {
    const Placed placed = waiting.back();
    waiting.pop_back();
    const std::string place = "node " + std::to_string(placed.node);
    if (met[placed.node]) return reader.fault(place, "it has two parents, or is its own; export again");
    met[placed.node] = true;
    const json& node = reader.root["nodes"][placed.node];
    const std::string file_place = reader.name + ": " + place;
    GltfMatrix own;
    if (Status status = read_gltf_transformation(file_place, node, own); !status.ok()) return status;
    const GltfMatrix m = product(placed.parent, own);
    if (Status status = read_mesh_of_node(reader, place, node, m); !status.ok()) return status;
    std::vector<std::size_t> children;
    Status status = read_gltf_references(file_place, reader.root, node, "children", "nodes", children);
    if (!status.ok()) return status;
    for (std::size_t i = children.size(); i-- > 0;) waiting.push_back({children[i], m});
  }
  return {};
}

Status read_scene(GltfReader& reader) {
  std::vector<std::size_t> roots;
  if (Status status = find_roots(reader, roots); !status.ok()) return status;
  if (!roots.empty()) return read_nodes(reader, roots);
  for (std::size_t i = 0; i < gltf_count(reader.root, "meshes"); ++i)  // no scene at all: a library of meshes
    if (Status status = append_mesh(reader, i, kGltfIdentity); !status.ok()) return status;
  return {};
}

// A file that requires an extension is another one without it (3.12).
Status check_required(const json& root, const std::string& name) {
  const json* const required = gltf_member(root, "extensionsRequired");
  if (required == nullptr) return {};
  for (const json& entry : *required) {
    const std::string& extension = entry.get_ref<const std::string&>();
    const auto covers = [&extension](std::string_view harmless) {
      return harmless.back() == '_' ? extension.starts_with(harmless) : extension == harmless;
    };
    if (std::none_of(kHarmless.begin(), kHarmless.end(), covers))
      return Status::error(name + ": it requires the extension " + in_quotes(std::string_view(extension)) +
                           ", which is not read; export without it");
  }
  return {};
}

}  // namespace

Status parse_gltf(std::string_view content, const std::string& name, const std::string& folder,
                  Mesh& mesh) try {
  json root;
  std::string_view binary;
  if (Status status = read_gltf_container(content, name, root, binary); !status.ok()) return status;
  if (Status status = check_required(root, name); !status.ok()) return status;
  GltfBuffers buffers(root, name, folder, binary);
  GltfReader reader{root, name, buffers, GltfSkins(root, name, buffers), content.size(), mesh};
  return read_scene(reader);
} catch (const json::exception&) {
  return Status::error(name + ": not the structure of a glTF file; export it again");
}

}  // namespace lumbrical
