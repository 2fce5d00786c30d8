// A fast 64-bit hash of numbers for stage hashes, state hashes and input checks: the same result on every
// machine.
//
// Words go round four independent lanes, so that the multiplications overlap (several GB/s without SIMD). It
// tells accidental differences, however small or symmetric; it is no protection against someone who wants a
// collision.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace lumbrical {

// Words are read from memory as they stand; every machine the engine runs on is little-endian.
static_assert(std::endian::native == std::endian::little);

class Hasher {
 public:
  /// One number or enum, by its bits: +0 and -0 differ, equal NaNs agree.
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void value(T number) {
    std::uint64_t word = 0;
    static_assert(sizeof(T) <= sizeof(word));
    std::memcpy(&word, &number, sizeof(T));
    absorb(word);
  }

  /// Bytes and their count; so ("ab", "c") and ("a", "bc") differ.
  void bytes(const void* data, std::size_t size) {
    const auto* from = static_cast<const unsigned char*>(data);
    std::size_t left = size % kRound;
    rounds(from, size / kRound);
    from += size - left;
    while (left > 0) {
      std::uint64_t word = 0;
      const std::size_t part = left < sizeof(word) ? left : sizeof(word);
      std::memcpy(&word, from, part);
      absorb(word);
      from += part;
      left -= part;
    }
    absorb(size);
  }

  /// As many single values as there are words: the same as value() of each, sooner.
  void words(std::span<const std::uint64_t> values) {
    std::size_t next = 0;
    for (; next < values.size() && count_ % kLanes != 0; ++next) absorb(values[next]);
    const std::size_t round_count = (values.size() - next) / kLanes;
    rounds(values.data() + next, round_count);
    count_ += kLanes * round_count;
    for (next += kLanes * round_count; next < values.size(); ++next) absorb(values[next]);
  }

  /// An array of numbers, or of structs of numbers without padding (padding bytes are not defined).
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void array(std::span<const T> items) { bytes(items.data(), items.size_bytes()); }
  template <class T>
  void array(const std::vector<T>& items) {
    array(std::span<const T>(items));
  }
  template <class T, std::size_t N>
  void array(const std::array<T, N>& items) {
    array(std::span<const T>(items));
  }

  [[nodiscard]] std::uint64_t digest() const {
    std::uint64_t result = count_;
    for (const std::uint64_t lane : lanes_) result = mixed(mixed(result, lane), result >> 29);
    return result ^ (result >> 31);
  }

 private:
  // A bijection of the lane for every word and of the word for every lane: nothing that enters is lost.
  static constexpr std::uint64_t mixed(std::uint64_t lane, std::uint64_t word) {
    lane = (lane ^ word) * 0xd6e8feb86659fd93u;
    return lane ^ (lane >> 32);
  }
  void absorb(std::uint64_t word) {
    std::uint64_t& lane = lanes_[count_++ % kLanes];
    lane = mixed(lane, word);
  }
  // A word for each lane, `round_count` times. The lanes are in variables of their own, which compilers keep
  // in registers: as elements of an array they would go to memory and back with every word, which takes twice
  // as long as all the rest.
  void rounds(const void* data, std::size_t round_count) {
    const auto* from = static_cast<const unsigned char*>(data);
    auto [a, b, c, d] = lanes_;
    for (; round_count > 0; --round_count, from += kRound) {
      a = mixed(a, word_at(from));
      b = mixed(b, word_at(from + 8));
      c = mixed(c, word_at(from + 16));
      d = mixed(d, word_at(from + 24));
    }
    lanes_ = {a, b, c, d};
  }
  static std::uint64_t word_at(const unsigned char* from) {
    std::uint64_t word;
    std::memcpy(&word, from, sizeof(word));
    return word;
  }

  static constexpr std::size_t kLanes = 4;
  static constexpr std::size_t kRound = kLanes * sizeof(std::uint64_t);  // [bytes]
  std::array<std::uint64_t, kLanes> lanes_{0x2545f4914f6cdd1du, 0x9e6c63d0676a9a99u, 0xb5ad4eceda1ce2a9u,
                                           0x8f3c1a5be2d74605u};
  std::uint64_t count_ = 0;  // single words so far; says which lane is next
};

}  // namespace lumbrical
