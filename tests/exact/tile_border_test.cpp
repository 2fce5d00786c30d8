// Neighbouring tiles share out space: over all of them the field law is the integral of the largest field,
// for any lengths, radii and bends, and every tile's share is a smooth function of the pose.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "borders/border_cut.h"
#include "borders/pair_contact.h"
#include "borders/shared_contact.h"
#include "largest.h"
#include "shaped_finger.h"

namespace lumbrical {
namespace {

using namespace test;

// One pair by the way that needs no lanes.
Contact alone(const Primitives& hand, const Primitive& tile, const Corners& t) {
  Contact contact;
  const TileBorders borders = borders_on(hand, tile, t);
  const bool touches = borders.any()
                           ? collide_shared(hand, tile, borders, exact_kernels(Isa::scalar), t, contact)
                           : collide(tile, {1e-4, &hand}, t, contact);
  return touches ? contact : Contact{};
}

Corners random_triangle(const Primitives& hand, test::Random& random) {
  const Primitive& near = hand.capsule[3 + random.bits() % 3];
  const Vec3 middle = near.end1 + random.between(0, 1) * (near.end2 - near.end1) + random.in_box(kRadius);
  const double size = kRadius * std::pow(10, random.between(-1, 1));
  return {middle + size * random.direction(), middle + size * random.direction(),
          middle + size * random.direction()};
}

void expect_reference(const Primitives& hand, const Corners& t, double size, int number, double off = 1e-9) {
  const Felt felt = feel(hand, t);
  const test::FingerReference expected = test::finger_reference(capsules_of(hand), t.a, t.b, t.c);
  const double square = kRadius * kRadius, cube = square * kRadius, lever = kRadius + size;
  EXPECT_NEAR(felt.area / square, expected.area / square, off) << number;
  EXPECT_NEAR(felt.volume / cube, expected.volume / cube, 0.1 * off) << number;
  EXPECT_LT(norm(felt.area_first - expected.area_first) / (square * lever), off) << number;
  EXPECT_LT(norm(felt.first - expected.first) / (cube * lever), 0.1 * off) << number;
}

TEST(TileBorder, TilesOfAnyFingerAddUpToTheLargestFieldOnAnyTriangle) {
  const int count = finger_count(24);
  for (int i = 0; i < count; ++i) {
    test::Random random(static_cast<std::uint64_t>(9000 + i));
    const FingerShape shape = random_finger(random);
    const Primitives hand = posed(shape, random.pose(0.1));
    const Corners t = random_triangle(hand, random);
    expect_reference(hand, t, norm(t.b - t.a), i);
  }
}

// Of 3 to 1000 radii, through a point next to a joint.
Corners wide_triangle(const Primitives& hand, test::Random& random) {
  const Vec3 middle = hand.border[3 + random.bits() % 2].centre + random.in_box(kRadius);
  const Vec3 n = random.direction(), u = unit_or(cross(n, random.direction()), {}), v = cross(n, u);
  const double size = kRadius * std::pow(10, random.between(0.5, 3)), turn = random.between(0, 6.28);
  const auto corner = [&](double at) { return middle + size * (std::cos(at) * u + std::sin(at) * v); };
  return {corner(turn), corner(turn + 2), corner(turn + 4)};
}

TEST(TileBorder, StatesWhatMayBeLostBetweenABorderAndItsChord) {
  // Of 14,000 fingers the one whose bulges are off by most against what all else of their contacts may be.
  test::Random random(285);
  const FingerShape shape = random_finger(random);
  const Primitives hand = posed(shape, random.pose(0.1));
  const Corners t = wide_triangle(hand, random);
  const Felt felt = feel(hand, t);
  const double expected = test::finger_reference(capsules_of(hand), t.a, t.b, t.c).volume;
  EXPECT_LE(std::fabs(felt.volume - expected), felt.error);
  EXPECT_LT(felt.error, 1e-6 * std::pow(kRadius, 3));
}

// Where the phalanges on both sides of a joint are equally deep, on the line between a and b.
std::optional<Vec3> on_border(const Primitives& hand, std::size_t joint, Vec3 a, Vec3 b) {
  const auto capsules = capsules_of(hand);
  const auto lead = [&](Vec3 p) {
    return test::finger_field({capsules[joint]}, p) - test::finger_field({capsules[joint + 1]}, p);
  };
  const bool inner = lead(a) > 0;
  if ((lead(b) > 0) == inner) return {};
  for (int i = 0; i < 60; ++i) {
    const Vec3 middle = 0.5 * (a + b);
    ((lead(middle) > 0) == inner ? a : b) = middle;
  }
  return a;
}

TEST(TileBorder, NothingIsLostWhereABorderEndsInTwoCornersOfATriangle) {
  int compared = 0;
  for (int i = 0; i < 4000; ++i) {
    test::Random random(static_cast<std::uint64_t>(70000 + i));
    const Primitives hand = posed(random_finger(random), random.pose(0.1));
    const std::size_t joint = random.bits() % 2;
    const JointBorder& border = hand.border[3 + joint];
    const Vec3 n = random.direction(), u = unit_or(cross(n, random.direction()), {}), v = cross(n, u);
    const Vec3 middle = border.centre + random.in_box(kRadius);
    const Vec3 along = 3 * kRadius * unit_or(border.normal - dot(border.normal, n) * n, {});
    const double size = kRadius * random.between(0.1, 2), turn = random.between(0, 6.28);
    const auto corner = [&](double at) { return middle + size * (std::cos(at) * u + std::sin(at) * v); };
    const Vec3 first = corner(turn), second = corner(turn + 2);
    const auto a = on_border(hand, joint, first - along, first + along),
               b = on_border(hand, joint, second - along, second + along);
    if (!a || !b) continue;
    const Corners t{*a, *b, corner(turn + 4)};
    const Felt felt = feel(hand, t);
    compared += felt.volume > 0;
    // Beside the corner no chord is an edge.
    const Vec3 off = 1e-9 * kRadius * unit_or(t.a - t.c, {});
    const Felt beside = feel(hand, {t.a + off, t.b, t.c});
    EXPECT_NEAR(felt.volume / std::pow(kRadius, 3), beside.volume / std::pow(kRadius, 3), 1e-7) << i;
  }
  EXPECT_GT(compared, 1000);
}

TEST(TileBorder, StraightAndHyperextendedJointsAndPhalangesOfNoLengthAreNoExceptions) {
  const int count = finger_count(24);
  const double bends[] = {0, 1e-9, 1e-4, 0.5, std::numbers::pi / 2, 2, -1, 2 * std::numbers::pi / 3};
  const double lengths[] = {0, 1e-11, 1e-8, 1e-6};
  for (int i = 0; i < count; ++i) {
    test::Random random(static_cast<std::uint64_t>(70000 + i));
    FingerShape shape = random_finger(random);
    if (i % 4 == 0 || i % 4 == 1)
      shape.bend1 = bends[random.bits() % 8], shape.bend2 = bends[random.bits() % 8];
    if (i % 4 == 1 || i % 4 == 2) shape.radius.fill(kRadius);
    if (i % 4 == 3) shape.length[random.bits() % 3] = lengths[random.bits() % 4];
    if (random.bits() % 2 != 0) shape.sideways = 0;
    const Primitives hand = posed(shape, random.pose(0.1));
    const Corners t = random_triangle(hand, random);
    expect_reference(hand, t, norm(t.b - t.a), i);
  }
}

TEST(TileBorder, FullFistIsTheUnionOfItsPhalanges) {
  // Bent by 115 and 100 degrees the outermost phalanx lies in the innermost one.
  const FingerShape shape{
      {0.030, 0.014, 0.020}, {0.009, 0.008, 0.0075, 0.0065}, 115 * kDegree, 100 * kDegree, 0};
  Primitives hand = posed(shape, joints_of(shape, 0));
  ASSERT_TRUE(hand.folded[1]);
  for (const double height : {-0.012, -0.006, -0.001}) expect_reference(hand, floor_at(height), 1, 0);
  const Corners across{{0.02, -1, -1}, {0.02, 1, -1}, {0.02, 0, 1}};
  expect_reference(hand, across, 1, 1);
  // With neighbours alone, what the outermost and the innermost phalanx share counts twice.
  const double exact = feel(hand, across).area;
  hand.folded.fill(false);
  EXPECT_GT(feel(hand, across).area, 1.05 * exact);
}

TEST(TileBorder, EveryTriangleOfAPlaneIsSharedOutWithoutRest) {
  const FingerShape shape{
      {0.040, 0.025, 0.020}, {0.0103, 0.0088, 0.0076, 0.0066}, 62 * kDegree, 35 * kDegree, 0.05};
  auto joints = joints_of(shape, -0.1);
  for (Vec3& joint : joints) joint += Vec3{-0.03, 0.001, 0.006};
  const Primitives hand = posed(shape, joints);
  const Felt whole = feel(hand, make_plane(0.4, 1));
  expect_reference(hand, floor_at(0), 1, 0);
  int shared = 0;
  for (const std::uint32_t cells : {8u, 25u, 60u, 140u}) {
    const Mesh plane = make_plane(0.4, cells, 1, cells);
    const Felt felt = feel(hand, plane);
    EXPECT_NEAR(felt.volume / whole.volume, 1, 1e-12) << cells;
    EXPECT_NEAR(felt.area / whole.area, 1, 1e-12) << cells;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(felt.share[i] / whole.volume, whole.share[i] / whole.volume, 1e-12) << cells << ' ' << i;
    }
    for (const auto& t : plane.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        shared += borders_on(hand, hand.primitive[i],
                             {plane.vertices[t[0]], plane.vertices[t[1]], plane.vertices[t[2]]})
                      .any();
      }
    }
  }
  EXPECT_GT(shared, 50);
}

TEST(TileBorder, ForceIsContinuousWhileAJointBends) {
  FingerShape shape{{0.020, 0.012, 0.016}, {0.0095, 0.0085, 0.0072, 0.0066}, 0, 0, 0.03};
  const Corners floor = floor_at(-0.004);
  const double step = 0.01 * kDegree;
  Felt last;
  double worst = 0, worst_share = 0, most = 0;
  // The first joint bends, the second a third as far: all of the range, in parts.
  for (const double start : {-30.0, -0.5, 28.0, 59.0, 89.0, 113.0}) {
    for (int i = 0; i <= 600; ++i) {
      shape.bend1 = start * kDegree + step * i;
      shape.bend2 = shape.bend1 / 3;
      const Felt felt = feel(posed(shape, joints_of(shape, 0.4)), floor);
      most = largest(most, felt.volume);
      if (i > 0) {
        // phi changes by no more than the joints move.
        const double motion = step * (shape.length[1] + 4 * shape.length[2] / 3);
        worst =
            largest(worst, std::fabs(felt.volume - last.volume) / (motion * largest(felt.area, last.area)));
        for (std::size_t k = 0; k < 3; ++k) {
          worst_share = largest(worst_share, std::fabs(felt.share[k] - last.share[k]) / step);
        }
      }
      last = felt;
    }
  }
  EXPECT_GT(most, 0.5 * std::pow(0.008, 3));
  EXPECT_LT(worst, 1);
  EXPECT_LT(worst_share, 10 * std::pow(0.0085, 3));
}

TEST(TileBorder, NoWorkIsDoneRoundALoopOverAnEdge) {
  const FingerShape shape{
      {0.030, 0.018, 0.016}, {0.0100, 0.0085, 0.0072, 0.0062}, 70 * kDegree, 25 * kDegree, 0.04};
  const Primitives start = posed(shape, joints_of(shape, 0.6));
  Mesh box = make_box({0.08, 0.09, 0.05}, 1);
  const Vec3 joint = start.capsule[4].end1;
  // The first joint circles an upper edge of the box.
  const int steps = 3000;
  double work = 0, largest = 0;
  const double reach = 0.004;
  for (int i = 0; i < steps; ++i) {
    const double at = 2 * std::numbers::pi * i / steps;
    const Vec3 target =
        Vec3{0.040, 0.003, 0.028} + reach * Vec3{std::cos(at), 0.3 * std::sin(2 * at), std::sin(at)};
    const Vec3 along = reach * Vec3{-std::sin(at), 0.6 * std::cos(2 * at), std::cos(at)};
    const Felt felt = feel(moved(start, target - joint), box);
    work += dot(felt.force, along) * 2 * std::numbers::pi / steps;
    largest = std::fmax(largest, norm(felt.force));
  }
  EXPECT_GT(largest, 0.1 * std::pow(kRadius, 3));
  EXPECT_LT(std::fabs(work), 1e-9 * largest * 2 * std::numbers::pi * reach);
}

TEST(TileBorder, EqualRadiiKeepThePlanesAndTheirBits) {
  FingerShape shape{{0.040, 0.025, 0.020}, {kRadius, kRadius, kRadius, kRadius}, 0, 0, 0};
  const Mesh plane = make_plane(0.2, 12, 1);
  for (const double bend : {0.0, 0.4, 1.5}) {
    shape.bend1 = shape.bend2 = bend;
    const Primitives hand = posed(shape, joints_of(shape, 0.1));
    for (const auto& t : plane.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_FALSE(borders_on(hand, hand.primitive[i],
                                {plane.vertices[t[0]], plane.vertices[t[1]], plane.vertices[t[2]]})
                         .any());
      }
    }
  }
}

TEST(TileBorder, PlanesAreExactWhereTheBorderDoesNotMatter) {
  int plain = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    test::Random random(500 + i);
    const FingerShape shape = random_finger(random);
    const Primitives hand = posed(shape, random.pose(0.1));
    Primitives doubtful = hand;  // every border is looked at everywhere
    for (JointBorder& border : doubtful.border) {
      border.shared = true;
      border.near = false;
      border.reach = border.slab = 1;
    }
    for (Primitive& tile : doubtful.primitive) tile.overhang = {1, 1};
    const Corners t = random_triangle(hand, random);
    for (std::size_t k = 0; k < 3; ++k) {
      const TileBorders everywhere{k > 0, k < 2, k != 1 && hand.folded[1]};
      const Primitive& tile = hand.primitive[k];
      if (borders_on(hand, tile, t).any()) continue;
      Contact quick, slow;
      const bool touches = collide(tile, {1e-4, &hand}, t, quick);
      if (!collide_shared(doubtful, doubtful.primitive[k], everywhere, exact_kernels(Isa::scalar), t, slow))
        slow = {};
      if (!touches) quick = {};
      EXPECT_NEAR(quick.volume / std::pow(kRadius, 3), slow.volume / std::pow(kRadius, 3), 1e-10)
          << i << ' ' << k;
      EXPECT_NEAR(quick.area / std::pow(kRadius, 2), slow.area / std::pow(kRadius, 2), 1e-9) << i << ' ' << k;
      plain += touches;
    }
  }
  EXPECT_GT(plain, 50);
}

TEST(TileBorder, LanesAndBulgesGiveWhatOnePairAloneGives) {
  int cut = 0, curved = 0, gone = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    test::Random random(21000 + i);
    FingerShape shape = random_finger(random);
    for (double& length : shape.length) length = kRadius * random.between(1.5, 6);
    if (i % 2 == 0) shape.bend1 *= 0.6, shape.bend2 *= 0.6;
    const Primitives hand = posed(shape, random.pose(0.1));
    std::vector<Corners> triangles;
    for (int k = 0; k < 20; ++k) triangles.push_back(random_triangle(hand, random));
    std::vector<Contact> found(60);
    for (const Contact& contact : contacts_of(hand, mesh_of(triangles)))
      found[20 * contact.primitive + contact.triangle] = contact;
    for (std::size_t pair = 0; pair < 60; ++pair) {
      const Primitive& tile = hand.primitive[pair / 20];
      const Corners& t = triangles[pair % 20];
      const Contact& seen = found[pair];
      const Contact expected = alone(hand, tile, t);
      EXPECT_NEAR(seen.volume, expected.volume, 1e-10 * std::pow(kRadius, 3)) << i << ' ' << pair;
      EXPECT_NEAR(seen.area, expected.area, 1e-9 * std::pow(kRadius, 2)) << i << ' ' << pair;
      const Vec3 off = seen.volume * (seen.centre - t.a) - expected.volume * (expected.centre - t.a);
      EXPECT_LT(norm(off), 1e-9 * std::pow(kRadius, 4)) << i << ' ' << pair;
      const BorderCut how =
          cut_at_borders(exact_kernels(Isa::scalar), hand, tile, borders_in_reach(hand, tile, t), t);
      cut += how.kind == CutKind::other;
      curved += how.kind == CutKind::other && how.crosses;
      gone += how.kind == CutKind::gone;
    }
  }
  EXPECT_GT(cut, 1000);
  EXPECT_GT(curved, 300);
  EXPECT_GT(gone, 50);
}

TEST(TileBorder, TriangleInThePlaneBetweenTwoTilesCountsOnce) {
  FingerShape shape{{0.040, 0.025, 0.020}, {kRadius, kRadius, kRadius, kRadius}, 0, 0, 0};
  for (std::uint64_t i = 0; i < 16; ++i) {
    test::Random random(8000 + i);
    shape.bend1 = i % 4 == 0 ? 0 : random.between(-0.3, 1.5);
    for (std::size_t k = 1; k < 4; ++k)
      shape.radius[k] = kRadius * (i % 2 == 0 ? 1 : random.between(0.8, 1.2));
    const Primitives hand = i % 8 == 0 ? posed(shape, joints_of(shape, 0)) : posed(shape, random.pose(0.1));
    const HalfSpace& cut = hand.primitive[0].cut[0];
    const Vec3 u = unit_or(cross(cut.normal, random.direction()), {1, 0, 0}), v = cross(cut.normal, u);
    Corners t{cut.point - 0.02 * u - 0.011 * v, cut.point + 0.03 * u - 0.015 * v,
              cut.point + 0.001 * u + 0.02 * v};
    const Felt front = feel(hand, t);
    expect_reference(hand, t, 0.05, static_cast<int>(i));
    std::swap(t.b, t.c);
    const Felt back = feel(hand, t);
    EXPECT_NEAR(back.volume / front.volume, 1, 1e-9) << i;
    EXPECT_GT(front.area, 1.5 * kRadius * kRadius) << i;
    // Seen from the other side it is the other tile's.
    if (i % 8 == 0) {
      EXPECT_EQ((front.share[0] > 0) + (front.share[1] > 0), 1) << i;
      EXPECT_NE(front.share[0] > 0, back.share[0] > 0) << i;
    }
  }
}

TEST(TileBorder, OtherLawsKeepThePlanes) {
  test::Random random(3);
  const FingerShape shape = random_finger(random);
  const Corners floor = floor_at(0);
  for (const Law law : {Law::column, Law::max_depth, Law::centroid, Law::point}) {
    const Primitives hand = posed(shape, joints_of(shape, 0), law);
    for (std::size_t i = 0; i < hand.count; ++i) {
      EXPECT_FALSE(borders_on(hand, hand.primitive[i], floor).any());
    }
  }
}

TEST(TileBorder, FingersNoHandHasAreSharedOutNearlyAsWell) {
  // Phalanges of no length, one sphere inside the next, a finger folded back exactly onto itself, where two
  // tiles are one but for rounding.
  const double r = kRadius;
  const FingerShape shapes[] = {
      {{r, 0, r}, {r, r, r, r}, 1, 1, 0},
      {{0.2 * r, 0.2 * r, 0.2 * r}, {r, 0.5 * r, 1.5 * r, r}, 1, 1, 0},
      {{0.2 * r, 3 * r, 0.2 * r}, {1.5 * r, r, r, 1.5 * r}, 1, 1, 0},
      {{3 * r, 3 * r, 3 * r}, {r, 0.8 * r, r, 0.8 * r}, std::numbers::pi, std::numbers::pi, 0},
      {{2 * r, r, 2 * r}, {r, 1.2 * r, 0.9 * r, r}, 3.1, 3.1, 0},
      {{3 * r, 2.9 * r, 3 * r}, {r, r, r, r}, 0, std::numbers::pi, 0}};
  int number = 0;
  for (const FingerShape& shape : shapes) {
    const Primitives hand = posed(shape, joints_of(shape, 0.3));
    for (const double height : {0.0, 0.003}) {
      const Felt felt = feel(hand, floor_at(height));
      EXPECT_TRUE(is_finite(felt.volume) && is_finite(felt.area) && is_finite(felt.first)) << number;
      expect_reference(hand, floor_at(height), 1, number, 1e-4);
    }
    ++number;
  }
}

}  // namespace
}  // namespace lumbrical
