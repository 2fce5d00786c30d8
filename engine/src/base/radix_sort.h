// Sorting 64-bit keys byte by byte, from the lowest (least significant digit first): linear, stable, without
// comparisons. A few keys are put in their places one by one, since a byte has 256 places to count.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace lumbrical {

/// Up to as many keys cost less by comparisons (measured).
inline constexpr std::size_t kFewKeys = 24;

inline void insertion_sort(std::span<std::uint64_t> keys) {
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const std::uint64_t key = keys[i];
    std::size_t place = i;
    for (; place > 0 && keys[place - 1] > key; --place) keys[place] = keys[place - 1];
    keys[place] = key;
  }
}

/// Sorts `keys` ascending. `other` is working memory of at least the same size. Bytes in which all keys agree
/// cost one look each, and keys that are in order already are left alone.
inline void radix_sort(std::span<std::uint64_t> keys, std::span<std::uint64_t> other) {
  if (keys.size() <= kFewKeys) return insertion_sort(keys);
  std::uint64_t differing = 0, last = 0;
  bool in_order = true;
  for (const std::uint64_t key : keys) {
    differing |= key ^ keys[0];
    in_order = in_order && last <= key;
    last = key;
  }
  if (in_order) return;
  std::uint64_t *from = keys.data(), *to = other.data();
  for (int shift = 0; shift < 64; shift += 8) {
    if ((differing >> shift & 0xff) == 0) continue;
    std::array<std::uint32_t, 256> place{};
    for (std::size_t i = 0; i < keys.size(); ++i) ++place[from[i] >> shift & 0xff];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : place) {
      const std::uint32_t size = count;
      count = sum;
      sum += size;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) to[place[from[i] >> shift & 0xff]++] = from[i];
    std::uint64_t* const sorted = to;
    to = from;
    from = sorted;
  }
  if (from == keys.data()) return;
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = from[i];
}

}  // namespace lumbrical
