// The voxel index: complete lists, distances that are right, a cache that no file can fool, and errors that
// tell the remedy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "index/triangle_box.h"
#include "index/triangle_distance.h"
#include "index/voxel_cache.h"
#include "index/voxel_index.h"
#include "model/corners.h"
#include "random.h"
#include "reference/triangle_distance.h"
#include "session.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

#define SKIP_WITHOUT_OPENVDB()       \
  if (!available(Broadphase::voxel)) \
  GTEST_SKIP() << "this build has no OpenVDB; install libopenvdb-dev and build again"

Execution with_voxels() {
  Execution execution;
  execution.broadphase = Broadphase::voxel;
  return execution;
}

Mesh moved(Mesh mesh, const Pose& place, double scale) {
  for (Vec3& p : mesh.vertices) p = transform(place, scale * p);
  return mesh;
}

Scene scene_of(const Mesh& mesh) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"mesh", mesh});
  return scene;
}

Triangles triangles_of(const Mesh& mesh) { return model_of(scene_of(mesh)).triangles; }

// Triangles of sizes from a thousandth to about the whole; every tenth is a line, every thirteenth a point.
Mesh uneven_soup(Random& random, std::size_t count) {
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const double size = std::pow(10.0, random.between(-3, 0));
    const Vec3 p = random.in_box(1), q = i % 13 == 0 ? p : p + random.in_box(size);
    const Vec3 r = i % 13 == 0 ? p : i % 10 == 0 ? p + 0.4 * (q - p) : p + random.in_box(size);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {p, q, r});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Corners in_voxels(const Triangles& triangles, const VoxelLists& lists, std::uint32_t triangle) {
  const auto corner = [&](const SharedArray<std::uint32_t>& corners) {
    return (triangles.vertex(corners[triangle]) - lists.origin) / lists.voxel_size;
  };
  return {corner(triangles.a), corner(triangles.b), corner(triangles.c)};
}

std::span<const std::uint32_t> list_of(const VoxelLists& lists, Vec3 p) {
  const auto part = [](double x) { return static_cast<std::uint64_t>(max(std::floor(x), 0)); };
  const std::uint64_t key = voxel_key(part(p.x), part(p.y), part(p.z));
  const auto found = std::lower_bound(lists.key.begin(), lists.key.end(), key);
  if (found == lists.key.end() || *found != key) return {};
  const Voxel* const voxel = &lists.voxel[static_cast<std::size_t>(found - lists.key.begin())];
  return {lists.triangle.data() + voxel[0].first, voxel[1].first - voxel[0].first};
}

bool contains(std::span<const std::uint32_t> list, std::uint32_t triangle) {
  return std::find(list.begin(), list.end(), triangle) != list.end();
}

TEST(Voxel, KeysNameTheirVoxels) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t x = random.bits() >> 44, y = random.bits() >> 44, z = random.bits() >> 44;
    const VoxelPlace place = voxel_place(voxel_key(x, y, z));
    EXPECT_EQ(static_cast<std::uint64_t>(place.x), x);
    EXPECT_EQ(static_cast<std::uint64_t>(place.y), y);
    EXPECT_EQ(static_cast<std::uint64_t>(place.z), z);
  }
}

TEST(Voxel, TriangleTouchesACubeExactlyWhereSomeOfItIsInside) {
  Random random(2);
  int touching = 0, apart = 0;
  for (int i = 0; i < 20000; ++i) {
    const double size = std::pow(10.0, random.between(-2, 1));
    const Vec3 a = random.in_box(1.5), b = a + random.in_box(size), c = a + random.in_box(size);
    // The least largest coordinate over the triangle, by ternary search: it is convex.
    const auto over_edge = [&](double s) {
      double low = 0, high = 1;
      const auto at = [&](double t) {
        const Vec3 p = a + s * (b - a) + (1 - s) * t * (c - a);
        return max(std::fabs(p.x), max(std::fabs(p.y), std::fabs(p.z)));
      };
      for (int k = 0; k < 60; ++k) {
        const double third = (high - low) / 3;
        (at(low + third) > at(high - third) ? low : high) =
            at(low + third) > at(high - third) ? low + third : high - third;
      }
      return at(0.5 * (low + high));
    };
    double low = 0, high = 1;
    for (int k = 0; k < 60; ++k) {
      const double third = (high - low) / 3;
      if (over_edge(low + third) > over_edge(high - third)) {
        low += third;
      } else {
        high -= third;
      }
    }
    const double least = over_edge(0.5 * (low + high));
    if (least < 0.5 - 1e-9) {
      EXPECT_TRUE(touches_cube(a, b, c, 0.5)) << i << ": " << least;
      ++touching;
    } else if (least > 0.5 + 1e-4) {
      EXPECT_FALSE(touches_cube(a, b, c, 0.5)) << i << ": " << least;
      ++apart;
    }
    if (i == 2000 && std::getenv("LUMBRICAL_BROADPHASE_SCENES") == nullptr) break;
  }
  EXPECT_GT(touching, 50);
  EXPECT_GT(apart, 50);
}

TEST(Voxel, EveryVoxelListsEveryTriangleThatTouchesItAndNoOther) {
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    const double scale = std::pow(10.0, random.between(-3, 3));
    const Mesh mesh = moved(uneven_soup(random, 300), random.pose(100 * scale), scale);
    const Triangles triangles = triangles_of(mesh);
    Execution execution;
    execution.voxel_size = i % 2 == 0 ? 0 : scale * random.between(0.05, 0.5);
    VoxelLists lists;
    ASSERT_TRUE(build_voxel_lists(triangles, execution, lists).ok());
    EXPECT_LT(lists.wide.size(), mesh.triangles.size() / 2);
    for (std::uint32_t triangle = 0; triangle < triangles.size(); ++triangle) {
      if (std::binary_search(lists.wide.begin(), lists.wide.end(), triangle)) continue;
      const Corners t = in_voxels(triangles, lists, triangle);
      for (int k = 0; k < 100; ++k) {
        const double u = random.between(0, 1), v = random.between(0, 1 - u);
        EXPECT_TRUE(contains(list_of(lists, t.a + u * (t.b - t.a) + v * (t.c - t.a)), triangle)) << triangle;
      }
    }
    std::vector<int> centred(triangles.size());
    for (std::size_t k = 0; k < lists.key.size(); ++k) {
      const VoxelPlace place = voxel_place(lists.key[k]);
      const Vec3 middle{place.x + 0.5, place.y + 0.5, place.z + 0.5};
      for (std::uint32_t n = lists.voxel[k].first; n < lists.voxel[k + 1].first; ++n) {
        const Corners t = in_voxels(triangles, lists, lists.triangle[n]);
        EXPECT_TRUE(touches_cube(t.a - middle, t.b - middle, t.c - middle, 0.5 + 1e-5));
        if (n < lists.voxel[k].others) ++centred[lists.triangle[n]];
      }
    }
    for (const std::uint32_t triangle : lists.wide) ++centred[triangle];
    EXPECT_EQ(centred, std::vector<int>(triangles.size(), 1));
  }
}

// ---- Distance ----

double distance_by_definition(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const auto wide = [](Vec3 v) { return reference::Vector<long double>{v.x, v.y, v.z}; };
  return static_cast<double>(reference::distance_to_triangle(wide(p), wide(a), wide(b), wide(c)));
}

TEST(Voxel, NearestPointOfATriangleIsTheNearestOfManyOnIt) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = random.in_box(1), a = random.in_box(1);
    const Vec3 b = i % 7 == 0 ? a : random.in_box(1), c = i % 5 == 0 ? a + 0.3 * (b - a) : random.in_box(1);
    const NearestPoint nearest = nearest_point(p, a, b, c);
    EXPECT_NEAR(norm(nearest.gap), std::sqrt(nearest.square), 1e-15);
    EXPECT_NEAR(std::sqrt(nearest.square), distance_by_definition(p, a, b, c), 1e-14);
    constexpr int kSteps = 100;
    double least = 1e300;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; u + v <= kSteps; ++v)
        least = min(least, norm(a + u / double{kSteps} * (b - a) + v / double{kSteps} * (c - a) - p));
    }
    EXPECT_LE(std::sqrt(nearest.square), least + 1e-14);
    EXPECT_GE(std::sqrt(nearest.square), least - 4.0 / kSteps);
  }
}

double brute_distance(const Mesh& mesh, Vec3 p) {
  double least = HUGE_VAL;
  for (const Triangle& t : mesh.triangles)
    least =
        min(least, distance_by_definition(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  return least;
}

// Once round for a point inside (Van Oosterom, Strackee, 1983).
double winding_number(const Mesh& mesh, Vec3 p) {
  double angle = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p, c = mesh.vertices[t[2]] - p;
    const double x = norm(a), y = norm(b), z = norm(c);
    angle += 2 * std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
  }
  return angle / (4 * 3.14159265358979323846);
}

void expect_distances(const Mesh& mesh, double size, Random& random) {
  const Model model = model_of(scene_of(mesh), with_voxels());
  const VoxelReport report = *voxel_report(model);
  ASSERT_TRUE(report.has_distance) << report.note;
  const double voxel = report.voxel_size;
  for (int i = 0; i < 300; ++i) {
    const Vec3 at = mesh.vertices[random.bits() % mesh.vertices.size()];
    const Vec3 p = at + std::pow(10.0, random.between(-2, 1)) * voxel * random.direction();
    const double exact = brute_distance(mesh, p);
    const double found = *signed_distance(model, p);
    const bool inside = std::fabs(winding_number(mesh, p)) > 0.5;
    EXPECT_EQ(found < 0, inside) << "at " << exact / voxel << " voxels";
    if (exact < 0.999 * voxel) {
      EXPECT_NEAR(std::fabs(found), exact, 1e-9 * size);
    } else if (exact < 2.9 * voxel) {
      EXPECT_NEAR(std::fabs(found), exact, 0.6 * voxel);
    } else {
      EXPECT_GT(std::fabs(found), 2.3 * voxel);
    }
  }
}

TEST(Voxel, DistanceOfBoxesAndSpheresIsThatOfBruteForceWhereverTheyAre) {
  SKIP_WITHOUT_OPENVDB();
  Random random(5);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    Mesh box = make_box({1, 0.5, 0.7}, 6);
    expect_distances(moved(box, random.pose(10 * scale), scale), scale, random);
    for (Triangle& triangle : box.triangles) std::swap(triangle[0], triangle[1]);  // inside out
    expect_distances(moved(box, random.pose(10 * scale), scale), scale, random);
    expect_distances(moved(make_sphere(0.5, 10), random.pose(10 * scale), scale), scale, random);
  }
}

TEST(Voxel, DistanceOfRealMeshesIsThatOfBruteForce) {
  SKIP_WITHOUT_OPENVDB();
  const char* const data = std::getenv("LUMBRICAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set LUMBRICAL_DATA to a folder with meshes/";
  Random random(6);
  int closed = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(data) / "meshes")) {
    Mesh mesh;
    if (fs::file_size(entry) > 3'000'000 || !load_mesh(entry.path().string(), Unit::metre, mesh).ok())
      continue;
    const MeshReport report = inspect_mesh(mesh);
    const Model model = model_of(scene_of(mesh), with_voxels());
    if (!report.watertight) {
      EXPECT_FALSE(voxel_report(model)->has_distance) << entry.path();
      EXPECT_NE(voxel_report(model)->note, "");
      EXPECT_EQ(signed_distance(model, {}), std::nullopt);
    }
    if (!voxel_report(model)->has_distance) continue;
    ++closed;
    SCOPED_TRACE(entry.path());
    expect_distances(mesh, norm(report.upper - report.lower), random);
  }
  EXPECT_GT(closed, 0);
}

// ---- Cache ----

fs::path fresh_folder() {
  const fs::path folder =
      fs::temp_directory_path() / ("lumbrical_voxel_" + std::to_string(std::random_device{}()));
  fs::remove_all(folder);
  return folder;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
void put_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

struct Cached {
  fs::path folder = fresh_folder();
  Scene scene = mug_scene(Law::field);
  Execution execution = with_voxels();
  fs::path file;  // the one that the first build left
  Cached() {
    execution.voxel_cache = folder.string();
    const Model first = model_of(scene, execution);
    EXPECT_FALSE(voxel_report(first)->from_cache);
    for (const auto& entry : fs::directory_iterator(folder)) file = entry.path();
  }
  ~Cached() { fs::remove_all(folder); }
};

TEST(Voxel, ASecondBuildReadsTheFirstOnesFileAndGivesTheSameBits) {
  SKIP_WITHOUT_OPENVDB();
  const Cached cached;
  const Model built = model_of(cached.scene, with_voxels()), read = model_of(cached.scene, cached.execution);
  EXPECT_TRUE(voxel_report(read)->from_cache);
  EXPECT_EQ(voxel_report(read)->note, "");
  const auto frames = grasp_frames(cached.scene.hand, 20);
  EXPECT_EQ(hash_run(read, frames), hash_run(built, frames));
  Random random(7);
  EXPECT_EQ(voxel_report(read)->bytes, voxel_report(built)->bytes);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random.in_box(0.1);
    EXPECT_EQ(signed_distance(read, p), signed_distance(built, p));
  }
}

TEST(Voxel, AnotherSceneOrSizeDoesNotReadTheFile) {
  SKIP_WITHOUT_OPENVDB();
  Cached cached;
  cached.execution.voxel_size = 0.01;
  EXPECT_FALSE(voxel_report(model_of(cached.scene, cached.execution))->from_cache);
  cached.execution.voxel_size = 0;
  cached.scene.objects[0].mesh.vertices[5].x += 1e-15;
  EXPECT_FALSE(voxel_report(model_of(cached.scene, cached.execution))->from_cache);
}

TEST(Voxel, DamagedFilesAreRejectedWithAReasonAndBuiltAnew) {
  SKIP_WITHOUT_OPENVDB();
  const Cached cached;
  const std::string good = bytes_of(cached.file);
  const auto frames = grasp_frames(cached.scene.hand, 5);
  const std::uint64_t expected = hash_run(model_of(cached.scene, with_voxels()), frames);
  Random random(8);
  for (int i = 0; i < 30; ++i) {
    std::string bad = good;
    if (i % 3 == 0) bad.resize(random.bits() % good.size());
    if (i % 3 == 1)
      bad[i < 15 ? random.bits() % 88 : random.bits() % good.size()] ^= char(1 << random.bits() % 8);
    if (i % 3 == 2) bad += std::string(1 + random.bits() % 100, '\0');
    put_bytes(cached.file, bad);
    const Model model = model_of(cached.scene, cached.execution);
    const VoxelReport report = *voxel_report(model);
    EXPECT_FALSE(report.from_cache) << i;
    EXPECT_NE(report.note.find(cached.file.string()), std::string::npos) << i << ": " << report.note;
    EXPECT_NE(report.note.find("built anew"), std::string::npos) << i << ": " << report.note;
    if (i % 10 == 0) {
      EXPECT_EQ(hash_run(model, frames), expected) << i;
    }
    EXPECT_EQ(bytes_of(cached.file), good) << i;
  }
}

// Right hashes over wrong content, as someone hostile would write it.
TEST(Voxel, ForgedListsAreRejectedBeforeTheyAreUsed) {
  SKIP_WITHOUT_OPENVDB();
  const Cached cached;
  const Triangles triangles = model_of(cached.scene).triangles;
  const std::uint64_t source = hash_of_source(triangles, cached.execution);
  const std::string path = cache_path(cached.folder.string(), source);
  ASSERT_EQ(path, cached.file.string());
  VoxelLists lists;
  DistanceField field;
  ASSERT_TRUE(read_voxel_cache(path, source, triangles.size(), lists, field).ok());
  const auto forge = [&](const auto& change) {
    VoxelLists bad_lists = lists;
    DistanceField bad_field = field;
    change(bad_lists, bad_field);
    ASSERT_TRUE(write_voxel_cache(path, source, bad_lists, bad_field).ok());
    VoxelLists read_lists;
    DistanceField read_field;
    const Status status = read_voxel_cache(path, source, triangles.size(), read_lists, read_field);
    EXPECT_FALSE(status.ok());
    EXPECT_TRUE(read_lists.voxel.empty());
    EXPECT_FALSE(voxel_report(model_of(cached.scene, cached.execution))->from_cache);
  };
  const auto count = static_cast<std::uint32_t>(triangles.size());
  forge([&](VoxelLists& l, DistanceField&) { l.triangle[7] = count; });
  forge([&](VoxelLists& l, DistanceField&) { l.wide.push_back(count); });
  forge([&](VoxelLists& l, DistanceField&) { l.voxel[3].first = 0xffffffffu; });
  forge([&](VoxelLists& l, DistanceField&) { l.voxel[3].others = 0xffffffffu; });
  forge([&](VoxelLists& l, DistanceField&) { l.voxel[3].reach = std::nanf(""); });
  forge([&](VoxelLists& l, DistanceField&) { l.voxel.back().first -= 1; });
  forge([&](VoxelLists& l, DistanceField&) { std::swap(l.key[0], l.key[1]); });
  forge([&](VoxelLists& l, DistanceField&) { l.key.back() = ~std::uint64_t{0}; });
  forge([&](VoxelLists& l, DistanceField&) { l.voxel_size = 0; });
  forge([&](VoxelLists& l, DistanceField&) { l.origin.x = std::nan(""); });
  forge([&](VoxelLists&, DistanceField& f) { f.value[0] = std::nanf(""); });
  forge([&](VoxelLists&, DistanceField& f) { f.key[1] = f.key[0]; });
  forge([&](VoxelLists& l, DistanceField&) { l.wide.push_back(l.triangle[0]); });
  forge([&](VoxelLists& l, DistanceField&) { l.wide = {5, 5}; });
  forge([&](VoxelLists& l, DistanceField&) {  // one that is only touched there counts as centred there
    const auto has_others = [&](std::size_t i) { return l.voxel[i].others < l.voxel[i + 1].first; };
    std::size_t i = 0;
    while (!has_others(i)) ++i;
    ++l.voxel[i].others;
  });
}

// A voxel that stands alone takes a thousand times what a file takes to name it.
TEST(Voxel, AFileThatNamesVoxelsFarApartIsRejectedBeforeTheirTreeIsMade) {
  SKIP_WITHOUT_OPENVDB();
  Cached cached;
  cached.execution.voxel_memory = 5e7;
  const std::uint64_t source = hash_of_source(model_of(cached.scene).triangles, cached.execution);
  VoxelLists lists;
  DistanceField field;
  const std::size_t triangles = model_of(cached.scene).triangles.size();
  ASSERT_TRUE(read_voxel_cache(cached.file.string(), source, triangles, lists, field).ok());
  const std::uint32_t end = lists.voxel.back().first;
  for (std::uint64_t x = 1; x < 200; ++x) {
    lists.key.push_back(voxel_key(4096 * x, 0, 0));
    lists.voxel.insert(lists.voxel.end() - 1, {end, end, -1});
  }
  ASSERT_TRUE(write_voxel_cache(cached.file.string(), source, lists, field).ok());
  const VoxelReport report = *voxel_report(model_of(cached.scene, cached.execution));
  EXPECT_FALSE(report.from_cache);
  EXPECT_NE(report.note.find("voxel_memory"), std::string::npos) << report.note;
}

TEST(Voxel, AFolderThatCannotBeWrittenIsANoteNoError) {
  SKIP_WITHOUT_OPENVDB();
  const fs::path file = fresh_folder();
  put_bytes(file, "a file where a folder should be");
  Execution execution = with_voxels();
  execution.voxel_cache = (file / "inside").string();
  const Model model = model_of(mug_scene(Law::field), execution);
  EXPECT_NE(voxel_report(model)->note.find("not kept"), std::string::npos) << voxel_report(model)->note;
  fs::remove(file);
}

// ---- The tick and errors ----

TEST(Voxel, TicksGiveTheSameBitsAsTheTreesAlsoOnSeveralThreadsAtOnce) {
  SKIP_WITHOUT_OPENVDB();
  const Scene scene = mug_scene(Law::field);
  const auto frames = grasp_frames(scene.hand, 40);
  const std::uint64_t expected = hash_run(model_of(scene), frames);
  for (const double size : {0.0, 0.002, 0.01, 0.1}) {
    Execution execution = with_voxels();
    execution.voxel_size = size;
    const Model model = model_of(scene, execution);
    std::array<std::uint64_t, 3> hash{};
    std::array<std::thread, 3> threads;
    for (std::size_t i = 0; i < 3; ++i)
      threads[i] = std::thread([&, i] { hash[i] = hash_run(model, frames); });
    for (std::thread& thread : threads) thread.join();
    for (const std::uint64_t one : hash) EXPECT_EQ(one, expected) << "voxels of " << size;
  }
}

TEST(Voxel, MoreMemoryThanAllowedIsAnErrorThatTellsTheRemedy) {
  SKIP_WITHOUT_OPENVDB();
  Execution execution = with_voxels();
  execution.voxel_memory = 1e6;
  Model model;
  const Status status = build_model(scene_of(make_height_field(0.3, 100, 0.002, 0.04)), execution, model);
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message().find("voxel_memory"), std::string::npos) << status.message();
  EXPECT_NE(status.message().find("broadphase tree"), std::string::npos) << status.message();
  execution.voxel_memory = 1e3;
  EXPECT_FALSE(build_model(scene_of(make_mug({})), execution, model).ok());
  execution = with_voxels();
  execution.voxel_size = -1;
  EXPECT_FALSE(build_model(scene_of(make_mug({})), execution, model).ok());
}

// Pebbles strewn over ten kilometres: each has nodes of its own in every level of the tree.
TEST(Voxel, MemoryIsBoundedWhereTrianglesAreFarApart) {
  Mesh pebbles;
  Random random(12);
  for (int i = 0; i < 1000; ++i) {
    const Mesh pebble = make_box({0.1, 0.1, 0.1}, 1);
    const Vec3 at = random.in_box(5000);
    const auto first = static_cast<std::uint32_t>(pebbles.vertices.size());
    for (const Triangle& t : pebble.triangles)
      pebbles.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    for (const Vec3 p : pebble.vertices) pebbles.vertices.push_back(at + p);
  }
  Execution execution = with_voxels();
  execution.voxel_memory = 2e8;
  VoxelLists lists;
  EXPECT_FALSE(build_voxel_lists(triangles_of(pebbles), execution, lists).ok());
  execution.voxel_memory = 4e8;
  EXPECT_TRUE(build_voxel_lists(triangles_of(pebbles), execution, lists).ok());
  EXPECT_GT(tree_bytes(lists.key, 0), 2e8);
}

TEST(Voxel, EmptyAndDegenerateScenesAreNoTrouble) {
  SKIP_WITHOUT_OPENVDB();
  Scene empty;
  empty.hand = default_hand(Side::right);
  Model model = model_of(empty, with_voxels());
  EXPECT_EQ(voxel_report(model), std::nullopt);
  const auto frames = grasp_frames(empty.hand, 3);
  EXPECT_EQ(hash_run(model, frames), hash_run(model_of(empty), frames));
  Mesh point;
  point.vertices = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  point.triangles = {{0, 1, 2}, {0, 0, 0}};
  model = model_of(scene_of(point), with_voxels());
  EXPECT_EQ(voxel_report(model)->voxels, 1u);
}

TEST(Voxel, WhereOpenVdbIsMissingItIsToldWhatToInstall) {
  if (available(Broadphase::voxel)) GTEST_SKIP() << "OpenVDB is here";
  Model model;
  const Status status = build_model(mug_scene(Law::field), with_voxels(), model);
  EXPECT_NE(status.message().find("nstall"), std::string::npos) << status.message();
  EXPECT_NE(status.message().find("OpenVDB"), std::string::npos) << status.message();
}

}  // namespace
}  // namespace lumbrical::test
