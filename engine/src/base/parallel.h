// Work shared out over threads. The only file that names the threading library is parallel.cpp.
#pragma once

#include <cstddef>

namespace lumbrical {

/// Calls work(first, last) for consecutive chunks of [0, count), on up to `threads` threads, in any order.
/// The work must write to slots fixed by its indices and read nothing another chunk writes: then results
/// don't depend on threads. With one thread, or built without oneTBB, it is a plain call on this thread,
/// which allocates nothing.
template <class Work>
void parallel_chunks(std::size_t count, std::size_t chunk, std::size_t threads, const Work& work);

/// The same with the work as a plain function; what the template calls.
void run_chunks(std::size_t count, std::size_t chunk, std::size_t threads,
                void (*work)(const void* context, std::size_t first, std::size_t last), const void* context);

template <class Work>
void parallel_chunks(std::size_t count, std::size_t chunk, std::size_t threads, const Work& work) {
  run_chunks(
      count, chunk, threads,
      [](const void* context, std::size_t first, std::size_t last) {
        (*static_cast<const Work*>(context))(first, last);
      },
      &work);
}

}  // namespace lumbrical
