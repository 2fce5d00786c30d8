// Real time as far as the system allows it, and back.
#include "lumbrical/real_time.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <time.h>

#include <thread>

namespace lumbrical {
namespace {

cpu_set_t processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  EXPECT_EQ(sched_getaffinity(0, sizeof set, &set), 0);
  return set;
}

TEST(RealTime, IsUndoneWithEveryProcessorThatTheThreadMightUseBefore) {
  std::thread([] {
    const cpu_set_t before = processors();
    const RealTime real_time = enter_real_time(1, Pinning::last_processor);
    const cpu_set_t within = processors();
    EXPECT_EQ(CPU_COUNT(&within), real_time.cpu < 0 ? CPU_COUNT(&before) : 1);
    leave_real_time(real_time);
    const cpu_set_t after = processors();
    EXPECT_TRUE(CPU_EQUAL(&before, &after));
  }).join();
}

// Or a force would come back at once that the device has let go of meanwhile.
TEST(RealTime, ItsClockGoesOnWhileTheMachineIsAsleep) {
  const auto awake_or_not = [] {
    timespec time{};
    clock_gettime(CLOCK_BOOTTIME, &time);
    return time.tv_sec * 1000000000 + time.tv_nsec;
  };
  const std::int64_t before = awake_or_not(), now = clock_ns();
  EXPECT_GE(now, before);
  EXPECT_LE(now, awake_or_not());
  sleep_until_ns(now + 1000000);
  EXPECT_GE(clock_ns(), now + 1000000);
}

}  // namespace
}  // namespace lumbrical
