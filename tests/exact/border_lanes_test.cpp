// Curved borders in lanes (border_pairs.h) against one border at a time (border_cut.h), and the same bits
// with every instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "base/gauss.h"
#include "borders/border_bulge.h"
#include "borders/border_pairs.h"
#include "borders/joint_border.h"
#include "borders/root.h"
#include "loose_triangles.h"
#include "pose_hand.h"
#include "posed_finger.h"
#include "random.h"
#include "simd/lane_vectors.h"

namespace lumbrical {
namespace {

constexpr double kRadius = 0.0078125;
constexpr double kDegree = std::numbers::pi / 180;

// A finger of any slopes, bent by -30 to 120 degrees; every other one by less.
Primitives random_finger(test::Random& random) {
  Hand hand = test::plain_hand(kRadius);
  std::array<Vec3, 4> joint{};
  double angle = 0, radius = kRadius * random.between(0.8, 1.2);
  const double most = random.bits() % 2 == 0 ? 120 : 40;
  for (std::size_t i = 0; i < 4; ++i) {
    hand.radius[kIndexProximal + i] = radius;
    radius *= random.between(0.7, 1.3);
    if (i == 3) break;
    const Vec3 bone{std::cos(angle), random.between(-0.1, 0.1), std::sin(angle)};
    joint[i + 1] = joint[i] + kRadius * random.between(1.2, 6) * unit_or(bone, {});
    angle -= random.between(-0.25 * most, most) * kDegree;
  }
  const Pose X = random.pose(0.1);
  for (Vec3& p : joint) p = transform(X, p);
  Primitives primitives;
  test::pose_hand(hand, {}, test::finger_frame(joint), primitives);
  return primitives;
}

// From 0.1 to 100 mm, round a point near a joint, every other one in the plane of the joint.
Corners random_triangle(const Primitives& hand, test::Random& random) {
  const JointBorder& border = hand.border[3 + random.bits() % 2];
  Vec3 away = random.in_box(kRadius);
  if (random.bits() % 2 == 0) away += -dot(away, border.normal) * border.normal;
  const Vec3 middle = border.centre + away;
  const double size = 1e-4 * std::pow(10, random.between(0, 3));
  return {middle + size * random.direction(), middle + size * random.direction(),
          middle + size * random.direction()};
}

// A tile and a triangle one or two of its borders cross.
struct Crossed {
  std::size_t tile;
  Corners at;
  TriangleCuts cuts;
};

std::vector<Crossed> crossed_by(const Primitives& hand, test::Random& random, int triangles) {
  std::vector<Crossed> found;
  for (int i = 0; i < triangles; ++i) {
    const Corners t = random_triangle(hand, random);
    for (std::size_t tile = 0; tile < 3; ++tile) {
      const TileBorders near = borders_in_reach(hand, hand.primitive[tile], t);
      if (!near.any()) continue;
      const TriangleCuts cuts = cross_borders(hand, hand.primitive[tile], near, t);
      const bool crossed = cuts.crossing[0].exists || cuts.crossing[1].exists;
      if (cuts.kind == CutKind::other && crossed) found.push_back({tile, t, cuts});
    }
  }
  return found;
}

// A pair's cuts from the lanes, with the ends of the last of its chords [m] from the joint.
struct Found {
  OwnCuts own;
  Vec3 from, to;
};

// The pairs with the kernel of one table.
std::vector<Found> in_lanes(const ExactKernels& kernels, const Primitives& hand,
                            const std::vector<Crossed>& pairs) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (const Crossed& pair : pairs) triangles.push_back({pair.at.a, pair.at.b, pair.at.c});
  const Triangles world = test::loose_triangles(triangles);
  std::vector<Contact> contacts(pairs.size());
  std::vector<RoundHull> hulls;
  for (std::size_t i = 0; i < 3; ++i) hulls.push_back(round_hull(hand.primitive[i]));
  std::vector<OwnCuts> own(pairs.size());
  std::vector<BorderWay> ways;
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    const auto& [tile, t, cuts] = pairs[i];
    contacts[i].primitive = static_cast<std::uint32_t>(tile);
    contacts[i].triangle = i;
    own[i].slot = i;
    own[i].cut = cuts.cut;
    own[i].bulge.base = hulls[tile].origin;
    for (const bool outer : {false, true}) {
      if (cuts.crossing[outer].exists)
        ways.push_back({i, outer, cuts.crossing[outer].from, cuts.crossing[outer].to});
    }
  }
  follow_borders({world, hand, kernels, contacts}, hulls, ways, own);
  std::vector<Found> result;
  for (const OwnCuts& cuts : own) result.push_back({cuts, {}, {}});
  for (const BorderWay& way : ways) {
    result[way.own].from = way.from;
    result[way.own].to = way.to;
  }
  return result;
}

double height_over(const HalfSpace& space, Vec3 p) {
  return dot(space.normal, p - space.point) - space.offset;
}

// What lies between a chord [m, from the joint] and its border, by brute force: many short pieces, a root of
// precedence at every node and many nodes across.
BulgeMoments brute_bulge(const Primitives& hand, const Primitive& tile, bool outer, Vec3 from, Vec3 to,
                         const Corners& t) {
  Section section;
  Vec3 n;
  if (!normal_of(t, n) || !look_along(tile, t.a, n, t.b - t.a, section)) return {};
  const Kin kin = joint_kin(section, hand, joint_of(tile, outer), outer);
  const Vec3 joint = hand.border[joint_of(tile, outer)].centre, start = to_plane(section, joint + from),
             end = to_plane(section, joint + to);
  const Chord chord = chord_between({start.x, start.y}, {end.x, end.y});
  BulgeMoments bulge;
  bulge.base = tile.end1;
  const int pieces = 100;
  for (int i = 0; i < pieces; ++i) {
    for (const GaussNode& node : kGauss8) {
      const double s = chord.length * (i + node.at) / pieces, limit = 0.3 * chord.length;
      const auto lead = [&](double y) { return precedence(kin, chord.at(s, y)); };
      const double height = find_root(lead, -limit, lead(-limit), limit, lead(limit), 1e-16 * kRadius);
      for (int k = 0; k < 4; ++k) {
        for (const GaussNode& across : kGauss4) {
          const Point2 p = chord.at(s, height * (k + across.at) / 4);
          const double area = chord.length / pieces * node.weight * height * across.weight / 4;
          const double volume = area * field_at(section, p);
          const Vec3 lever = to_world(section, p) - bulge.base;
          bulge.area += area;
          bulge.volume += volume;
          bulge.area_first += area * lever;
          bulge.first += volume * lever;
        }
      }
    }
  }
  return bulge;
}

TEST(BorderLanes, GiveChordsAndBulgesOfOneBorderAtATime) {
  const double square = kRadius * kRadius;
  int crossed = 0, clear = 0, bulges = 0, small = 0, large = 0;
  for (std::uint64_t i = 0; i < 80; ++i) {
    test::Random random(31000 + i);
    const Primitives hand = random_finger(random);
    const std::vector<Crossed> pairs = crossed_by(hand, random, 60);
    const std::vector<Found> found = in_lanes(exact_kernels(Isa::scalar), hand, pairs);
    ASSERT_EQ(found.size(), pairs.size());
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto& [index, t, cuts] = pairs[k];
      const Primitive& tile = hand.primitive[index];
      if (cuts.crossing[0].exists && cuts.crossing[1].exists) continue;
      ++crossed;
      if (!found[k].own.clear) continue;
      ++clear;
      const BulgeMoments& bulge = found[k].own.bulge;
      const TileBorders near = borders_in_reach(hand, tile, t);
      const BorderCut alone = cut_at_borders(exact_kernels(Isa::scalar), hand, tile, near, t);
      if (!alone.crosses) {
        EXPECT_LT(std::fabs(bulge.volume), 1e-12 * square * kRadius) << i << ' ' << k;
        continue;
      }
      ++bulges;
      small += norm(t.b - t.a) < 0.1 * kRadius;
      large += norm(t.b - t.a) > 3 * kRadius;
      const HalfSpace& cut = found[k].own.cut[own_cut(tile, alone.outer)];
      const Vec3 joint = hand.border[joint_of(tile, alone.outer)].centre;
      EXPECT_NEAR(height_over(cut, joint + alone.from), 0, 1e-10 * kRadius) << i << ' ' << k;
      EXPECT_NEAR(height_over(cut, joint + alone.to), 0, 1e-10 * kRadius) << i << ' ' << k;
      const BulgeMoments brute = brute_bulge(hand, tile, alone.outer, found[k].from, found[k].to, t);
      const double off = 4e-9 * std::fabs(brute.area) + 2e-13 * square;
      EXPECT_NEAR(bulge.area, brute.area, off) << i << ' ' << k;
      EXPECT_NEAR(bulge.volume, brute.volume, off * kRadius) << i << ' ' << k;
      const Vec3 shift = brute.base - bulge.base;
      EXPECT_LT(norm(bulge.area_first - (brute.area_first + brute.area * shift)), 3 * off * kRadius)
          << i << ' ' << k;
      EXPECT_LT(norm(bulge.first - (brute.first + brute.volume * shift)), 3 * off * square) << i << ' ' << k;
    }
  }
  EXPECT_GT(clear, 0.78 * crossed);
  EXPECT_GT(bulges, 800);
  EXPECT_GT(small, 100);
  EXPECT_GT(large, 100);
}

TEST(BorderLanes, HaveTheSameBitsWithEveryInstructionSet) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    test::Random random(32000 + i);
    const Primitives hand = random_finger(random);
    const std::vector<Crossed> pairs = crossed_by(hand, random, 60);
    const std::vector<Found> expected = in_lanes(exact_kernels(Isa::scalar), hand, pairs);
    for (const Isa isa : {Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
      if (!available(isa)) continue;
      const std::vector<Found> found = in_lanes(exact_kernels(isa), hand, pairs);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t k = 0; k < found.size(); ++k) {
        const OwnCuts &one = expected[k].own, &other = found[k].own;
        EXPECT_EQ(other.clear, one.clear) << i << ' ' << k;
        if (!one.clear) continue;
        EXPECT_EQ(std::memcmp(&other.cut, &one.cut, sizeof one.cut), 0) << i << ' ' << k;
        EXPECT_EQ(std::memcmp(&other.bulge, &one.bulge, sizeof one.bulge), 0) << i << ' ' << k;
      }
    }
  }
}

}  // namespace
}  // namespace lumbrical
