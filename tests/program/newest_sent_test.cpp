// What a session shows of its device while it runs, where few of its ticks are shown.
#include "newest_sent.h"

#include <gtest/gtest.h>

namespace lumbrical::tool {
namespace {

TEST(NewestSent, IsToldByTheTickThatIsShownWhereThatHasNone) {
  NewestSent newest;
  TickRecord silent, telling;
  newest.take(silent);
  newest.put_into(silent);
  EXPECT_EQ(silent.sent_count, 0u);

  telling.sent_count = 2;
  telling.sent[0].state = SafetyState::idle;
  telling.sent[1].state = SafetyState::armed;
  newest.take(telling);
  newest.take(silent);
  TickRecord shown = silent;
  newest.put_into(shown);
  ASSERT_EQ(shown.sent_count, 1u);
  EXPECT_EQ(shown.sent[0].state, SafetyState::armed);

  shown = telling;
  newest.put_into(shown);
  EXPECT_EQ(shown.sent_count, 2u);
}

}  // namespace
}  // namespace lumbrical::tool
