// The kernel that computes contacts of spheres, capsules and rounded cones in lanes, against the general
// path, and instruction sets against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "borders/pair_contact.h"
#include "mesh_world.h"
#include "random_pairs.h"
#include "stages/narrowphase.h"

namespace lumbrical::test {
namespace {

void expect_agreement(const Pair& pair, Isa isa, int& touching) {
  Contact contact, general;
  const bool expected = general_contact(pair.primitive, {}, pair.at, general);
  const ContactQuery in_lanes{1e-4, nullptr, exact_kernels(isa)};
  const bool touches = collide(pair.primitive, in_lanes, pair.at, contact);
  const double r = kPairRadius, area = r * r, volume = r * r * r;
  if (touches != expected) {
    EXPECT_LT(touches ? contact.area : general.area, 1e-12 * area);
    return;
  }
  if (!touches) return;
  ++touching;
  EXPECT_NEAR(contact.area, general.area, 1e-11 * area);
  EXPECT_NEAR(contact.volume, general.volume, 2e-10 * volume);  // the quadrature's, mostly
  EXPECT_LT(norm(contact.centre - general.centre) * general.volume, 2e-10 * volume * r);
  EXPECT_LT(norm(contact.centroid - general.centroid) * general.area, 1e-11 * area * r);
  EXPECT_NEAR(contact.depth, general.depth, 1e-11 * r);
  EXPECT_LT(norm(contact.normal - general.normal), 1e-11);  // of slivers
}

TEST(RoundContacts, OfEveryShapeAndPoseAgreeWithTheBoundaryQuadrature) {
  Random random(3);
  for (int shape = 0; shape < 3; ++shape) {
    int touching = 0;
    for (int i = 0; i < 3000; ++i) expect_agreement(any_pair(random, shape), Isa::scalar, touching);
    EXPECT_GT(touching, 1000);
  }
}

TEST(RoundContacts, OfAxesExactlyAcrossAndAlongAgreeWithTheBoundaryQuadrature) {
  Random random(4);
  for (int shape = 0; shape < 3; ++shape) {
    int touching = 0;
    for (int i = 0; i < 3000; ++i) expect_agreement(square_pair(random, shape), widest_isa(), touching);
    EXPECT_GT(touching, 300);
  }
}

TEST(RoundContacts, OfAxesNearlyAlongThePlaneAgreeWithTheBoundaryQuadrature) {
  Random random(6);
  for (int shape = 1; shape < 3; ++shape) {
    int touching = 0;
    for (int i = 0; i < 6000; ++i) expect_agreement(flat_pair(random, shape), Isa::scalar, touching);
    EXPECT_GT(touching, 2000);
  }
}

// A whole scene of pairs, so that registers hold pairs of every kind side by side.
std::vector<Contact> contacts_of(Isa isa) {
  Random random(5);
  Model model;
  Primitives hand;
  Mesh mesh;
  std::vector<std::uint64_t> candidates;
  model.execution.isa = isa;
  for (int part = 0; part < 6; ++part) {
    hand.primitive[hand.count++] = random_part(random, part % 3, random.direction());
    const Primitive& p = hand.primitive[static_cast<std::size_t>(part)];
    for (int i = 0; i < 500; ++i) {
      const double size = kPairRadius * std::pow(10.0, random.between(-2.5, 1.5));
      const Vec3 near = p.end1 + random.between(0, 1) * (p.end2 - p.end1) +
                        random.between(0, 1) * kPairRadius * random.direction();
      const Vec3 a = near + size * random.direction(), b = near + size * random.direction(),
                 c = near + size * random.direction();
      candidates.push_back(static_cast<std::uint64_t>(part) << 32 | mesh.triangles.size());
      add_triangle(a, b, c, mesh);
    }
  }
  model.triangles = world_of(mesh);
  std::vector<Contact> contacts(candidates.size());
  contacts.resize(collide_pairs(model, hand, candidates, contacts));
  return contacts;
}

TEST(RoundContacts, AreTheSameToTheLastBitWithEveryInstructionSet) {
  const std::vector<Contact> expected = contacts_of(Isa::scalar);
  EXPECT_GT(expected.size(), 1000u);
  for (const Isa isa : {Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
    if (!available(isa)) continue;
    const std::vector<Contact> got = contacts_of(isa);
    ASSERT_EQ(got.size(), expected.size()) << isa_name(isa);
    EXPECT_EQ(std::memcmp(got.data(), expected.data(), got.size() * sizeof(Contact)), 0) << isa_name(isa);
  }
}

TEST(RoundContacts, OfATriangleBetweenTwoTilesCountOnce) {
  Primitive left, right;
  for (Primitive* part : {&left, &right}) {
    part->law = Law::field;
    part->radius1 = part->radius2 = kPairRadius;
    part->end2 = {0.03, 0, 0};
    part->cut_count = 1;
  }
  left.end1 = {0, 0, 0};
  right.end1 = {0.03, 0, 0};
  right.end2 = {0.05, 0.01, 0};
  const Vec3 normal = Vec3{0.8, 0.6, 0};
  left.cut[0] = {normal, {0.03, 0, 0}};
  right.cut[0] = {-1.0 * normal, {0.03, 0, 0}};
  const Vec3 along{-0.6, 0.8, 0}, up{0, 0, 1}, base{0.03, 0, 0};
  const Vec3 a = base - 0.001 * along, b = base + 0.002 * along, c = base + 0.001 * up;
  for (const bool turned : {false, true}) {
    int felt = 0;
    for (const Primitive& part : {left, right}) {
      Contact contact;
      felt += collide(part, {}, {a, turned ? c : b, turned ? b : c}, contact) ? 1 : 0;
    }
    EXPECT_EQ(felt, 1);
  }
}

TEST(RoundContacts, AreTheSameWhateverSharesTheirRegister) {
  Random random(41);
  for (const bool flat : {false, true}) {
    for (int shape = 1; shape < 3; ++shape) {
      std::vector<Pair> pairs;
      while (pairs.size() < 1000) {
        const Pair pair = flat ? flat_pair(random, shape) : any_pair(random, shape);
        const RoundHull hull = round_hull(pair.primitive);
        const Corners at = seen_from(hull.origin, pair.at);
        if ((kind_of(exact_kernels(Isa::scalar), hull, at).zone == RoundZone::flat) == flat)
          pairs.push_back(pair);
      }
      const RoundKind kind{false, shape == 2, flat ? RoundZone::flat : RoundZone::inner};
      const std::vector<double> status = expect_same_alone(&ExactKernels::round_contacts, kind, pairs);
      std::vector<Pair> slivers;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (status[i] == kSlivers) slivers.push_back(pairs[i]);
      }
      EXPECT_GT(std::count(status.begin(), status.end(), kContact), 100);
      EXPECT_TRUE(shape == 1 || slivers.size() > 50);
      expect_same_alone(&ExactKernels::cone_slivers, kind, slivers);
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
