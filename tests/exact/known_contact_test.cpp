// Contacts whose values are known by hand: a primitive pressed into a large plane, however the plane is cut
// into triangles and wherever it stands in the world.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "largest.h"
#include "lumbrical/probe.h"
#include "lumbrical/shapes.h"
#include "random.h"

namespace lumbrical {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.008;

// What all triangles together say of the section, in the plane's frame.
struct Total {
  double area = 0, volume = 0, depth = 0;
  Vec3 centroid, centre, force;
  std::size_t contacts = 0;
};

// The plane z = 0 cut into 1 triangle (cells 0) or 2 cells^2.
Mesh plane_of(std::uint32_t cells, double irregularity) {
  if (cells > 0) return make_plane(0.3, cells, irregularity);
  return {{{-1, -0.7, 0}, {1.1, -0.6, 0}, {0.05, 1.2, 0}}, {{0, 1, 2}}};
}

Total press(const Mesh& plane, ProbePrimitive primitive, Law law, const Pose& placement) {
  Mesh mesh = plane;
  for (Vec3& p : mesh.vertices) p = transform(placement, p);
  primitive.end1 = transform(placement, primitive.end1);
  primitive.end2 = transform(placement, primitive.end2);
  std::vector<ProbeContact> contacts;
  const Status status = probe(mesh, std::span(&primitive, 1), law, 1e7, contacts);
  EXPECT_TRUE(status.ok()) << status.message();
  Total total;
  const Pose back = inverse(placement);
  for (const ProbeContact& contact : contacts) {
    total.area += contact.area;
    total.volume += contact.volume;
    total.depth = test::largest(total.depth, contact.depth);
    total.centroid += contact.area * transform(back, contact.centroid);
    total.centre += contact.volume * transform(back, contact.centre);
    total.force += rotate(back.orientation, contact.force);
  }
  total.contacts = contacts.size();
  if (total.area > 0) total.centroid = total.centroid / total.area;
  if (total.volume > 0) total.centre = total.centre / total.volume;
  return total;
}

struct Known {
  ProbePrimitive primitive;
  double area, depth;
  Vec3 centroid;
};

// A sphere whose lowest point is `depth` below the plane.
Known sphere_at(double x, double y, double depth) {
  return {{ProbeShape::sphere, {x, y, kRadius - depth}, {}, kRadius, 0},
          kPi * depth * (2 * kRadius - depth),
          depth,
          {x, y, 0}};
}

// A cylinder lying in the plane (a rectangle), depth below it.
Known lying_cylinder(double depth) {
  const double length = 0.025, h = kRadius - depth, half = std::sqrt(depth * (2 * kRadius - depth));
  return {{ProbeShape::cylinder, {0.001, 0.002, h}, {0.001 + length, 0.002, h}, kRadius, 0},
          2 * half * length,
          depth,
          {0.001 + 0.5 * length, 0.002, 0}};
}

// A cylinder standing upright with its base below the plane (a circle).
Known standing_cylinder(double depth) {
  return {{ProbeShape::cylinder, {0.003, -0.001, -depth}, {0.003, -0.001, 0.02}, kRadius, 0},
          kPi * kRadius * kRadius,
          depth,
          {0.003, -0.001, 0}};
}

// A long cylinder through the plane at an angle (a whole ellipse): the side is all that is cut.
Known slanted_cylinder(double angle) {
  const Vec3 axis{std::sin(angle), 0, std::cos(angle)};
  const double down = 0.03;  // from the plane to the lower base along the axis
  // Deepest column: under the lowest point of the rim, if the section holds that point's foot.
  const double rim_x = -down * axis.x + kRadius * axis.z, rim_depth = down * axis.z + kRadius * axis.x;
  const double reach = kRadius / axis.z;  // half axis of the ellipse along x
  double depth = rim_depth;
  if (rim_x < -reach) {
    // Columns leave through the side; deepest where the ellipse begins: 2 R / sin(angle).
    depth = 2 * kRadius / axis.x;
  }
  return {{ProbeShape::cylinder, -down * axis, 0.06 * axis, kRadius, 0},
          kPi * kRadius * kRadius / axis.z,
          depth,
          {0, 0, 0}};
}

void expect_known(const Known& known, const Mesh& plane, const Pose& placement, const char* what) {
  SCOPED_TRACE(what);
  const Total total = press(plane, known.primitive, Law::max_depth, placement);
  EXPECT_NEAR(total.area / known.area, 1, 1e-9);
  EXPECT_NEAR(total.depth / known.depth, 1, 1e-9);
  EXPECT_LT(norm(total.centroid - known.centroid), 1e-9 * kRadius);
}

// A hull that stands on its smaller end and widens up through the plane: what is below the plane is a frustum
// on a part of the smaller sphere.
struct Funnel {
  double small = 0.004, large = 0.01, length = 0.012, below = 0.002;  // [m] of the smaller centre

  [[nodiscard]] ProbePrimitive primitive(double x, double y) const {
    return {ProbeShape::capsule, {x, y, -below}, {x, y, length - below}, small, large};
  }
  [[nodiscard]] double volume() const {
    const double sine = (large - small) / length, cosine = std::sqrt(1 - sine * sine);
    const double foot = small * cosine, head = foot + (below + small * sine) * sine / cosine;
    const double cap = small - small * sine, height = below + small * sine;
    return kPi * (cap * cap * (3 * small - cap) + height * (foot * foot + foot * head + head * head)) / 3;
  }
};

class KnownContact : public testing::TestWithParam<std::uint32_t> {};

TEST_P(KnownContact, IsRightForEverySectionShape) {
  test::Random random(GetParam() + 7);
  const Mesh plane = plane_of(GetParam(), 1);
  for (int i = 0; i < 8; ++i) {
    const Pose placement = random.pose(0.5);
    for (const double depth : {1e-5, 1e-3, 5e-3, 0.011}) {
      expect_known(sphere_at(0.002, -0.003, depth), plane, placement, "sphere: a circle");
      expect_known(lying_cylinder(depth), plane, placement, "lying cylinder: a rectangle");
      expect_known(standing_cylinder(depth), plane, placement, "standing cylinder: a circle");
    }
    for (const double angle : {0.05, 0.4, 0.9, 1.2}) {
      expect_known(slanted_cylinder(angle), plane, placement, "slanted cylinder: an ellipse");
    }
  }
}

TEST_P(KnownContact, ColumnsOfAFunnelAreWhatIsBelowThePlane) {
  test::Random random(GetParam() + 51);
  const Mesh plane = plane_of(GetParam(), 1);
  for (const double small : {1e-4, 0.004, 0.0095}) {
    for (const double below : {0.0005, 0.002, 0.0035}) {
      Funnel funnel;
      funnel.small = small;
      funnel.below = below;
      const Pose placement = random.pose(0.5);
      const Total total = press(plane, funnel.primitive(0.001, -0.002), Law::column, placement);
      EXPECT_NEAR(total.volume / funnel.volume(), 1, 1e-10) << small << " " << below;
      EXPECT_LT(norm(total.centre - Vec3{0.001, -0.002, 0}), 1e-8 * kRadius);
    }
  }
}

TEST_P(KnownContact, ForcesOfTheExactLawsDoNotDependOnTheTriangles) {
  test::Random random(GetParam() + 99);
  const Mesh plane = plane_of(GetParam(), 1);
  for (int i = 0; i < 4; ++i) {
    const Pose placement = random.pose(0.5);
    const double depth = 0.002;
    // Sphere, by hand: pi depth^2 (3R - 2 depth ...) of the two laws.
    const Known sphere = sphere_at(0.001, 0.002, depth);
    const double h = kRadius - depth;
    const double column = kPi * depth * depth * (3 * kRadius - depth) / 3;
    const double field =
        kPi * (kRadius * (kRadius * kRadius - h * h) - 2.0 / 3 * (kRadius * kRadius * kRadius - h * h * h));
    const Total by_column = press(plane, sphere.primitive, Law::column, placement);
    const Total by_field = press(plane, sphere.primitive, Law::field, placement);
    EXPECT_NEAR(by_column.volume / column, 1, 1e-10);
    EXPECT_NEAR(by_field.volume / field, 1, 1e-10);
    EXPECT_LT(norm(by_field.force - Vec3{0, 0, 1e7 * field}), 1e-9 * 1e7 * field);
    EXPECT_LT(norm(by_field.centre - Vec3{0.001, 0.002, 0}), 1e-8 * kRadius);
  }
}

INSTANTIATE_TEST_SUITE_P(Cuts, KnownContact, testing::Values(0u, 1u, 3u, 10u, 30u, 71u),
                         [](const auto& cells) {
                           return std::to_string(cells.param == 0 ? 1 : 2 * cells.param * cells.param) +
                                  "Triangles";
                         });

TEST(KnownContact, FarFromTheOriginNothingIsLost) {
  for (const double offset : {1.0, 1e3, 1e6}) {
    // A placement whose coordinates are exact at this distance: the plane itself then is where it should be.
    const Pose placement{{offset, -offset, 2 * offset}, {}};
    const Known known = sphere_at(0.001953125, -0.00390625, 0.001953125);
    const Mesh plane{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    ProbePrimitive primitive = known.primitive;
    primitive.radius1 = 0.0078125;
    primitive.end1.z = 0.0078125 - 0.001953125;
    const Total total = press(plane, primitive, Law::field, placement);
    EXPECT_NEAR(total.area / (kPi * 0.001953125 * (2 * 0.0078125 - 0.001953125)), 1, 1e-12) << offset;
    EXPECT_NEAR(total.depth, 0.001953125, 1e-15);
  }
}

TEST(KnownContact, SmallTriangleWhollyInsideCountsWhole) {
  const Mesh mesh{{{0.001, 0.001, 0}, {0.0011, 0.001, 0}, {0.001, 0.0012, 0}}, {{0, 1, 2}}};
  const Total total = press(mesh, sphere_at(0, 0, 0.002).primitive, Law::max_depth, {});
  EXPECT_EQ(total.contacts, 1u);
  EXPECT_NEAR(total.area, 1e-8, 1e-20);
  EXPECT_LT(norm(total.centroid - Vec3{0.001 + 0.0001 / 3, 0.001 + 0.0002 / 3, 0}), 1e-15);
}

TEST(KnownContact, TriangleBesideTheSectionIsNoContact) {
  const Mesh mesh{{{0.02, 0, 0}, {0.03, 0, 0}, {0.02, 0.01, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(press(mesh, sphere_at(0, 0, 0.002).primitive, Law::field, {}).contacts, 0u);
}

}  // namespace
}  // namespace lumbrical
