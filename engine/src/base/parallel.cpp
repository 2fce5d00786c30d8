#include "base/parallel.h"

#ifdef LUMBRICAL_TBB
#include <array>
#include <optional>

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

// The calling thread's own, kept for as long as it lives: a new one for every call costs 10 us on an idle
// machine, one that is kept 1 us, and workers come to the first arena of a program and, with oneTBB 2021.8,
// to hardly any that is made after that one is gone. One for each number of threads, since work may share out
// work.
tbb::task_arena& arena_of(std::size_t threads) {
  constexpr std::size_t kMost = 64;  // Execution::threads
  thread_local std::array<std::optional<tbb::task_arena>, kMost + 1> arenas;
  // Asking for more than the machine has would make the library print a warning.
  const std::size_t most = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  threads = std::min({threads, most, kMost});
  if (!arenas[threads]) arenas[threads].emplace(static_cast<int>(threads));
  return *arenas[threads];
}

}  // namespace
#endif

void run_chunks(std::size_t count, std::size_t chunk, std::size_t threads,
                void (*work)(const void* context, std::size_t first, std::size_t last), const void* context) {
  if (count == 0) return;
#ifdef LUMBRICAL_TBB
  if (threads > 1 && count > chunk) {
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
