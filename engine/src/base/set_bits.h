// Numbers as a set, a bit each.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lumbrical {

constexpr bool has_bit(std::uint64_t numbers, std::size_t number) { return (numbers >> number & 1u) != 0; }

/// Calls take(number) for every number whose bit is set, ascending.
template <class Take>
inline void for_numbers(std::uint64_t numbers, const Take& take) {
  for (; numbers != 0; numbers &= numbers - 1) take(static_cast<std::size_t>(__builtin_ctzll(numbers)));
}

}  // namespace lumbrical
