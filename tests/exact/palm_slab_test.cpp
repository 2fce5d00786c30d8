// The palm's slabs in lanes: triangles inside and such that faces cut, held against the same polygons in
// extended precision, against values known by hand, and against their own parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "exact/slab_pairs.h"
#include "largest.h"
#include "loose_triangles.h"
#include "random.h"
#include "section/slab.h"

namespace lumbrical {
namespace {

using Real = long double;

struct Point {
  Real x, y, z;
};
Point operator+(Point p, Point q) { return {p.x + q.x, p.y + q.y, p.z + q.z}; }
Point operator-(Point p, Point q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
Point operator*(Real s, Point p) { return {s * p.x, s * p.y, s * p.z}; }
Real dot(Point p, Point q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
Point cross(Point p, Point q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
Point point(Vec3 v) { return {v.x, v.y, v.z}; }
Vec3 vector(Point p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

// value + dot(slope, p).
struct Function {
  Real value;
  Point slope;
  Real at(Point p) const { return value + dot(slope, p); }
};

using Polygon = std::vector<Point>;

Polygon where_not_above(const Function& f, const Polygon& polygon) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const Real fp = f.at(p), fq = f.at(q);
    if (fp <= 0) kept.push_back(p);
    if ((fp <= 0) != (fq <= 0)) kept.push_back(p + (fp / (fp - fq)) * (q - p));
  }
  return kept;
}

struct Wanted {
  Real area = 0, volume = 0, depth = 0;
  Point centroid{}, centre{};  // relative to the first face's point
};

using Triangle3 = std::array<Vec3, 3>;

Wanted in_extended_precision(const Slab& slab, const Triangle3& t) {
  const Point origin = point(slab.face[0].point);
  Polygon polygon{point(t[0]) - origin, point(t[1]) - origin, point(t[2]) - origin};
  const Point raw = cross(polygon[1] - polygon[0], polygon[2] - polygon[0]);
  const Point n = (1 / std::sqrt(dot(raw, raw))) * raw;
  for (std::size_t i = 0; i < slab.face_count; ++i) {
    const HalfSpace& face = slab.face[i];
    const Point normal = point(face.normal);
    const Function over{-dot(normal, point(face.point) - origin), normal};
    polygon = where_not_above(over, polygon);
  }
  Wanted wanted;
  if (polygon.size() < 3) return wanted;
  const Point down = point(slab.face[0].normal), base = polygon[0];
  const auto f = [&](Point p) { return -dot(down, p); };
  for (const Point p : polygon) wanted.depth = std::max(wanted.depth, f(p));
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Point p = polygon[i], q = polygon[i + 1];
    const Real area = dot(n, cross(p - base, q - base)) / 2, sum = f(base) + f(p) + f(q);
    wanted.area += area;
    wanted.volume += area * sum / 3;
    wanted.centroid = wanted.centroid + (area / 3) * (base + p + q);
    wanted.centre =
        wanted.centre + (area / 12) * (sum * (base + p + q) + f(base) * base + f(p) * p + f(q) * q);
  }
  if (wanted.area > 0) wanted.centroid = (1 / wanted.area) * wanted.centroid;
  if (wanted.volume > 0) wanted.centre = (1 / wanted.volume) * wanted.centre;
  return wanted;
}

// A palm of some corners, its sides not quite upright.
Slab some_slab(test::Random& random, const Pose& X) {
  Slab slab;
  const auto add = [&](Vec3 normal, Vec3 at) {
    slab.face[slab.face_count++] = {rotate(X.orientation, normal), transform(X, at)};
  };
  slab.thickness = 0.024;
  add({0, 0, -1}, {0, 0, -0.002});
  add({0, 0, 1}, {0, 0, 0.022});
  const int sides = 3 + static_cast<int>(random.below(14));
  for (int i = 0; i < sides; ++i) {
    const double angle = 6.283185307179586 * (i + random.between(0, 0.8)) / sides;
    const Vec3 out{std::cos(angle), std::sin(angle), 0};
    const double slant = random.below(2) == 0 ? 0 : random.between(-0.4, 0.4);
    add((out + Vec3{0, 0, slant}) / std::sqrt(1 + slant * slant), random.between(0.03, 0.045) * out);
  }
  return slab;
}

// 2 a by 2 b wide, its skin `depth` below z = 0.
Slab box_slab(double a, double b, double depth, double thickness, const Pose& X = {}) {
  Slab slab;
  slab.thickness = thickness;
  const auto add = [&](Vec3 normal, Vec3 point) {
    slab.face[slab.face_count++] = {rotate(X.orientation, normal), transform(X, point)};
  };
  add({0, 0, -1}, {0, 0, -depth});
  add({0, 0, 1}, {0, 0, thickness - depth});
  add({1, 0, 0}, {a, 0, 0});
  add({-1, 0, 0}, {-a, 0, 0});
  add({0, 1, 0}, {0, b, 0});
  add({0, -1, 0}, {0, -b, 0});
  return slab;
}

struct Pressed {
  std::vector<Contact> contact;
  std::size_t left = 0;  // by the general path
};

Pressed press(const Slab& slab, Isa isa, const std::vector<Triangle3>& triangles) {
  Pressed pressed;
  pressed.contact.resize(triangles.size());
  std::vector<std::uint32_t> list(triangles.size());
  for (std::uint32_t slot = 0; slot < list.size(); ++slot) list[slot] = pressed.contact[slot].triangle = slot;
  const Triangles world = test::loose_triangles(triangles);
  const Primitives hand;
  PairList alone;
  collide_slab_pairs({world, hand, exact_kernels(isa), pressed.contact}, slab, list, alone);
  pressed.left = alone.size();
  for (const std::uint32_t slot : alone) {
    const Triangle3& t = triangles[slot];
    Contact& contact = pressed.contact[slot];
    if (!collide_slab(slab, Law::field, 1e-4, {t[0], t[1], t[2]}, contact)) contact.area = 0;
  }
  return pressed;
}

// Sizes of what comes out [m], and the share of it that rounding may take.
struct Allowed {
  double area, depth, place;
};

// Triangles of some size about a palm; one in three is narrow.
std::vector<Triangle3> triangles_about(test::Random& random, const Pose& X, double size) {
  std::vector<Triangle3> triangles(300);
  for (Triangle3& t : triangles) {
    const Vec3 near = random.in_box(0.03), a = random.direction(), b = random.direction();
    const double thin = random.below(3) == 0 ? std::pow(10.0, random.between(-8, 0)) : 1;
    const Vec3 c =
        thin < 1 ? a + random.between(0, 1) * (b - a) + thin * random.direction() : random.direction();
    // What is larger than the palm has a point in it.
    const Vec3 in = size < 0.05 ? Vec3{} : random.between(0, 0.6) * a + random.between(0, 0.4) * b;
    t = {transform(X, near + size * (a - in)), transform(X, near + size * (b - in)),
         transform(X, near + size * (c - in))};
  }
  return triangles;
}

// The narrower a triangle, the less certain its plane.
bool is_broad(const Triangle3& t) {
  const Vec3 raw = cross(t[1] - t[0], t[2] - t[0]);
  const double longest = std::fmax(norm(t[1] - t[0]), std::fmax(norm(t[2] - t[0]), norm(t[2] - t[1])));
  return norm(raw) > 1e-3 * longest * longest;
}

TEST(PalmSlab, TrianglesOfEverySizeAreTheirPolygonsInExtendedPrecision) {
  test::Random random(21);
  for (const double at : {0.4, 300.0}) {
    for (const double size : {1e-6, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0}) {
      int touched = 0, certain = 0;
      std::size_t left = 0;
      for (int round = 0; round < 25; ++round) {
        const Pose X = random.pose(at);
        const Slab slab = some_slab(random, X);
        const std::vector<Triangle3> triangles = triangles_about(random, X, size);
        const Pressed pressed = press(slab, widest_isa(), triangles);
        left += pressed.left;
        const Allowed allowed{5e-16 * size, 1e-8, 1e-15 * at};
        for (std::size_t k = 0; k < triangles.size(); ++k) {
          const Contact& contact = pressed.contact[k];
          const Wanted wanted = in_extended_precision(slab, triangles[k]);
          const auto area = static_cast<double>(wanted.area), volume = static_cast<double>(wanted.volume);
          ASSERT_NEAR(contact.area, area, allowed.area);
          if (!(contact.area > 0)) continue;
          ++touched;
          const Vec3 origin = slab.face[0].point;
          ASSERT_NEAR(contact.volume, volume, 0.03 * allowed.area);
          // The narrower a triangle, the less certain its plane where that is far from the corners.
          const double lever = std::fmax(1, size);
          ASSERT_LT(area * norm(contact.centroid - origin - vector(wanted.centroid)),
                    allowed.place * area + 0.1 * lever * allowed.area);
          ASSERT_LT(volume * norm(contact.centre - origin - vector(wanted.centre)),
                    allowed.place * volume + 0.003 * lever * allowed.area);
          const bool sure = is_broad(triangles[k]) && area > 1e3 * allowed.area;
          certain += sure ? 1 : 0;
          ASSERT_NEAR(contact.depth, static_cast<double>(wanted.depth),
                      sure ? 1e-13 * (1 + size) : allowed.depth);
        }
      }
      EXPECT_GT(touched, 60) << size;
      EXPECT_TRUE(size >= 1 || certain > 100) << size;
      EXPECT_TRUE(size >= 0.1 || left == 0) << size;
    }
  }
}

TEST(PalmSlab, EveryInstructionSetHasTheSameBits) {
  test::Random random(22);
  for (int round = 0; round < 10; ++round) {
    const Pose X = random.pose(0.4);
    const Slab slab = some_slab(random, X);
    const std::vector<Triangle3> triangles =
        triangles_about(random, X, std::pow(10.0, random.between(-3, -1)));
    const Pressed expected = press(slab, Isa::scalar, triangles);
    for (const Isa isa : {Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
      if (!available(isa)) continue;
      const Pressed pressed = press(slab, isa, triangles);
      EXPECT_EQ(pressed.left, expected.left);
      for (std::size_t k = 0; k < triangles.size(); ++k) {
        const Contact &a = pressed.contact[k], &b = expected.contact[k];
        ASSERT_EQ(a.area, b.area) << isa_name(isa);
        if (!(a.area > 0)) continue;
        ASSERT_TRUE(a.volume == b.volume && a.depth == b.depth && a.normal == b.normal &&
                    a.centroid == b.centroid && a.centre == b.centre)
            << isa_name(isa);
      }
    }
  }
}

struct Sum {
  double area = 0, volume = 0, depth = 0;
  Vec3 centroid, centre;  // times area, volume
};

Sum sum_of(const Pressed& pressed, Vec3 origin) {
  Sum sum;
  for (const Contact& contact : pressed.contact) {
    if (!(contact.area > 0)) continue;
    sum.area += contact.area;
    sum.volume += contact.volume;
    sum.depth = test::largest(sum.depth, contact.depth);
    sum.centroid += contact.area * (contact.centroid - origin);
    sum.centre += contact.volume * (contact.centre - origin);
  }
  return sum;
}

TEST(PalmSlab, ATriangleIsTheSumOfItsParts) {
  test::Random random(23);
  int touched = 0;
  for (int round = 0; round < 300; ++round) {
    const Pose X = random.pose(0.4);
    const Slab slab = some_slab(random, X);
    const Vec3 corner = transform(X, random.in_box(0.05));
    const Vec3 u = 0.1 * random.direction(), v = 0.1 * random.direction();
    if (norm(cross(u, v)) < 1e-3) continue;
    const auto grid = [&](int i, int j) { return corner + (i / 12.0) * u + (j / 12.0) * v; };
    std::vector<Triangle3> parts;
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; i + j < 12; ++j) {
        parts.push_back({grid(i, j), grid(i + 1, j), grid(i, j + 1)});
        if (i + j < 11) parts.push_back({grid(i + 1, j), grid(i + 1, j + 1), grid(i, j + 1)});
      }
    }
    const Vec3 origin = slab.face[0].point;
    const Sum one = sum_of(press(slab, widest_isa(), {{grid(0, 0), grid(12, 0), grid(0, 12)}}), origin);
    const Sum all = sum_of(press(slab, widest_isa(), parts), origin);
    touched += one.area > 0 ? 1 : 0;
    EXPECT_NEAR(all.area, one.area, 1e-16);
    EXPECT_NEAR(all.volume, one.volume, 1e-18);
    EXPECT_NEAR(all.depth, one.depth, 1e-11);
    EXPECT_LT(norm(all.centroid - one.centroid), 1e-17);
    EXPECT_LT(norm(all.centre - one.centre), 1e-19);
  }
  EXPECT_GT(touched, 100);
}

// A mesh whose lines run along the box' own, and through its corners; one side is there twice.
TEST(PalmSlab, TrianglesAlongTheFacesAddUpToThePalm) {
  test::Random random(24);
  for (int round = 0; round < 40; ++round) {
    const Pose X = round == 0 ? Pose{} : random.pose(0.4);
    Slab slab = box_slab(0.04, 0.02, 0.002, 0.024, X);
    slab.face[slab.face_count++] = slab.face[2];
    std::vector<Triangle3> triangles;
    for (int i = -8; i < 8; ++i) {
      for (int j = -8; j < 8; ++j) {
        const auto at = [&](int k, int l) { return transform(X, Vec3{0.01 * k, 0.01 * l, 0}); };
        triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
    const Sum sum = sum_of(press(slab, widest_isa(), triangles), X.position);
    EXPECT_NEAR(sum.area / (0.08 * 0.04), 1, 1e-12);
    EXPECT_NEAR(sum.volume / (0.08 * 0.04 * 0.002), 1, 1e-11);
    EXPECT_NEAR(sum.depth / 0.002, 1, 1e-12);
    EXPECT_LT(norm(sum.centroid), 1e-17);
  }
}

// Corners in corners, edges and faces of a box, and on the lines and planes that go on from them.
TEST(PalmSlab, TrianglesThroughEdgesAndCornersAreTheirPolygons) {
  test::Random random(27);
  const double x[] = {-0.08, -0.04, 0, 0.04, 0.08}, y[] = {-0.06, -0.03, 0, 0.03, 0.06};
  const double z[] = {-0.024, -0.002, 0, 0.022, 0.044};
  int touched = 0;
  for (int round = 0; round < 60; ++round) {
    const Pose X = round % 6 == 0 ? Pose{} : random.pose(0.4);
    Slab slab = box_slab(0.04, 0.03, 0.002, 0.024, X);
    if (round % 2 == 0) slab.face[slab.face_count++] = slab.face[4];
    std::vector<Triangle3> triangles;
    while (triangles.size() < 250) {
      Vec3 corner[3];
      for (Vec3& p : corner) p = {x[random.below(5)], y[random.below(5)], z[random.below(5)]};
      const Vec3 raw = cross(corner[1] - corner[0], corner[2] - corner[0]);
      if (norm(raw) < 1e-9) continue;
      const double upright = std::fmax(std::fabs(raw.x), std::fmax(std::fabs(raw.y), std::fabs(raw.z)));
      if (upright > (1 - 1e-9) * norm(raw)) continue;  // maybe in a face
      triangles.push_back({transform(X, corner[0]), transform(X, corner[1]), transform(X, corner[2])});
    }
    const Pressed pressed = press(slab, widest_isa(), triangles);
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const Wanted wanted = in_extended_precision(slab, triangles[k]);
      const Contact& contact = pressed.contact[k];
      touched += contact.area > 1e-9 ? 1 : 0;
      ASSERT_NEAR(contact.area, static_cast<double>(wanted.area), 1e-16);
      if (!(contact.area > 0)) continue;
      ASSERT_NEAR(contact.volume, static_cast<double>(wanted.volume), 3e-18);
      if (!(contact.area > 1e-9)) continue;
      ASSERT_NEAR(contact.depth, static_cast<double>(wanted.depth), 1e-14);
    }
  }
  EXPECT_GT(touched, 3000);
}

// In the plane of a face there is an area or none, by rounding, but never any depth to speak of; what only
// touches an edge or a corner has no area.
TEST(PalmSlab, TrianglesInAFaceOrAtAnEdgeAreHarmless) {
  test::Random random(25);
  for (int round = 0; round < 40; ++round) {
    const Pose X = random.pose(0.4);
    const Slab slab = box_slab(0.04, 0.03, 0.002, 0.024, X);
    const auto at = [&](double x, double y, double z) { return transform(X, Vec3{x, y, z}); };
    const double depth = -0.002;  // of the skin
    const std::vector<Triangle3> triangles = {
        {at(-0.1, -0.1, depth), at(0.1, -0.1, depth), at(0, 0.3, depth)},        // the skin
        {at(0.04, -0.1, -0.1), at(0.04, 0.1, -0.1), at(0.04, 0, 0.3)},           // a side
        {at(0.04, 0.03, -0.1), at(0.14, 0.03, -0.1), at(0.04, 0.03, 0.1)},       // an upright edge
        {at(-0.1, 0.03, depth), at(0.1, 0.03, depth), at(0, 0.3, depth - 0.1)},  // an edge of the skin
        {at(0.04, 0.03, depth), at(0.1, 0.03, depth), at(0.04, 0.1, depth)},     // a corner
    };
    const Pressed pressed = press(slab, widest_isa(), triangles);
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const Contact& contact = pressed.contact[k];
      if (!(contact.area > 0)) continue;
      EXPECT_LT(contact.area, k == 0   ? 0.08 * 0.06 * (1 + 1e-12)
                              : k == 1 ? 0.06 * 0.024 * (1 + 1e-12)
                                       : 1e-16);
      EXPECT_TRUE(k != 0 || contact.depth < 1e-15);
      EXPECT_TRUE(is_finite(contact.centre) && is_finite(contact.centroid));
    }
    const double nan = std::nan("");
    for (const Vec3 corner : {Vec3{nan, 0, 0}, Vec3{0, INFINITY, 0}, Vec3{1e200, 0, 0}}) {
      const Pressed none = press(slab, widest_isa(), {{corner, at(0, 0, 0), at(0, 1, 0)}});
      EXPECT_FALSE(none.contact[0].area > 0);
    }
  }
}

// More faces than the lanes cut with.
TEST(PalmSlab, TrianglesCutByManyFacesGoTheGeneralWay) {
  Slab slab = box_slab(0.04, 0.04, 0.002, 0.024);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0})
      slab.face[slab.face_count++] = {Vec3{std::sqrt(0.5) * x, std::sqrt(0.5) * y, 0},
                                      {0.03 * x, 0.03 * y, 0}};
  }
  const Pressed pressed = press(slab, widest_isa(), {{Vec3{-9, -9, 0}, Vec3{9, -9, 0}, Vec3{0, 9, 0}}});
  EXPECT_EQ(pressed.left, 1u);
  EXPECT_NEAR(pressed.contact[0].area / (0.08 * 0.08 - 2 * 0.02 * 0.02), 1, 1e-12);
  EXPECT_NEAR(pressed.contact[0].volume / (0.002 * pressed.contact[0].area), 1, 1e-12);
}

}  // namespace
}  // namespace lumbrical
