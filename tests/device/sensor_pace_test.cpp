// Sensors that are as quick as the bus, and slower ones.
#include "device/sensor_pace.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lumbrical {
namespace {

constexpr std::int64_t kTick = 1000000;  // [ns]

// Of a joint that swings once a second, told anew every `held` milliseconds and asked for every `bus`.
AnglePace paced(int held, int bus, double swing, double step) {
  AnglePace pace;
  for (int t = 1; t < 2000; t += bus) {
    const double at = swing * std::sin(6.28e-3 * (t - t % held));
    const double told = step > 0 ? step * std::floor(at / step) : at;
    note_angle(static_cast<float>(told), t * kTick, step, pace);
  }
  return pace;
}

TEST(SensorPace, OfASensorSlowerThanTheBusIsWhatItTakes) {
  EXPECT_NEAR(slow_pace(paced(20, 1, 0.5, 0)), 0.02, 1e-3);
  EXPECT_NEAR(slow_pace(paced(20, 5, 0.5, 1e-4)), 0.02, 1e-3);
  EXPECT_NEAR(slow_pace(paced(8, 1, 0.5, 1e-3)), 0.008, 1e-3);
}

TEST(SensorPace, OfASensorAsQuickAsTheBusIsNotTold) {
  EXPECT_EQ(slow_pace(paced(1, 1, 2, 0)), 0);
  EXPECT_EQ(slow_pace(paced(20, 20, 0.5, 0)), 0);
  EXPECT_EQ(slow_pace(paced(10, 20, 0.5, 0)), 0);
}

TEST(SensorPace, AJointThatMovesSlowlyOrByItsEncodersStepsTellsNothing) {
  EXPECT_EQ(slow_pace(paced(1, 1, 0.5, 0.01)), 0);
  EXPECT_EQ(slow_pace(paced(20, 1, 0.01, 0)), 0);
}

}  // namespace
}  // namespace lumbrical
