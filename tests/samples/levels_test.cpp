// How fine a lattice a hand is felt by, by its force.
#include <gtest/gtest.h>

#include <numeric>

#include "samples/levels.h"

namespace lumbrical::test {
namespace {

TEST(Levels, MixFromFineToCoarseAsForceGrowsAndNeverJump) {
  LevelWeights before = level_weights(0);
  EXPECT_EQ(before.back(), 1);
  const double step = 1e-3, most = 1.05 * step / ((1 - kTooLittle) * kEnoughForce.back());
  for (double force = 0; force < 2 * kEnoughForce[0]; force += step) {
    const LevelWeights weights = level_weights(force);
    EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-15) << force;
    for (std::size_t k = 0; k < kLevels; ++k) {
      EXPECT_GE(weights[k], 0) << force;
      EXPECT_NEAR(weights[k], before[k], most) << force;
    }
    EXPECT_GE(weights.front(), before.front());
    EXPECT_LE(weights.back(), before.back());
    before = weights;
  }
  EXPECT_EQ(before.front(), 1);
}

}  // namespace
}  // namespace lumbrical::test
