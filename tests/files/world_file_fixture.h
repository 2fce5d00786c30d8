// Scenes, and the world files of them.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "files.h"
#include "lumbrical/shapes.h"
#include "lumbrical/world.h"
#include "random.h"

namespace lumbrical::test {

inline Status write_world(const Scene& scene, const Execution& execution, const std::string& path) {
  WorldWriter writer;
  if (Status status = writer.open(path, execution); !status.ok()) return status;
  for (const SceneObject& object : scene.objects)
    if (Status status = writer.add_object(object); !status.ok()) return status;
  return writer.finish();
}

/// The scene with its objects in a world file.
inline Scene in_world(const Scene& scene, const Execution& execution, const std::string& path) {
  Scene mapped{scene.hand, {}, scene.settings};
  std::remove(path.c_str());
  Status status = write_world(scene, execution, path);
  if (status.ok()) status = open_world(path, mapped.world);
  EXPECT_TRUE(status.ok()) << status.message();
  return mapped;
}

inline Model built(const Scene& scene, const Execution& execution = {}) {
  Model model;
  const Status status = build_model(scene, execution, model);
  EXPECT_TRUE(status.ok()) << status.message();
  return model;
}

/// Objects strewn over `extent` [m], some triangles wider than cells, some of no area.
inline Scene strewn_scene(std::uint64_t seed, double extent, std::size_t count) {
  Random random(seed);
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  for (std::size_t i = 0; i < count; ++i) {
    Mesh mesh = i % 3 == 0   ? make_sphere(random.between(0.02, 0.2), 6 + static_cast<std::uint32_t>(i % 7))
                : i % 3 == 1 ? make_box({0.1, random.between(0.01, 2), 0.3}, 5)
                             : make_height_field(0.3, 20, 0.002, 0.04);
    const Vec3 at = random.in_box(extent / 2);
    const std::size_t middle = mesh.triangles.size() / 2;
    mesh.triangles[middle] = {mesh.triangles[middle][0], mesh.triangles[middle][0],
                              mesh.triangles[middle][2]};
    for (Vec3& p : mesh.vertices) p += at;
    scene.objects.push_back({"object " + std::to_string(i), std::move(mesh)});
  }
  return scene;
}

template <class T>
bool same_bytes(const SharedArray<T>& a, const SharedArray<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// The same arrays, to the last bit.
inline void expect_same_world(const Model& a, const Model& b) {
  EXPECT_TRUE(same_bytes(a.triangles.x, b.triangles.x));
  EXPECT_TRUE(same_bytes(a.triangles.y, b.triangles.y));
  EXPECT_TRUE(same_bytes(a.triangles.z, b.triangles.z));
  EXPECT_TRUE(same_bytes(a.triangles.a, b.triangles.a));
  EXPECT_TRUE(same_bytes(a.triangles.b, b.triangles.b));
  EXPECT_TRUE(same_bytes(a.triangles.c, b.triangles.c));
  EXPECT_TRUE(same_bytes(a.grid.cell, b.grid.cell));
  EXPECT_TRUE(same_bytes(a.grid.tree, b.grid.tree));
  EXPECT_TRUE(same_bytes(a.grid.lines, b.grid.lines));
  EXPECT_EQ(a.grid.origin, b.grid.origin);
  EXPECT_EQ(a.grid.cell_size, b.grid.cell_size);
  EXPECT_EQ(a.grid.frontier, b.grid.frontier);
  EXPECT_EQ(a.extent.lower, b.extent.lower);
  EXPECT_EQ(a.extent.upper, b.extent.upper);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].name, b.objects[i].name);
    EXPECT_EQ(a.objects[i].first_triangle, b.objects[i].first_triangle);
    EXPECT_EQ(a.objects[i].triangle_count, b.objects[i].triangle_count);
    EXPECT_EQ(a.objects[i].first_vertex, b.objects[i].first_vertex);
    EXPECT_EQ(a.objects[i].vertex_count, b.objects[i].vertex_count);
  }
}

}  // namespace lumbrical::test
