// The ring between a thread that must not wait and one that may.
#include "base/ring.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace lumbrical {
namespace {

TEST(Ring, HandsOverEverythingInOrder) {
  Ring<std::uint64_t> ring(5);  // rounded up to 8
  constexpr std::uint64_t kCount = 200000;
  std::thread filler([&] {
    for (std::uint64_t i = 0; i < kCount;) {
      if (std::uint64_t* const slot = ring.claim()) {
        *slot = i++;
        ring.publish();
      } else {
        std::this_thread::yield();
      }
    }
  });
  for (std::uint64_t expected = 0; expected < kCount;) {
    if (const std::uint64_t* const item = ring.front()) {
      ASSERT_EQ(*item, expected++);
      ring.pop();
    } else {
      std::this_thread::yield();
    }
  }
  filler.join();
  EXPECT_EQ(ring.front(), nullptr);
}

TEST(Ring, IsFullAtItsCapacityAndFreeAgainAfterPop) {
  Ring<int> ring(4);
  for (int i = 0; i < 4; ++i) {
    ASSERT_NE(ring.claim(), nullptr);
    ring.publish();
  }
  EXPECT_EQ(ring.claim(), nullptr);
  ring.pop();
  EXPECT_NE(ring.claim(), nullptr);
}

}  // namespace
}  // namespace lumbrical
