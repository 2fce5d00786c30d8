// Under sanitizers a test takes many times as long.
#pragma once

#include <cstddef>

namespace lumbrical::test {

/// The step at which a test goes through what repeats itself: under sanitizers `step`, else 1.
constexpr std::size_t sanitized_step([[maybe_unused]] std::size_t step) {
#ifdef LUMBRICAL_SANITIZED
  return step;
#else
  return 1;
#endif
}

}  // namespace lumbrical::test
