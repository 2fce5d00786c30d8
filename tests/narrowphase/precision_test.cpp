// The ladder of precision: every rung stays within the bound it states, and every instruction set gives the
// same bits on every rung.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "random.h"
#include "section/pressure_rules.h"
#include "session.h"
#include "stages/narrowphase.h"

namespace lumbrical::test {
namespace {

struct Pair {
  Primitive primitive;
  Vec3 a, b, c;
};

// A sphere, capsule or rounded cone and a triangle near it, from a hundredth of R to thirty R in size.
Pair random_pair(Random& random, int shape) {
  Pair pair;
  const double r = 0.008;
  Primitive& p = pair.primitive;
  p.law = Law::field;
  p.radius1 = r;
  p.radius2 = shape == 2 ? random.between(0.7, 1.0) * r : r;
  p.end1 = random.in_box(0.1);
  p.end2 = p.end1 + (shape == 0 ? 0.0 : random.between(0.5, 4) * r) * random.direction();
  const double size = r * std::pow(10.0, random.between(-2, 1.5));
  const Vec3 near =
      p.end1 + random.between(0, 1) * (p.end2 - p.end1) + random.between(0, 1) * r * random.direction();
  pair.a = near + size * random.direction();
  pair.b = near + size * random.direction();
  pair.c = near + size * random.direction();
  return pair;
}

TEST(Precision, EveryRungStaysWithinTheBoundItStates) {
  Random random(11);
  Boundary boundary;
  int cheaper = 0;
  for (int i = 0; i < 6000; ++i) {
    const Pair pair = random_pair(random, i % 3);
    Contact exact;
    if (!collide(pair.primitive, {}, pair.a, pair.b, pair.c, boundary, exact)) continue;
    const double r = pair.primitive.radius1;
    EXPECT_LE(exact.error, kBoundaryError * r * r * r);
    for (const double tolerance : {1e-11, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
      ContactQuery query;
      query.tolerance = tolerance;
      Contact contact;
      ASSERT_TRUE(collide(pair.primitive, query, pair.a, pair.b, pair.c, boundary, contact));
      EXPECT_LE(std::fabs(contact.volume - exact.volume), contact.error + exact.error)
          << "pair " << i << ", tolerance " << tolerance;
      const double around = norm(pair.b - pair.a) + norm(pair.c - pair.b) + norm(pair.a - pair.c);
      EXPECT_LE(contact.error,
                std::max(1.0001 * tolerance * r * contact.area + 1e-15 * r * r * around, exact.error));
      cheaper += contact.error > exact.error ? 1 : 0;
    }
  }
  EXPECT_GT(cheaper, 1000);
}

// A hand of capsules, so that both ways of integrating are used (the palm's fingers keep their radii).
Scene hand_of_capsules(double tolerance) {
  Scene scene = mug_scene(Law::field);
  for (double& radius : scene.hand.radius) radius = 0.008;
  scene.settings.tolerance = tolerance;
  return scene;
}

TEST(Precision, TheTickStatesHowFarItsForcesMayBeOff) {
  const Scene exact_scene = hand_of_capsules(0);
  const Scene coarse_scene = hand_of_capsules(1e-2);
  const Model exact = model_of(exact_scene), coarse = model_of(coarse_scene);
  Scratch exact_scratch = make_scratch(exact), coarse_scratch = make_scratch(coarse);
  State exact_state, coarse_state;
  double largest = 0;
  for (const DeviceFrame& frame : grasp_frames(exact_scene.hand, 40)) {
    const ActuatorFrame wanted = tick(exact, exact_state, exact_scratch, frame);
    const ActuatorFrame got = tick(coarse, coarse_state, coarse_scratch, frame);
    // Triangle by triangle in one, whole clusters in the other: what they have in common are the primitives.
    std::array<Vec3, Primitives::kMaxCount> off{};
    for (std::uint32_t i = 0; i < wanted.contact_count; ++i) {
      const Contact& contact = exact_scratch.contacts[i];
      off[contact.primitive] -= contact.volume * contact.normal;
    }
    for (std::uint32_t i = 0; i < got.contact_count; ++i) {
      const Contact& contact = coarse_scratch.contacts[i];
      off[contact.primitive] += contact.volume * contact.normal;
    }
    double difference = 0;
    for (const Vec3 d : off) difference += norm(d);
    difference *= exact_scene.settings.stiffness;
    EXPECT_LE(got.contact_count, wanted.contact_count);
    EXPECT_LE(difference, got.force_error + wanted.force_error);
    largest = std::max(largest, difference);
  }
  EXPECT_GT(largest, 1e-6);
}

std::uint64_t bits_of_run(const Scene& scene, Isa isa, const std::vector<DeviceFrame>& frames) {
  Execution execution;
  execution.isa = isa;
  return hash_run(model_of(scene, execution), frames);
}

TEST(Precision, EveryInstructionSetGivesTheSameBits) {
  for (const double tolerance : {0.0, 1e-4}) {
    for (const Scene& scene : {mug_scene(Law::field), hand_of_capsules(tolerance)}) {
      const auto frames = grasp_frames(scene.hand, 30);
      const std::uint64_t expected = bits_of_run(scene, Isa::scalar, frames);
      for (const Isa isa : {Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
        if (!available(isa)) continue;
        EXPECT_EQ(bits_of_run(scene, isa, frames), expected) << isa_name(isa) << ", tolerance " << tolerance;
      }
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
