// Between which bounds one part's lead over another one stays within a block, and how near they are.
#define LUMBRICAL_ISA scalar
#include "samples/block_kernels.h"

#include <gtest/gtest.h>

#include "lumbrical/shapes.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

using Point = scalar::Wide3<float>;

Point point_of(Vec3 v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

/// A block `reach` [m] large, flat or not, anywhere about a place.
scalar::Boxes<float> block_about(Vec3 place, double reach, float largest, Random& random) {
  const Quat turn = random.rotation();
  Vec3 arm[3] = {
      {random.between(0.1, 1), 0, 0}, {0, random.between(0.1, 1), 0}, {0, 0, random.between(0, 1)}};
  const double size = std::sqrt(dot(arm[0], arm[0]) + dot(arm[1], arm[1]) + dot(arm[2], arm[2]));
  scalar::Boxes<float> boxes{point_of(place), static_cast<float>(reach), 0, {}};
  boxes.reach = scalar::reach_of(boxes.radius, largest);
  for (std::size_t k = 0; k < 3; ++k) boxes.arm[k] = point_of(rotate(turn, (reach / size) * arm[k]));
  return boxes;
}

struct LeadCounts {
  std::size_t blocks = 0, bounded = 0;
};

void look_at_block(const OtherParts& others, std::size_t leader, std::size_t other,
                   const scalar::Boxes<float>& boxes, Random& random, LeadCounts& counts) {
  const auto lead_at = [&](Point at) {
    return scalar::field_at(others.bodies, leader, others.offset, at) -
           scalar::field_at(others.bodies, other, others.offset, at);
  };
  const scalar::LeadRange<float> range = scalar::lead_range(boxes, others, leader, other);
  const float lead = lead_at(boxes.centre);
  ++counts.blocks;
  counts.bounded += range.less + range.more < 3 * boxes.reach;
  for (int i = 0; i < 30; ++i) {
    Point at = boxes.centre;
    for (const Point& arm : boxes.arm) {
      const double along = random.between(-1, 1);  // corners and edges more often than not
      at = at + static_cast<float>(along < -0.4 ? -1 : along > 0.4 ? 1 : along) * arm;
    }
    ASSERT_GE(lead_at(at), lead - range.less);
    ASSERT_LE(lead_at(at), lead + range.more);
  }
}

TEST(LeadRange, HoldsWhereverInABlockAndIsNarrow) {
  LeadCounts counts;
  Random random(51);
  const auto look = [&](const Patches&, const SampleMemory& memory) {
    const Bodies& bodies = memory.bodies;
    const std::uint64_t parts = parts_of(bodies);
    for (int i = 0; i < 3000; ++i) {
      const std::size_t leader = random.below(Bodies::kMostParts), other = random.below(Bodies::kMostParts);
      if ((parts >> leader & parts >> other & 1u) == 0 || body_of(leader) == body_of(other)) continue;
      const OtherParts others{bodies, body_of(other), offsets_from(Vec3{}, bodies), nullptr};
      const Vec3 place = 0.5 * (bodies.finger[0].origin + bodies.palm.origin) + random.in_box(0.08);
      const double reach = std::exp(random.between(std::log(1e-4), std::log(0.01)));
      look_at_block(others, leader, other, block_about(place, reach, others.offset.largest, random), random,
                    counts);
    }
  };
  for_hands_on_planes(
      41, [](const Hand& hand, Random& any) { return dropped_hand(hand, any, -0.3, 1.2, 0.4, 0.01, 0.03); },
      look);
  EXPECT_GT(counts.blocks, 10000u);
  EXPECT_GT(2 * counts.bounded, counts.blocks);
}

}  // namespace
}  // namespace lumbrical::test
