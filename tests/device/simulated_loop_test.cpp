// Closed loops in simulated time: the predicted passive limit is where shaking starts, the limiter keeps the
// engine's own touch below it, the energy account ends what shaking makes, and a local model earns its
// registers.
#include "simulated_loop.h"

#include <gtest/gtest.h>

namespace lumbrical {
namespace {

using bench::LoopOutcome;
using bench::simulate;
using bench::SimulatedLoop;

TEST(SimulatedLoop, IsQuietBelowThePredictedLimitAndShakesSoonAboveIt) {
  for (const double delay : {0.001, 0.004, 0.009}) {
    SimulatedLoop loop;
    loop.delay = delay;
    const double limit = stiffness_bound({loop.period, 0, delay}, loop.dynamics).largest;
    for (const double share : {0.3, 0.95, 1.4, 3.0}) {
      loop.start = 1.2 * loop.push / (share * limit);
      const LoopOutcome outcome = simulate(loop, bench::linear_wall(share * limit));
      EXPECT_EQ(outcome.shakes, share > 1) << delay << " s, " << share << " of the limit: " << outcome.swing;
    }
  }
}

TEST(SimulatedLoop, JitterIsPaidForLikeALongerPeriod) {
  SimulatedLoop loop;
  loop.jitter = 0.003;
  const double limit = stiffness_bound({loop.period, loop.jitter, loop.delay}, loop.dynamics).largest;
  loop.start = 1.2 * loop.push / (0.95 * limit);
  EXPECT_FALSE(simulate(loop, bench::linear_wall(0.95 * limit)).shakes);
}

TEST(SimulatedLoop, TheLimiterKeepsTheEnginesTouchQuietAtEveryDelay) {
  for (const double delay : {0.001, 0.004, 0.009}) {
    const bench::Touch touch = bench::engine_touch(1e8);
    SimulatedLoop loop;
    loop.delay = delay;
    loop.push = 0.05;
    loop.seconds = 1.5;
    EXPECT_TRUE(simulate(loop, touch).shakes) << "without it, at " << delay;
    loop.limiter = loop.account = true;
    const LoopOutcome limited = simulate(loop, touch);
    EXPECT_FALSE(limited.shakes) << delay << ": " << limited.swing;
    EXPECT_LT(limited.least_factor, 0.5);
    EXPECT_LT(limited.generated, 1e-3);
  }
}

TEST(SimulatedLoop, TheAccountAloneEndsTheEnergyThatShakingMakes) {
  for (const double share : {3.0, 30.0}) {
    SimulatedLoop loop;
    loop.delay = 0.009;
    loop.start = 0.02;
    const double stiffness = share * stiffness_bound({loop.period, 0, loop.delay}, loop.dynamics).largest;
    const LoopOutcome without = simulate(loop, bench::linear_wall(stiffness));
    loop.account = true;
    const LoopOutcome with = simulate(loop, bench::linear_wall(stiffness));
    EXPECT_GT(without.generated, 0.1);
    EXPECT_LT(with.generated, 0.01);
    EXPECT_FALSE(with.shakes) << with.swing;
  }
}

TEST(SimulatedLoop, ALocalModelIsFarStifferAndTruerThanPlainHoldOnASlowBus) {
  SimulatedLoop plain;
  plain.period = plain.delay = 0.0106;
  SimulatedLoop local = plain;
  local.period = local.delay = 0.0185;  // it needs more registers
  local.local_period = 0.001;
  for (SimulatedLoop* const loop : {&plain, &local}) loop->start = 1.2 * loop->push / 10;
  EXPECT_TRUE(simulate(plain, bench::linear_wall(2)).shakes);
  EXPECT_FALSE(simulate(local, bench::linear_wall(10)).shakes);
  for (SimulatedLoop* const loop : {&plain, &local}) {
    loop->human = {1, 0.02};
    loop->middle = loop->start = 0.1;
    loop->sweep = 0.05;
    loop->push = bench::round_wall(0.5)(0.1).torque;
  }
  const double hold = simulate(plain, bench::round_wall(0.5)).felt_error;
  const double followed = simulate(local, bench::round_wall(0.5)).felt_error;
  EXPECT_GT(hold, 0.04);
  EXPECT_LT(followed, 0.01);
}

}  // namespace
}  // namespace lumbrical
