// The hand-over of the newest value: never torn, never older than one already seen.
#include "base/newest.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace lumbrical {
namespace {

TEST(Newest, GivesTheLastOfSeveralOnce) {
  Newest<int> newest;
  int value = 0;
  EXPECT_FALSE(newest.take(value));
  newest.put(1);
  newest.put(2);
  EXPECT_TRUE(newest.take(value));
  EXPECT_EQ(value, 2);
  EXPECT_FALSE(newest.take(value));
}

TEST(Newest, IsNeverTornBetweenTwoThreads) {
  using Block = std::array<std::uint64_t, 32>;
  constexpr std::uint64_t kCount = 200000;
  Newest<Block> newest;
  std::thread writer([&] {
    Block block;
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      block.fill(i);
      newest.put(block);
    }
  });
  Block block{};
  std::uint64_t last = 0;
  while (last < kCount) {
    if (!newest.take(block)) continue;
    EXPECT_GT(block[0], last);
    last = block[0];
    for (const std::uint64_t value : block) ASSERT_EQ(value, last);
  }
  writer.join();
}

}  // namespace
}  // namespace lumbrical
