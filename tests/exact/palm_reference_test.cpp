// The palm against its definition, r less the distance to a filled polygon, in long double and cut up another
// way: strips beside the edges and wedges beyond the corners, by the reference for single solids, and flat
// parts by polygons.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "box_palm.h"
#include "contact_pairs.h"
#include "largest.h"
#include "model/corners.h"
#include "session.h"

namespace lumbrical {
namespace {

using Real = long double;
using Vector = reference::Vector<Real>;

struct Sums {
  Real area = 0, volume = 0;
  Vector first{};  // of the volume
  void add(Real a, Real v, const Vector& moment) {
    area += a;
    volume += v;
    first = first + moment;
  }
};

Vector wide(Vec3 v) { return test::to_reference(v).as<Real>(); }

// The part of the triangle in a slab, on the side of the core that `up` points to: polygons, exactly.
void add_slab(const SweptPolygon& palm, Vec3 up, const reference::Triangle& triangle, Sums& sums) {
  const Vector top = wide(up), base = wide(palm.corner[0]);
  std::vector<Vector> polygon;
  for (const auto& corner : triangle) polygon.push_back(corner.as<Real>());
  const Vector raw = cross(polygon[1] - polygon[0], polygon[2] - polygon[0]);
  const Vector n = unit(raw);
  const auto keep = [&](const Vector& outward, const Vector& point) {
    std::vector<Vector> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector p = polygon[i], q = polygon[(i + 1) % polygon.size()];
      const Real fp = dot(outward, p - point), fq = dot(outward, q - point);
      if (fp <= 0) kept.push_back(p);
      if ((fp < 0 && fq > 0) || (fp > 0 && fq < 0)) kept.push_back(p + (fp / (fp - fq)) * (q - p));
    }
    polygon = kept;
  };
  keep(Real(-1) * top, base);
  keep(top, base + Real(palm.radius) * top);
  for (std::size_t i = 0; i < palm.corner_count; ++i) keep(wide(palm.outward[i]), wide(palm.corner[i]));
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vector &a = polygon[0], &b = polygon[i], &c = polygon[i + 1];
    const Real area = dot(n, cross(b - a, c - a)) / 2;
    const auto field = [&](const Vector& p) { return Real(palm.radius) - dot(top, p - base); };
    for (const Vector& middle : {Real(0.5) * (a + b), Real(0.5) * (b + c), Real(0.5) * (c + a)}) {
      const Real share = area / 3 * field(middle);
      sums.add(area / 3, share, share * (middle - base));
    }
  }
}

Sums by_definition(const SweptPolygon& palm, const reference::Triangle& triangle) {
  Sums sums;
  add_slab(palm, palm.normal, triangle, sums);
  add_slab(palm, -palm.normal, triangle, sums);
  const std::size_t count = palm.corner_count;
  const auto direction = [&](std::size_t i) {  // of edge i, by its corners alone
    const Vec3 way = palm.corner[(i + 1) % count] - palm.corner[i % count];
    return way / norm(way);
  };
  const auto add = [&](Vec3 end1, Vec3 end2, std::vector<reference::HalfSpace> cuts) {
    reference::Solid solid;
    solid.end1 = test::to_reference(end1);
    solid.end2 = test::to_reference(end2);
    solid.radius1 = solid.radius2 = palm.radius;
    solid.cuts = std::move(cuts);
    const auto part = reference::contact<Real>(solid, triangle, {true, false, false});
    if (part.touches)
      sums.add(part.area.amount, part.field.amount,
               part.field.amount * (part.field.centre - wide(palm.corner[0])));
  };
  const auto half = [](Vec3 normal, Vec3 point) {
    return reference::HalfSpace{test::to_reference(normal), test::to_reference(point)};
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 here = palm.corner[i], next = palm.corner[(i + 1) % count], along = direction(i);
    add(here, next, {half(-palm.outward[i], here), half(-along, here), half(along, next)});
    add(here, here, {half(along, here), half(-direction(i + count - 1), here)});
  }
  return sums;
}

struct PalmPair {
  SweptPolygon palm;
  std::array<Vec3, 3> at;  // a triangle about any point of the palm: near its middle, an edge or a corner
};
// Of a size of 10^low .. 10^high radii; false for a sliver.
bool make_pair(test::Random& random, const Pose& X, double low, double high, PalmPair& pair) {
  const SweptPolygon& palm = pair.palm = place_palm(test::random_palm(random), X);
  const double r = palm.radius, size = r * test::power_of_ten(random, low, high);
  const std::size_t corners = palm.corner_count;
  Vec3 middle;
  for (std::size_t k = 0; k < corners; ++k) middle += (palm.corner[k] - palm.corner[0]) / palm.corner_count;
  const Vec3 corner = palm.corner[random.below(corners)] - palm.corner[0];
  const Vec3 near =
      palm.corner[0] + middle + random.between(0, 1.1) * (corner - middle) + r * random.in_box(0.8);
  for (Vec3& p : pair.at) p = near + size * random.direction();
  return norm(cross(pair.at[1] - pair.at[0], pair.at[2] - pair.at[0])) >= 0.1 * size * size;
}

test::Pressed press(const PalmPair& pair) {
  Mesh mesh;
  mesh.vertices.assign(pair.at.begin(), pair.at.end());
  mesh.triangles.push_back({0, 1, 2});
  return test::press(test::world_of(mesh), test::hand_of(pair.palm));
}

TEST(PalmAgainstReference, IsRadiusLessDistanceToAFilledPolygon) {
  test::Random random(51);
  const int count = test::in_a_hurry() ? 20 : 400;
  int touched = 0, many_parts = 0;
  double worst_area = 0, worst_volume = 0, worst_moment = 0;
  for (int i = 0; i < count; ++i) {
    const Pose X = random.pose(i % 10 == 0 ? 100 : 0.4);
    PalmPair pair;
    if (!make_pair(random, X, -1.5, 1.5, pair)) continue;
    const SweptPolygon& palm = pair.palm;
    const double r = palm.radius;
    const test::Pressed felt = press(pair);
    const Sums wanted = by_definition(palm, test::to_reference(pair.at));
    touched += wanted.volume > 0 ? 1 : 0;
    many_parts += felt.contacts.size() > 3 ? 1 : 0;
    const Vector centre = wide(felt.centre - palm.corner[0]);
    const Vector off = Real(felt.volume) * centre - wanted.first;
    worst_area = test::largest(worst_area, std::fabs(static_cast<double>(felt.area - wanted.area)) / (r * r));
    worst_volume = test::largest(worst_volume,
                                 std::fabs(static_cast<double>(felt.volume - wanted.volume)) / (r * r * r));
    // Far from the origin positions have the digits of their coordinates.
    const double place = 1e-15 * (1 + norm(X.position)) * felt.volume;
    worst_moment = test::largest(worst_moment, (static_cast<double>(norm(off)) - place) / (r * r * r * r));
    if (norm(X.position) < 1) {
      EXPECT_LT(std::fabs(static_cast<double>(felt.volume - wanted.volume)), 1e-12 * r * r * r) << i;
    }
  }
  std::printf("area %.1e r^2, volume %.1e r^3, moment %.1e r^4\n", worst_area, worst_volume, worst_moment);
  EXPECT_GT(touched, count / 2);
  EXPECT_GT(many_parts, count / 20);
  EXPECT_LT(worst_area, 1e-9);  // 100 m away a metre has 1.4e-14 of digits
  EXPECT_LT(worst_volume, 1e-10);
  EXPECT_LT(worst_moment, 1e-9);
}

TEST(PalmAgainstReference, IsOffByNoMoreThanItStatesOnTrianglesFromTinyToHuge) {
  test::Random random(52);
  const int count = test::in_a_hurry() ? 20 : 400;
  int touched = 0;
  for (int i = 0; i < count; ++i) {
    PalmPair pair;
    if (!make_pair(random, random.pose(0.4), -4, 5, pair)) continue;
    const double r = pair.palm.radius;
    const test::Pressed felt = press(pair);
    const Sums wanted = by_definition(pair.palm, test::to_reference(pair.at));
    double stated = 0;
    for (const Contact& contact : felt.contacts) stated += contact.error;
    const double off = std::fabs(static_cast<double>(felt.volume - wanted.volume));
    EXPECT_LE(off, stated) << i << ", " << off / (r * r * r) << " R^3";
    touched += wanted.volume > 0 ? 1 : 0;
  }
  EXPECT_GT(touched, count / 4);
}

}  // namespace
}  // namespace lumbrical
