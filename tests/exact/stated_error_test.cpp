// What a contact states about its own error, against the reference: triangles of all sizes, and lying axes.
#include <gtest/gtest.h>

#include <cmath>

#include "borders/pair_contact.h"
#include "contact_pairs.h"
#include "random.h"

namespace lumbrical::test {
namespace {

constexpr double kRadius = 0.008;

using Triangle3 = std::array<Vec3, 3>;

Primitive random_primitive(Random& random, int shape) {
  Primitive p;
  p.law = Law::field;
  p.radius1 = kRadius;
  p.radius2 = shape == 2 ? random.between(0.5, 1) * kRadius : kRadius;
  p.end1 = random.in_box(0.1);
  p.end2 = p.end1 + (shape == 0 ? 0.0 : random.between(0.3, 6) * kRadius) * random.direction();
  return p;
}

// Through a point, as long as `size` and as wide as that or down to a hundredth.
Triangle3 triangle_through(Vec3 point, double size, Random& random) {
  const Vec3 u = size * random.direction(),
             v = size * std::pow(10.0, random.between(-2, 0)) * random.direction();
  const double s = random.between(0, 1), t = random.between(0, 1 - s);
  const Vec3 a = point - s * u - t * v;
  return {a, a + u, a + v};
}

struct Stated {
  double off = -1;     // by how much of R^3 the volume is off, or -1 where they don't touch
  bool usual = false;  // states no more than the usual share of R^3
};

// The stated error must hold, and must not be so large that it says nothing.
Stated expect_stated_error(const Primitive& p, const Triangle3& corner, double usual, int number) {
  Contact contact;
  const ContactQuery query{1e-4, nullptr, exact_kernels(Isa::scalar)};
  if (!collide(p, query, {corner[0], corner[1], corner[2]}, contact)) return {};
  const reference::Solid solid{false, to_reference(p.end1), to_reference(p.end2), p.radius1, p.radius2};
  const auto wanted = reference::contact<long double>(solid, to_reference(corner), {true, false, false});
  const double off = std::fabs(static_cast<double>(contact.volume - wanted.field.amount));
  const auto most = [&](double share) { return most_stated(share, p.radius1, p.end1, corner, contact.area); };
  EXPECT_LE(off, contact.error) << "pair " << number;
  EXPECT_LE(contact.error, most(kMostStated)) << "pair " << number;
  return {off / (kRadius * kRadius * kRadius), contact.error <= most(usual)};
}

TEST(StatedError, HoldsForTrianglesFromTinyToHuge) {
  int touching = 0, rounded = 0, usual = 0;
  for (int i = 0; i < 6000; ++i) {
    Random random(static_cast<std::uint64_t>(810000 + i));
    const Primitive p = random_primitive(random, i % 3);
    const double size = kRadius * std::pow(10.0, random.between(-4, 5));
    const Vec3 point = p.end1 + random.between(0, 1) * (p.end2 - p.end1) +
                       random.between(0, 1) * kRadius * random.direction();
    const Stated stated = expect_stated_error(p, triangle_through(point, size, random), kMostOfDiscs, i);
    touching += stated.off >= 0;
    rounded += stated.off > 1e-11;
    usual += stated.usual;
  }
  EXPECT_GT(touching, 3000);
  EXPECT_GT(rounded, 0);  // large triangles, off by more than the formulas are
  EXPECT_GT(usual, 0.97 * touching);
}

TEST(StatedError, HoldsForAxesThatLieNearlyInThePlane) {
  int touching = 0, usual = 0;
  for (int i = 0; i < 4000; ++i) {
    Random random(static_cast<std::uint64_t>(820000 + i));
    const Primitive p = random_primitive(random, 1 + i % 2);
    const Vec3 axis = unit_or(p.end2 - p.end1, {}), across = unit_or(cross(axis, random.direction()), {});
    const double tilt = i % 6 == 0 ? 0 : std::pow(10.0, random.between(-14, -2.4));
    const Vec3 along = unit_or(axis + tilt * cross(axis, across), {}), n = cross(along, across);
    const double depth = i % 3 == 0 ? std::pow(10.0, random.between(-9, 0)) : random.between(-1, 1);
    const Vec3 middle = p.end1 + random.between(-0.1, 1.1) * (p.end2 - p.end1) + depth * kRadius * n;
    const double size = kRadius * std::pow(10.0, random.between(-1.5, 2));
    const auto corner = [&] {
      const double turn = random.between(0, 7);
      return middle + size * random.between(0.1, 1) * (std::cos(turn) * along + std::sin(turn) * across);
    };
    const Vec3 a = corner(), b = corner(), c = corner();
    const Stated stated = expect_stated_error(p, {a, b, c}, kMostOfLying, i);
    touching += stated.off >= 0;
    usual += stated.usual;
  }
  EXPECT_GT(usual, 0.6 * touching);
  EXPECT_GT(touching, 2000);
}

}  // namespace
}  // namespace lumbrical::test
