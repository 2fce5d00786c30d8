// Real time as far as the system allows it, and back.
#include "lumbrical/real_time.h"

#include <gtest/gtest.h>
#include <sched.h>

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

}  // namespace
}  // namespace lumbrical
