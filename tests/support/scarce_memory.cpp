// See scarce_memory.h.
#include "scarce_memory.h"

#include <atomic>

#include "own_allocator.h"

namespace lumbrical::test {
namespace {

std::atomic<std::int64_t> left{0};
thread_local bool is_spared = false;

}  // namespace

ScarceMemory::ScarceMemory(std::int64_t allowed) {
  is_spared = true;
  left = allowed;
  may_allocate = [] { return is_spared || --left >= 0; };
}

ScarceMemory::~ScarceMemory() {
  may_allocate = nullptr;
  is_spared = false;
}

}  // namespace lumbrical::test
