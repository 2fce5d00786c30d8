// glTF: what a scene's nodes make of its meshes, where bytes may lie, and what is refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "files.h"
#include "mesh_samples.h"

namespace lumbrical {
namespace {

std::string file(const std::string& nodes) { return glb(gltf_json(nodes), gltf_buffer()); }

std::string base64(const std::string& bytes) {
  const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (int shift = 18; shift >= 0; shift -= 6) text += digits[group >> shift & 63];
  }
  return text;
}

TEST(MeshGltf, PlacesMeshesByTheNodesAboveThem) {
  const Mesh mesh = parsed(file(R"([{"translation":[10,0,0],"children":[1,2]},)"
                                R"({"mesh":0,"rotation":[0,0,0.70710678118654752,0.70710678118654752]},)"
                                R"({"mesh":0,"scale":[2,2,2],"translation":[0,0,1]}])"),
                           "a.glb", Unit::centimetre);
  ASSERT_EQ(mesh.vertices.size(), 8u);
  ASSERT_EQ(mesh.triangles.size(), 8u);
  EXPECT_NEAR(mesh.vertices[1].x, 0.1, 1e-12);  // (1, 0, 0), turned to y, at 10 cm
  EXPECT_NEAR(mesh.vertices[1].y, 0.01, 1e-12);
  EXPECT_NEAR(mesh.vertices[7].z, 0.03, 1e-12);  // (0, 0, 1), doubled, 1 up
  EXPECT_EQ(mesh.triangles[4], (Triangle{4, 6, 5}));
  const Mesh by_matrix = parsed(file(R"([{"mesh":0,"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,6,7,1]}])"), "a.glb");
  EXPECT_EQ(by_matrix.vertices[1], (Vec3{5, 7, 7}));
}

TEST(MeshGltf, AMirroringNodeKeepsTheOutsideOutside) {
  for (const char* const nodes : {R"([{"mesh":0}])", R"([{"mesh":0,"scale":[-1,1,1]}])",
                                  R"([{"scale":[1,-1,1],"children":[1]},{"mesh":0,"scale":[1,1,-2]}])"}) {
    const MeshReport report = inspect_mesh(parsed(file(nodes), "a.glb"));
    EXPECT_TRUE(report.watertight) << nodes;
    EXPECT_GT(report.volume, 0) << nodes;
  }
}

TEST(MeshGltf, ReadsBytesFromTheFileFromDataAndFromBesideIt) {
  const std::string nodes = R"([{"mesh":0}])";
  const std::string inlined =
      gltf_json(nodes, R"(,"uri":"data:application/octet-stream;base64,)" + base64(gltf_buffer()) + "\"");
  expect_tetrahedron(parsed(inlined, "a.gltf"));
  const std::string path = test::write_file("a.gltf", gltf_json(nodes, R"(,"uri":"my%20bytes.bin")"));
  Mesh mesh;
  EXPECT_NE(load_mesh(path, Unit::metre, mesh).message().find("my bytes.bin: there is no such file"),
            std::string::npos);
  test::write_file("my bytes.bin", gltf_buffer());
  ASSERT_TRUE(load_mesh(path, Unit::metre, mesh).ok());
  expect_tetrahedron(mesh);
}

TEST(MeshGltf, NamesNoFileOutsideItsFolder) {
  test::write_file("secret.bin", gltf_buffer());
  const std::string folder = test::own_folder().string();
  std::filesystem::create_directories(folder + "/inner");
  for (const std::string uri : {"../secret.bin", "%2e%2e/secret.bin", "x/../../secret.bin", "file:secret.bin",
                                "http://secret.bin", "", "%", "a%00b"}) {
    const std::string path =
        test::write_file("inner/a.gltf", gltf_json(R"([{"mesh":0}])", ",\"uri\":\"" + uri + "\""));
    Mesh mesh;
    EXPECT_NE(load_mesh(path, Unit::metre, mesh).message().find("no file beside this one"), std::string::npos)
        << uri;
  }
  const std::string absolute = gltf_json(R"([{"mesh":0}])", ",\"uri\":\"" + folder + "/secret.bin\"");
  Mesh mesh;
  EXPECT_FALSE(load_mesh(test::write_file("b.gltf", absolute), Unit::metre, mesh).ok());
  expect_refusal(gltf_json(R"([{"mesh":0}])", R"(,"uri":"secret.bin")"), folder + "/a.gltf", folder,
                 "no file beside");  // in memory there is no folder
}

TEST(MeshGltf, ReadsStripsFansAndCornersWithoutIndices) {
  const std::string json = gltf_json(R"([{"mesh":0}])");
  const std::string indices = R"("indices":1)";
  const auto triangles = [&](const std::string& mode) {
    return parsed(glb(replaced(json, indices, mode), gltf_buffer()), "a.glb").triangles;
  };
  EXPECT_EQ(triangles(R"("mode":5)"), (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(triangles(R"("mode":6)"), (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  expect_refusal(glb(replaced(json, indices, R"("mode":4)"), gltf_buffer()), "a.glb",
                 "a.glb: ", "no whole triangles");
  expect_refusal(glb(replaced(json, indices, R"("mode":1)"), gltf_buffer()), "a.glb",
                 "a.glb: ", "no triangles");
}

/// A glTF file with the tetrahedron's corners, interleaved with normals, in one buffer and its faces, by twos
/// and with indices of `index_type`, in another; quantised to 16 bits where asked, and placed back by its
/// node.
std::string split_tetrahedron(int index_type, bool quantised) {
  std::string corners, faces;
  for (const Vec3& p : kCorners) {
    for (const double coordinate : {p.x, p.y, p.z}) {
      if (quantised)
        append_value(corners, static_cast<std::int16_t>(coordinate * 32767));
      else
        append_value(corners, static_cast<float>(coordinate));
    }
    corners += std::string(quantised ? 2 : 12, '\x7f');  // padding, or a normal
  }
  const std::size_t size = index_type == 5121 ? 1 : index_type == 5123 ? 2 : 4;
  for (const Triangle& face : kFaces) {
    for (const std::uint32_t corner : face) {
      std::string number;
      append_value(number, corner);
      faces += number.substr(0, size);
    }
  }
  const auto inlined = [](const std::string& bytes) {
    return R"({"byteLength":)" + std::to_string(bytes.size()) +
           R"(,"uri":"data:application/gltf-buffer;base64,)" + base64(bytes) + "\"}";
  };
  const auto primitive = [&](int number) {
    return R"({"attributes":{"POSITION":0,"NORMAL":0},"indices":)" + std::to_string(number) + "}";
  };
  const auto indices = [&](std::size_t from) {
    return R"({"bufferView":1,"byteOffset":)" + std::to_string(from * size) + R"(,"componentType":)" +
           std::to_string(index_type) + R"(,"count":6,"type":"SCALAR"})";
  };
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1,2],"translation":[1,2,3]},)"
         R"({"mesh":0,"scale":[4,4,4]},{"mesh":1,"scale":[4,4,4]}],"meshes":[{"primitives":[)" +
         primitive(1) + R"(]},{"primitives":[)" + primitive(2) + R"(]}],"buffers":[)" + inlined(corners) +
         "," + inlined(faces) + R"(],"bufferViews":[{"buffer":0,"byteLength":)" +
         std::to_string(corners.size()) + R"(,"byteStride":)" + std::to_string(corners.size() / 4) +
         R"(},{"buffer":1,"byteLength":)" + std::to_string(faces.size()) + R"(}],"accessors":[)" +
         R"({"bufferView":0,"componentType":)" + (quantised ? R"(5122,"normalized":true)" : "5126") +
         R"(,"count":4,"type":"VEC3"},)" + indices(0) + "," + indices(6) + "]}";
}

TEST(MeshGltf, PutsPartsOfManyBuffersAndLayoutsTogether) {
  for (const int index_type : {5121, 5123, 5125}) {
    for (const bool quantised : {false, true}) {
      SCOPED_TRACE(index_type);
      const Mesh mesh = parsed(split_tetrahedron(index_type, quantised), "a.gltf");
      ASSERT_EQ(mesh.triangles.size(), 4u);
      for (std::size_t t = 0; t < 4; ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
          const Vec3 expected = 4 * kCorners[kFaces[t][i]] + Vec3{1, 2, 3};
          EXPECT_LT(norm(mesh.vertices[mesh.triangles[t][i]] - expected), 1e-12) << t;
        }
      }
    }
  }
}

TEST(MeshGltf, RefusesWhatItRequiresAndIsNotRead) {
  const std::string nodes = R"([{"mesh":0}])";
  const auto requiring = [&](const std::string& extension) {
    return glb(gltf_json(nodes, "", R"(,"extensionsRequired":["KHR_materials_unlit",")" + extension + "\"]"),
               gltf_buffer());
  };
  for (const char* const harmless : {"KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_basisu",
                                     "KHR_lights_punctual", "EXT_texture_webp"}) {
    SCOPED_TRACE(harmless);
    expect_tetrahedron(parsed(requiring(harmless), "a.glb"));
  }
  for (const char* const other : {"XX_geometry", "KHR_node_visibility", "KHR_mesh_quantization_2", ""})
    expect_refusal(requiring(other), "a.glb", "a.glb: it requires the extension '" + std::string(other) + "'",
                   "export without it");
  expect_refusal(glb(gltf_json(nodes, "", R"(,"extensionsRequired":[1])"), gltf_buffer()), "a.glb",
                 "a.glb: ", "structure");
  expect_tetrahedron(
      parsed(glb(gltf_json(nodes, "", R"(,"extensionsUsed":["XX_geometry"])"), gltf_buffer()), "a.glb"));
}

TEST(MeshGltf, RefusesInstancesAndCompressionWhereTheyAreUsed) {
  const std::string json = gltf_json(R"([{"mesh":0}])");
  const struct {
    const char *from, *to, *what;
  } cases[] = {
      {R"({"mesh":0})", R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}})", "without instancing"},
      {R"({"buffer":0,)", R"({"extensions":{"KHR_meshopt_compression":{}},"buffer":1,)", "by meshopt"},
      {R"({"buffer":0,)", R"({"extensions":{"EXT_meshopt_compression":{}},"buffer":1,)", "by meshopt"},
  };
  for (const auto& [from, to, what] : cases) {
    SCOPED_TRACE(to);
    expect_refusal(glb(replaced(json, from, to), gltf_buffer()), "a.glb", "a.glb: ", what);
  }
}

/// A tetrahedron whose corners hang on joint 0, but the last one on joints 0 and 1 alike.
std::string skinned_tetrahedron(const std::string& nodes) {
  const std::string rows =
      R"(,{"buffer":0,"byteOffset":72,"byteLength":16},{"buffer":0,"byteOffset":88,"byteLength":64},)"
      R"({"buffer":0,"byteOffset":152,"byteLength":128}],)";
  const std::string accessors = R"("count":12,"type":"SCALAR"},)"
                                R"({"bufferView":2,"componentType":5121,"count":4,"type":"VEC4"},)"
                                R"({"bufferView":3,"componentType":5126,"count":4,"type":"VEC4"},)"
                                R"({"bufferView":4,"componentType":5126,"count":2,"type":"MAT4"})";
  std::string json = gltf_json(nodes, "", R"(,"skins":[{"joints":[1,2],"inverseBindMatrices":4}])");
  json = replaced(json, "\"byteLength\":72", "\"byteLength\":280");
  json =
      replaced(json, R"("byteOffset":48,"byteLength":24}],)", R"("byteOffset":48,"byteLength":24})" + rows);
  json = replaced(json, R"("count":12,"type":"SCALAR"})", accessors);
  json = replaced(json, R"("POSITION":0)", R"("POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3)");
  std::string bytes = gltf_buffer();
  for (int i = 0; i < 4; ++i) bytes += std::string("\0\1\0\0", 4);
  for (int i = 0; i < 4; ++i)
    for (const float weight : {i < 3 ? 1.0f : 0.5f, i < 3 ? 0.0f : 0.5f, 0.0f, 0.0f})
      append_value(bytes, weight);
  for (const Vec3& bound : {Vec3{1, 0, 0}, Vec3{1, 0, 1}})
    for (int i = 0; i < 16; ++i) {
      const double last[] = {-bound.x, -bound.y, -bound.z, 1};
      append_value(bytes, static_cast<float>(i >= 12 ? last[i - 12] : i % 5 == 0 ? 1 : 0));
    }
  return glb(json, bytes);
}

TEST(MeshGltf, ASkinnedMeshStandsWhereItsJointsDo) {
  const std::string joints = R"([{"translation":[0,0,5],"children":[1,3]},)"
                             R"({"translation":[1,0,0],"children":[2]},{"translation":[0,0,3]},)";
  const Mesh mesh = parsed(
      skinned_tetrahedron(joints + R"({"mesh":0,"skin":0,"scale":[100,100,-100],"translation":[7,7,7]}])"),
      "a.glb");
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}, {0, 0, 7}}));
  EXPECT_GT(inspect_mesh(mesh).volume, 0);
  const std::string whole = skinned_tetrahedron(joints + R"({"mesh":0,"skin":0}])");
  const struct {
    const char *from, *to, *what;
  } cases[] = {
      {R"("skin":0)", R"("skin":1)", "its skin is none"},
      {R"("joints":[1,2])", R"("joints":[1,9])", "one of its joints is none"},
      {R"("joints":[1,2])", R"("joints":[1]  )", "hangs on none of its skin's 1 joints"},
      {R"("JOINTS_0":2)", R"("JOINTS_7":2)", "no JOINTS_0 and WEIGHTS_0"},
      {R"("count":2,"type":"MAT4")", R"("count":1,"type":"MAT4")", "1 elements where 2 are needed"},
      {R"("scenes":[{"nodes":[0]}])", R"("scenes":[{"nodes":[3]}])", ""},
      {R"("children":[2]},)", R"("children":[1]},)", "its own"},
  };
  for (const auto& [from, to, what] : cases) {
    SCOPED_TRACE(to);
    if (*what != '\0') {
      expect_refusal(replaced(whole, from, to), "a.glb", "a.glb: ", what);
    } else {
      EXPECT_EQ(parsed(replaced(whole, from, to), "a.glb").vertices[3], (Vec3{0, 0, 7}))
          << "joints outside the scene";
    }
  }
}

TEST(MeshGltf, SaysThatSparseAccessorsAreNotRead) {
  const std::string json =
      replaced(gltf_json(R"([{"mesh":0}])"), R"("type":"VEC3")", R"("type":"VEC3","sparse":{"count":1})");
  expect_refusal(glb(json, gltf_buffer()), "a.glb", "a.glb: ", "sparse accessors are not read");
}

TEST(MeshGltf, RefusesWhatWouldLeadOutOfItsBytes) {
  const std::string json = gltf_json(R"([{"mesh":0}])");
  const struct {
    const char *from, *to, *what;
  } cases[] = {
      {R"("count":4)", R"("count":5)", "do not fit"},
      {R"("count":4)", R"("count":4000000000000)", "do not fit"},
      {R"("count":4)", R"("count":18446744073709551615)", "whole numbers"},
      {R"("count":4)", R"("count":-4)", "whole numbers"},
      {R"("count":4)", R"("count":3)", "is not one of the 3 vertices"},
      {R"("byteLength":48)", R"("byteLength":73)", "do not fit"},
      {R"("byteOffset":48)", R"("byteOffset":9007199254740992)", "do not fit"},
      {R"("byteLength":48)", R"("byteLength":48,"byteStride":4)", "do not fit"},
      {R"("byteLength":48)", R"("byteLength":48,"byteStride":100)", "do not fit"},
      {R"("bufferView":1)", R"("bufferView":2)", "bufferView"},
      {R"("POSITION":0)", R"("POSITION":7)", "none of that number"},
      {R"("mesh":0)", R"("mesh":1)", "mesh is none"},
      {R"("nodes":[0])", R"("nodes":[3])", "none of the file's nodes"},
      {R"("type":"VEC3")", R"("type":"VEC4")", "VEC3"},
      {R"("componentType":5123)", R"("componentType":5122)", "unsigned integers"},
      {R"("componentType":5126)", R"("componentType":7)", "componentType"},
      {R"("mesh":0})", R"("mesh":0,"children":[0]})", "its own"},
      {R"("mesh":0})", R"("mesh":0,"rotation":[0,0,0,0]})", "unit quaternion"},
      {R"("mesh":0})", R"("mesh":0,"scale":[1,1]})", "3 numbers"},
      {R"("version":"2.0")", R"("version":"1.0")", "only glTF 2"},
      {R"("indices":1)", R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{}})", "Draco"},
      {R"("primitives":[)", R"("primitives":7,"x":[)", ""},
  };
  for (const auto& [from, to, what] : cases) {
    SCOPED_TRACE(to);
    expect_refusal(glb(replaced(json, from, to), gltf_buffer()), "a.glb", "a.glb: ", what);
  }
  expect_refusal(std::string(100000, '['), "a.gltf", "a.gltf: ", "nested");
  expect_refusal("{\"asset\":" + std::string(100000, '[') + std::string(100000, ']') + "}", "a.gltf",
                 "a.gltf: ", "nested");
}

TEST(MeshGltf, ASmallFileMakesNoEndlessMesh) {
  expect_refusal(file(R"([{"children":[1,1]},{"mesh":0}])"), "a.glb", "a.glb: node 1: ", "two parents");
  // 2000 nodes that share a mesh of 3000 vertices.
  std::string nodes = R"([{"children":[1)", children;
  for (int i = 1; i < 2000; ++i) {
    nodes += "," + std::to_string(i + 1);
    children += R"({"mesh":0},)";
  }
  std::string json = gltf_json(nodes + "]}," + children + R"({"mesh":0}])");
  json = replaced(replaced(json, R"("count":4)", R"("count":3000)"), R"("byteLength":48)",
                  R"("byteLength":36000)");
  json = replaced(json, R"(,"indices":1)", "");
  expect_refusal(glb(json, std::string(36000, '\0')), "a.glb", "a.glb: mesh 0", "until there are more than");
}

/// A file of that many nodes which share a mesh of these primitives.
std::string shared_by(std::size_t node_count, const std::string& primitives, const std::string& buffer,
                      const std::string& accessors) {
  std::string nodes = R"({"mesh":0})", roots = "0";
  for (std::size_t i = 1; i < node_count; ++i) {
    nodes += R"(,{"mesh":0})";
    roots += "," + std::to_string(i);
  }
  return glb(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[)" + roots + R"(]}],"nodes":[)" + nodes +
                 R"(],"meshes":[{"primitives":[)" + primitives +
                 R"(]}],"buffers":[{}],"bufferViews":[{"buffer":0,)" + R"("byteLength":)" +
                 std::to_string(buffer.size()) + R"(}],"accessors":[)" + accessors + "]}",
             buffer);
}

TEST(MeshGltf, ASmallFileAsksForNoEndlessWorkThatMakesNoTriangle) {
  // A strip in which all corners are the same vertex.
  const std::string strip =
      shared_by(100, R"({"attributes":{"POSITION":0},"indices":1,"mode":5})", std::string(500'000, '\0'),
                R"({"bufferView":0,"componentType":5126,"count":1,"type":"VEC3"},)"
                R"({"bufferView":0,"componentType":5121,"count":500000,"type":"SCALAR"})");
  expect_refusal(strip, "a.glb", "a.glb: mesh 0, primitive 0: ", "corners to read");
  std::string points = R"({"mode":0})";
  for (int i = 1; i < 10'000; ++i) points += R"(,{"mode":0})";
  expect_refusal(shared_by(100, points, "", ""), "a.glb", "a.glb: mesh 0, primitive ", "corners to read");
}

TEST(MeshGltf, BytesBesideAFileCountForHowMuchItMayHold) {
  constexpr std::size_t kVertices = 4'194'306;  // more than any small file may make
  test::write_file("many.bin", std::string(3 * kVertices, '\1'));
  const std::string count = std::to_string(kVertices);
  const std::string path = test::write_file(
      "a.gltf", R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
                R"("buffers":[{"uri":"many.bin"}],"bufferViews":[{"buffer":0,"byteLength":)" +
                    std::to_string(3 * kVertices) +
                    R"(}],"accessors":[{"bufferView":0,"componentType":5121,"count":)" + count +
                    R"(,"type":"VEC3"}]})");
  Mesh mesh;
  const Status status = load_mesh(path, Unit::metre, mesh);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(mesh.vertices.size(), kVertices);
}

TEST(MeshGltf, ReadsTheRealFile) {
  const std::filesystem::path path = test::data_folder() / "meshes" / "duck.glb";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real mesh at " << path << "; set LUMBRICAL_DATA";
  Mesh mesh;
  const Status status = load_mesh(path.string(), Unit::metre, mesh);
  ASSERT_TRUE(status.ok()) << status.message();
  const MeshReport report = inspect_mesh(mesh);
  EXPECT_EQ(report.triangles, 4212u);
  EXPECT_EQ(report.components, 1u);
  EXPECT_EQ(report.non_manifold_edges, 0u);
}

}  // namespace
}  // namespace lumbrical
