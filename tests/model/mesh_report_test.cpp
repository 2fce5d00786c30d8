// The mesh report: what counts as degenerate, sliver, duplicate, open, non-manifold or misoriented, on small
// meshes with known answers and on real ones.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "files.h"
#include "lumbrical/mesh.h"
#include "lumbrical/shapes.h"

namespace lumbrical {
namespace {

const std::vector<Vec3> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const Mesh kTetrahedron = {kCorners, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};

bool has_example(const MeshReport& report, const std::string& text) {
  for (const std::string& example : report.examples) {
    if (example == text) return true;
  }
  return false;
}

TEST(MeshReport, FindsNothingWrongWithATetrahedron) {
  const MeshReport report = inspect_mesh(kTetrahedron);
  EXPECT_EQ(report.triangles, 4u);
  EXPECT_EQ(report.vertices, 4u);
  EXPECT_EQ(report.merged_vertices, 4u);
  EXPECT_EQ(report.unused_vertices + report.degenerate + report.sliver + report.duplicate, 0u);
  EXPECT_EQ(report.boundary_edges + report.non_manifold_edges + report.misoriented_edges, 0u);
  EXPECT_EQ(report.components, 1u);
  EXPECT_TRUE(report.watertight);
  EXPECT_TRUE(report.examples.empty());
  EXPECT_NEAR(report.volume, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(report.area, 1.5 + std::sqrt(0.75), 1e-15);
  EXPECT_EQ(report.shortest_edge, 1);
  EXPECT_DOUBLE_EQ(report.longest_edge, std::sqrt(2.0));
  EXPECT_EQ(report.lower, (Vec3{0, 0, 0}));
  EXPECT_EQ(report.upper, (Vec3{1, 1, 1}));
}

TEST(MeshReport, OfNothingIsEmptyAndNotWatertight) {
  const MeshReport report = inspect_mesh({});
  EXPECT_EQ(report.triangles + report.components + report.boundary_edges, 0u);
  EXPECT_FALSE(report.watertight);
  EXPECT_EQ(report.area, 0);
}

TEST(MeshReport, ComparesVerticesByPosition) {
  Mesh soup;
  for (const Triangle& triangle : kTetrahedron.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : triangle) soup.vertices.push_back(kCorners[corner]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  soup.vertices[0].x = -0.0;
  soup.vertices.push_back({9, 9, 9});
  const MeshReport report = inspect_mesh(soup);
  EXPECT_EQ(report.vertices, 13u);
  EXPECT_EQ(report.merged_vertices, 5u);
  EXPECT_EQ(report.unused_vertices, 1u);
  EXPECT_TRUE(report.watertight);
  EXPECT_EQ(report.upper, (Vec3{1, 1, 1}));  // the unused vertex does not count
}

TEST(MeshReport, CountsDegenerateTriangles) {
  Mesh mesh = kTetrahedron;
  mesh.vertices.push_back({0, 1, 0});     // 4, where 2 is
  mesh.vertices.push_back({0.25, 0, 0});  // 5, between 0 and 1
  mesh.triangles.push_back({3, 3, 1});    // triangle 4
  mesh.triangles.push_back({4, 2, 1});    // triangle 5
  mesh.triangles.push_back({0, 5, 1});    // triangle 6
  const MeshReport report = inspect_mesh(mesh);
  EXPECT_EQ(report.degenerate, 3u);
  EXPECT_EQ(report.sliver, 0u);
  EXPECT_EQ(report.duplicate, 0u);
  EXPECT_TRUE(has_example(report, "triangle 4 is degenerate (corner 3 occurs twice)"));
  EXPECT_TRUE(has_example(report, "triangle 5 is degenerate (corners 2 and 4 coincide)"));
  EXPECT_TRUE(has_example(report, "triangle 6 is degenerate (corners 0, 5 and 1 are collinear)"));
  EXPECT_EQ(report.boundary_edges, 2u);      // 0-5 and 5-1 of triangle 6, which has three edges at least
  EXPECT_EQ(report.non_manifold_edges, 1u);  // 0-1
  EXPECT_EQ(report.shortest_edge, 0.25);
}

TEST(MeshReport, CallsCollinearPointsDegenerateAtAnySizeAndPlace) {
  std::mt19937_64 random(7);
  const auto draw = [&] { return 2.0 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1.0; };
  for (int i = 0; i < 2000; ++i) {
    const double size = std::ldexp(1.0, static_cast<int>(random() % 40) - 20);
    const Vec3 place = 1000.0 * size * Vec3{draw(), draw(), draw()};
    const Vec3 way = size * Vec3{draw(), draw(), draw()};
    Mesh mesh{{place, place + 0.3 * way, place + way}, {{0, 1, 2}}};
    EXPECT_EQ(inspect_mesh(mesh).degenerate, 1u);
    mesh.vertices[1] += 1e-6 * norm(way) * unit_or(cross(way, {1, 0, 0}), {0, 1, 0});
    const MeshReport report = inspect_mesh(mesh);
    EXPECT_EQ(report.degenerate, 0u);
    EXPECT_EQ(report.sliver, 1u);
  }
}

TEST(MeshReport, CallsTrianglesBelowOneDegreeSlivers) {
  const double degree = 3.14159265358979 / 180.0;
  for (const double size : {1e-9, 1.0, 1e9}) {
    for (const double angle : {0.001, 0.5, 0.999, 1.001, 2.0, 30.0}) {
      const Vec3 tip = size * Vec3{std::cos(angle * degree), std::sin(angle * degree), 0};
      const MeshReport report = inspect_mesh({{{0, 0, 0}, {size, 0, 0}, tip}, {{0, 1, 2}}});
      EXPECT_EQ(report.sliver, angle < 1 ? 1u : 0u) << angle;
      EXPECT_EQ(report.degenerate, 0u) << angle;
    }
    // A flat cap has two small angles, and the vertex with the large one may be any.
    for (std::uint32_t first = 0; first < 3; ++first) {
      const Triangle turned = {first, (first + 1) % 3, (first + 2) % 3};
      const double height = size * 0.5 * std::tan(0.9 * degree);
      EXPECT_EQ(inspect_mesh({{{0, 0, 0}, {size, 0, 0}, {0.5 * size, height, 0}}, {turned}}).sliver, 1u);
    }
  }
}

TEST(MeshReport, CountsDuplicatesInAnyOrderOfTheCorners) {
  Mesh mesh = kTetrahedron;
  mesh.vertices.push_back({1, 0, 0});  // 4, where 1 is
  mesh.triangles.push_back({4, 0, 2});
  mesh.triangles.push_back({1, 2, 0});
  const MeshReport report = inspect_mesh(mesh);
  EXPECT_EQ(report.duplicate, 2u);
  EXPECT_TRUE(has_example(report, "triangle 4 repeats triangle 0"));
  EXPECT_TRUE(has_example(report, "triangle 5 repeats triangle 4"));
  EXPECT_EQ(report.non_manifold_edges, 3u);
}

TEST(MeshReport, CountsOpenAndMisorientedEdges) {
  Mesh mesh = kTetrahedron;
  mesh.triangles.pop_back();
  const MeshReport open = inspect_mesh(mesh);
  EXPECT_EQ(open.boundary_edges, 3u);
  EXPECT_FALSE(open.watertight);
  EXPECT_TRUE(has_example(open, "edge 0-2 is open (only triangle 0 has it)"));

  mesh = kTetrahedron;
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  const MeshReport turned = inspect_mesh(mesh);
  EXPECT_EQ(turned.misoriented_edges, 3u);
  EXPECT_EQ(turned.boundary_edges, 0u);
  EXPECT_FALSE(turned.watertight);
  EXPECT_TRUE(has_example(
      turned, "edge 0-2 is misoriented (triangle 0 and triangle 3 run through it in the same direction)"));
}

TEST(MeshReport, SeesAnInsideOutSolidByItsVolume) {
  Mesh mesh = kTetrahedron;
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  const MeshReport report = inspect_mesh(mesh);
  EXPECT_TRUE(report.watertight);
  EXPECT_NEAR(report.volume, -1.0 / 6.0, 1e-15);
}

TEST(MeshReport, CountsPartsThatShareNoEdge) {
  Mesh mesh = kTetrahedron;
  for (const Vec3& corner : kCorners)
    mesh.vertices.push_back(corner - Vec3{1, 0, 0});  // touches at one vertex
  for (std::size_t i = 0; i < 4; ++i) {
    const Triangle& t = kTetrahedron.triangles[i];
    mesh.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  }
  const MeshReport report = inspect_mesh(mesh);
  EXPECT_EQ(report.components, 2u);
  EXPECT_EQ(report.merged_vertices, 7u);
  EXPECT_TRUE(report.watertight);
}

TEST(MeshReport, MeasuresTheSameAfterARigidMotion) {
  std::mt19937_64 random(11);
  const auto draw = [&] { return 2.0 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1.0; };
  const Mesh mesh = make_sphere(0.1, 6);
  const MeshReport before = inspect_mesh(mesh);
  for (int i = 0; i < 20; ++i) {
    const Pose pose{{draw(), draw(), draw()}, normalized({draw(), draw(), draw(), draw()})};
    Mesh moved = mesh;
    for (Vec3& p : moved.vertices) p = transform(pose, p);
    const MeshReport after = inspect_mesh(moved);
    EXPECT_TRUE(after.watertight);
    EXPECT_NEAR(after.area, before.area, 1e-13);
    EXPECT_NEAR(after.volume, before.volume, 1e-14);
    EXPECT_NEAR(after.longest_edge, before.longest_edge, 1e-14);
    EXPECT_EQ(after.degenerate + after.sliver, 0u);
  }
}

TEST(MeshReport, DoesNotOverflowOrVanishAtExtremeSizes) {
  for (const double size : {1e-150, 1e-90, 1e90, 1e150, 1.7e308}) {
    Mesh mesh = kTetrahedron;
    for (Vec3& p : mesh.vertices) p = size * p;
    mesh.vertices.push_back({-size, 0, 0});
    mesh.triangles.push_back({0, 4, 1});  // collinear
    const MeshReport report = inspect_mesh(mesh);
    EXPECT_EQ(report.degenerate, 1u) << size;
    EXPECT_EQ(report.sliver, 0u) << size;
    EXPECT_FALSE(std::isnan(report.area) || std::isnan(report.volume)) << size;
  }
}

TEST(MeshReport, GivesAFewExamplesOfEachKindOnly) {
  Mesh mesh = make_plane(1, 20);
  mesh.triangles.insert(mesh.triangles.end(), 100, Triangle{0, 0, 1});
  EXPECT_LE(inspect_mesh(mesh).examples.size(), 18u);
}

// ---- Real meshes ----

struct KnownMesh {
  const char* file;
  Unit unit;
  std::size_t triangles, vertices, sliver, boundary_edges, non_manifold_edges, components;
  double volume;  // [m^3]
};

constexpr KnownMesh kKnown[] = {
    {"spot.obj", Unit::metre, 5856, 2930, 0, 0, 0, 1, 0.718259},
    {"bunny.obj", Unit::metre, 69451, 35947, 1, 223, 0, 1, 0.000736},
    {"fandisk.obj", Unit::metre, 12946, 6475, 0, 0, 0, 1, 20.2434},
    {"horse.ply", Unit::metre, 96966, 48485, 0, 0, 0, 1, -0.000263418},  // this file is inside out
    {"igea_268k.ply", Unit::metre, 268686, 134345, 0, 0, 0, 1, 0.000278524},
    {"mug.obj", Unit::centimetre, 24544, 12272, 0, 0, 0, 1, 0.000133298},
    {"screwdriver.off", Unit::metre, 6786, 3395, 0, 0, 0, 1, 1.3906e-5},
    {"teapot.obj", Unit::metre, 6320, 3644, 0, 160, 0, 4, 26.22},
    {"beetle.obj", Unit::metre, 2053, 1148, 7, 296, 47, 2, 0.0308},
    {"adis16480_bin.stl", Unit::metre, 7436, 3672, 2332, 0, 0, 1, 2.81925e-5},
    {"tray_bin.stl", Unit::millimetre, 4520, 2216, 732, 0, 0, 1, 0.000347866},
    {"z1_gripper_stator_bin.stl", Unit::metre, 43404, 21745, 2479, 146, 0, 1, 0.000322},
    {"fuji_ascii.stl", Unit::millimetre, 344, 174, 17, 0, 0, 1, 1.24425e-5},
    {"fuze_ascii.ply", Unit::metre, 1000, 502, 0, 0, 0, 1, 0.000606689},
};

TEST(MeshReport, AgreesWithWhatIsKnownOfRealMeshes) {
  const std::filesystem::path folder = test::data_folder() / "meshes";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no real meshes at " << folder << "; set LUMBRICAL_DATA";
  for (const KnownMesh& known : kKnown) {
    SCOPED_TRACE(known.file);
    Mesh mesh;
    const Status status = load_mesh((folder / known.file).string(), known.unit, mesh);
    ASSERT_TRUE(status.ok()) << status.message();
    const MeshReport report = inspect_mesh(mesh);
    EXPECT_EQ(report.triangles, known.triangles);
    EXPECT_EQ(report.vertices, known.vertices);
    EXPECT_EQ(report.sliver, known.sliver);
    EXPECT_EQ(report.boundary_edges, known.boundary_edges);
    EXPECT_EQ(report.non_manifold_edges, known.non_manifold_edges);
    EXPECT_EQ(report.components, known.components);
    EXPECT_EQ(report.degenerate + report.duplicate + report.misoriented_edges, 0u);
    EXPECT_EQ(report.watertight, known.boundary_edges + known.non_manifold_edges == 0);
    EXPECT_NEAR(report.volume, known.volume, 2e-3 * std::fabs(known.volume));
  }
}

}  // namespace
}  // namespace lumbrical
