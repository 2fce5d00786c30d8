#include "base/parallel.h"

#include <algorithm>

#ifdef LUMBRICAL_TBB
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "base/floating_point.h"
#endif

namespace lumbrical {

void run_chunks(std::size_t count, std::size_t chunk, std::size_t threads,
                void (*work)(const void* context, std::size_t first, std::size_t last), const void* context) {
  if (count == 0) return;
#ifdef LUMBRICAL_TBB
  if (threads > 1 && count > chunk) {
    // Asking for more than the machine has would make the library print a warning.
    threads =
        std::min(threads, tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    tbb::task_arena arena(static_cast<int>(threads));
    arena.execute([&] {
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
#else
  (void)threads;
  (void)chunk;
#endif
  work(context, 0, count);
}

}  // namespace lumbrical
