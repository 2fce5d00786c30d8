// Random pairs of a round primitive with a triangle, and their way through the kernels.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "exact/round_pairs.h"
#include "exact/through_lanes.h"
#include "random.h"

namespace lumbrical::test {

struct Pair {
  Primitive primitive;
  Corners at;
};

inline constexpr double kPairRadius = 0.008;

inline Primitive random_part(Random& random, int shape, Vec3 direction) {
  Primitive part;
  part.law = Law::field;
  part.radius1 = kPairRadius;
  part.radius2 = shape == 2 ? random.between(0.6, 1.0) * kPairRadius : kPairRadius;
  part.end1 = random.in_box(0.1);
  part.end2 = part.end1 + (shape == 0 ? 0.0 : random.between(0.5, 4) * kPairRadius) * direction;
  if (random.between(0, 1) < 0.5) return part;
  part.cut_count = static_cast<std::uint8_t>(1 + random.below(3));
  for (HalfSpace& cut : part.cut) {
    cut.normal = random.direction();
    cut.point = &cut == part.cut.data() ? part.end1 : part.end2;
  }
  return part;
}

// Triangles of a hundredth of R to thirty R that lie anyhow.
inline Pair any_pair(Random& random, int shape) {
  Pair pair{random_part(random, shape, random.direction()), {}};
  const Primitive& p = pair.primitive;
  const double size = kPairRadius * std::pow(10.0, random.between(-2, 1.5));
  const Vec3 near = p.end1 + random.between(0, 1) * (p.end2 - p.end1) +
                    random.between(0, 1) * kPairRadius * random.direction();
  for (Vec3* corner : {&pair.at.a, &pair.at.b, &pair.at.c}) *corner = near + size * random.direction();
  return pair;
}

// Planes exactly across and exactly along the axis, near either end.
inline Pair square_pair(Random& random, int shape) {
  const Vec3 axis[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
  Pair pair{random_part(random, shape, axis[static_cast<std::size_t>(random.between(0, 4)) % 4]), {}};
  const Primitive& p = pair.primitive;
  const double size = kPairRadius * std::pow(10.0, random.between(-2, 1.5));
  Vec3 near = random.between(0, 1) < 0.5 ? p.end1 : p.end2;
  near += Vec3{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)} * kPairRadius;
  for (Vec3* corner : {&pair.at.a, &pair.at.b, &pair.at.c}) {
    const Vec3 d = random.direction();
    *corner = near + size * Vec3{d.x, d.y, 0};
  }
  return pair;
}

// Planes within a quarter of a degree of the axis, at every depth.
inline Pair flat_pair(Random& random, int shape) {
  const Vec3 along = random.direction(), n = unit_or(cross(along, random.direction()), {1, 0, 0});
  const double tilt = std::pow(10.0, random.between(-12, -2.4));
  Pair pair{random_part(random, shape, unit_or(along + tilt * n, along)), {}};
  const Primitive& p = pair.primitive;
  const double size = kPairRadius * std::pow(10.0, random.between(-1.5, 1.5));
  const Vec3 v = cross(n, along);
  const Vec3 near = p.end1 + random.between(-0.2, 1.2) * (p.end2 - p.end1) +
                    kPairRadius * (random.between(-1, 1) * n + random.between(-1, 1) * v);
  for (Vec3* corner : {&pair.at.a, &pair.at.b, &pair.at.c})
    *corner = near + size * (random.between(-1, 1) * along + random.between(-1, 1) * v);
  return pair;
}

// Pairs of one kind through a kernel, a group at a time; of each what is found.
inline std::vector<Contact> through(void (*kernel)(RoundTerms&), RoundKind kind, std::span<const Pair> pairs,
                                    std::vector<double>& status) {
  std::vector<Contact> contacts;
  status.clear();
  int cut_count = 0;
  for (const Pair& pair : pairs) cut_count = std::max<int>(cut_count, pair.primitive.cut_count);
  const auto terms = std::make_unique<RoundTerms>();
  set_kind(kind, cut_count, *terms);
  through_lanes(
      pairs, *terms, kernel,
      [](const Pair& pair, std::size_t k, RoundTerms& to) {
        const RoundHull hull = round_hull(pair.primitive);
        put_pair(hull, seen_from(hull.origin, pair.at),
                 std::span(hull.cut).first(static_cast<std::size_t>(hull.cut_count)), k, to);
      },
      [&](const Pair&, std::size_t k, const RoundTerms& from) {
        status.push_back(from.status[k]);
        read_contact(from, k, {}, contacts.emplace_back());
      });
  return contacts;
}

// A register takes the way of all its pairs, and none may show another's. Returns what became of each pair.
inline std::vector<double> expect_same_alone(void (*ExactKernels::*kernel)(RoundTerms&), RoundKind kind,
                                             std::span<const Pair> pairs) {
  std::vector<double> status, alone_status;
  const std::vector<Contact> contacts = through(exact_kernels(widest_isa()).*kernel, kind, pairs, status);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Contact alone =
        through(exact_kernels(Isa::scalar).*kernel, kind, pairs.subspan(i, 1), alone_status)[0];
    EXPECT_EQ(status[i], alone_status[0]) << i;
    const bool found = status[i] == kContact || status[i] == kSlivers;
    const bool sliver = kernel == &ExactKernels::cone_slivers;
    EXPECT_TRUE(!found || (alone.volume == contacts[i].volume && alone.centre == contacts[i].centre)) << i;
    EXPECT_TRUE(!found || sliver || std::memcmp(&alone, &contacts[i], sizeof alone) == 0) << i;
  }
  return status;
}

}  // namespace lumbrical::test
