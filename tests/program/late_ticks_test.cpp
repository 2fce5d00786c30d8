// Whose fault a late tick is.
#include "late_ticks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lumbrical/motion.h"
#include "stage_clock.h"

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

// Needles round the grasp, of so many patches that they are cut where a hand comes near.
Scene scene_of_needles() {
  constexpr std::uint32_t kNeedles = 2000;
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.max_candidates = 500000;
  SceneObject& needles = scene.objects.emplace_back();
  needles.name = "needles";
  for (std::uint32_t i = 0; i < kNeedles; ++i) {
    const double angle = 2.4 * i;
    const Vec3 along{std::cos(angle), std::sin(angle), 0.2 * std::sin(3.0 * i)}, aside{-along.y, along.x, 0};
    const Vec3 middle{0.1 * std::sin(5.0 * i), 0.1 * std::sin(7.0 * i), 0.04 + 0.05 * std::sin(11.0 * i)};
    for (const Vec3 corner : {middle - 2 * along, middle + 2 * along, middle + 2 * along + 3e-4 * aside})
      needles.mesh.vertices.push_back(corner);
    needles.mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return scene;
}

// Those 5 ms apart in a grasp, as the session measures them.
LateTicks late_ticks_of(const Scene& scene, const Model& model) {
  LateTicks late;
  TickStart start;
  start.state[0] = make_state(model);
  late.slowest.reserve(start);
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = false;
  const Motion motion = make_grasp(scene.hand, 0.037, 0.095, 2);
  for (int i = 0; i < 300; ++i) {
    start.frame[0] = resample(motion, 5e-3 * i);
    State state = start.state[0];
    const std::int64_t begin = read_clock(CLOCK_THREAD_CPUTIME_ID);
    tick(model, state, scratch, start.frame[0]);
    late.slowest.add(read_clock(CLOCK_THREAD_CPUTIME_ID) - begin, start);
    start.state[0] = std::move(state);
  }
  return late;
}

// Ticks that cut what is near took 7 ms, the same again 2: it was the machine's fault, and nothing helped.
TEST(LateTicks, WhatATickMeetsForTheFirstTimeIsPartOfItsWork) {
  const Scene scene = scene_of_needles();
  std::vector<Model> models(1);
  ASSERT_TRUE(build_model(scene, {}, models[0]).ok());
  const LateReport report = study(late_ticks_of(scene, models[0]), scene, models, false);
  EXPECT_GT(report.microseconds, 0.5 * report.session_microseconds);
  EXPECT_GT(report.microseconds, 1.3 * report.again_microseconds);
  EXPECT_GT(report.load.thin_triangles, 10u);
  EXPECT_EQ(report.load.thin_triangles, report.load.triangles);
  ASSERT_FALSE(report.remedies.empty());
  EXPECT_LT(report.remedies.front().microseconds, report.microseconds);
  Table table;
  LateTicks late;
  late.slow = 1;
  late.slowest.kept = 1;
  add_late(late, report, 0.9 * report.session_microseconds, table);
  const std::string text = table.text();
  EXPECT_NE(text.find("with what it meets for the first time"), std::string::npos) << text;
  EXPECT_NE(text.find("are needles"), std::string::npos) << text;
  EXPECT_EQ(text.find("other work on this machine"), std::string::npos) << text;
}

TEST(LateTicks, WhetherATickWasAFirstVisitIsKnownByWhatTheSessionMeasured) {
  EXPECT_TRUE(was_first_visit({7000, 2000, 0}, 5000));
  EXPECT_FALSE(was_first_visit({17000, 2000, 0}, 2500)) << "computed again it met more than in its session";
  EXPECT_FALSE(was_first_visit({2000, 2000, 0}, 9000)) << "neither";
}

}  // namespace
}  // namespace lumbrical::tool
