// Whether a hand's cores are outside all surfaces, asked by itself.
#include "proxy/core_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pressed_hand.h"
#include "proxied_session.h"
#include "proxy/proxy_hand.h"
#include "random.h"
#include "stages/hand_pose.h"

namespace lumbrical {
namespace {

constexpr double kReach = 0.002;  // [m]

void find_gaps(const DeviceFrame& frame, test::Session& run, CoreGaps& gaps) {
  Primitives& hand = *run.scratch.primitives;
  static_cast<void>(place_hand(run.model.hand, run.model.settings, frame, hand));
  ProxyMemory& memory = *run.scratch.proxy;
  EXPECT_TRUE(add_gaps({run.model, {}, 0}, hand.joints, kReach, memory.search, memory.gaps, gaps));
}

bool is_any_closed(const CoreGaps& gaps) {
  return std::any_of(gaps.gap.begin(), gaps.gap.end(), [](const Gap& gap) { return gap.width < 0; }) ||
         std::count(gaps.clearance.begin(), gaps.clearance.end(), 0) > 0;
}

// A whole hand anywhere round a fine mug, and in it.
TEST(CoreGaps, TellWithoutLookingAtAllWhetherAHandIsOutside) {
  Scene scene = test::proxy_scene(make_mug({.segments = 128}));
  scene.hand = default_hand(Side::right);
  test::Session run(scene);
  test::Random random(3);
  DeviceFrame frame = test::pressed_frame(scene.hand, 0, 0);
  int outside = 0, closed = 0;
  std::size_t pairs_of_closed = 0, asked = 0, asked_again = 0;
  for (int i = 0; i < 1600; ++i) {
    const Vec3 turn = random.direction();
    frame.base = {{random.between(-0.1, 0.1), random.between(-0.1, 0.1), random.between(-0.05, 0.15)},
                  normalized({random.between(-1, 1), turn.x, turn.y, turn.z})};
    CoreGaps all, quick, again;
    quick.asks_only_that = again.asks_only_that = true;
    find_gaps(frame, run, all);
    find_gaps(frame, run, quick);
    find_gaps(frame, run, again);
    EXPECT_EQ(quick.closed, all.closed) << i;
    EXPECT_EQ(again.closed, all.closed) << i;
    EXPECT_EQ(all.closed, is_any_closed(all)) << i;
    outside += !all.closed && all.pairs > 0;
    closed += all.closed;
    if (!all.closed) continue;
    pairs_of_closed += all.pairs;
    asked += quick.pairs;
    asked_again += again.pairs;
  }
  EXPECT_GT(outside, 20);
  EXPECT_GT(closed, 200);
  EXPECT_LT(asked, pairs_of_closed / 20);
  EXPECT_LT(asked_again, pairs_of_closed / 30);
}

}  // namespace
}  // namespace lumbrical
