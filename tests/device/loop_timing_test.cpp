// What is measured of a bus: known at once when it grows, forgotten slowly, and no lone outlier believed.
#include "lumbrical/loop_timing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lumbrical {
namespace {

void measure(int count, double interval, double delay, TimingMeter& meter) {
  for (int i = 0; i < count; ++i) measure_exchange(interval, delay, meter);
}

TEST(LoopTiming, KnowsNothingBeforeTwoExchanges) {
  TimingMeter meter;
  EXPECT_FALSE(is_measured(meter));
  EXPECT_EQ(timing_of(meter).delay, std::numeric_limits<double>::infinity());
  measure(1, 0.001, 0.002, meter);
  EXPECT_FALSE(is_measured(meter));
  measure(1, 0.001, 0.002, meter);
  EXPECT_TRUE(is_measured(meter));
  EXPECT_NEAR(timing_of(meter).period, 0.001, 1e-12);
  EXPECT_NEAR(timing_of(meter).delay, 0.002, 1e-12);
}

TEST(LoopTiming, GrowsWithTheSecondLateExchangeAtOnceAndInFull) {
  TimingMeter meter;
  measure(1000, 0.001, 0.002, meter);
  measure(1, 0.02, 0.04, meter);
  EXPECT_NEAR(timing_of(meter).delay, 0.002, 1e-12) << "a lone one";
  measure(1, 0.02, 0.04, meter);
  const LoopTiming timing = timing_of(meter);
  EXPECT_NEAR(timing.delay, 0.04, 1e-12);
  EXPECT_NEAR(timing.period + timing.jitter, 0.02, 1e-12);
}

TEST(LoopTiming, ForgetsSlowly) {
  TimingMeter meter;
  measure(100, 0.02, 0.04, meter);
  measure(450, 0.001, 0.002, meter);
  EXPECT_NEAR(timing_of(meter).delay, 0.04, 1e-12) << "what was half a second ago is no past";
  measure(1500, 0.001, 0.002, meter);
  EXPECT_GT(timing_of(meter).delay, 0.02);
  measure(30000, 0.001, 0.002, meter);
  EXPECT_NEAR(timing_of(meter).delay, 0.002, 1e-3);
}

TEST(LoopTiming, SeesEverySlowExchangeOfABusTooSlowForTwoInASecond) {
  TimingMeter meter;
  measure(3, 0.8, 0.9, meter);
  EXPECT_NEAR(timing_of(meter).delay, 0.9, 1e-12);
  measure(2, 0.8, 1.5, meter);
  EXPECT_NEAR(timing_of(meter).delay, 1.5, 1e-12);
}

TEST(LoopTiming, IsNotConfusedByWhatIsNoTime) {
  TimingMeter meter;
  measure(3, 0.001, 0.002, meter);
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    measure(5, bad, 0.002, meter);
    measure(5, 0.001, bad, meter);
  }
  EXPECT_NEAR(timing_of(meter).delay, 0.002, 1e-12);
}

}  // namespace
}  // namespace lumbrical
