// Work shared out over threads. The only file that names the threading library is parallel.cpp.
#pragma once

#include <algorithm>
#include <cstddef>

namespace lumbrical {

/// Calls work(first, last) for consecutive chunks of [0, count), on up to `threads` threads, in any order.
/// The work must write to slots fixed by its indices and read nothing another chunk writes: then results
/// don't depend on threads. With one thread, or built without oneTBB, it is a plain call on this thread,
/// which allocates nothing.
template <class Work>
void parallel_chunks(std::size_t count, std::size_t chunk, std::size_t threads, const Work& work);

/// Calls work(piece, first, last) for every piece of `size` indices of [0, count); the last may be shorter.
/// Unlike chunks, pieces are the same however many threads there are: what is reduced within one, into a slot
/// of its own, is the same too.
template <class Work>
void parallel_pieces(std::size_t count, std::size_t size, std::size_t threads, const Work& work);

/// How many pieces there are.
constexpr std::size_t piece_count(std::size_t count, std::size_t size) { return (count + size - 1) / size; }

/// parallel_chunks with the work as a plain function; what the template calls.
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

template <class Work>
void parallel_pieces(std::size_t count, std::size_t size, std::size_t threads, const Work& work) {
  parallel_chunks(piece_count(count, size), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t piece = begin; piece < end; ++piece)
      work(piece, piece * size, std::min(count, (piece + 1) * size));
  });
}

}  // namespace lumbrical
