// Time as the sink's thread counts it: its own sleep is no time.
#include "loop/running_time.h"

#include <gtest/gtest.h>

namespace lumbrical {
namespace {

TEST(RunningTime, CountsAStallAsTwoUsualCyclesAndTellsTheRest) {
  RunningTime running{0.001};
  for (int i = 0; i < 100; ++i) EXPECT_EQ(running.advance(0.001), 0.001);
  EXPECT_EQ(running.lost, 0);
  EXPECT_NEAR(running.advance(0.0076), 0.002, 1e-15);
  EXPECT_NEAR(running.lost, 0.0056, 1e-15);
  EXPECT_EQ(running.advance(0.001), 0.001);
}

TEST(RunningTime, GetsUsedToASlowerBusAndToAFasterOne) {
  RunningTime running{0.001};
  double wall = 0, counted = 0;
  for (int i = 0; i < 100; ++i) {
    wall += 0.012;
    counted += running.advance(0.012);
  }
  EXPECT_EQ(running.advance(0.012), 0.012);
  EXPECT_NEAR(running.lost, wall - counted, 1e-12);
  EXPECT_LT(running.lost, 0.5);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(running.advance(0.001), 0.001);
  EXPECT_NEAR(running.advance(0.1), 0.002, 1e-6);
}

TEST(RunningAge, ForgivesACommandWhatWasLostOfAStallSinceItCame) {
  RunningTime running{0.001};
  RunningAge before, within;
  before.begin(running);  // came 1 ms before a stall of 80 ms
  within.begin(running);  // came 3 ms before the end of it, which no one saw: the thread stood still
  running.advance(0.08);
  EXPECT_NEAR(before.of(0.081, running), 0.003, 1e-12);
  EXPECT_NEAR(within.of(0.003, running), 0, 1e-12);
  for (int i = 0; i < 100; ++i) running.advance(0.001);
  EXPECT_NEAR(before.of(0.181, running), 0.103, 1e-12);
  EXPECT_NEAR(within.of(0.103, running), 0.1, 1e-12);
}

TEST(WaitForTick, IsNoLongerThanTheExchangeOrTheHoldAndOnlyForAnglesNotYetFelt) {
  SafetyTimes times;
  times.tick_hold = 0.005;
  DeviceCommand command;
  command.feedback_time = 10;
  EXPECT_EQ(wait_for_tick(command, 20, 0.003, times), 0.003);
  EXPECT_EQ(wait_for_tick(command, 20, 0.05, times), 0.005);
  EXPECT_EQ(wait_for_tick(command, 10, 0.05, times), 0) << "felt already";
  command.feedback_time = 0;
  EXPECT_EQ(wait_for_tick(command, 20, 0.05, times), 0) << "not made of angles";
}

}  // namespace
}  // namespace lumbrical
