#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <optional>

#ifdef LUMBRICAL_TBB
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "base/floating_point.h"
#elif defined(LUMBRICAL_PLAIN_THREADS)
#include <atomic>
#include <thread>
#include <vector>

#include "base/floating_point.h"
#endif

namespace lumbrical {
#ifdef LUMBRICAL_TBB
namespace {

constexpr std::size_t kMostThreads = 64;

// A new arena for every call costs 10 us on an idle machine and far more on a busy one; one that is kept
// costs 1 us. Every calling thread has its own, so that sessions never wait for one another, and one for each
// number of threads, since work may share out work.
tbb::task_arena& arena_of(std::size_t threads) {
  thread_local std::array<std::optional<tbb::task_arena>, kMostThreads + 1> arenas;
  std::optional<tbb::task_arena>& arena = arenas[threads];
  if (!arena) arena.emplace(static_cast<int>(threads));
  return *arena;
}

}  // namespace
#endif

void run_chunks(std::size_t count, std::size_t chunk, std::size_t threads,
                void (*work)(const void* context, std::size_t first, std::size_t last), const void* context) {
  if (count == 0) return;
#ifdef LUMBRICAL_TBB
  if (threads > 1 && count > chunk) {
    // Asking for more than the machine has would make the library print a warning.
    threads = std::min(std::min(threads, kMostThreads),
                       tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    arena_of(threads).execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(0, count, chunk),
          [&](const tbb::blocked_range<std::size_t>& range) {
            const FloatingPointGuard guard;  // worker threads have modes of their own
            work(context, range.begin(), range.end());
          },
          tbb::simple_partitioner());
    });
    return;
  }
#elif defined(LUMBRICAL_PLAIN_THREADS)
  // For the thread sanitizer, which does not see into oneTBB: no order but that of start and end.
  if (threads > 1 && count > chunk) {
    std::atomic<std::size_t> next{0};
    const auto take_chunks = [&] {
      const FloatingPointGuard guard;
      for (std::size_t first; (first = next.fetch_add(chunk, std::memory_order_relaxed)) < count;)
        work(context, first, std::min(count, first + chunk));
    };
    std::vector<std::thread> others;
    for (std::size_t i = 1; i < threads; ++i) others.emplace_back(take_chunks);
    take_chunks();
    for (std::thread& other : others) other.join();
    return;
  }
#else
  (void)threads;
  (void)chunk;
#endif
  work(context, 0, count);
}

}  // namespace lumbrical
