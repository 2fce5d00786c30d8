// The engine's own meshes: closed where they should be, of the right size, and the same on every machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumbrical/mesh.h"
#include "lumbrical/shapes.h"

namespace lumbrical {
namespace {

constexpr double kPi = 3.141592653589793;

double doubled_height_of_normal(const Mesh& mesh, const Triangle& t) {
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return cross(b - a, c - a).z;
}

void expect_closed(const MeshReport& report, std::size_t parts) {
  EXPECT_TRUE(report.watertight);
  EXPECT_EQ(report.components, parts);
  EXPECT_GT(report.volume, 0);
  EXPECT_EQ(report.degenerate + report.duplicate + report.sliver + report.unused_vertices, 0u);
  EXPECT_EQ(report.merged_vertices, report.vertices);
}

TEST(Shapes, MugIsTwoClosedPartsOfTheRightSize) {
  const MugShape shape;
  const Mesh mug = make_mug(shape);
  const MeshReport report = inspect_mesh(mug);
  expect_closed(report, 2);
  EXPECT_EQ(report.lower.z, 0);
  EXPECT_NEAR(report.upper.z, shape.height, 1e-9);
  EXPECT_NEAR(report.lower.x, -shape.radius, 1e-9);
  EXPECT_NEAR(report.upper.x, shape.radius + shape.handle_reach + shape.handle_radius, 1e-4);

  // Outer cylinder less the hollow, plus the tube along half an ellipse; rim and foot are rounded, circles
  // are polygons: so within 2 %.
  const double inner = shape.radius - shape.wall;
  const double body =
      kPi * (shape.radius * shape.radius * shape.height - inner * inner * (shape.height - shape.wall));
  const double reach = shape.handle_reach + 0.5 * shape.wall, rise = 0.3 * shape.height;
  const double length = 0.5 * kPi * (3 * (reach + rise) - std::sqrt((3 * reach + rise) * (reach + 3 * rise)));
  const double handle = kPi * shape.handle_radius * shape.handle_radius * length;
  EXPECT_NEAR(report.volume, body + handle, 0.02 * (body + handle));
}

TEST(Shapes, MugHidesTheEndsOfItsHandleInTheWall) {
  for (const std::uint32_t segments : {8u, 9u, 10u, 11u, 12u, 37u, 96u, 300u}) {
    MugShape shape;
    shape.segments = segments;
    const Mesh mug = make_mug(shape);
    expect_closed(inspect_mesh(mug), 2);
    // The wall lies between the inner radius and the outer polygon's edges.
    const double inner = shape.radius - shape.wall, outer = shape.radius * std::cos(kPi / segments);
    const double end_x = shape.radius - 0.5 * shape.wall;
    std::size_t end_vertices = 0;
    for (const Vec3& p : mug.vertices) {
      const double r = std::sqrt(p.x * p.x + p.y * p.y);
      const bool in_hollow = r < inner - 1e-9 && p.z > shape.wall + 1e-9;
      EXPECT_FALSE(in_hollow) << p.x << " " << p.y << " " << p.z;
      if (std::fabs(p.x - end_x) > 1e-12 || std::fabs(p.y) > shape.handle_radius + 1e-12) continue;
      for (std::uint32_t edge = 0; edge < segments; ++edge) {
        const double direction = (2 * edge + 1) * kPi / segments;
        EXPECT_LT(p.x * std::cos(direction) + p.y * std::sin(direction), outer) << segments;
      }
      ++end_vertices;
    }
    EXPECT_GE(end_vertices, 2 * std::max(12u, segments / 4));
  }
}

TEST(Shapes, MugOfOtherSizesIsClosedAndImpossibleOnesAreEmpty) {
  MugShape cup;
  cup.radius = 0.045;
  cup.height = 0.06;
  cup.wall = 0.004;
  cup.handle_radius = 0.004;
  cup.handle_reach = 0.02;
  cup.segments = 64;
  expect_closed(inspect_mesh(make_mug(cup)), 2);

  const auto is_empty = [](auto change) {
    MugShape shape;
    change(shape);
    return make_mug(shape).triangles.empty();
  };
  EXPECT_TRUE(is_empty([](MugShape& s) { s.radius = 0; }));
  EXPECT_TRUE(is_empty([](MugShape& s) { s.height = -1; }));
  EXPECT_TRUE(is_empty([](MugShape& s) { s.wall = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(is_empty([](MugShape& s) { s.wall = 0.03; }));
  EXPECT_TRUE(is_empty([](MugShape& s) { s.handle_radius = 0.02; }));
  EXPECT_TRUE(is_empty([](MugShape& s) { s.handle_reach = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(is_empty([](MugShape& s) { s.segments = 2; }));
  EXPECT_TRUE(is_empty([](MugShape& s) { s.segments = 7; }));
  EXPECT_TRUE(is_empty([](MugShape& s) {  // the ends of the handle would stick out between two corners
    s.segments = 8;
    s.handle_radius = 0.007;
  }));
  EXPECT_TRUE(is_empty([](MugShape& s) { s.segments = 4000000000u; }));
}

TEST(Shapes, PlaneKeepsItsAreaAndFacesUpHoweverIrregular) {
  for (const double irregularity : {0.0, 0.3, 1.0}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Mesh plane = make_plane(0.3, 40, irregularity, seed);
      ASSERT_EQ(plane.triangles.size(), 3200u);
      double doubled_area = 0;
      for (const Triangle& triangle : plane.triangles) {
        const double part = doubled_height_of_normal(plane, triangle);
        EXPECT_GT(part, 0);
        doubled_area += part;
      }
      EXPECT_NEAR(0.5 * doubled_area, 0.09, 1e-12 * 0.09);
      const MeshReport report = inspect_mesh(plane);
      EXPECT_EQ(report.boundary_edges, 160u);
      EXPECT_EQ(report.non_manifold_edges + report.misoriented_edges, 0u);
      EXPECT_EQ(report.lower, (Vec3{-0.15, -0.15, 0}));
      EXPECT_EQ(report.upper, (Vec3{0.15, 0.15, 0}));
    }
  }
}

TEST(Shapes, IrregularPlaneMovesVerticesAndFlipsDiagonals) {
  const Mesh regular = make_plane(1, 10), irregular = make_plane(1, 10, 1, 3);
  std::size_t moved = 0, flipped = 0;
  for (std::size_t i = 0; i < regular.vertices.size(); ++i) {
    const double way = norm(irregular.vertices[i] - regular.vertices[i]);
    EXPECT_LE(way, 0.3 * 0.1 + 1e-15);
    if (way > 0) ++moved;
  }
  for (std::size_t i = 0; i < regular.triangles.size(); ++i) {
    if (regular.triangles[i] != irregular.triangles[i]) ++flipped;
  }
  EXPECT_EQ(moved, 81u);
  EXPECT_GT(flipped, 60u);
  EXPECT_LT(flipped, 140u);
  EXPECT_EQ(irregular.vertices, make_plane(1, 10, 1, 3).vertices);
  EXPECT_NE(irregular.vertices, make_plane(1, 10, 1, 4).vertices);
}

TEST(Shapes, IrregularPlaneIsTheSameOnEveryMachine) {
  const Mesh plane = make_plane(0.25, 4, 1, 1);
  std::uint64_t hash = 0xCBF29CE484222325u;  // FNV-1a over the vertices, in multiples of 2^-60 m
  for (const Vec3& p : plane.vertices) {
    for (const double value : {p.x, p.y}) {
      hash = (hash ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(value * 0x1p60))) * 0x100000001B3u;
    }
  }
  for (const Triangle& t : plane.triangles) {
    for (const std::uint32_t corner : t) hash = (hash ^ corner) * 0x100000001B3u;
  }
  EXPECT_EQ(hash, 8807331311068061942u);
}

TEST(Shapes, HeightFieldFollowsItsFormula) {
  const double amplitude = 0.01, wavelength = 0.05;
  const Mesh field = make_height_field(0.3, 30, amplitude, wavelength);
  ASSERT_EQ(field.triangles.size(), 1800u);
  double highest = 0;
  for (const Vec3& p : field.vertices) {
    const double u = 2 * kPi * p.x / wavelength, v = 2 * kPi * p.y / wavelength;
    const double z = 0.85 * std::sin(u) * std::cos(v) + 0.15 * std::cos(3 * u + 1) * std::sin(3 * v + 0.5);
    EXPECT_NEAR(p.z, amplitude * z, 1e-13);
    highest = std::max(highest, std::fabs(p.z));
  }
  EXPECT_LE(highest, amplitude);
  EXPECT_GT(highest, 0.5 * amplitude);
  for (const Triangle& triangle : field.triangles) EXPECT_GT(doubled_height_of_normal(field, triangle), 0);
}

TEST(Shapes, BoxIsClosedWithTheVolumeOfItsSides) {
  for (const std::uint32_t cells : {1u, 2u, 7u}) {
    const Vec3 size{0.1, 0.2, 0.3};
    const Mesh box = make_box(size, cells);
    const MeshReport report = inspect_mesh(box);
    expect_closed(report, 1);
    EXPECT_EQ(report.triangles, 12u * cells * cells);
    EXPECT_EQ(report.vertices, 6u * cells * cells + 2u);
    EXPECT_NEAR(report.volume, 0.006, 1e-15);
    EXPECT_NEAR(report.area, 0.22, 1e-14);
    EXPECT_EQ(report.lower, -0.5 * size);
    EXPECT_EQ(report.upper, 0.5 * size);
  }
}

TEST(Shapes, SphereIsClosedWithAllVerticesAtItsRadius) {
  const Mesh sphere = make_sphere(0.05, 20);
  const MeshReport report = inspect_mesh(sphere);
  expect_closed(report, 1);
  for (const Vec3& p : sphere.vertices) EXPECT_NEAR(norm(p), 0.05, 1e-16);
  const double ball = 4.0 / 3.0 * kPi * 0.05 * 0.05 * 0.05;
  EXPECT_LT(report.volume, ball);
  EXPECT_GT(report.volume, 0.995 * ball);
}

TEST(Shapes, ArgumentsOutOfRangeGiveAnEmptyMesh) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(make_plane(0, 4).triangles.empty());
  EXPECT_TRUE(make_plane(nan, 4).triangles.empty());
  EXPECT_TRUE(make_plane(1, 0).triangles.empty());
  EXPECT_TRUE(make_plane(1, 4000000000u).triangles.empty());
  EXPECT_TRUE(make_plane(1, 4, 2).triangles.empty());
  EXPECT_TRUE(make_plane(1, 4, nan).triangles.empty());
  EXPECT_TRUE(make_height_field(1, 4, nan, 1).triangles.empty());
  EXPECT_TRUE(make_height_field(1, 4, 1, 0).triangles.empty());
  EXPECT_TRUE(make_box({1, 1, -1}, 1).triangles.empty());
  EXPECT_TRUE(make_box({1, 1, 1}, 0).triangles.empty());
  EXPECT_TRUE(make_sphere(-1, 4).triangles.empty());
  EXPECT_TRUE(make_sphere(1, 0).triangles.empty());
}

}  // namespace
}  // namespace lumbrical
