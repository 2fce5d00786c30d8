// Triangles and poses that break naive formulas: everything stays finite, and right where it is defined.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "borders/pair_contact.h"
#include "random.h"
#include "session.h"

namespace lumbrical {
namespace {

constexpr double kRadius = 0.008;
constexpr Law kLaws[] = {Law::field, Law::column, Law::max_depth, Law::centroid, Law::point};

Primitive round(Vec3 end1, Vec3 end2, double radius1, double radius2) {
  Primitive primitive;
  primitive.end1 = end1;
  primitive.end2 = end2;
  primitive.radius1 = radius1;
  primitive.radius2 = radius2;
  return primitive;
}

bool finite(const Contact& contact) {
  return is_finite(contact.depth) && is_finite(contact.area) && is_finite(contact.volume) &&
         is_finite(contact.centroid) && is_finite(contact.centre) && is_finite(contact.normal);
}

struct Answer {
  bool touches = false;
  Contact contact;
};

Answer ask(Primitive primitive, Law law, Vec3 a, Vec3 b, Vec3 c) {
  Answer answer;
  primitive.law = law;
  answer.touches = collide(primitive, {}, {a, b, c}, answer.contact);
  EXPECT_TRUE(!answer.touches || finite(answer.contact)) << law_name(law);
  return answer;
}

TEST(HardCase, TrianglesWithoutAreaAreNoContact) {
  const Primitive sphere = round({0, 0, 0.006}, {0, 0, 0.006}, kRadius, kRadius);
  const Vec3 p{0.001, 0, 0}, q{0.002, 0, 0}, r{0.003, 0, 0};
  for (const Law law : kLaws) {
    EXPECT_FALSE(ask(sphere, law, p, p, q).touches);
    EXPECT_FALSE(ask(sphere, law, p, p, p).touches);
    EXPECT_FALSE(ask(sphere, law, p, q, r).touches);
  }
}

TEST(HardCase, NumbersThatAreNotFiniteAreNoContact) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity()};
  const Vec3 a{-0.1, -0.1, 0}, b{0.1, -0.1, 0}, c{0, 0.1, 0};
  for (const double x : bad) {
    for (const Law law : kLaws) {
      EXPECT_FALSE(ask(round({0, 0, 0.006}, {0, 0, 0.02}, kRadius, kRadius), law, {x, 0, 0}, b, c).touches);
      ask(round({x, 0, 0.006}, {0, 0, 0.02}, kRadius, kRadius), law, a, b, c);
      ask(round({0, 0, 0.006}, {0, x, 0.02}, kRadius, kRadius), law, a, b, c);
      ask(round({0, 0, 0.006}, {0, 0, 0.02}, x, kRadius), law, a, b, c);
    }
  }
}

TEST(HardCase, DenormalAndTinyTrianglesAreFinite) {
  const Primitive sphere = round({0, 0, 0.006}, {0, 0, 0.006}, kRadius, kRadius);
  for (const double size : {5e-324, 1e-310, 1e-160, 1e-30, 1e-12, 1e-9}) {
    for (const Law law : kLaws) ask(sphere, law, {0, 0, 0}, {size, 0, 0}, {0, size, 0});
  }
}

TEST(HardCase, SliversKeepTheirArea) {
  const Primitive sphere = round({0, 0, 0.006}, {0, 0, 0.006}, kRadius, kRadius);
  for (const double width : {1e-5, 1e-7, 1e-9, 1e-12}) {
    const Answer answer = ask(sphere, Law::field, {-0.002, 0, 0}, {0.002, 0, 0}, {0, width, 0});
    ASSERT_TRUE(answer.touches) << width;
    EXPECT_NEAR(answer.contact.area / (0.002 * width), 1, 1e-9) << width;
  }
}

TEST(HardCase, HugeTrianglesWithAnEdgeThroughTheSectionKeepHalfOfIt) {
  const Primitive sphere = round({0, 0, 0.006}, {0, 0, 0.006}, kRadius, kRadius);
  const double disc = std::numbers::pi * (kRadius * kRadius - 0.006 * 0.006);
  for (const double size : {1.0, 100.0, 10000.0}) {
    const Answer answer = ask(sphere, Law::field, {-size, 0, 0}, {size, 0, 0}, {0, size, 0});
    ASSERT_TRUE(answer.touches);
    EXPECT_NEAR(answer.contact.area / (0.5 * disc), 1, 1e-9) << size;
  }
}

TEST(HardCase, TangencyDownToATrillionthOfTheRadius) {
  for (const double depth : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const Primitive sphere = round({0, 0, 1 - depth}, {0, 0, 1 - depth}, 1, 1);
    const Answer answer = ask(sphere, Law::field, {-9, -9, 0}, {9, -9, 0}, {0, 9, 0});
    ASSERT_TRUE(answer.touches) << depth;
    const double seen = 1 - (1 - depth);  // what is left of the depth in the input
    EXPECT_NEAR(answer.contact.area / (std::numbers::pi * seen * (2 - seen)), 1, 1e-9) << depth;
    EXPECT_NEAR(answer.contact.depth / seen, 1, 1e-9) << depth;
    EXPECT_NEAR(answer.contact.volume / (std::numbers::pi * seen * seen * (3 - 2 * seen) / 3), 1, 1e-9)
        << depth;
  }
}

TEST(HardCase, AxesAtEveryAngleToThePlaneAgreeWithTheirNeighbours) {
  // Area is a smooth function of the angle: values at an angle and 1e-12 beside it must agree.
  const Vec3 a{-0.3, -0.2, 0}, b{0.3, -0.25, 0}, c{0.02, 0.4, 0};
  for (const double angle :
       {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.3, 0.8, 1.2, 1.5697963, 1.570796326, 1.5707963267948966}) {
    for (const double radius2 : {kRadius, 0.006}) {
      const auto pose = [&](double at) {
        const Vec3 axis{std::sin(at), 0, std::cos(at)};
        return round({0.001, 0.002, 0.004}, Vec3{0.001, 0.002, 0.004} + 0.025 * axis, kRadius, radius2);
      };
      for (const Law law : kLaws) {
        const Answer here = ask(pose(angle), law, a, b, c), beside = ask(pose(angle + 1e-12), law, a, b, c);
        ASSERT_TRUE(here.touches && beside.touches);
        EXPECT_NEAR(here.contact.area / beside.contact.area, 1, 1e-9) << angle << ' ' << law_name(law);
        EXPECT_NEAR(here.contact.volume / beside.contact.volume, 1, 1e-6) << angle << ' ' << law_name(law);
      }
    }
  }
}

TEST(HardCase, PhalanxOfNoLengthIsFeltAsASphere) {
  const Vec3 a{-0.3, -0.2, 0}, b{0.3, -0.25, 0}, c{0.02, 0.4, 0}, p{0, 0, 0.006};
  for (const Law law : kLaws) {
    const Answer sphere = ask(round(p, p, kRadius, kRadius), law, a, b, c);
    const Answer inner = ask(round(p, p + Vec3{0.001, 0, 0}, kRadius, 0.002), law, a, b, c);
    EXPECT_NEAR(inner.contact.area, sphere.contact.area, 1e-15);
    EXPECT_NEAR(inner.contact.volume, sphere.contact.volume, 1e-15);
  }
}

// The cut is an edge of the polygon on which two places where the field is not smooth are a last digit apart.
TEST(HardCase, AxisInThePlaneAlongACutIsFinite) {
  const Vec3 a{-0.01, -0.01, 0}, b{0.01, -0.01, 0}, c{0, 0.01, 0};
  Primitive cone = round({0, 0, 0}, {0.02, 0, 0}, kRadius, 0.5 * kRadius);
  cone.cut_count = 1;
  cone.cut[0] = {{0, 1, 0}, {0, 0, 0}};
  Primitive beside = cone;
  beside.end1.z = beside.end2.z = 1e-9;
  beside.cut[0].point.y = 1e-9;
  for (const Law law : kLaws) {
    const Answer on = ask(cone, law, a, b, c), near = ask(beside, law, a, b, c);
    ASSERT_TRUE(on.touches && near.touches);
    EXPECT_NEAR(on.contact.volume / near.contact.volume, 1, 1e-6) << law_name(law);
  }
}

TEST(HardCase, VertexOnTheBoundaryAndEdgeThroughTheCentre) {
  const double rho = std::sqrt(kRadius * kRadius - 0.006 * 0.006);
  const Primitive sphere = round({0, 0, 0.006}, {0, 0, 0.006}, kRadius, kRadius);
  const Answer touching = ask(sphere, Law::field, {rho, 0, 0}, {0.02, -0.01, 0}, {0.02, 0.01, 0});
  EXPECT_TRUE(!touching.touches || touching.contact.area < 1e-12);
  const Answer quarter = ask(sphere, Law::field, {0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0});
  EXPECT_NEAR(quarter.contact.area / (0.25 * std::numbers::pi * rho * rho), 1, 1e-12);
}

}  // namespace
}  // namespace lumbrical
