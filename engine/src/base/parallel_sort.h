// Putting many numbers in the order of their codes, on several threads: byte by byte from the lowest, as in
// radix_sort.h, with the places of every piece of the keys counted on its own (Zagha, Blelloch, Radix sort
// for vector multiprocessors, 1991).
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel.h"

namespace lumbrical {

/// Sorts keys by their upper 32 bits; equal ones keep their order. `other` is working memory of the same
/// size. The result does not depend on `threads`. At most 2^32 - 1 keys.
void sort_by_upper_half(std::span<std::uint64_t> keys, std::span<std::uint64_t> other, std::size_t threads);

/// Sorts `members`, given ascending, by code_of(member), a number of `bits` <= 63 bits; a tie goes by the
/// member. The result does not depend on `threads`. Takes 16 bytes per member of working memory.
template <class CodeOf>
void sort_by_code(std::vector<std::uint32_t>& members, int bits, std::size_t threads, const CodeOf& code_of) {
  constexpr std::size_t kPiece = 16384;
  const std::size_t count = members.size();
  const int rest = std::max(0, bits - 32);
  // Written before they are read: that they start as zeros would cost as much as a pass of the sort.
  const auto memory = std::make_unique_for_overwrite<std::uint64_t[]>(2 * count);
  const std::span keys(memory.get(), count), other(memory.get() + count, count);
  parallel_pieces(count, kPiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) keys[i] = code_of(members[i]) >> rest << 32 | members[i];
  });
  sort_by_upper_half(keys, other, threads);
  const auto agree = [&](std::size_t i, std::size_t k) { return keys[i] >> 32 == keys[k] >> 32; };
  // A run belongs to the piece it starts in.
  parallel_pieces(count, kPiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    while (first < last && first > 0 && agree(first, first - 1)) ++first;
    for (std::size_t end = first; first < last; first = end) {
      while (end < count && agree(first, end)) ++end;
      const bool refine = rest > 0 && end - first > 1;  // the upper 32 bits agree
      const auto low_key = [&](std::uint64_t key) {
        const auto member = static_cast<std::uint32_t>(key);
        return (code_of(member) & ((std::uint64_t{1} << rest) - 1)) << 32 | member;
      };
      if (refine) {
        for (std::size_t i = first; i < end; ++i) other[i] = low_key(keys[i]);
        std::sort(other.begin() + static_cast<std::ptrdiff_t>(first),
                  other.begin() + static_cast<std::ptrdiff_t>(end));
      }
      for (std::size_t i = first; i < end; ++i)
        members[i] = static_cast<std::uint32_t>(refine ? other[i] : keys[i]);
    }
  });
}

}  // namespace lumbrical
