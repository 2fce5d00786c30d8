// Whose fault a late tick is.
#include "late_ticks.h"

#include <gtest/gtest.h>

namespace lumbrical::tool {
namespace {

constexpr std::int64_t kPeriod = 1000, kMoment = 10;  // [ns]

LateTicks no_ticks() {
  LateTicks late;
  late.slowest.reserve({});
  return late;
}

TEST(LateTicks, TicksBehindAreLateForTheReasonsOfThoseBeforeThem) {
  LateTicks late = no_ticks();
  std::int64_t behind = 0;
  for (int i = 0; i < 100; ++i) {  // each a tenth too long: the backlog outgrows every tick
    late.add({behind, kMoment, kPeriod + 100, kMoment}, {});
    behind += 100 + 2 * kMoment;
  }
  EXPECT_EQ(late.slow, 100u);
  EXPECT_EQ(late.woken_late + late.beside, 0u);
  EXPECT_EQ(late.slowest.kept, late.slowest.start.size());
}

TEST(LateTicks, WhoeverWaitedForTheProcessorOnceWaitsUntilTheBacklogIsGone) {
  LateTicks late = no_ticks();
  std::int64_t behind = 0, wake_up = 20 * kPeriod;
  for (int i = 0; i < 12; ++i) {  // each takes half of its period: the session catches up
    late.add({behind, wake_up, kPeriod / 2, 0}, {});
    behind += wake_up - kPeriod / 2;
    wake_up = 0;
  }
  EXPECT_EQ(late.woken_late, 12u);
  EXPECT_EQ(late.slowest.kept, 0u) << "no tick was slow";
  // A later one, before which there was no backlog, has its own cause.
  late.add({0, 0, kPeriod / 2, kPeriod}, {});
  EXPECT_EQ(late.beside, 1u);
  late.add({0, 0, 2 * kPeriod, kPeriod}, {});
  EXPECT_EQ(late.slow, 1u);
}

TEST(LateTicks, TheSlowestAreKept) {
  LateTicks late = no_ticks();
  for (std::int64_t i = 1; i <= 100; ++i) late.add({0, 0, kPeriod + i * 7 % 100, 0}, {});
  for (const std::uint32_t duration : late.slowest.duration) EXPECT_GT(duration, kPeriod + 60);
}

// A rough object: 30,000 evaluations take 60 us of a tick of 560, which no bound brings to 490.
TEST(LateTicks, WhereOtherWorkFillsHalfAPeriodNoBoundOnEffortIsProposed) {
  const std::vector<EffortTimes> rough = {{560, 500, 30000, 1000}, {900, 100, 81000, 1000}};
  EXPECT_FALSE(effort_within(490, rough).has_value());
  EXPECT_DOUBLE_EQ(effort_within(530, rough).value(), 15500) << "the tick that a bound spares least";
  EXPECT_FALSE(effort_within(500, std::vector<EffortTimes>{{560, 570, 30000, 30000}}).has_value())
      << "coarser than one cell a patch";
}

// A session that had a bound already was proposed ever smaller ones, since what remained went by fewer.
TEST(LateTicks, ABoundOnEffortIsProposedByWhatTicksWithoutOneTake) {
  EXPECT_DOUBLE_EQ(effort_within(500, std::vector<EffortTimes>{{900, 100, 81000, 1000}}).value(), 41000);
  const std::vector<EffortTimes> fast = {{100, 40, 30000, 1000}, {250, 245, 10000, 1000}};
  EXPECT_DOUBLE_EQ(effort_within(500, fast).value(), 60000) << "twice the time is there, and no tick is cut";
  EXPECT_FALSE(effort_within(500, {}).has_value());
}

}  // namespace
}  // namespace lumbrical::tool
