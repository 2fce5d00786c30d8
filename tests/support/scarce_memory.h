// Memory that runs out on command (own_allocator.h).
#pragma once

#include <cstdint>

namespace lumbrical::test {

/// While this lives, no thread but that which made it gets memory beyond its next `allowed` allocations. One
/// at a time.
class ScarceMemory {
 public:
  explicit ScarceMemory(std::int64_t allowed);
  ~ScarceMemory();
  ScarceMemory(const ScarceMemory&) = delete;
  ScarceMemory& operator=(const ScarceMemory&) = delete;
};

}  // namespace lumbrical::test
