// Pairs that break contact code, against fifty digits: tangency, axes along and across the plane to within
// next to nothing, borders through corners and centres, slivers, triangles of a hundred metres and of a
// micrometre, places far from the origin, cones at their limits.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "contact_pairs.h"
#include "lumbrical/probe.h"

namespace lumbrical {
namespace {

using reference::Multi;
using test::Pair, test::describe, test::from_reference;

constexpr double kR = 0.008;
constexpr double kH = 0.025;

struct HardPair {
  std::string name;
  Pair pair;
};
void PrintTo(const HardPair& hard, std::ostream* out) { *out << hard.name; }

using ThreePoints = std::array<Vec3, 3>;
const ThreePoints kCovering = {Vec3{-0.21, -0.13, 0}, {0.2, -0.17, 0}, {0.03, 0.24, 0}};
const ThreePoints kAcross = {Vec3{-0.003, -0.002, 0}, {0.05, -0.011, 0}, {0.011, 0.06, 0}};
const ThreePoints kSmall = {Vec3{0.0007, -0.0011, 0}, {0.0021, 0.0003, 0}, {-0.0004, 0.0017, 0}};

ProbePrimitive sphere(double height) { return {ProbeShape::sphere, {0, 0, height}, {}, kR, 0}; }
ProbePrimitive capsule(Vec3 end1, Vec3 end2, double radius2 = kR) {
  return {ProbeShape::capsule, end1, end2, kR, radius2};
}
ProbePrimitive cylinder(Vec3 end1, Vec3 end2) { return {ProbeShape::cylinder, end1, end2, kR, kR}; }

ThreePoints scaled(double scale, const ThreePoints& corners, Vec3 shift = {}) {
  return {scale * corners[0] + shift, scale * corners[1] + shift, scale * corners[2] + shift};
}

Pair moved(Pair pair, const Pose& pose) {
  pair.primitive.end1 = transform(pose, pair.primitive.end1);
  pair.primitive.end2 = transform(pose, pair.primitive.end2);
  for (Vec3& corner : pair.corners) corner = transform(pose, corner);
  return pair;
}

class List {
 public:
  void add(const std::string& name, const ProbePrimitive& primitive, const ThreePoints& corners) {
    list_.push_back({name, {primitive, corners, kR}});
  }
  void add_moved(const std::string& name, const ProbePrimitive& primitive, const ThreePoints& corners,
                 Vec3 by = {}) {
    const Pose pose{by, normalized({0.3, -0.5, 0.7, 0.2})};
    list_.push_back({name, moved({primitive, corners, kR}, pose)});
  }
  [[nodiscard]] const std::vector<HardPair>& all() const { return list_; }

 private:
  std::vector<HardPair> list_;
};

void add_tangencies(List& list) {
  const double deep[] = {1e-12, 1e-6};
  const char* const names[] = {"Tangent", "NearlyTangent"};
  for (int i = 0; i < 2; ++i) {
    const double h = kR * (1 - deep[i]);
    list.add(std::string(names[i]) + "Sphere", sphere(h), kCovering);
    list.add(std::string(names[i]) + "Capsule", capsule({0, 0, h}, {kH, 0, h}), kCovering);
    list.add(std::string(names[i]) + "Cone", capsule({0, 0, h}, {kH, 0, 0.9 * kR}, 0.7 * kR), kCovering);
    list.add(std::string(names[i]) + "Cylinder", cylinder({0, 0, h}, {kH, 0, h}), kCovering);
  }
}

void add_directions(List& list) {
  for (const double off : {0.0, 1e-12, 1e-6}) {
    const std::string by = off == 0 ? "Exactly" : off < 1e-9 ? "AlmostExactly" : "Nearly";
    const Vec3 lying = kH * Vec3{0.6, 0.8, off}, upright = kH * Vec3{0.6 * off, 0.8 * off, 1};
    const Vec3 low{0.001, -0.002, 0.7 * kR}, lower{0.001, -0.002, 0.2 * kR}, below{0.001, -0.002, -0.4 * kR};
    list.add(by + "LyingCapsule", capsule(low, low + lying), kAcross);
    list.add(by + "LyingCone", capsule(low, low + lying, 0.8 * kR), kAcross);
    list.add(by + "LyingCylinder", cylinder(low, low + lying), kAcross);
    list.add(by + "UprightCapsule", capsule(lower, lower + upright), kAcross);
    list.add(by + "UprightCone", capsule(lower, lower + upright, 0.8 * kR), kAcross);
    list.add(by + "UprightCylinder", cylinder(below, below + upright), kAcross);
  }
  list.add("AxisInThePlaneCapsule", capsule({0, 0, 0}, {kH, 0, 0}), kAcross);
  list.add("AxisInThePlaneCone", capsule({0, 0, 0}, {kH, 0, 0}, 0.5 * kR), kAcross);
  list.add("AxisInThePlaneCylinder", cylinder({0, 0, 0}, {kH, 0, 0}), kAcross);
  list.add("AxisThroughACorner",
           capsule(kAcross[0] - 0.4 * Vec3{0, 0.01, 0.02}, kAcross[0] + Vec3{0, 0.01, 0.02}), kAcross);
  list.add("BaseInThePlane", cylinder({0, 0, 0}, {0, 0, kH}), kAcross);
}

// The section of a sphere three fifths of its radius up has four fifths of it as its own, exactly.
void add_borders(List& list) {
  const ProbePrimitive ball{ProbeShape::sphere, {0, 0, 0.006}, {}, 0.01, 0};
  list.add("CornerOnTheBorder", ball, {Vec3{0.008, 0, 0}, {0.03, 0.02, 0}, {-0.01, 0.03, 0}});
  list.add("CornerOnTheBorderFromInside", ball, {Vec3{0.008, 0, 0}, {0.001, 0.003, 0}, {-0.002, -0.004, 0}});
  list.add("EdgeAlongTheBorder", ball, {Vec3{0.008, -0.02, 0}, {0.008, 0.03, 0}, {-0.02, 0.001, 0}});
  list.add("EdgeThroughTheCentre", ball, {Vec3{-0.02, 0, 0}, {0.03, 0, 0}, {0.001, 0.03, 0}});
  list.add("CornerAtTheCentre", ball, {Vec3{0, 0, 0}, {0.03, 0.002, 0}, {0.001, 0.03, 0}});
  list.add("CentreInThePlane", sphere(0), kAcross);
  list.add("CentreAlmostInThePlane", sphere(1e-12 * kR), kAcross);
  list.add("CentreBelowThePlane", sphere(-0.6 * kR), kAcross);
}

void add_sizes(List& list) {
  const ProbePrimitive finger = capsule({0.001, 0.002, 0.6 * kR}, {0.02, 0.005, 1.3 * kR});
  list.add_moved("Sliver1e5", finger, {Vec3{-0.005, 0.002, 0}, {0.005, 0.003, 0}, {0, 0.002501, 0}});
  list.add_moved("Sliver1e9", finger, {Vec3{-0.005, 0.002, 0}, {0.005, 0.003, 0}, {0, 0.00250000001, 0}});
  list.add_moved("HugeCovering", finger, scaled(500, kCovering));
  list.add_moved("HugeEdgeAcross", finger, scaled(500, kCovering, {0.003, 0.13 * 500 + 0.001, 0}));
  list.add_moved("HugeCornerInside", finger, scaled(2000, kAcross, {6.003, 4.001, 0}));
  list.add_moved("TinyInside", finger, scaled(1e-3, kSmall, {0.001, 0.002, 0}));
  const double border = std::sqrt((kR - 0.003) * (kR + 0.003));
  list.add("TinyOnTheBorder", sphere(0.003), scaled(1e-3, kSmall, {border, 0, 0}));
  list.add_moved("AMetreAway", finger, kAcross, {1, -1, 2});
  list.add_moved("AKilometreAway", finger, kAcross, {1e3, -1e3, 2e3});
}

void add_cones(List& list) {
  const Vec3 low{0.001, -0.002, 0.5 * kR};
  const Vec3 slant = kH * Vec3{0.6, 0, 0.8};
  list.add("RadiiAlmostEqual", capsule(low, low + slant, kR * (1 - 1e-12)), kAcross);
  list.add("RadiiNearlyEqual", capsule(low, low + slant, kR * (1 - 1e-6)), kAcross);
  list.add("NeedlePoint", capsule(low, low + slant, 1e-6 * kR), kAcross);
  list.add("OneEndAlmostHoldsTheOther", capsule(low, low + (0.5 + 1e-9) * kR * unit_or(slant, {}), 0.5 * kR),
           kAcross);
  list.add("OneEndHoldsTheOther", capsule(low, low + 0.3 * kR * unit_or(slant, {}), 0.5 * kR), kAcross);
  list.add("NoLength", capsule(low, low), kAcross);
  // The side's half angle has sine 0.6: against an axis with the same cosine to the plane the section is a
  // parabola, with the same sine one line of the side stands upright.
  const double r2 = kR - 0.6 * 0.01;
  list.add("ParabolicCone", capsule(low, low + 0.01 * Vec3{0.8, 0, 0.6}, r2), kAcross);
  list.add("ConeWithAnUprightLine", capsule(low, low + 0.01 * Vec3{0.6, 0, 0.8}, r2), kAcross);
  list.add("ConeWithALineInThePlane", capsule({0, 0, kR * 0.8}, {0.008, 0, kR * 0.8 - 0.006}, r2), kAcross);
}

const std::vector<HardPair>& hard_pairs() {
  static const std::vector<HardPair> kList = [] {
    List list;
    add_tangencies(list);
    add_directions(list);
    add_borders(list);
    add_sizes(list);
    add_cones(list);
    return list.all();
  }();
  return kList;
}

// What rounding of the input alone may do to a height: a normal is known to about the last digit times the
// triangle's length over its width, a corner to the last digit of how far away it is. Over R.
double conditioning(const Pair& pair) {
  const auto& [a, b, c] = pair.corners;
  const double longest = std::max({norm(b - a), norm(c - a), norm(c - b)});
  const double reach = std::max({norm(a), norm(b), norm(c)});
  return 2e-15 * (longest * longest / norm(cross(b - a, c - a)) + reach / pair.radius);
}

double error(const Multi& got, const Multi& exact) { return std::fabs(static_cast<double>(got - exact)); }

class HardPairs : public testing::TestWithParam<HardPair> {};

void expect_reference(const Pair& pair, const reference::Contact<Multi>& exact) {
  const double r = pair.radius;
  const auto seen = test::ask_reference(pair);
  ASSERT_TRUE(seen.touches);
  EXPECT_LE(error(seen.area.amount, exact.area.amount), 1e-17 * r * r);
  EXPECT_LE(error(seen.field.amount, exact.field.amount), 1e-17 * r * r * r);
  EXPECT_LE(error(seen.column.amount, exact.column.amount), 1e-17 * r * r * r);
  EXPECT_LE(error(seen.deepest, exact.deepest), 1e-17 * r);
}

void expect_engine(const Pair& pair, Law law, double bound, const reference::Contact<Multi>& exact) {
  const Mesh mesh{{pair.corners.begin(), pair.corners.end()}, {{0, 1, 2}}};
  std::vector<ProbeContact> contacts;
  ASSERT_TRUE(probe(mesh, {&pair.primitive, 1}, law, 1, contacts).ok());
  ASSERT_EQ(contacts.size(), 1u);
  const ProbeContact& contact = contacts[0];
  const double r = pair.radius, noise = 1e-13 + conditioning(pair);
  const auto& load = law == Law::field ? exact.field : exact.column;
  EXPECT_LE(error(contact.area, exact.area.amount), noise * r * r);
  EXPECT_LE(error(contact.depth, exact.deepest), noise * r);
  EXPECT_LE(error(contact.volume, load.amount), (bound + noise) * r * r * r);
  if (load.amount > 0) {
    EXPECT_LE(norm(contact.centre - from_reference(load.centre)) * contact.volume,
              (bound + noise) * r * r * r * r);
  }
}

TEST_P(HardPairs, AgreeWithFiftyDigits) {
  const Pair& pair = GetParam().pair;
  if (test::in_a_hurry() && GetParam().name.size() % 6 != 0) GTEST_SKIP() << "in a hurry";
  SCOPED_TRACE(describe(pair));
  const auto exact = test::ask_reference<Multi>(pair);
  ASSERT_TRUE(exact.touches);
  EXPECT_LE(exact.area.error, 1e-20 * exact.area.amount);
  EXPECT_LE(exact.field.error, 1e-20 * exact.field.amount);
  EXPECT_LE(exact.column.error, 1e-20 * exact.column.amount);
  expect_reference(pair, exact);
  expect_engine(pair, Law::field, 1e-11, exact);
  expect_engine(pair, Law::column, 1e-7, exact);
}

INSTANTIATE_TEST_SUITE_P(All, HardPairs, testing::ValuesIn(hard_pairs()), testing::PrintToStringParamName());

}  // namespace
}  // namespace lumbrical
