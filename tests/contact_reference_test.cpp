// Holds the engine's contacts against the reference of contact_reference.h, on random pairs of primitive and
// triangle of every shape, size, depth and angle. LUMBRICAL_REFERENCE_PAIRS sets the number of pairs per
// shape; with it, the measured errors are printed.
#include "contact_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "lumbrical/probe.h"
#include "random.h"

namespace lumbrical {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 2e7;
constexpr double kPointArea = 1e-4;

enum class Form { sphere, cylinder, capsule, cone };
constexpr const char* kFormNames[] = {"sphere", "cylinder", "capsule", "cone"};

struct Pair {
  ProbePrimitive primitive;
  std::array<Vec3, 3> corners;
  double radius = 0;  // [m] of the thickest section: the scale of all errors
};

double power_of_ten(test::Random& random, double low, double high) {
  return std::pow(10.0, random.between(low, high));
}

// A unit axis at an angle to the z axis: anything, or along or across it to within next to nothing.
Vec3 random_axis(test::Random& random) {
  const double turn = random.between(0, 2 * kPi);
  const double off = random.bits() % 3 == 0 ? 0 : power_of_ten(random, -13, -2);
  const auto at = [&](double sine, double cosine) {
    return Vec3{sine * std::cos(turn), sine * std::sin(turn), cosine};
  };
  switch (random.bits() % 4) {
    case 0:
      return at(std::sqrt((1 - off) * (1 + off)), random.bits() % 2 == 0 ? off : -off);
    case 1:
      return at(off, random.bits() % 2 == 0 ? 1 : -1);
    default:
      return random.direction();
  }
}

// A primitive whose lowest point is somewhere below the plane z = 0, and a triangle of that plane round a
// point of their section; half of the pairs then go anywhere.
Pair random_pair(Form form, test::Random& random) {
  Pair pair;
  ProbePrimitive& primitive = pair.primitive;
  primitive.radius1 = random.between(0.004, 0.012);
  primitive.radius2 = primitive.radius1;
  pair.radius = primitive.radius1;
  primitive.shape = form == Form::sphere     ? ProbeShape::sphere
                    : form == Form::cylinder ? ProbeShape::cylinder
                                             : ProbeShape::capsule;
  const Vec3 axis = random_axis(random);
  const double length = form == Form::sphere ? 0 : random.between(0.2, 5) * primitive.radius1;
  if (form == Form::cone) {
    const double most = 0.98 * std::min(length, primitive.radius1);
    primitive.radius2 -=
        random.bits() % 2 == 0 ? random.between(0.01, 1) * most : most * power_of_ten(random, -9, -2);
  }
  primitive.end2 = length * axis;
  // The lowest points: under the ends' spheres, or on the rim of a flat end.
  const double down = form == Form::cylinder
                          ? primitive.radius1 * std::sqrt(axis.x * axis.x + axis.y * axis.y)
                          : primitive.radius1;
  const double down2 = form == Form::cone ? primitive.radius2 : down;
  const double lowest = std::min(-down, length * axis.z - down2);
  const double highest = std::max(down, length * axis.z + down2);
  const double depth = random.bits() % 3 == 0
                           ? random.between(0.01, 0.95) * (highest - lowest)
                           : std::min(pair.radius * power_of_ten(random, -4, 0.3), 0.95 * (highest - lowest));
  const Vec3 shift{0, 0, -depth - lowest};
  primitive.end1 += shift;
  primitive.end2 += shift;

  // Some point of the section: tries under the axis, then straight above the lowest point.
  const Vec3 lower = axis.z * length - down2 < -down ? primitive.end2 : primitive.end1;
  const double size =
      std::min(pair.radius, std::sqrt(depth * std::max(2 * pair.radius - depth, pair.radius))) *
      power_of_ten(random, -1.5, 1.5);
  Vec3 inside{lower.x, lower.y, 0};
  for (int i = 0; i < 40; ++i) {
    const Vec3 on_axis = primitive.end1 + random.between(-0.3, 1.3) * (primitive.end2 - primitive.end1);
    const Vec3 p{on_axis.x + random.between(-1, 1) * pair.radius,
                 on_axis.y + random.between(-1, 1) * pair.radius, 0};
    if (test::reference_depth(primitive, {0, 0, 1}, p) > 0) {
      inside = p;
      break;
    }
  }
  const double first = random.between(0, 2 * kPi);
  const double angles[] = {first, first + random.between(0.2, 2.9), first + random.between(3.3, 6.0)};
  const Vec3 middle =
      inside + size * random.between(0, 1.2) * Vec3{std::cos(3 * first), std::sin(3 * first), 0};
  for (int i = 0; i < 3; ++i) {
    pair.corners[i] =
        middle + size * random.between(0.4, 1) * Vec3{std::cos(angles[i]), std::sin(angles[i]), 0};
  }
  if (random.bits() % 2 == 0) {
    const Pose anywhere = random.pose(0.5);
    primitive.end1 = transform(anywhere, primitive.end1);
    primitive.end2 = transform(anywhere, primitive.end2);
    for (Vec3& corner : pair.corners) corner = transform(anywhere, corner);
  }
  return pair;
}

std::string describe(const Pair& pair) {
  char text[600];
  const ProbePrimitive& p = pair.primitive;
  const auto& c = pair.corners;
  std::snprintf(
      text, sizeof text,
      "ends {%.17g, %.17g, %.17g} {%.17g, %.17g, %.17g} radii %.17g %.17g triangle {%.17g, %.17g, %.17g} "
      "{%.17g, %.17g, %.17g} {%.17g, %.17g, %.17g}",
      p.end1.x, p.end1.y, p.end1.z, p.end2.x, p.end2.y, p.end2.z, p.radius1, p.radius2, c[0].x, c[0].y,
      c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y, c[2].z);
  return text;
}

ProbeContact ask_engine(const Pair& pair, Law law) {
  const Mesh mesh{{pair.corners.begin(), pair.corners.end()}, {{0, 1, 2}}};
  std::vector<ProbeContact> contacts;
  const Status status = probe(mesh, {&pair.primitive, 1}, law, kStiffness, contacts);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_LE(contacts.size(), 1u);
  return contacts.empty() ? ProbeContact{} : contacts[0];
}

// Errors by name, each with the pair of its worst.
class Errors {
 public:
  void add(const std::string& name, double error, const std::string& pair) {
    std::vector<double>& errors = errors_[name];
    // A NaN is the largest error there is.
    errors.push_back(std::isnan(error) ? HUGE_VAL : error);
    if (errors.size() == 1 || errors.back() > worst_[name].first) worst_[name] = {errors.back(), pair};
  }
  [[nodiscard]] bool has(const std::string& name) const { return errors_.contains(name); }
  double at(const std::string& name, double fraction) {
    std::vector<double>& errors = errors_[name];
    std::sort(errors.begin(), errors.end());
    return errors[static_cast<std::size_t>(fraction * static_cast<double>(errors.size() - 1))];
  }
  [[nodiscard]] const std::string& worst_pair(const std::string& name) const {
    return worst_.at(name).second;
  }
  void print(const char* form) {
    std::printf("%-9s %-28s %6s %9s %9s %9s %9s\n", form, "error", "pairs", "median", "98 %", "99.9 %",
                "worst");
    for (const auto& [name, errors] : errors_) {
      std::printf("%-9s %-28s %6zu %9.1e %9.1e %9.1e %9.1e\n", form, name.c_str(), errors.size(),
                  at(name, 0.5), at(name, 0.98), at(name, 0.999), at(name, 1));
    }
  }

 private:
  std::map<std::string, std::vector<double>> errors_;
  std::map<std::string, std::pair<double, std::string>> worst_;
};

// How far p is from the plane of the triangle, or outside one of its edges.
double distance_outside(const Pair& pair, Vec3 normal, Vec3 p) {
  double distance = std::fabs(dot(normal, p - pair.corners[0]));
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 from = pair.corners[i], edge = pair.corners[(i + 1) % 3] - from;
    distance = std::max(distance, dot(cross(edge, normal), p - from) / norm(edge));
  }
  return distance;
}

// Lengths over R, areas over R^2, volumes over R^3; centres weighted by what acts there, as torques feel
// them.
void compare(const Pair& pair, const test::ContactReference& expected, Errors& errors) {
  const double r = pair.radius, r2 = r * r, r3 = r2 * r;
  const std::string text = describe(pair);
  const auto add = [&](const char* name, double error) { errors.add(name, std::fabs(error), text); };
  add("reference area", expected.area_error);
  add("reference field", expected.field_error);
  add("reference column", expected.column_error);

  const ProbeContact field = ask_engine(pair, Law::field);
  add("area", (field.area - expected.area) / r2);
  if (expected.area > 1e-11 * r2) {
    add("normal", norm(field.normal - expected.normal));
    add("centroid x area", norm(field.centroid - expected.centroid) * expected.area / r3);
  }
  add("field volume", (field.volume - expected.field) / r3);
  add("field centre x volume",
      norm(field.centre - expected.field_centre) * std::fabs(expected.field) / (r3 * r));
  add("field force", norm(field.force - kStiffness * expected.field * expected.normal) / (kStiffness * r3));
  if (!expected.touches || expected.area < 1e-11 * r2) return;
  add("field relative", field.volume / expected.field - 1);

  const ProbeContact column = ask_engine(pair, Law::column);
  add("column volume", (column.volume - expected.column) / r3);
  add("column relative", column.volume / expected.column - 1);
  add("column centre x volume", norm(column.centre - expected.column_centre) * expected.column / (r3 * r));

  const ProbeContact deepest = ask_engine(pair, Law::max_depth);
  add("depth", (deepest.depth - expected.deepest) / r);
  add("max-depth volume", (deepest.volume - expected.area * expected.deepest) / r3);
  add("max-depth centre", norm(deepest.centre - deepest.centroid) / r);

  const ProbeContact centroid = ask_engine(pair, Law::centroid);
  add("centroid volume", (centroid.volume - expected.area * expected.at_centroid) / r3);

  const ProbeContact point = ask_engine(pair, Law::point);
  add("point volume", (point.volume / kPointArea - expected.deepest) / r);
  // Several points may be deepest; the one named must be one of them, and of the triangle. A flat base ends
  // at a cliff that rounding may step over, hence the look a little way in.
  const Vec3 at = point.centre + 1e-7 * (expected.centroid - point.centre);
  add("point not deepest",
      std::max(0.0, expected.deepest - test::reference_depth(pair.primitive, expected.normal, at)) / r);
  add("point off the triangle", distance_outside(pair, expected.normal, point.centre) / r);
}

struct Bound {
  const char* name;
  double most, worst;  // of 98 % of the pairs, of all
};

void expect_within(Errors& errors, const std::vector<Bound>& bounds) {
  for (const Bound& bound : bounds) {
    if (!errors.has(bound.name)) {
      ADD_FAILURE() << "nothing measured for " << bound.name;
      continue;
    }
    EXPECT_LE(errors.at(bound.name, 0.98), bound.most) << bound.name << ", 98 % of the pairs";
    EXPECT_LE(errors.at(bound.name, 1), bound.worst)
        << bound.name << ", worst: " << errors.worst_pair(bound.name);
  }
}

class ContactAgainstReference : public testing::TestWithParam<Form> {};

TEST_P(ContactAgainstReference, AgreesOnRandomPairs) {
  const char* asked = std::getenv("LUMBRICAL_REFERENCE_PAIRS");
  const int pair_count = asked != nullptr ? std::atoi(asked) : 100;
  test::Random random(2024 + static_cast<std::uint64_t>(GetParam()));
  Errors errors;
  for (int touching = 0; touching < pair_count;) {
    const Pair pair = random_pair(GetParam(), random);
    const test::ContactReference expected =
        test::contact_reference(pair.primitive, pair.corners[0], pair.corners[1], pair.corners[2]);
    compare(pair, expected, errors);
    if (expected.touches) ++touching;
  }
  if (asked != nullptr) errors.print(kFormNames[static_cast<int>(GetParam())]);
  // The column law's accuracy depends on how sharply its way out changes surface; the others are alike for
  // all.
  constexpr Bound kColumn[] = {{"column volume", 1e-11, 1e-8},
                               {"column volume", 1e-6, 1e-5},
                               {"column volume", 1e-9, 1e-7},
                               {"column volume", 1e-4, 1e-2}};
  const Bound column = kColumn[static_cast<int>(GetParam())];
  expect_within(errors, {{"reference area", 1e-14, 1e-13},
                         {"reference field", 1e-14, 1e-13},
                         {"reference column", 1e-14, 1e-13},
                         {"area", 1e-13, 1e-12},
                         {"normal", 1e-14, 1e-12},
                         {"centroid x area", 1e-13, 1e-12},
                         {"field volume", 1e-11, 1e-8},
                         {"field force", 1e-11, 1e-8},
                         {"field centre x volume", 1e-11, 1e-8},
                         {"field relative", 1e-8, 1e-5},
                         column,
                         {"column centre x volume", column.most, column.worst},
                         {"depth", 1e-13, 1e-12},
                         {"point volume", 1e-13, 1e-12},
                         {"point not deepest", 1e-6, 1e-6},
                         {"point off the triangle", 1e-12, 1e-10},
                         {"max-depth volume", 1e-12, 1e-11},
                         {"max-depth centre", 1e-14, 1e-14},
                         {"centroid volume", 1e-12, 1e-11}});
}

// The deepest point of this contact lies next to the base, which is all but upright: where the depth falls
// off a cliff.
TEST(ContactReference, DepthOfANearlyLyingCylinderDoesNotJumpWithTheLastDigitOfItsTilt) {
  Pair pair;
  pair.primitive = {ProbeShape::cylinder,
                    {0, 0, 0.00474955264278204},
                    {0.0044360322994343154, -0.0008491605256931218, 0},
                    0.009596143673306072,
                    0.009596143673306072};
  pair.corners = {Vec3{-0.0028988010330932672, -0.0054760419451611985, 0},
                  {0.0015376466630020477, -0.0099201023325784336, 0},
                  {0.0037672743372176853, -0.0076424876386621404, 0}};
  const double r = pair.primitive.radius1;
  for (const double tilt : {0.0, 1e-16, 1.2e-15, -1.2e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5}) {
    pair.primitive.end2.z = pair.primitive.end1.z + tilt;
    const auto expected =
        test::contact_reference(pair.primitive, pair.corners[0], pair.corners[1], pair.corners[2]);
    EXPECT_NEAR(ask_engine(pair, Law::max_depth).depth, expected.deepest, 1e-12 * r) << tilt;
  }
}

// ---- The reference itself
// -----------------------------------------------------------------------------------------

TEST(ContactReference, KnowsTheCapOfASphere) {
  for (const double height : {0.0079, 0.005, 0.0, -0.004}) {
    const double r = 0.008, h = std::fabs(height);
    const auto seen = test::contact_reference({ProbeShape::sphere, {0.001, 0.002, height}, {}, r, 0},
                                              {-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0, 0.2, 0});
    const double disc = kPi * (r - h) * (r + h), below = height >= 0 ? r - h : r + h;
    EXPECT_NEAR(seen.area / disc, 1, 1e-13);
    EXPECT_NEAR(seen.deepest / below, 1, 1e-13);
    EXPECT_NEAR(seen.field / (kPi * (r - h) * (r - h) * (r + 2 * h) / 3), 1, 1e-12);
    // The column below the disc: a cap, and with the centre below also a cylinder of twice that height.
    const double cap = kPi * (r - h) * (r - h) * (2 * r + h) / 3;
    EXPECT_NEAR(seen.column / (height >= 0 ? cap : cap + 2 * h * disc), 1, 1e-12);
    EXPECT_LT(norm(seen.centroid - Vec3{0.001, 0.002, 0}), 1e-15);
    EXPECT_LT(norm(seen.column_centre - Vec3{0.001, 0.002, 0}), 1e-15);
  }
}

TEST(ContactReference, FieldIsTheLargestOverTheSpheresBetweenTheEnds) {
  test::Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Pair pair = random_pair(Form::cone, random);
    const ProbePrimitive& p = pair.primitive;
    const Vec3 at = p.end1 + 2 * pair.radius * random.direction();
    double largest = -1;
    for (int k = 0; k <= 20000; ++k) {
      const double t = k / 20000.0;
      const double radius = p.radius1 + t * (p.radius2 - p.radius1);
      largest = std::max(largest, radius - norm(at - (p.end1 + t * (p.end2 - p.end1))));
    }
    EXPECT_NEAR(test::reference_field(p, at), largest, 1e-6 * pair.radius);
  }
}

TEST(ContactReference, OfAWholeTriangleIsTheSumOfItsParts) {
  test::Random random(6);
  for (const Form form : {Form::sphere, Form::cylinder, Form::capsule, Form::cone}) {
    for (int i = 0; i < 12; ++i) {
      const Pair pair = random_pair(form, random);
      const auto& [a, b, c] = pair.corners;
      const double t = random.between(0.1, 0.9);
      const Vec3 middle = (1 - t) * a + t * b;
      const auto whole = test::contact_reference(pair.primitive, a, b, c);
      const auto one = test::contact_reference(pair.primitive, a, middle, c);
      const auto two = test::contact_reference(pair.primitive, middle, b, c);
      const double r = pair.radius;
      EXPECT_NEAR(one.area + two.area, whole.area, 1e-13 * r * r) << describe(pair);
      EXPECT_NEAR(one.field + two.field, whole.field, 1e-13 * r * r * r) << describe(pair);
      EXPECT_NEAR(one.column + two.column, whole.column, 1e-13 * r * r * r) << describe(pair);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, ContactAgainstReference,
                         testing::Values(Form::sphere, Form::cylinder, Form::capsule, Form::cone),
                         [](const auto& form) {
                           return std::string(kFormNames[static_cast<int>(form.param)]);
                         });

}  // namespace
}  // namespace lumbrical
