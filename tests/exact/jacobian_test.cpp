// The Jacobian of contacts: values known by hand, differences of the force, the symmetries of a potential.
// jacobian_reference_test.cpp holds it against the definition.
#include "section/contact_jacobian.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "borders/pair_contact.h"
#include "box_palm.h"
#include "lumbrical/shapes.h"
#include "matrix6.h"
#include "random_touch.h"
#include "section/slab.h"

namespace lumbrical {
namespace {

using test::blocks;
using test::difference;
using test::kAxes;
using test::times;
using test::TouchForm;
using test::turn_about;
constexpr double kPi = std::numbers::pi;

// The same derivative seen from a world that is turned by q.
Matrix6 turned(const Matrix6& m, Quat q) {
  std::array<Vec3, 6> force, torque;
  for (std::size_t k = 0; k < 6; ++k) {
    const Vec3 axis = rotate(conjugate(q), kAxes[k % 3]);
    const Wrench change = k < 3 ? times(m, axis, {}) : times(m, {}, axis);
    force[k] = rotate(q, change.force);
    torque[k] = rotate(q, change.torque);
  }
  return blocks(force, torque);
}

Primitive moved(Primitive primitive, const Pose& X) {
  primitive.end1 = transform(X, primitive.end1);
  primitive.end2 = transform(X, primitive.end2);
  for (std::size_t i = 0; i < primitive.cut_count; ++i) {
    primitive.cut[i].normal = rotate(X.orientation, primitive.cut[i].normal);
    primitive.cut[i].point = transform(X, primitive.cut[i].point);
  }
  return primitive;
}

// Against a whole mesh, everything placed by X.
Matrix6 sum_over(const Mesh& mesh, Primitive primitive, Vec3 joint, const Pose& X) {
  primitive = moved(primitive, X);
  Matrix6 sum{};
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = transform(X, mesh.vertices[t[0]]), b = transform(X, mesh.vertices[t[1]]),
               c = transform(X, mesh.vertices[t[2]]);
    Contact contact;
    if (!collide(primitive, {}, {a, b, c}, contact)) continue;
    EXPECT_TRUE(add_contact_jacobian(primitive, contact, transform(X, joint), {a, b, c}, sum));
  }
  return sum;
}

// ---- Known by hand ----

// V(h) = integral of R - sqrt(r^2 + h^2) over the disc; V' = -2 pi h (R - h).
TEST(Jacobian, SphereOnAPlaneIsAsCalculatedByHand) {
  const double R = 0.008;
  test::Random random(3);
  for (const std::uint32_t cells : {1u, 5u, 40u}) {
    for (const double h : {0.00799, 0.006, 0.001, 0.0, -0.003}) {
      const Mesh plane = make_plane(0.1, cells, 1);
      const Vec3 arm = random.in_box(0.01);  // from the joint to the centre
      Primitive sphere;
      sphere.end1 = sphere.end2 = {0.001, 0.002, h};
      sphere.radius1 = sphere.radius2 = R;
      const double a = std::fabs(h);
      const double volume = kPi * (R * (R * R - h * h) - 2.0 / 3 * (R * R * R - a * a * a));
      const double slope = -2 * kPi * h * (R - a);
      const Vec3 force{0, 0, volume};
      std::array<Vec3, 6> forces{}, torques{};
      forces[2] = {0, 0, slope};
      torques[2] = cross(arm, forces[2]);
      for (std::size_t k = 0; k < 3; ++k) {  // the centre swings about the joint, and the arm turns
        forces[3 + k] = {0, 0, slope * cross(kAxes[k], arm).z};
        torques[3 + k] = cross(cross(kAxes[k], arm), force) + cross(arm, forces[3 + k]);
      }
      const Pose X = random.pose(0.3);
      const Matrix6 expected = turned(blocks(forces, torques), X.orientation);
      EXPECT_LT(difference(sum_over(plane, sphere, sphere.end1 - arm, X), expected, R), 2e-10)
          << cells << " cells, h = " << h;
    }
  }
}

// The force is its area times its depth, and depth is linear: second moments of the rectangle.
TEST(Jacobian, TheFlatOfAPalmOnAPlaneIsAsCalculatedByHand) {
  const double a = 0.04, b = 0.03, depth = 0.002, area = 4 * a * b;
  for (const std::uint32_t cells : {1u, 7u}) {
    const Mesh plane = make_plane(0.3, cells, 1);
    Matrix6 sum{};
    const SweptPolygon palm = test::box_palm(a, b, depth);
    const Slab slab = slab_of(palm, test::hand_of(palm).primitive[0]);
    for (const Triangle& t : plane.triangles) {
      const Vec3 p = plane.vertices[t[0]], q = plane.vertices[t[1]], r = plane.vertices[t[2]];
      Contact contact;
      if (!collide_slab(slab, Law::field, 0, {p, q, r}, contact)) continue;
      EXPECT_TRUE(add_contact_jacobian(slab, contact, {}, {p, q, r}, sum));
    }
    std::array<Vec3, 6> forces{}, torques{};
    forces[2] = {0, 0, -area};
    // The joint moves along with the palm, so sliding changes no torque; turned by w about x the depth
    // changes by -w y.
    torques[3] = {-area * b * b / 3, 0, 0};
    torques[4] = {0, -area * a * a / 3, 0};
    EXPECT_LT(difference(sum, blocks(forces, torques), a), 1e-10);
  }
}

// ---- Differences of the engine's own force ----

Matrix6 difference_of_forces(const test::RandomTouch& touch, double step) {
  std::array<Vec3, 6> forces, torques;
  for (std::size_t k = 0; k < 6; ++k) {
    const double h = k < 3 ? step * touch.radius : step;
    Wrench side[2];
    for (const int i : {0, 1}) {
      const Vec3 by = (i == 0 ? -h : h) * kAxes[k % 3];
      const Pose X = k < 3 ? turn_about(touch.joint, by, {}) : turn_about(touch.joint, {}, by);
      Contact contact;
      if (!collide(moved(touch.primitive, X), {}, {touch.corner[0], touch.corner[1], touch.corner[2]},
                   contact)) {
        continue;
      }
      side[i].force = contact.volume * contact.normal;
      side[i].torque = cross(contact.centre - transform(X, touch.joint), side[i].force);
    }
    forces[k] = (side[1].force - side[0].force) / (2 * h);
    torques[k] = (side[1].torque - side[0].torque) / (2 * h);
  }
  return blocks(forces, torques);
}

// Any pose, those too that the slower reference can't do; the best of three steps, since a step has to be
// long against rounding and short against the triangle.
TEST(Jacobian, AgreesWithDifferencesOfTheForce) {
  test::Random random(31);
  std::vector<double> worst;
  for (int i = 0; i < 600; ++i) {
    const test::RandomTouch touch = test::random_touch(static_cast<TouchForm>(i % 3), i / 3 % 3, random);
    const Mesh triangle{{touch.corner.begin(), touch.corner.end()}, {{0, 1, 2}}};
    const Matrix6 ours = sum_over(triangle, touch.primitive, touch.joint, {});
    double best = 1e300;
    for (const double step : {1e-4, 1e-5, 1e-6}) {
      best = std::fmin(best, difference(ours, difference_of_forces(touch, step), touch.radius));
    }
    worst.push_back(best);
  }
  std::sort(worst.begin(), worst.end());
  EXPECT_LT(worst[300], 2e-9);
  EXPECT_LT(worst[588], 1e-7);
  EXPECT_LT(worst[599], 1e-5);
}

// ---- Symmetries ----

// Against a closed surface the force is the gradient of a potential E: blocks of second derivatives, and for
// rotations, which do not commute, a skew part that is the torque.
TEST(Jacobian, IsTheHessianOfAPotentialOverAClosedSurface) {
  test::Random random(21);
  const Mesh meshes[] = {make_box({0.02, 0.03, 0.025}, 3), make_sphere(0.015, 4)};
  for (const TouchForm form : {TouchForm::sphere, TouchForm::capsule, TouchForm::cone}) {
    for (int i = 0; i < 20; ++i) {
      const Mesh& mesh = meshes[i % 2];
      Primitive primitive = test::random_touch(form, 0, random).primitive;
      primitive = moved(primitive, {random.in_box(0.02), random.rotation()});
      const Vec3 joint = primitive.end1 + random.in_box(0.01);
      Wrench wrench;
      for (const Triangle& t : mesh.triangles) {
        Contact contact;
        if (!collide(primitive, {}, {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]},
                     contact)) {
          continue;
        }
        wrench.force += contact.volume * contact.normal;
        wrench.torque += contact.volume * cross(contact.centre - joint, contact.normal);
      }
      const Matrix6 sum = sum_over(mesh, primitive, joint, {});
      Matrix6 expected{};
      for (std::size_t r = 0; r < 6; ++r) {
        for (std::size_t c = 0; c < 6; ++c) expected[r][c] = sum[c][r];
      }
      expected[3][4] += wrench.torque.z;
      expected[4][3] -= wrench.torque.z;
      expected[4][5] += wrench.torque.x;
      expected[5][4] -= wrench.torque.x;
      expected[5][3] += wrench.torque.y;
      expected[3][5] -= wrench.torque.y;
      EXPECT_LT(difference(sum, expected, primitive.radius1), 1e-9) << static_cast<int>(form) << " " << i;
    }
  }
}

TEST(Jacobian, MovesWithTheWorld) {
  test::Random random(5);
  for (int i = 0; i < 150; ++i) {
    const test::RandomTouch touch = test::random_touch(static_cast<TouchForm>(i % 3), i / 3 % 3, random);
    const Pose X = random.pose(0.3);
    const Mesh triangle{{touch.corner.begin(), touch.corner.end()}, {{0, 1, 2}}};
    const Matrix6 here = sum_over(triangle, touch.primitive, touch.joint, {}),
                  there = sum_over(triangle, touch.primitive, touch.joint, X);
    EXPECT_LT(difference(turned(here, X.orientation), there, touch.radius), 1e-9) << i;
  }
}

TEST(Jacobian, DoesNotDependOnHowATriangleIsCut) {
  test::Random random(6);
  for (int i = 0; i < 60; ++i) {
    const test::RandomTouch touch = test::random_touch(static_cast<TouchForm>(i % 3), i / 3 % 3, random);
    const auto& [a, b, c] = touch.corner;
    const double s = random.between(0.1, 0.9);
    const Mesh whole{{a, b, c}, {{0, 1, 2}}};
    const Vec3 inside = s * (0.5 * (a + b)) + (1 - s) * c;
    const Mesh parts{{a, b, c, inside}, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    EXPECT_LT(difference(sum_over(whole, touch.primitive, touch.joint, {}),
                         sum_over(parts, touch.primitive, touch.joint, {}), touch.radius),
              1e-8)
        << i;
  }
}

// ---- What it does not give ----

TEST(Jacobian, FlatCylindersAndNothingGiveNothing) {
  Primitive primitive;
  primitive.end2 = {0, 0, 0.02};
  primitive.radius1 = primitive.radius2 = 0.008;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3 a{-0.01, -0.01, 0.001}, b{0.01, -0.01, 0.001}, c{0, 0.01, 0.001};
  Matrix6 sum{};
  EXPECT_FALSE(add_contact_jacobian(primitive, Contact{}, {}, {a, a, b}, sum));
  EXPECT_FALSE(add_contact_jacobian(primitive, Contact{}, {}, {a, b, 0.5 * (a + b)}, sum));
  EXPECT_FALSE(add_contact_jacobian(primitive, Contact{}, {}, {a, b, {nan, 0, 0}}, sum));
  EXPECT_FALSE(add_contact_jacobian(primitive, Contact{}, {},
                                    {a + Vec3{1, 0, 0}, b + Vec3{1, 0, 0}, c + Vec3{1, 0, 0}}, sum));
  const SweptPolygon palm = test::box_palm(1, 1, 1, 1);
  const Slab slab = slab_of(palm, test::hand_of(palm).primitive[0]);
  EXPECT_FALSE(add_contact_jacobian(Slab{}, Contact{}, {}, {a, b, c}, sum));
  EXPECT_FALSE(add_contact_jacobian(slab, Contact{}, {}, {a, a, b}, sum));
  primitive.shape = Shape::flat;
  EXPECT_FALSE(add_contact_jacobian(primitive, Contact{}, {}, {a, b, c}, sum));
  EXPECT_EQ(sum, Matrix6{});
}

TEST(Jacobian, StaysFiniteInDegeneratePoses) {
  Primitive primitive;
  primitive.radius1 = primitive.radius2 = 0.008;
  const Vec3 a{-0.01, -0.01, 0}, b{0.01, -0.01, 0}, c{0, 0.01, 0};
  const Vec3 far_ends[] = {{0, 0, 0},     {0, 0, 0.02}, {0.02, 0, 0},     {0.02, 0, 1e-17},
                           {0, 0, 1e-30}, {0, 1e-9, 0}, {0.01, 0, -0.01}, {1e-13, 0, 0.03}};
  for (const double height : {0.0, 1e-300, 1e-17, 1e-9, 0.008 - 1e-12, 0.004}) {
    for (const Vec3 start :
         {Vec3{0, 0, height}, a + Vec3{0, 0, height}, 0.5 * (a + b) + Vec3{0, 0, height}}) {
      for (const Vec3 end : far_ends) {
        for (const double thin : {1.0, 0.999999999, 0.5}) {
          for (const Vec3 cut :
               {Vec3{0, 0, 0}, Vec3{0, 0, 1}, Vec3{1e-14, 0, -1}, Vec3{1e-8, 0, 1}, Vec3{0, 1, 0}}) {
            primitive.end1 = start;
            primitive.end2 = start + end;
            primitive.radius2 = thin * primitive.radius1;
            primitive.cut_count = norm(cut) > 0 ? 1 : 0;
            primitive.cut[0] = {cut, start};
            Matrix6 sum{};
            Contact contact;
            if (!collide(primitive, {}, {a, b, c}, contact)) continue;
            EXPECT_TRUE(add_contact_jacobian(primitive, contact, start, {a, b, c}, sum));
            EXPECT_LT(difference(sum, sum, 0.008), 1) << height;  // finite
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace lumbrical
