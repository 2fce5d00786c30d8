// Small mesh files made in memory, one of every format, and what the tests of the mesh readers ask of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "lumbrical/mesh.h"

namespace lumbrical {

// ---- A tetrahedron in every format, with the trimmings of real files ----

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline const std::string kObj =
    "# a tetrahedron\n"
    "mtllib a.mtl\no thing\n"
    "v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 1.0\nvt 0 0\nvn 0 0 1\n"
    "g one\nusemtl red\ns off\n"
    "f 1 3 2\nf 1/1 2/1 4/1\nv 0 0 1\nl 1 2\np 1\n"
    "f -3//1 -2//1 -1//1\nf 3/1/1 1/1/1 \\\n 4/1/1\n";

inline const std::string kAsciiStl =
    "solid two words\n"
    " facet normal 0 0 -1\n  outer loop\n   vertex 0 0 0\n   vertex 0 1 0\n   vertex 1 0 0\n  endloop\n "
    "endfacet\n"
    "facet normal nan -1.#IND 1e-007\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 "
    "1E+000\nendloop\nendfacet\n"
    "endsolid two words\n"
    "SOLID\n"
    "FACET NORMAL 1 1 1\nOUTER LOOP\nVERTEX 1 0 0\nVERTEX 0 1 0\nVERTEX 0 0 1\nENDLOOP\nENDFACET\n"
    "FACET NORMAL -1 0 0\nOUTER LOOP\nVERTEX 0 1 0\nVERTEX 0 0 0\nVERTEX -0 0 1\nENDLOOP\nENDFACET\n"
    "ENDSOLID\n";

inline const std::string kAsciiPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nobj_info nothing\n"
    "element camera 1\nproperty list uchar float matrix\n"
    "element vertex 4\nproperty uchar red\nproperty float x\nproperty list uchar int near\nproperty double "
    "y\n"
    "property float z\n"
    "element face 4\nproperty float quality\nproperty list uchar uint vertex_index\nproperty uchar flags\n"
    "element edge 1\nproperty int a\nproperty int b\n"
    "end_header\n"
    "2 0.5 0.5\n"
    "9 0 0 0 0\n9 1 1 7 0 0\n9 0 2 7 8 1 0\n9 0 0 0 1\n"
    "0.5 3 0 2 1 0\n0.5 3 0 1 3 0\n0.5 3 1 2 3 0\n0.5 3 2 0 3 0\n"
    "0 1\n";

inline const std::string kOff =
    "COFF # colours\n# a comment\n4 4 6\n"
    "0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n\n0 1 0 255 0 0 255 # another\n0 0 1 255 0 0 255\n"
    "3 0 2 1\n3 0 1 3 0.5 0.5 0.5\n3 1 2 3\n3 2 0 3 7\n";

inline constexpr Vec3 kCorners[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
inline constexpr Triangle kFaces[4] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

template <class Value>
void append_value(std::string& bytes, Value value, bool big_endian = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  const bool machine_is_big = std::endian::native == std::endian::big;
  if (big_endian != machine_is_big) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

inline std::string binary_stl(const std::string& title = "solid but not text") {
  std::string bytes = title;
  bytes.resize(80, ' ');
  append_value(bytes, std::uint32_t{4});
  for (const Triangle& face : kFaces) {
    for (int i = 0; i < 3; ++i) append_value(bytes, static_cast<float>(kNan));
    for (const std::uint32_t corner : face) {
      append_value(bytes, static_cast<float>(kCorners[corner].x));
      append_value(bytes, static_cast<float>(kCorners[corner].y));
      append_value(bytes, static_cast<float>(kCorners[corner].z));
    }
    append_value(bytes, std::uint16_t{7});
  }
  return bytes;
}

inline std::string binary_ply(bool big) {
  std::string bytes = "ply\r\nformat binary_";
  bytes += big ? "big" : "little";
  bytes +=
      "_endian 1.0\r\ncomment x\r\nelement extra 2\r\nproperty int16 a\r\nelement vertex 4\r\n"
      "property float64 x\r\nproperty list uint8 int16 near\r\nproperty float32 y\r\nproperty int8 z\r\n"
      "element face 4\r\nproperty list uint16 int32 vertex_indices\r\nproperty list char double uv\r\n"
      "end_header\r\n";
  append_value(bytes, std::int16_t{5}, big);
  append_value(bytes, std::int16_t{6}, big);
  for (std::uint8_t i = 0; i < 4; ++i) {
    append_value(bytes, kCorners[i].x, big);
    append_value(bytes, i);
    for (std::int16_t k = 0; k < i; ++k) append_value(bytes, k, big);
    append_value(bytes, static_cast<float>(kCorners[i].y), big);
    append_value(bytes, static_cast<std::int8_t>(kCorners[i].z));
  }
  for (const Triangle& face : kFaces) {
    append_value(bytes, std::uint16_t{3}, big);
    for (const std::uint32_t corner : face) append_value(bytes, static_cast<std::int32_t>(corner), big);
    append_value(bytes, std::int8_t{1});
    append_value(bytes, 0.25, big);
  }
  return bytes;
}

/// A list of strips, each of one triangle.
inline const std::string kPlyStrips =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n16 0 2 1 -1 0 1 3 -1 1 2 3 -1 2 0 3 -1\n";

/// The JSON of a glTF file whose buffer 0 is gltf_buffer(); `more` are further members, each with a comma
/// before it.
inline std::string gltf_json(const std::string& nodes, const std::string& buffer = "",
                             const std::string& more = "") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":72)" +
         buffer +
         R"(}],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],)" +
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)" +
         R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}])" + more + "}";
}

inline std::string gltf_buffer() {
  std::string bytes;
  for (const Vec3& p : kCorners)
    for (const double coordinate : {p.x, p.y, p.z}) append_value(bytes, static_cast<float>(coordinate));
  for (const Triangle& face : kFaces)
    for (const std::uint32_t corner : face) append_value(bytes, static_cast<std::uint16_t>(corner));
  return bytes;
}

inline std::string glb(std::string json, const std::string& buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append_value(bytes, std::uint32_t{2});
  append_value(bytes, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
  append_value(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append_value(bytes, static_cast<std::uint32_t>(buffer.size()));
  return bytes + std::string("BIN\0", 4) + buffer;
}

struct Sample {
  std::string name, content;
};

inline std::vector<Sample> all_samples() {
  return {{"a.obj", kObj},
          {"a.stl", kAsciiStl},
          {"b.stl", binary_stl()},
          {"a.ply", kAsciiPly},
          {"b.ply", binary_ply(false)},
          {"c.ply", binary_ply(true)},
          {"a.off", kOff},
          {"d.ply", kPlyStrips},
          {"a.glb", glb(gltf_json(R"([{"mesh":0}])"), gltf_buffer())}};
}

// ---- Helpers ----

inline Mesh parsed(const std::string& content, const std::string& name, Unit unit = Unit::metre) {
  Mesh mesh;
  const Status status = parse_mesh(content, name, unit, mesh);
  EXPECT_TRUE(status.ok()) << status.message();
  return mesh;
}

/// The message of a file that must be refused; the mesh handed in must stay as it was.
inline std::string refusal(const std::string& content, const std::string& name) {
  Mesh mesh;
  mesh.vertices = {{1, 2, 3}};
  const Status status = parse_mesh(content, name, Unit::metre, mesh);
  EXPECT_FALSE(status.ok()) << "accepted: " << content.substr(0, 200);
  EXPECT_EQ(mesh.vertices, std::vector<Vec3>{(Vec3{1, 2, 3})});
  EXPECT_TRUE(mesh.triangles.empty());
  return status.message();
}

inline void expect_refusal(const std::string& content, const std::string& name, const std::string& start,
                           const std::string& part) {
  const std::string message = refusal(content, name);
  EXPECT_EQ(message.substr(0, start.size()), start) << message;
  EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
}

/// The same solid whatever the order of the vertices: corners by position.
inline void expect_tetrahedron(const Mesh& mesh) {
  ASSERT_EQ(mesh.vertices.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 4u);
  for (std::size_t t = 0; t < 4; ++t) {
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(mesh.vertices[mesh.triangles[t][i]], kCorners[kFaces[t][i]]);
  }
}

inline bool is_sound(const Mesh& mesh) {
  for (const Vec3& p : mesh.vertices) {
    if (!is_finite(p)) return false;
  }
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.vertices.size()) return false;
    }
  }
  return !mesh.triangles.empty();
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline std::string with_line_ends(const std::string& text, const std::string& line_end) {
  std::string result;
  for (const char c : text) result += c == '\n' ? line_end : std::string(1, c);
  return result;
}

}  // namespace lumbrical
