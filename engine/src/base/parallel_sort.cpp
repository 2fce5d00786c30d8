#include "base/parallel_sort.h"

#include <array>

namespace lumbrical {
namespace {

constexpr std::size_t kPiece = 65536;  // keys: enough that 256 counters are nothing beside them

using Counts = std::array<std::uint32_t, 256>;

// Bits in which not all keys agree.
std::uint64_t differing_bits(std::span<const std::uint64_t> keys, std::size_t threads) {
  std::vector<std::uint64_t> found(piece_count(keys.size(), kPiece));
  parallel_pieces(keys.size(), kPiece, threads, [&](std::size_t piece, std::size_t first, std::size_t last) {
    std::uint64_t differing = 0;
    for (std::size_t i = first; i < last; ++i) differing |= keys[i] ^ keys[0];
    found[piece] = differing;
  });
  std::uint64_t differing = 0;
  for (const std::uint64_t bits : found) differing |= bits;
  return differing;
}

// From how many keys of a piece have which byte, to where the first of them goes.
void counts_to_places(std::vector<Counts>& counts) {
  std::uint32_t sum = 0;
  for (std::size_t byte = 0; byte < 256; ++byte) {
    for (Counts& count : counts) {
      const std::uint32_t size = count[byte];
      count[byte] = sum;
      sum += size;
    }
  }
}

}  // namespace

void sort_by_upper_half(std::span<std::uint64_t> keys, std::span<std::uint64_t> other, std::size_t threads) {
  const std::uint64_t differing = differing_bits(keys, threads);
  std::vector<Counts> counts(piece_count(keys.size(), kPiece));
  std::span<std::uint64_t> from = keys, to = other;
  for (int shift = 32; shift < 64; shift += 8) {
    if ((differing >> shift & 0xff) == 0) continue;
    parallel_pieces(from.size(), kPiece, threads,
                    [&](std::size_t piece, std::size_t first, std::size_t last) {
                      Counts& count = counts[piece];
                      count.fill(0);
                      for (std::size_t i = first; i < last; ++i) ++count[from[i] >> shift & 0xff];
                    });
    counts_to_places(counts);
    parallel_pieces(from.size(), kPiece, threads,
                    [&](std::size_t piece, std::size_t first, std::size_t last) {
                      Counts& place = counts[piece];
                      for (std::size_t i = first; i < last; ++i)
                        to[place[from[i] >> shift & 0xff]++] = from[i];
                    });
    std::swap(from, to);
  }
  if (from.data() == keys.data()) return;
  parallel_pieces(keys.size(), kPiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) keys[i] = from[i];
  });
}

}  // namespace lumbrical
