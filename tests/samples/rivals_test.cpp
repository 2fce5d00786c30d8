// Which parts of a posed hand share space with parts of other bodies: against points strewn over the hand.
#include "samples/rivals.h"

#include <gtest/gtest.h>

#include "exact/finger_reference.h"
#include "model/primitive.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

constexpr double kNowhere = -1;

// The fields of all parts at a point, by their numbers.
std::array<double, Bodies::kMostParts> fields_at(const Primitives& hand, const Bodies& bodies, Vec3 p) {
  std::array<double, Bodies::kMostParts> field;
  field.fill(kNowhere);
  for (std::size_t i = 0; i < bodies.finger_count; ++i) {
    for (std::size_t k = 0; k < bodies.finger[i].tile_count; ++k) {
      const Primitive& phalanx = hand.capsule[bodies.finger[i].segment[k]];
      field[i * Bodies::kTilesApart + k] =
          finger_field({{phalanx.end1, phalanx.end2, phalanx.radius1, phalanx.radius2}}, p);
    }
  }
  const SweptPolygon& palm = hand.palm;
  const double height = dot(p - palm.corner[0], palm.normal);
  double beyond = 0;  // the farthest edge: beyond a corner the polygon is farther away
  for (std::size_t i = 0; i < palm.corner_count; ++i) {
    beyond = std::max(beyond, dot(p - palm.corner[i], palm.outward[i]));
  }
  field[palm_number(bodies)] = palm.radius - std::hypot(height, beyond);
  return field;
}

TEST(Rivals, AreAllPartsOfDifferentBodiesThatHaveAPointInCommon) {
  const Hand hand = default_hand(Side::right);
  const Model model = model_at(sampled_scene(hand, {{"plane", make_plane(0.3, 4)}}), 1e-4);
  Scratch scratch = make_scratch(model);
  Random random(31);
  std::size_t pairs = 0, farther = 0;
  for (int pose = 0; pose < 40; ++pose) {
    State state;
    tick(model, state, scratch, dropped_hand(hand, random, 0, pose % 2 == 0 ? 0.3 : 1.6, 0.2, 0.005, 0.02));
    const Primitives& posed = *scratch.primitives;
    const Bodies& bodies = scratch.samples->bodies;
    Rivals rivals(posed, bodies);
    std::array<std::uint64_t, Bodies::kMostParts> met{};
    for (int i = 0; i < 20000; ++i) {
      const auto phalanx = static_cast<std::size_t>(random.between(0, 14.999));
      const Primitive& by = posed.capsule[phalanx];
      const auto aside = [&] { return random.between(-1.2, 1.2) * by.radius1; };
      const Vec3 p =
          by.end1 + random.between(-0.2, 1.2) * (by.end2 - by.end1) + Vec3{aside(), aside(), aside()};
      const auto field = fields_at(posed, bodies, p);
      for (std::size_t a = 0; a < field.size(); ++a) {
        if (field[a] <= 0) continue;
        for (std::size_t b = 0; b < field.size(); ++b) {
          if (field[b] > 0 && body_of(a) != body_of(b)) met[a] |= std::uint64_t{1} << b;
        }
      }
    }
    for_numbers(parts_of(bodies), [&](std::size_t a) {
      EXPECT_EQ(met[a] & ~rivals.of(a), 0u) << "part " << a << " in pose " << pose;
      EXPECT_EQ(rivals.of(a) >> body_of(a) * Bodies::kTilesApart & 15u, 0u);
      for_numbers(rivals.of(a), [&](std::size_t b) { EXPECT_NE(rivals.of(b) >> a & 1u, 0u); });
      pairs += static_cast<std::size_t>(__builtin_popcountll(met[a]));
      farther += static_cast<std::size_t>(__builtin_popcountll(rivals.of(a) & ~met[a]));
    });
  }
  EXPECT_GT(pairs, 400u);
  EXPECT_LT(farther, pairs);  // a tenth of a radius apart, or beyond a corner of the palm
}

TEST(Rivals, OfAFingerByItselfThereAreNone) {
  Hand hand = default_hand(Side::right);
  hand.palm.polygon.clear();
  const Model model = model_at(sampled_scene(hand, {{"plane", make_plane(0.3, 4)}}), 1e-4);
  Scratch scratch = make_scratch(model);
  DeviceFrame frame = as_joint_poses(hand, pressed_frame(hand, 0.003, 0.2));
  for (std::size_t k = kThumbMetacarpal; k < kJointCount; ++k) {
    if (k < kIndexMetacarpal || k >= kMiddleMetacarpal) frame.valid &= ~(1u << k);
  }
  State state;
  tick(model, state, scratch, frame);
  ASSERT_GT(scratch.samples->bodies.finger_count, 0u);
  const Bodies& bodies = scratch.samples->bodies;
  Rivals rivals(*scratch.primitives, bodies);
  for_numbers(parts_of(bodies), [&](std::size_t part) { EXPECT_EQ(rivals.of(part), 0u); });
}

}  // namespace
}  // namespace lumbrical::test
