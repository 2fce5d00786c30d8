// The kernel that computes contacts of spheres, capsules and rounded cones in lanes, against the general
// path, and instruction sets against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "exact/round_pairs.h"
#include "exact/through_lanes.h"
#include "mesh_world.h"
#include "random.h"
#include "stages/narrowphase.h"

namespace lumbrical::test {
namespace {

struct Pair {
  Primitive primitive;
  Corners at;
};

constexpr double kRadius = 0.008;

Primitive random_part(Random& random, int shape, Vec3 direction) {
  Primitive part;
  part.law = Law::field;
  part.radius1 = kRadius;
  part.radius2 = shape == 2 ? random.between(0.6, 1.0) * kRadius : kRadius;
  part.end1 = random.in_box(0.1);
  part.end2 = part.end1 + (shape == 0 ? 0.0 : random.between(0.5, 4) * kRadius) * direction;
  if (random.between(0, 1) < 0.5) return part;
  part.cut_count = static_cast<std::uint8_t>(1 + random.below(3));
  for (HalfSpace& cut : part.cut) {
    cut.normal = random.direction();
    cut.point = &cut == part.cut.data() ? part.end1 : part.end2;
  }
  return part;
}

// Triangles of a hundredth of R to thirty R that lie anyhow.
Pair any_pair(Random& random, int shape) {
  Pair pair{random_part(random, shape, random.direction()), {}};
  const Primitive& p = pair.primitive;
  const double size = kRadius * std::pow(10.0, random.between(-2, 1.5));
  const Vec3 near =
      p.end1 + random.between(0, 1) * (p.end2 - p.end1) + random.between(0, 1) * kRadius * random.direction();
  for (Vec3* corner : {&pair.at.a, &pair.at.b, &pair.at.c}) *corner = near + size * random.direction();
  return pair;
}

// Planes exactly across and exactly along the axis, near either end.
Pair square_pair(Random& random, int shape) {
  const Vec3 axis[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
  Pair pair{random_part(random, shape, axis[static_cast<std::size_t>(random.between(0, 4)) % 4]), {}};
  const Primitive& p = pair.primitive;
  const double size = kRadius * std::pow(10.0, random.between(-2, 1.5));
  Vec3 near = random.between(0, 1) < 0.5 ? p.end1 : p.end2;
  near += Vec3{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)} * kRadius;
  for (Vec3* corner : {&pair.at.a, &pair.at.b, &pair.at.c}) {
    const Vec3 d = random.direction();
    *corner = near + size * Vec3{d.x, d.y, 0};
  }
  return pair;
}

// Planes within a quarter of a degree of the axis, at every depth.
Pair flat_pair(Random& random, int shape) {
  const Vec3 along = random.direction(), n = unit_or(cross(along, random.direction()), {1, 0, 0});
  const double tilt = std::pow(10.0, random.between(-12, -2.4));
  Pair pair{random_part(random, shape, unit_or(along + tilt * n, along)), {}};
  const Primitive& p = pair.primitive;
  const double size = kRadius * std::pow(10.0, random.between(-1.5, 1.5));
  const Vec3 v = cross(n, along);
  const Vec3 near = p.end1 + random.between(-0.2, 1.2) * (p.end2 - p.end1) +
                    kRadius * (random.between(-1, 1) * n + random.between(-1, 1) * v);
  for (Vec3* corner : {&pair.at.a, &pair.at.b, &pair.at.c})
    *corner = near + size * (random.between(-1, 1) * along + random.between(-1, 1) * v);
  return pair;
}

void expect_agreement(const Pair& pair, Isa isa, int& touching) {
  Boundary boundary;
  Contact contact, general;
  ContactQuery query;
  const bool expected = [&] {
    Primitive aside = pair.primitive;
    aside.law = Law::column;  // keeps it from the kernel; the law asked for stays the query's
    return collide(aside, query, pair.at, boundary, general);
  }();
  const ContactQuery in_lanes{Law::field, 1e-4, nullptr, field_kernels(isa)};
  const bool touches = collide(pair.primitive, in_lanes, pair.at, boundary, contact);
  const double r = kRadius, area = r * r, volume = r * r * r;
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
      const double size = kRadius * std::pow(10.0, random.between(-2.5, 1.5));
      const Vec3 near = p.end1 + random.between(0, 1) * (p.end2 - p.end1) +
                        random.between(0, 1) * kRadius * random.direction();
      const Vec3 a = near + size * random.direction(), b = near + size * random.direction(),
                 c = near + size * random.direction();
      candidates.push_back(static_cast<std::uint64_t>(part) << 32 | mesh.triangles.size());
      add_triangle(a, b, c, mesh);
    }
  }
  model.triangles = world_of(mesh);
  std::vector<Contact> contacts(candidates.size());
  contacts.resize(find_contacts(model, hand, candidates, contacts));
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
    part->radius1 = part->radius2 = kRadius;
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
  Boundary boundary;
  for (const bool turned : {false, true}) {
    int felt = 0;
    for (const Primitive& part : {left, right}) {
      Contact contact;
      felt += collide(part, {}, {a, turned ? c : b, turned ? b : c}, boundary, contact) ? 1 : 0;
    }
    EXPECT_EQ(felt, 1);
  }
}

// Pairs of one kind through a kernel, a group at a time; of each what is found.
std::vector<Contact> through(void (*kernel)(RoundTerms&), RoundKind kind, std::span<const Pair> pairs,
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
std::vector<double> expect_same_alone(void (*FieldKernels::*kernel)(RoundTerms&), RoundKind kind,
                                      std::span<const Pair> pairs) {
  std::vector<double> status, alone_status;
  const std::vector<Contact> contacts = through(field_kernels(widest_isa()).*kernel, kind, pairs, status);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Contact alone =
        through(field_kernels(Isa::scalar).*kernel, kind, pairs.subspan(i, 1), alone_status)[0];
    EXPECT_EQ(status[i], alone_status[0]) << i;
    const bool found = status[i] == kContact || status[i] == kSlivers;
    const bool sliver = kernel == &FieldKernels::cone_slivers;
    EXPECT_TRUE(!found || (alone.volume == contacts[i].volume && alone.centre == contacts[i].centre)) << i;
    EXPECT_TRUE(!found || sliver || std::memcmp(&alone, &contacts[i], sizeof alone) == 0) << i;
  }
  return status;
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
        if ((kind_of(field_kernels(Isa::scalar), hull, at).zone == RoundZone::flat) == flat)
          pairs.push_back(pair);
      }
      const RoundKind kind{false, shape == 2, flat ? RoundZone::flat : RoundZone::inner};
      const std::vector<double> status = expect_same_alone(&FieldKernels::round_contacts, kind, pairs);
      std::vector<Pair> slivers;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (status[i] == kSlivers) slivers.push_back(pairs[i]);
      }
      EXPECT_GT(std::count(status.begin(), status.end(), kContact), 100);
      EXPECT_TRUE(shape == 1 || slivers.size() > 50);
      expect_same_alone(&FieldKernels::cone_slivers, kind, slivers);
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
