// Asking for memory before it is needed.
#pragma once

#include <cstddef>

#include "base/always_inline.h"

namespace lumbrical {

/// Asks for what stands at a place and `bytes` on: in a large world what comes next lies far from what came
/// before. In line, since g++ takes a function that does nothing else for one that does nothing.
LUMBRICAL_INLINE inline void prefetch(const void* at, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  for (std::size_t i = 0; i < bytes; i += kLine) __builtin_prefetch(static_cast<const char*>(at) + i);
}

}  // namespace lumbrical
