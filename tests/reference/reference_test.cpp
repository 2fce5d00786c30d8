// The reference itself (reference/contact.h): against values known by hand, against brute sampling of the
// definitions, and its long double against fifty digits.
#include "reference/contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact_pairs.h"

namespace lumbrical {
namespace {

using reference::Multi;
using test::Form, test::Pair, test::describe, test::from_reference, test::kPi, test::to_reference;

constexpr Form kForms[] = {Form::sphere, Form::cylinder, Form::capsule, Form::cone};

TEST(Reference, KnowsTheCapOfASphere) {
  for (const double height : {0.0079, 0.005, 0.0, -0.004}) {
    const double r = 0.008, h = std::fabs(height);
    const Pair pair{{ProbeShape::sphere, {0.001, 0.002, height}, {}, r, 0},
                    {Vec3{-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0, 0.2, 0}},
                    r};
    const auto seen = test::ask_reference(pair);
    const double disc = kPi * (r - h) * (r + h), below = height >= 0 ? r - h : r + h;
    EXPECT_NEAR(static_cast<double>(seen.area.amount) / disc, 1, 1e-13);
    EXPECT_NEAR(static_cast<double>(seen.deepest) / below, 1, 1e-13);
    EXPECT_NEAR(static_cast<double>(seen.field.amount) / (kPi * (r - h) * (r - h) * (r + 2 * h) / 3), 1,
                1e-12);
    // The column below the disc: a cap, and with the centre below also a cylinder of twice that height.
    const double cap = kPi * (r - h) * (r - h) * (2 * r + h) / 3;
    EXPECT_NEAR(static_cast<double>(seen.column.amount) / (height >= 0 ? cap : cap + 2 * h * disc), 1, 1e-12);
    EXPECT_LT(norm(from_reference(seen.area.centre) - Vec3{0.001, 0.002, 0}), 1e-15);
    EXPECT_LT(norm(from_reference(seen.column.centre) - Vec3{0.001, 0.002, 0}), 1e-15);
  }
}

TEST(Reference, FieldIsTheLargestOverTheSpheresBetweenTheEnds) {
  test::Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Pair pair = test::random_pair(Form::cone, random);
    const ProbePrimitive& p = pair.primitive;
    const Vec3 at = p.end1 + 2 * pair.radius * random.direction();
    double largest = -1;
    for (int k = 0; k <= 20000; ++k) {
      const double t = k / 20000.0;
      const double radius = p.radius1 + t * (p.radius2 - p.radius1);
      largest = std::max(largest, radius - norm(at - (p.end1 + t * (p.end2 - p.end1))));
    }
    const long double field = reference::field_at<long double>(to_reference(p), to_reference(at));
    EXPECT_NEAR(static_cast<double>(field), largest, 1e-6 * pair.radius);
  }
}

// The spheres between the ends, or the cylinder: the plainest of all definitions of being inside.
bool inside(const ProbePrimitive& p, Vec3 at) {
  const Vec3 axis = p.end2 - p.end1;
  if (p.shape == ProbeShape::cylinder) {
    const double q = dot(at - p.end1, axis) / dot(axis, axis);
    return q >= 0 && q <= 1 && norm(at - p.end1 - q * axis) <= p.radius1;
  }
  if (p.shape == ProbeShape::sphere) return norm(at - p.end1) <= p.radius1;
  for (int k = 0; k <= 4000; ++k) {
    const double t = k / 4000.0;
    if (norm(at - p.end1 - t * axis) <= p.radius1 + t * (p.radius2 - p.radius1)) return true;
  }
  return false;
}

TEST(Reference, DepthIsTheWayDownToTheLastPointInside) {
  test::Random random(8);
  for (const Form form : kForms) {
    for (int i = 0, seen = 0; seen < 25 && i < 1000; ++i) {
      const Pair pair = test::random_pair(form, random);
      const ProbePrimitive& p = pair.primitive;
      const Vec3 middle = form == Form::sphere ? p.end1 : p.end1 + random.between(0, 1) * (p.end2 - p.end1);
      const Vec3 at = middle + 0.7 * pair.radius * random.in_box(1), normal = random.direction();
      const auto depth =
          reference::depth_at<long double>(to_reference(p), to_reference(normal), to_reference(at));
      ASSERT_EQ(inside(p, at), depth >= 0) << describe(pair);
      if (depth < 0) continue;
      ++seen;
      double low = 0, high = 10 * pair.radius;
      for (int k = 0; k < 40; ++k) {
        const double d = 0.5 * (low + high);
        (inside(p, at - d * normal) ? low : high) = d;
      }
      EXPECT_NEAR(static_cast<double>(depth), low, 1e-5 * pair.radius) << describe(pair);
    }
  }
}

// Sums over many small parts of the triangle, each at its middle.
TEST(Reference, IntegratesItsOwnFieldAndDepth) {
  test::Random random(9);
  constexpr int kParts = 60;
  for (const Form form : kForms) {
    for (int i = 0; i < 3; ++i) {
      Pair pair = test::random_pair(form, random);
      const auto whole = test::ask_reference(pair);
      if (!whole.touches) continue;
      const auto& [a, b, c] = pair.corners;
      const double part = norm(cross(b - a, c - a)) / 2 / (kParts * kParts);
      double area = 0, field = 0, column = 0;
      for (int j = 0; j < kParts; ++j) {
        for (int k = 0; k < 2 * (kParts - j) - 1; ++k) {
          const double third = k % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
          const double u = (j + third) / kParts, v = (k / 2 + third) / kParts;
          const Vec3 at = a + u * (b - a) + v * (c - a);
          const auto depth = reference::depth_at<long double>(
              to_reference(pair.primitive), to_reference(from_reference(whole.normal)), to_reference(at));
          if (depth < 0) continue;
          area += part;
          field += part * static_cast<double>(reference::field_at<long double>(to_reference(pair.primitive),
                                                                               to_reference(at)));
          column += part * static_cast<double>(depth);
        }
      }
      // A part on the border counts whole or not at all: an error like the border's length times a part's.
      const double r = pair.radius, step = norm(b - a) + norm(c - a),
                   slack = 1.5 * step / kParts * std::min(step, 3 * r) / kParts * std::sqrt(kParts);
      EXPECT_NEAR(area, static_cast<double>(whole.area.amount), slack) << describe(pair);
      EXPECT_NEAR(field, static_cast<double>(whole.field.amount), slack * r) << describe(pair);
      EXPECT_NEAR(column, static_cast<double>(whole.column.amount), 2 * slack * r) << describe(pair);
    }
  }
}

TEST(Reference, OfAWholeTriangleIsTheSumOfItsParts) {
  test::Random random(6);
  for (const Form form : kForms) {
    for (int i = 0; i < 50; ++i) {
      const Pair pair = test::random_pair(form, random);
      const auto& [a, b, c] = pair.corners;
      const double t = random.between(0.1, 0.9);
      const Vec3 middle = (1 - t) * a + t * b;
      const auto whole = test::ask_reference(pair);
      const auto one = test::ask_reference({pair.primitive, {a, middle, c}, pair.radius});
      const auto two = test::ask_reference({pair.primitive, {middle, b, c}, pair.radius});
      const double r = pair.radius;
      const auto near = [&](const auto& of_one, const auto& of_two, const auto& of_whole, double scale) {
        // The middle is rounded, hence no nearer than double.
        EXPECT_NEAR(static_cast<double>(of_one.amount + of_two.amount - of_whole.amount), 0, 1e-13 * scale)
            << describe(pair);
      };
      near(one.area, two.area, whole.area, r * r);
      near(one.field, two.field, whole.field, r * r * r);
      near(one.column, two.column, whole.column, r * r * r);
    }
  }
}

class ReferenceForm : public testing::TestWithParam<Form> {};

// Its error estimate holds, and what rounding adds is less than a double could tell.
TEST_P(ReferenceForm, InLongDoubleAgreesWithFiftyDigits) {
  test::Random random(31 + static_cast<std::uint64_t>(GetParam()));
  const int pair_count = test::in_a_hurry() ? 1 : 12;
  for (int touching = 0; touching < pair_count;) {
    const Pair pair = test::random_pair(GetParam(), random);
    const auto exact = test::ask_reference<Multi>(pair);
    const auto seen = test::ask_reference(pair);
    ASSERT_EQ(seen.touches, exact.touches) << describe(pair);
    if (!seen.touches) continue;
    ++touching;
    const double r = pair.radius;
    const auto near = [&](const char* what, const auto& got, const auto& wanted, double scale) {
      const double error = std::fabs(static_cast<double>(Multi(got.amount) - wanted.amount));
      EXPECT_LE(error, 1e-16 * scale) << what << ' ' << describe(pair);
      EXPECT_LE(error, static_cast<double>(got.error) + 1e-17 * scale) << what << ' ' << describe(pair);
      EXPECT_LE(static_cast<double>(wanted.error), 1e-20 * scale) << what << ' ' << describe(pair);
      const Multi moment = norm(got.centre.template as<Multi>() - wanted.centre) * wanted.amount;
      EXPECT_LE(static_cast<double>(moment), 3e-16 * scale * r) << what << ' ' << describe(pair);
    };
    near("area", seen.area, exact.area, r * r);
    near("field", seen.field, exact.field, r * r * r);
    near("column", seen.column, exact.column, r * r * r);
    EXPECT_LE(std::fabs(static_cast<double>(Multi(seen.deepest) - exact.deepest)), 1e-16 * r)
        << describe(pair);
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, ReferenceForm, testing::ValuesIn(kForms), testing::PrintToStringParamName());

}  // namespace
}  // namespace lumbrical
