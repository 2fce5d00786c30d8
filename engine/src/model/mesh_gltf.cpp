// Reads the triangles of a glTF 2.0 scene, .glb or .gltf: every mesh of its nodes, placed by them, as one
// mesh. Materials, skins (the bind pose is read), morph targets, cameras and lights are passed over.
// https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html; section numbers below are of that.
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "base/text_cursor.h"
#include "model/gltf_buffers.h"
#include "model/mesh_formats.h"

namespace lumbrical {
namespace {

using nlohmann::json;

// Nodes may share a mesh, so a small file can ask for any number of triangles: this many at most, or as many
// as it and the files beside it have bytes where that is more.
constexpr std::size_t kMostInstanced = std::size_t{1} << 22;
constexpr std::size_t kCornersOfPrimitive = 16;  // that take the time of finding a primitive

using Matrix = std::array<double, 16>;  // column-major
constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 4; ++row)
      for (std::size_t k = 0; k < 4; ++k) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

Vec3 axis(const Matrix& m, std::size_t column) {
  return {m[4 * column], m[4 * column + 1], m[4 * column + 2]};
}

Vec3 transformed(const Matrix& m, const Vec3& p) {
  return axis(m, 0) * p.x + axis(m, 1) * p.y + axis(m, 2) * p.z + axis(m, 3);
}

struct GltfReader {
  const json& root;
  const std::string& name;
  GltfBuffers& buffers;
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

// `count` finite numbers of an object's member; `values` stays where there is none.
Status read_numbers(const GltfReader& reader, const std::string& place, const json& object, const char* key,
                    std::size_t count, double* values) {
  const json* const found = gltf_member(object, key);
  if (found == nullptr) return {};
  if (!found->is_array() || found->size() != count)
    return reader.fault(place, std::string(key) + " must be " + std::to_string(count) + " numbers");
  for (std::size_t i = 0; i < count; ++i) {
    if (!(*found)[i].is_number() || !is_finite((*found)[i].get<double>()))
      return reader.fault(place, std::string(key) + " must be finite numbers");
    values[i] = (*found)[i].get<double>();
  }
  return {};
}

// A node's own transformation (3.5.3): a matrix, or scale, then rotation, then translation.
Status read_transformation(const GltfReader& reader, const std::string& place, const json& node, Matrix& m) {
  m = kIdentity;
  if (gltf_member(node, "matrix") != nullptr)
    return read_numbers(reader, place, node, "matrix", 16, m.data());
  std::array<double, 3> t{}, s{1, 1, 1};
  std::array<double, 4> q{0, 0, 0, 1};
  Status status = read_numbers(reader, place, node, "translation", 3, t.data());
  if (status.ok()) status = read_numbers(reader, place, node, "rotation", 4, q.data());
  if (status.ok()) status = read_numbers(reader, place, node, "scale", 3, s.data());
  if (!status.ok()) return status;
  const Quat rotation{q[3], q[0], q[1], q[2]};
  const double length = dot(rotation, rotation);
  if (!(length > 0.9 && length < 1.1)) return reader.fault(place, "rotation must be a unit quaternion");
  const std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = rotate(normalized(rotation), axes[i]) * s[i];
    std::copy_n(std::array{a.x, a.y, a.z}.begin(), 3, m.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
  std::copy(t.begin(), t.end(), m.begin() + 12);
  return {};
}

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
Status append_part(const GltfReader& reader, const std::string& place, const Matrix& m, const Mesh& part) {
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
  const bool mirrored = dot(cross(axis(m, 0), axis(m, 1)), axis(m, 2)) < 0;
  for (Triangle triangle : part.triangles) {
    if (mirrored) std::swap(triangle[1], triangle[2]);
    for (std::uint32_t& corner : triangle) corner += first;
    mesh.triangles.push_back(triangle);
  }
  return {};
}

Status append_mesh(GltfReader& reader, std::size_t number, const Matrix& m) {
  const json& primitives = reader.root["meshes"][number].at("primitives");
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const std::string place = "mesh " + std::to_string(number) + ", primitive " + std::to_string(i);
    Mesh part;
    Status status = read_primitive(reader, place, primitives[i], part);
    if (status.ok()) status = append_part(reader, place, m, part);
    if (!status.ok()) return status;
  }
  return {};
}

// The numbers of a list of indices into root[list].
Status read_references(const GltfReader& reader, const std::string& place, const json& object,
                       const char* key, const char* list, std::vector<std::size_t>& numbers) {
  const json* const found = gltf_member(object, key);
  if (found == nullptr) return {};
  if (!found->is_array()) return reader.fault(place, std::string(key) + " must be a list");
  for (const json& entry : *found) {
    std::size_t number = 0;
    if (!gltf_reference(reader.root, entry, list, number))
      return reader.fault(place, "one of its " + std::string(key) + " is none of the file's " + list);
    numbers.push_back(number);
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
    return read_references(reader, "scene " + std::to_string(number), (*scenes)[number], "nodes", "nodes",
                           roots);
  }
  std::vector<bool> child(gltf_count(reader.root, "nodes"), false);
  for (std::size_t i = 0; i < child.size(); ++i) {
    std::vector<std::size_t> children;
    Status status = read_references(reader, "node " + std::to_string(i), reader.root["nodes"][i], "children",
                                    "nodes", children);
    if (!status.ok()) return status;
    for (const std::size_t c : children) child[c] = true;
  }
  for (std::size_t i = 0; i < child.size(); ++i)
    if (!child[i]) roots.push_back(i);
  return {};
}

struct Placed {
  std::size_t node;
  Matrix parent;
};

// Every node below the roots once, parents first; each in the order of the file.
Status read_nodes(GltfReader& reader, const std::vector<std::size_t>& roots) {
  std::vector<bool> met(gltf_count(reader.root, "nodes"), false);
  std::vector<Placed> waiting;
  for (std::size_t i = roots.size(); i-- > 0;) waiting.push_back({roots[i], kIdentity});
  while (!waiting.empty()) {
    const Placed placed = waiting.back();
    waiting.pop_back();
    const std::string place = "node " + std::to_string(placed.node);
    if (met[placed.node]) return reader.fault(place, "it has two parents, or is its own; export again");
    met[placed.node] = true;
    const json& node = reader.root["nodes"][placed.node];
    Matrix own;
    if (Status status = read_transformation(reader, place, node, own); !status.ok()) return status;
    const Matrix m = product(placed.parent, own);
    if (const json* const mesh = gltf_member(node, "mesh")) {
      std::size_t number = 0;
      if (!gltf_reference(reader.root, *mesh, "meshes", number))
        return reader.fault(place, "its mesh is none of the file's");
      if (Status status = append_mesh(reader, number, m); !status.ok()) return status;
    }
    std::vector<std::size_t> children;
    Status status = read_references(reader, place, node, "children", "nodes", children);
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
    if (Status status = append_mesh(reader, i, kIdentity); !status.ok()) return status;
  return {};
}

}  // namespace

Status parse_gltf(std::string_view content, const std::string& name, const std::string& folder,
                  Mesh& mesh) try {
  json root;
  std::string_view binary;
  if (Status status = read_gltf_container(content, name, root, binary); !status.ok()) return status;
  GltfBuffers buffers(root, name, folder, binary);
  GltfReader reader{root, name, buffers, content.size(), mesh};
  return read_scene(reader);
} catch (const json::exception&) {
  return Status::error(name + ": not the structure of a glTF file; export it again");
}

}  // namespace lumbrical
