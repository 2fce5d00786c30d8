// The palm as a sphere-swept polygon, with values known by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "box_palm.h"
#include "loose_triangles.h"
#include "session.h"
#include "tick/tick_trace.h"

namespace lumbrical {
namespace {

using test::kPalmRadius;

Model model_of(Mesh mesh, const Pose& X = {}) {
  for (Vec3& vertex : mesh.vertices) vertex = transform(X, vertex);
  return test::world_of(std::move(mesh));
}

// A plane at the height z over the core, of which `area` lies over the core and `rim` is its circumference:
// beside the core stands a fillet, and all corners together make one full turn.
struct Cap {
  double area, volume;
};
Cap cap_of(double area, double rim, double r, double z) {
  const double out = std::sqrt(r * r - z * z);
  const double beside = z > 0 ? r * out - 0.5 * (out * r + z * z * std::asinh(out / z)) : 0.5 * r * r;
  const double turn = 2 * std::numbers::pi * (0.5 * r * out * out - (r * r * r - z * z * z) / 3);
  return {area + rim * out + std::numbers::pi * out * out, area * (r - z) + rim * beside + turn};
}

constexpr double kA = 0.03, kB = 0.02, kArea = 4 * kA * kB, kRim = 4 * (kA + kB);

TEST(Palm, FeelsAPlaneAlikeWithItsBackAndItsPalmarSide) {
  test::Random random(11);
  const double r = kPalmRadius;
  for (const std::uint32_t cells : {1u, 5u, 24u}) {
    for (const double depth : {1e-5, 0.002, 0.009}) {
      const Pose X = random.pose(0.4);
      const Model plane = model_of(make_plane(0.3, cells, 1), X);
      const Cap cap = cap_of(kArea, kRim, r, r - depth);
      for (const double turn : {0.0, 1.0}) {  // palmar side, back
        const Pose at = turn == 0 ? X : X * Pose{{0, 0, 2 * (r - depth)}, Quat{0, 1, 0, 0}};
        const SweptPolygon palm = test::box_palm(kA, kB, depth, r, at);
        const test::Pressed felt = test::press(plane, test::hand_of(palm));
        EXPECT_NEAR(felt.area / cap.area, 1, 1e-9) << cells << ' ' << depth << ' ' << turn;
        EXPECT_NEAR(felt.volume / cap.volume, 1, 1e-9) << cells << ' ' << depth << ' ' << turn;
        EXPECT_NEAR(felt.depth / depth, 1, 1e-9);
        EXPECT_LT(norm(felt.force - felt.volume * rotate(X.orientation, {0, 0, 1})), 1e-12 * felt.volume);
        EXPECT_LT(norm(felt.centre - X.position), 1e-9);
      }
    }
  }
}

TEST(Palm, IsFeltOnceWhereATriangleLiesInThePlanesBetweenItsParts) {
  const double r = kPalmRadius;
  const Cap cap = cap_of(kArea, kRim, r, 0);
  for (const double z : {-1e-12, -1e-16, 0.0, 1e-16, 1e-12}) {
    Mesh plane = make_plane(0.3, 6);
    for (Vec3& vertex : plane.vertices) vertex.z += z;
    // In the plane of the core.
    const SweptPolygon palm = test::box_palm(kA, kB, r);
    const test::Pressed felt = test::press(model_of(plane), test::hand_of(palm));
    EXPECT_NEAR(felt.area / cap.area, 1, 1e-9) << z;
    EXPECT_NEAR(felt.volume / cap.volume, 1, 1e-9) << z;
    // In the plane that stands on an edge of the core, between the slabs and the edge: the edge's length of
    // half a disc of phi = r - |distance|, and round ends.
    const Quat upright{std::sqrt(0.5), 0, std::sqrt(0.5), 0};
    const Pose X{{kA, 0, 0}, upright};
    for (Vec3& vertex : plane.vertices) vertex = transform(X, vertex);
    const test::Pressed side = test::press(model_of(plane), test::hand_of(palm));
    EXPECT_NEAR(side.area, 2 * kB * 2 * r + std::numbers::pi * r * r, 1e-10) << z;
    EXPECT_NEAR(side.volume, 2 * kB * r * r + std::numbers::pi * r * r * r / 3, 1e-12) << z;
  }
}

// Corners on a lattice of quarters of the radius, on which those of the core lie too: in planes between parts
// of the palm, along its edges and through its corners.
std::array<Vec3, 3> lattice_triangle(test::Random& random, double radius, double a, double b, double height) {
  const double step = radius / 4;
  const auto at = [&](double half) {
    return step * std::floor(random.between(-1, 1) * (half + 2 * radius) / step);
  };
  std::array<Vec3, 3> t;
  for (Vec3& corner : t) corner = {at(a), at(b), height + at(0)};
  if (random.below(2) == 0) t[1].y = t[2].y = t[0].y = random.below(2) == 0 ? -b : b;
  if (random.below(3) == 0) t[1].z = t[2].z = t[0].z;
  return t;
}

TEST(Palm, HardlyChangesWhereATriangleLeavesThePlanesBetweenItsParts) {
  constexpr double r = 0.0078125, cube = r * r * r;
  int felt = 0;
  for (int i = 0; i < 3000; ++i) {
    test::Random random(static_cast<std::uint64_t>(6000 + i));
    const double a = 0.5 * r * static_cast<double>(1 + random.below(8)),
                 b = 0.5 * r * static_cast<double>(1 + random.below(8));
    const SweptPolygon palm = test::box_palm(a, b, 0.25 * r * static_cast<double>(random.below(5)), r);
    const Primitives hand = test::hand_of(palm);
    std::array<Vec3, 3> t = lattice_triangle(random, r, a, b, palm.corner[0].z);
    if (!(norm(cross(t[1] - t[0], t[2] - t[0])) > 1e-6 * r * r)) continue;
    const auto volume_of = [&](const std::array<Vec3, 3>& at) {
      Model model;
      model.triangles = test::loose_triangles({at});
      return test::press(model, hand).volume / cube;
    };
    const double in_plane = volume_of(t);
    felt += in_plane > 0;
    for (const double off : {1e-9, 1e-11, 1e-12, 1e-13, 1e-14}) {
      std::array<Vec3, 3> moved = t;
      for (Vec3& corner : moved) corner += off * r * random.direction();
      EXPECT_NEAR(volume_of(moved), in_plane, 1e-7) << i << ' ' << off;
    }
  }
  EXPECT_GT(felt, 1000);
}

TEST(Palm, GivesEveryLawTheFieldAsItsDepth) {
  const double r = kPalmRadius, depth = 0.002;
  const Model plane = model_of(make_plane(0.3, 1));
  const SweptPolygon palm = test::box_palm(kA, kB, depth);
  const Cap cap = cap_of(kArea, kRim, r, r - depth);
  const auto volume = [&](Law law) { return test::press(plane, test::hand_of(palm, law)).volume; };
  EXPECT_NEAR(volume(Law::column) / volume(Law::field), 1, 1e-9);
  EXPECT_NEAR(volume(Law::max_depth) / (cap.area * depth), 1, 1e-9);
  EXPECT_LT(volume(Law::centroid), volume(Law::max_depth));
  EXPECT_GT(volume(Law::centroid), volume(Law::field));
  for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid, Law::point}) {
    for (const Contact& contact : test::press(plane, test::hand_of(palm, law)).contacts) {
      // All parts have a point under the core.
      if (law != Law::field) {
        EXPECT_NEAR(contact.depth, depth, 1e-12) << law_name(law);
      }
      if (law == Law::point) {
        EXPECT_NEAR(contact.volume, Settings{}.point_area * depth, 1e-15);
      }
    }
  }
}

// The largest field over a triangle, by looking.
TEST(Palm, SaysHowFarItsFieldReaches) {
  test::Random random(12);
  int touched = 0;
  for (int i = 0; i < 300; ++i) {
    const SweptPolygon palm = test::box_palm(kA, kB, 0.01, kPalmRadius, random.pose(0.1));
    const Vec3 near = palm.corner[0] + random.in_box(0.02);
    Mesh mesh;
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(near + 0.02 * random.direction());
    mesh.triangles.push_back({0, 1, 2});
    const Vec3 a = mesh.vertices[0], u = mesh.vertices[1] - a, v = mesh.vertices[2] - a;
    if (norm(cross(u, v)) < 1e-5) continue;
    double most = 0;
    const int steps = 60;
    for (int s = 0; s <= steps; ++s) {
      for (int t = 0; s + t <= steps; ++t) {
        const Vec3 p = a + (1.0 * s / steps) * u + (1.0 * t / steps) * v;
        const double z = dot(palm.normal, p - palm.corner[0]);
        double outside = 0;  // of a rectangle: both coordinates by themselves
        for (std::size_t k = 0; k < 4; ++k) {
          const double over = max(0, dot(palm.outward[k], p - palm.corner[k]));
          outside += over * over;
        }
        most = max(most, palm.radius - std::sqrt(outside + z * z));
      }
    }
    const test::Pressed paper = test::press(model_of(mesh), test::hand_of(palm, Law::max_depth));
    touched += most > 0 ? 1 : 0;
    EXPECT_LT(std::fabs(paper.depth - most), 0.04 / steps);
    EXPECT_GT(paper.depth, most - 1e-12);
  }
  EXPECT_GT(touched, 100);
}

// Corners in corners, edges and planes of the core, where all three cuts of an edge meet: the lanes give what
// the path for one pair gives, which `column` takes.
TEST(Palm, TrianglesThroughCornersAndEdgesOfItsCoreAreTheSameInTheLanes) {
  test::Random random(13);
  const double r = kPalmRadius;
  const double x[] = {-0.06, -kA, 0, kA, 0.06}, y[] = {-0.05, -kB, 0, kB, 0.05},
               z[] = {-0.1, -0.011, 0, 0.009, 0.1};
  int touched = 0;
  for (int i = 0; i < 4000; ++i) {
    const Pose X = i % 4 == 0 ? Pose{} : random.pose(0.4);
    const SweptPolygon palm = test::box_palm(kA, kB, r, r, X);
    Mesh mesh;
    for (int k = 0; k < 3; ++k)
      mesh.vertices.push_back(transform(X, {x[random.below(5)], y[random.below(5)], z[random.below(5)]}));
    mesh.triangles.push_back({0, 1, 2});
    const Vec3 raw = cross(mesh.vertices[1] - mesh.vertices[0], mesh.vertices[2] - mesh.vertices[0]);
    if (norm(raw) < 1e-6) continue;
    const Model model = test::world_of(mesh);
    const test::Pressed lanes = test::press(model, test::hand_of(palm));
    const test::Pressed alone = test::press(model, test::hand_of(palm, Law::column));
    touched += alone.volume > 0 ? 1 : 0;
    ASSERT_NEAR(lanes.area, alone.area, 1e-12) << i;
    ASSERT_NEAR(lanes.volume, alone.volume, 1e-15) << i;
    ASSERT_LT(norm(lanes.volume * lanes.centre - alone.volume * alone.centre), 1e-15) << i;
    // Nothing is felt twice there, nor left out: beside it the force is the same.
    const Vec3 step = 1e-11 * random.direction();
    for (Vec3& vertex : mesh.vertices) vertex += step;
    const test::Pressed beside = test::press(test::world_of(mesh), test::hand_of(palm));
    ASSERT_NEAR(beside.volume, lanes.volume, 2e-13) << i;
  }
  EXPECT_GT(touched, 2000);
}

TEST(Palm, APolygonOfTheSceneReplacesTheDefault) {
  Scene scene = test::mug_scene(Law::field);
  scene.objects = {{"plane", make_plane(0.6, 30, 1)}};
  scene.settings.fade_time = 0;
  scene.settings.max_force = 1e5;
  scene.hand.palm_joint.orientation = {};
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  // Palm down over z = 0, the palmar skin 2 mm below.
  const double height = scene.hand.palm.height - 0.002 -
                        rotate({std::sqrt(0.5), std::sqrt(0.5), 0, 0}, scene.hand.palm_joint.position).z;
  frame.base = {{0, 0, height}, {std::sqrt(0.5), std::sqrt(0.5), 0, 0}};
  const auto palm_force = [&] {
    const Model model = test::model_of(scene);
    State state;
    Scratch scratch = make_scratch(model);
    return tick(model, state, scratch, frame).segment[kPalmSegment].force;
  };
  const double x = 0.01, z = 0.02, r = 0.5 * scene.hand.palm.thickness;
  const Cap cap = cap_of(4 * x * z, 4 * (x + z), r, r - 0.002);
  scene.hand.palm.polygon = {{-x, 0, -z}, {x, 0, -z}, {x, 0, z}, {-x, 0, z}};
  EXPECT_LT(norm(palm_force() - Vec3{0, 0, 2e7 * cap.volume}), 1e-6);
  std::reverse(scene.hand.palm.polygon.begin(), scene.hand.palm.polygon.end());
  EXPECT_LT(norm(palm_force() - Vec3{0, 0, 2e7 * cap.volume}), 1e-6);
  scene.hand.palm.polygon.clear();
  EXPECT_EQ(norm(palm_force()), 0);
}

TEST(Palm, ADifferentPalmIsADifferentPose) {
  Scene scene = test::mug_scene(Law::field);
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  const auto look = [&](std::vector<TraceValue>& values) {
    const Model model = test::model_of(scene);
    State state;
    Scratch scratch = make_scratch(model);
    scratch.hash_stages = true;
    const ActuatorFrame output = tick(model, state, scratch, frame);
    values = trace_stage(scratch, frame, {}, output, Stage::hand_pose);
    return scratch.stage_hash[static_cast<std::size_t>(Stage::hand_pose)];
  };
  std::vector<TraceValue> before, after;
  const std::uint64_t hash = look(before);
  EXPECT_EQ(look(after), hash);
  scene.hand.palm.polygon[1].x += 1e-9;
  EXPECT_NE(look(after), hash);
  ASSERT_EQ(before.size(), after.size());
  bool named = false;
  for (std::size_t i = 0; i < before.size(); ++i) {
    named = named || (before[i].bits != after[i].bits && before[i].field.starts_with("palm.corner["));
  }
  EXPECT_TRUE(named);
}

}  // namespace
}  // namespace lumbrical
