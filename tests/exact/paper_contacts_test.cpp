// The kernel that computes contacts under the paper's laws in lanes, and the depth through the finger after
// it, against the general path.
#include <gtest/gtest.h>

#include "borders/general_contact.h"
#include "mesh_world.h"
#include "pose_hand.h"
#include "posed_finger.h"
#include "random_pairs.h"
#include "section/depth.h"
#include "stages/narrowphase.h"

namespace lumbrical::test {
namespace {

// What became of pairs.
struct Found {
  int touching = 0, unclear = 0;
};

void expect_agreement(const Pair& pair, Isa isa, Found& found) {
  const ExactKernels& kernels = exact_kernels(isa);
  const RoundHull hull = round_hull(pair.primitive);
  const RoundKind kind = kind_of(kernels, hull, seen_from(hull.origin, pair.at));
  std::vector<double> status;
  Contact contact = through(kernels.paper_contacts, kind, std::span(&pair, 1), status)[0], general;
  if (status[0] == kUnclear) {
    ++found.unclear;
    return;
  }
  const double r = kPairRadius, area = r * r;
  Primitive primitive = pair.primitive;
  primitive.law = Law::max_depth;
  const bool expected = general_contact(primitive, {}, pair.at, general);
  if ((status[0] == kContact) != expected) {
    EXPECT_LT(expected ? general.area : contact.area, 1e-12 * area);
    return;
  }
  if (!expected) return;
  ++found.touching;
  EXPECT_NEAR(contact.area, general.area, 1e-11 * area);
  EXPECT_LT(norm(hull.origin + contact.centroid - general.centroid) * general.area, 1e-11 * area * r);
  EXPECT_LT(norm(contact.normal - general.normal), 1e-11);  // of slivers
  EXPECT_NEAR(contact.depth, general.depth, 1e-11 * r);
  // Points that are equally deep there may be many of; as deep as it says it has to be.
  Section section;
  ASSERT_TRUE(look_from_plane(pair.primitive, pair.at, section));
  const Vec3 deepest = hull.origin + contact.centre - section.origin;
  const Point2 at{dot(deepest, section.u), dot(deepest, section.v)};
  EXPECT_NEAR(dot(deepest, section.n), -section.h1, 1e-11 * r);
  EXPECT_TRUE(!inside_section(section, at) ||
              std::fabs(max(0, depth_at(section, at)) - contact.depth) < 1e-11 * r);
}

Found expect_agreement_of_all(Pair (*make)(Random&, int), int first_shape, int count, Isa isa) {
  Random random(7);
  Found found;
  for (int shape = first_shape; shape < 3; ++shape) {
    for (int i = 0; i < count; ++i) expect_agreement(make(random, shape), isa, found);
  }
  return found;
}

TEST(PaperContacts, OfEveryShapeAndPoseAreThoseOfTheGeneralPath) {
  const Found any = expect_agreement_of_all(any_pair, 0, 3000, Isa::scalar);
  EXPECT_GT(any.touching, 4000);
  EXPECT_LT(any.unclear, 300);
  const Found square = expect_agreement_of_all(square_pair, 0, 3000, widest_isa());
  EXPECT_GT(square.touching, 1000);
  const Found flat = expect_agreement_of_all(flat_pair, 1, 6000, widest_isa());
  EXPECT_GT(flat.touching, 4000);
}

TEST(PaperContacts, AreTheSameWhateverSharesTheirRegister) {
  Random random(42);
  for (int shape = 0; shape < 3; ++shape) {
    std::vector<Pair> pairs;
    for (int i = 0; i < 1000; ++i) pairs.push_back(any_pair(random, shape));
    const RoundKind kind{shape == 0, shape == 2, RoundZone::inner, true};
    const std::vector<double> status = expect_same_alone(&ExactKernels::paper_contacts, kind, pairs);
    EXPECT_GT(std::count(status.begin(), status.end(), kContact), 300);
  }
}

// A finger bent anyhow, with joints of any size.
Primitives any_finger(Random& random, Law law) {
  Hand hand = plain_hand(kPairRadius);
  std::array<Vec3, 4> joint{random.in_box(0.02)};
  for (std::size_t i = 0; i < 4; ++i) hand.radius[kIndexProximal + i] = random.between(0.6, 1) * kPairRadius;
  double angle = random.between(-1, 1);
  for (std::size_t i = 0; i < 3; ++i, angle -= random.between(-0.3, 1.5))
    joint[i + 1] = joint[i] + random.between(0.012, 0.04) * Vec3{std::cos(angle), 0, std::sin(angle)};
  Settings settings;
  settings.law.fill(law);
  Primitives primitives;
  pose_hand(hand, settings, finger_frame(joint), primitives);
  return primitives;
}

TEST(PaperContacts, OfAFingerAreThoseOfTheGeneralPathThroughAllPhalanges) {
  constexpr double kPointArea = 1e-4;
  Random random(8);
  int touching = 0;
  for (int round = 0; round < 150; ++round) {
    const Law law = round % 3 == 0 ? Law::point : Law::max_depth;
    Model model;
    model.settings.point_area = kPointArea;
    const Primitives hand = any_finger(random, law);
    Mesh mesh;
    std::vector<std::uint64_t> candidates;
    for (std::uint32_t part = 0; part < hand.count; ++part) {
      const Primitive& p = hand.primitive[part];
      for (int i = 0; i < 20; ++i) {
        const double size = kPairRadius * std::pow(10.0, random.between(-1.5, 1.5));
        const Vec3 near = p.end1 + random.between(0, 1) * (p.end2 - p.end1) +
                          random.between(0, 1) * kPairRadius * random.direction();
        candidates.push_back(std::uint64_t{part} << 32 | mesh.triangles.size());
        add_triangle(near + size * random.direction(), near + size * random.direction(),
                     near + size * random.direction(), mesh);
      }
    }
    model.triangles = world_of(mesh);
    std::vector<Contact> contacts(candidates.size());
    contacts.resize(collide_pairs(model, hand, candidates, contacts));
    for (const Contact& contact : contacts) {
      Contact general = contact;
      hand_contact(hand, exact_kernels(Isa::scalar), kPointArea,
                   corners_of(model.triangles, contact.triangle), general);
      if (!(general.area > 1e-12 * kPairRadius * kPairRadius)) continue;
      ++touching;
      EXPECT_NEAR(contact.area, general.area, 1e-11 * kPairRadius * kPairRadius);
      EXPECT_NEAR(contact.depth, general.depth, 1e-10 * kPairRadius);
      const double most = law == Law::point ? kPointArea : general.area;
      EXPECT_NEAR(contact.volume, general.volume, 1e-11 * kPairRadius * (most + kPairRadius * kPairRadius));
      EXPECT_EQ(contact.error, 0);
    }
  }
  EXPECT_GT(touching, 5000);
}

}  // namespace
}  // namespace lumbrical::test
