// Meshes turned outside out: what is turned, what is kept bit for bit, and what nobody but the user can
// decide.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "lumbrical/mesh.h"
#include "lumbrical/model.h"
#include "lumbrical/shapes.h"

namespace lumbrical {
namespace {

Mesh reversed(Mesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

Mesh scaled(Mesh mesh, double scale, Vec3 shift = {}) {
  for (Vec3& v : mesh.vertices) v = scale * v + shift;
  return mesh;
}

Mesh together(const std::vector<Mesh>& meshes) {
  Mesh all;
  for (const Mesh& mesh : meshes) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const Triangle& t : mesh.triangles)
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return all;
}

// Every triangle with vertices of its own, in an order that has nothing to do with the surface.
Mesh soup(const Mesh& mesh, std::uint32_t seed) {
  std::vector<Triangle> triangles = mesh.triangles;
  std::mt19937 random(seed);
  for (std::size_t i = triangles.size(); i > 1; --i) std::swap(triangles[i - 1], triangles[random() % i]);
  Mesh apart;
  for (const Triangle& t : triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t corner : t) apart.vertices.push_back(mesh.vertices[corner]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

const Mesh kBox = make_box({0.1, 0.1, 0.1}, 3), kBall = make_sphere(0.03, 6);

WindingReport wind(Mesh mesh, const Mesh& wanted) {
  const WindingReport report = wind_outwards(mesh);
  EXPECT_EQ(mesh.vertices, wanted.vertices);
  EXPECT_EQ(mesh.triangles, wanted.triangles);
  return report;
}

TEST(MeshWinding, WhatFacesOutwardsKeepsItsBits) {
  for (const Mesh& mesh :
       {kBox, kBall, make_mug({}), soup(kBox, 1), together({kBall, scaled(kBox, 1, {1, 0, 0})})}) {
    const WindingReport report = wind(mesh, mesh);
    EXPECT_EQ(report.turned_triangles + report.turned_parts + report.open_parts, 0u);
  }
}

TEST(MeshWinding, AnInsideOutMeshIsTurned) {
  for (const Mesh& mesh : {kBox, kBall, make_mug({}), soup(kBall, 2), scaled(kBall, 1, {5, -3, 100})}) {
    const WindingReport report = wind(reversed(mesh), mesh);
    EXPECT_EQ(report.turned_triangles, mesh.triangles.size());
    EXPECT_EQ(report.turned_parts, report.parts);
  }
}

TEST(MeshWinding, OfSeveralPartsOnlyThoseInsideOutAreTurned) {
  const Mesh left = scaled(kBall, 1, {-1, 0, 0});
  const WindingReport report = wind(together({reversed(left), kBox, reversed(scaled(kBox, 1, {1, 0, 0}))}),
                                    together({left, kBox, scaled(kBox, 1, {1, 0, 0})}));
  EXPECT_EQ(report.parts, 3u);
  EXPECT_EQ(report.turned_parts, 2u);
  EXPECT_EQ(report.turned_triangles, kBall.triangles.size() + kBox.triangles.size());
}

TEST(MeshWinding, SingleTrianglesOfAClosedPartAreTurnedToTheirNeighbours) {
  Mesh mixed = soup(kBall, 3);
  const Mesh wanted = mixed;
  std::mt19937 random(4);
  std::size_t wrong = 0;
  for (Triangle& t : mixed.triangles) {
    if (random() % 3 != 0) continue;
    std::swap(t[1], t[2]);
    ++wrong;
  }
  EXPECT_EQ(wind(mixed, wanted).turned_triangles, wrong);
}

TEST(MeshWinding, ACavityIsNotTurned) {
  const Mesh shell = together({kBox, reversed(kBall)});
  const WindingReport report = wind(shell, shell);
  EXPECT_EQ(report.turned_parts, 0u);
  EXPECT_EQ(report.inner_parts, 1u);
  EXPECT_EQ(report.open_parts, 0u);
}

TEST(MeshWinding, AShellThatIsInsideOutIsTurnedAsAWhole) {
  const Mesh shell = together({kBox, reversed(kBall)});
  EXPECT_EQ(wind(reversed(shell), shell).turned_parts, 2u);
  EXPECT_EQ(wind(reversed(soup(shell, 5)), soup(shell, 5)).turned_parts, 2u);
}

TEST(MeshWinding, ASolidInASolidStaysSolid) {
  const Mesh both = together({kBox, kBall});
  EXPECT_EQ(wind(both, both).turned_parts, 0u);
  EXPECT_EQ(wind(reversed(both), both).turned_parts, 2u);
}

TEST(MeshWinding, WhatStandsInACavityIsTurnedOutwards) {
  const Mesh shell = together({kBox, reversed(scaled(kBox, 0.8))});
  const WindingReport report = wind(together({shell, reversed(kBall)}), together({shell, kBall}));
  EXPECT_EQ(report.turned_parts, 1u);
  EXPECT_EQ(report.inner_parts, 2u);
}

TEST(MeshWinding, APartThatReachesOutOfAnotherIsNotItsCavity) {
  const Mesh out = scaled(kBall, 1, {0.04, 0, 0});  // by 2 cm
  EXPECT_EQ(wind(together({kBox, reversed(out)}), together({kBox, out})).turned_parts, 1u);
}

TEST(MeshWinding, ManyPartsInARowAreEachDecided) {
  std::vector<Mesh> given, wanted;
  std::mt19937 random(6);
  for (int i = 0; i < 200; ++i) {
    const Mesh shell = together({make_box({1, 1, 1}, 1), reversed(make_box({0.5, 0.5, 0.5}, 1))});
    wanted.push_back(scaled(shell, 0.01, {0.02 * (i % 20), 0.02 * (i / 20), 0}));
    given.push_back(random() % 2 == 0 ? wanted.back() : reversed(wanted.back()));
  }
  const WindingReport report = wind(together(given), together(wanted));
  EXPECT_EQ(report.parts, 400u);
  EXPECT_EQ(report.inner_parts, 200u);
}

TEST(MeshWinding, AScanWithSmallHolesIsDecidedAllTheSame) {
  Mesh scan = make_sphere(0.05, 24);
  std::mt19937 random(7);
  for (int i = 0; i < 40; ++i)
    scan.triangles.erase(scan.triangles.begin() +
                         static_cast<std::ptrdiff_t>(random() % scan.triangles.size()));
  const WindingReport report = wind(reversed(scan), scan);
  EXPECT_EQ(report.turned_parts, 1u);
  EXPECT_EQ(report.open_parts, 0u);
}

// A box without its lid, z > 0.
Mesh open_box() {
  Mesh box = kBox;
  std::erase_if(box.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return box.vertices[v].z > 0.0499; });
  });
  return box;
}

TEST(MeshWinding, AnOpenMeshStaysAsItIsAndIsSaidToFaceItsWay) {
  const WindingReport out = wind(open_box(), open_box()),
                      in = wind(reversed(open_box()), reversed(open_box()));
  EXPECT_EQ(out.open_parts, 1u);
  EXPECT_EQ(out.open_triangles, open_box().triangles.size());
  EXPECT_NEAR(out.open_area, 0.05, 1e-12);
  EXPECT_NEAR(out.outward_area, 0.05, 1e-12);
  EXPECT_EQ(out.inward_area, 0);
  EXPECT_NEAR(in.inward_area, 0.05, 1e-12);
  EXPECT_EQ(in.turned_triangles, 0u);
  const WindingReport plane = wind(make_plane(1, 4, 0), make_plane(1, 4, 0));  // faces no way
  EXPECT_EQ(plane.open_parts, 1u);
  EXPECT_EQ(plane.outward_area + plane.inward_area, 0);
}

TEST(MeshWinding, AVertexFarAwayThatNoTriangleNamesClosesNoHole) {
  Mesh box = reversed(open_box());
  const WindingReport without = wind(box, box);
  box.vertices.push_back({1e5, 0, 0});
  const WindingReport with = wind(box, box);
  EXPECT_EQ(with.open_parts, 1u);
  EXPECT_EQ(with.inward_area, without.inward_area);
}

TEST(MeshWinding, CopiesAndDegenerateTrianglesHideNothing) {
  Mesh mesh = kBall;
  mesh.triangles.push_back(mesh.triangles[7]);
  mesh.triangles.push_back({mesh.triangles[9][1], mesh.triangles[9][2], mesh.triangles[9][0]});
  mesh.triangles.push_back({3, 3, 5});
  Mesh given = reversed(mesh);
  std::swap(mesh.triangles.back()[1], mesh.triangles.back()[2]);  // has no sides: stays
  const WindingReport report = wind(given, mesh);
  EXPECT_EQ(report.turned_triangles, kBall.triangles.size() + 2);
  EXPECT_EQ(report.open_parts, 0u);
}

Mesh with_two_sides(Mesh mesh) {
  const std::vector<Triangle> behind = reversed(mesh).triangles;
  mesh.triangles.insert(mesh.triangles.end(), behind.begin(), behind.end());
  return mesh;
}

// As exporters write surfaces that are to be seen from both sides. What stands back to back would be felt
// nowhere.
TEST(MeshWinding, SecondSidesOfAClosedPartFaceOutwardsTooAndAreTold) {
  const std::size_t count = kBall.triangles.size();
  Mesh wanted = kBall;
  wanted.triangles.insert(wanted.triangles.end(), kBall.triangles.begin(), kBall.triangles.end());
  for (const Mesh& given : {with_two_sides(kBall), with_two_sides(reversed(kBall)), reversed(wanted)}) {
    const WindingReport report = wind(given, wanted);
    EXPECT_EQ(report.double_triangles, count);
    EXPECT_EQ(report.back_to_back_triangles, 0u);
  }
  Mesh half = with_two_sides(kBall);
  half.triangles.resize(count + count / 2);
  wanted.triangles.resize(count + count / 2);
  EXPECT_EQ(wind(half, wanted).double_triangles, count / 2);
}

// Their vertices are not the same, and no edge is open.
TEST(MeshWinding, AClosedPartThatStandsTwiceIsTold) {
  const Mesh beside = scaled(kBox, 1, {1, 0, 0}), twice = together({kBall, beside, kBall});
  EXPECT_EQ(wind(together({kBall, beside, reversed(kBall)}), twice).double_triangles, kBall.triangles.size());
  EXPECT_EQ(wind(together({kBall, kBall, kBall}), together({kBall, kBall, kBall})).double_triangles,
            2 * kBall.triangles.size());
  // In a solid the other may be its cavity: who knows?
  const Mesh held = together({kBox, kBall, reversed(kBall)});
  EXPECT_EQ(wind(held, held).back_to_back_triangles, kBall.triangles.size());
}

TEST(MeshWinding, PartsOfOneBoxAndNumberAreNotTakenForOneAnother) {
  const Mesh one{{{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  Mesh mirrored = one;
  for (Vec3& vertex : mirrored.vertices) vertex.x = 1 - vertex.x;
  Mesh both = together({one, mirrored});
  const WindingReport report = wind_outwards(both);
  EXPECT_EQ(report.parts, 2u);
  EXPECT_EQ(report.open_parts, 0u);
  EXPECT_EQ(report.double_triangles, 0u);
}

TEST(MeshWinding, ASheetWithTwoSidesStaysAndIsToldToBeFeltFromNeither) {
  const Mesh sheet = make_plane(1, 4, 0);
  for (const Mesh& given : {with_two_sides(sheet), together({sheet, reversed(sheet)})}) {
    const WindingReport report = wind(given, given);
    EXPECT_EQ(report.back_to_back_triangles, sheet.triangles.size());
    EXPECT_EQ(report.double_triangles, 0u);
  }
  Mesh twice = sheet;
  twice.triangles.insert(twice.triangles.end(), sheet.triangles.begin(), sheet.triangles.end());
  const WindingReport report = wind(twice, twice);
  EXPECT_EQ(report.double_triangles, sheet.triangles.size());
  EXPECT_EQ(report.back_to_back_triangles, 0u);
}

// As exporters leave it that round each triangle's corners by themselves.
TEST(MeshWinding, CornersThatRoundingDroveApartAreOne) {
  for (const double rounding : {1e-8, 1e-7}) {  // [m] at 0.17 and 0.06 m
    for (const Mesh& closed : {kBox, kBall, scaled(kBall, 1, {0.3, -2, 7})}) {
      Mesh wanted = soup(closed, 11);
      std::mt19937 random(12);
      std::uniform_real_distribution<double> off(-rounding, rounding);
      for (Vec3& vertex : wanted.vertices) vertex += {off(random), off(random), off(random)};
      const WindingReport report = wind(reversed(wanted), wanted);
      EXPECT_EQ(report.open_parts, 0u);
      EXPECT_EQ(report.turned_triangles, closed.triangles.size());
    }
  }
  // What is farther apart is another part.
  const Mesh near = together({open_box(), scaled(open_box(), 1, {0.1 + 5e-6, 0, 0})});
  EXPECT_EQ(wind(near, near).parts, 2u);
}

// Panels round a thing: none has an inside of its own, together they face away from it or towards it.
TEST(MeshWinding, ManyOpenPartsFaceTheirWayTogether) {
  Mesh panels = soup(kBall, 13);
  for (const Triangle& t : panels.triangles) {  // each shrunk: gaps all round
    const Vec3 middle = (panels.vertices[t[0]] + panels.vertices[t[1]] + panels.vertices[t[2]]) / 3;
    for (const std::uint32_t corner : t) panels.vertices[corner] += 0.1 * (middle - panels.vertices[corner]);
  }
  const WindingReport out = wind(panels, panels), in = wind(reversed(panels), reversed(panels));
  EXPECT_EQ(out.open_parts, panels.triangles.size());
  EXPECT_NEAR(out.outward_area, out.open_area, 1e-12);
  EXPECT_NEAR(in.inward_area, in.open_area, 1e-12);
}

TEST(MeshWinding, PartsThatTouchAlongAnEdgeAreDecidedEachForItself) {
  const Mesh box = make_box({1, 1, 1}, 1);
  const Mesh beside = scaled(box, 1, {1, 1, 0});  // they have an upright edge in common
  for (const bool merged : {false, true}) {
    const Mesh wanted = merged ? soup(together({box, beside}), 8) : together({box, beside});
    Mesh given = wanted;
    for (Triangle& t : given.triangles) {
      const double x = wanted.vertices[t[0]].x + wanted.vertices[t[1]].x + wanted.vertices[t[2]].x;
      if (x > 1.5) std::swap(t[1], t[2]);
    }
    const WindingReport report = wind(given, wanted);
    EXPECT_EQ(report.parts, 2u);
    EXPECT_EQ(report.turned_parts, 1u);
  }
}

TEST(MeshWinding, ASurfaceWithOneSideIsLeftAsItIs) {
  Mesh strip;  // Moebius': ten quadrilaterals, half a turn
  for (int i = 0; i < 10; ++i) {
    const double turn = 0.2 * M_PI * i;
    const Vec3 axis{std::cos(turn), std::sin(turn), 0};
    const Vec3 across = std::cos(turn / 2) * Vec3{0, 0, 1} + std::sin(turn / 2) * axis;
    strip.vertices.push_back(axis - 0.2 * across);
    strip.vertices.push_back(axis + 0.2 * across);
  }
  for (std::uint32_t i = 0; i < 10; ++i) {
    std::uint32_t a = 2 * i, b = a + 1, c = (a + 2) % 20, d = (a + 3) % 20;
    if (i == 9) std::swap(c, d);
    strip.triangles.push_back({a, c, b});
    strip.triangles.push_back({b, c, d});
  }
  const WindingReport report = wind(strip, strip);
  EXPECT_EQ(report.open_parts, 1u);
  EXPECT_EQ(report.parts, 1u);
}

TEST(MeshWinding, DoesNotDependOnTheOrderOfTrianglesOrOnWhereTheMeshLies) {
  const Mesh shell = together({kBox, reversed(kBall), scaled(kBox, 0.5, {1, 1, 1})});
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const Mesh moved = scaled(soup(shell, seed), 1000, {1e6, -2e6, 3e5});
    EXPECT_EQ(wind(moved, moved).turned_triangles, 0u);
    EXPECT_EQ(wind(reversed(moved), moved).turned_parts, 3u);
  }
}

TEST(MeshWinding, TakesNothingAndHugeNumbers) {
  Mesh none;
  EXPECT_EQ(wind_outwards(none), WindingReport{});
  Mesh huge = scaled(kBall, 1e300);
  EXPECT_EQ(wind(huge, huge).turned_triangles, 0u);
}

Model built(const Scene& scene, std::uint32_t threads = 1) {
  Model model;
  Execution execution;
  execution.threads = threads;
  const Status status = build_model(scene, execution, model);
  EXPECT_TRUE(status.ok()) << status.message();
  return model;
}

Scene scene_with(const Mesh& mesh, Winding winding) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"ball", kBall});
  scene.objects.push_back({"thing", mesh, winding});
  return scene;
}

TEST(MeshWinding, AModelIsTurnedAndSaysSo) {
  const Mesh thing = scaled(kBox, 1, {1, 0, 0});
  for (const std::uint32_t threads : {1u, 2u}) {
    const Model model = built(scene_with(reversed(thing), Winding::automatic), threads);
    const Scene after = scene_of(model);
    EXPECT_EQ(after.objects[0].mesh.triangles, kBall.triangles);
    EXPECT_EQ(after.objects[1].mesh.triangles, thing.triangles);
    EXPECT_EQ(model.objects[0].winding.turned_triangles, 0u);
    EXPECT_EQ(model.objects[1].winding.turned_triangles, thing.triangles.size());
    EXPECT_EQ(model.objects[1].winding.turned_parts, 1u);
  }
}

TEST(MeshWinding, AsIsAndFlipDoWhatTheySayAndASceneOfAModelIsAsIs) {
  const Mesh thing = scaled(kBox, 1, {1, 0, 0}), wrong = reversed(thing);
  const Scene as_is = scene_of(built(scene_with(wrong, Winding::as_is)));
  EXPECT_EQ(as_is.objects[1].mesh.triangles, wrong.triangles);
  EXPECT_EQ(as_is.objects[1].winding, Winding::as_is);
  const Scene again = scene_of(built(as_is));
  EXPECT_EQ(again.objects[1].mesh.triangles, wrong.triangles);
  const Scene flipped = scene_of(built(scene_with(open_box(), Winding::flip)));
  EXPECT_EQ(flipped.objects[1].mesh.triangles, reversed(open_box()).triangles);
}

// The pairs of parts of which one holds the other grow with the square of their number.
TEST(MeshWinding, MoreSolidsInOneAnotherThanMemoryHoldsAreLeftAsTheyAre) {
  std::vector<Mesh> onion;
  for (int i = 1; i <= 1300; ++i) {
    Mesh layer{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    onion.push_back(scaled(scaled(layer, 1, {-0.25, -0.25, -0.25}), i));
  }
  const Mesh all = together(onion);
  const WindingReport report = wind(all, all);
  EXPECT_EQ(report.parts, 1300u);
  EXPECT_EQ(report.open_parts, 1300u);
}

TEST(MeshWinding, NamesAreReadBack) {
  for (const Winding winding : {Winding::automatic, Winding::as_is, Winding::flip})
    EXPECT_EQ(parse_winding(winding_name(winding)), winding);
  EXPECT_FALSE(parse_winding("outwards"));
}

}  // namespace
}  // namespace lumbrical
