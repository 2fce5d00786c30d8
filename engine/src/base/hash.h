// A fast 64-bit hash of numbers for stage hashes, state hashes and input checks: the same result on every
// machine.
//
// Words go by pairs round four independent lanes, so that the multiplications overlap: sixteen bytes with
// each. It tells accidental differences, however small or symmetric; it is no protection against
// someone who wants a collision. Recordings hold these hashes: a change raises the version of their format
// (docs/recording.md).
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
    const std::size_t rest = size % kRound;
    const auto* const from = static_cast<const unsigned char*>(data);
    rounds(from, size / kRound);
    if (rest > 0) {
      std::array<unsigned char, kRound> last{};
      std::memcpy(last.data(), from + (size - rest), rest);
      rounds(last.data(), 1);
    }
    absorb(size);
  }

  /// Words that stand for something else each; as bytes().
  void words(std::span<const std::uint64_t> values) { array(values); }

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
    const auto& [a, b, c, d] = lanes_;
    return folded(folded(folded(a, b) ^ count_, folded(c, d)), kFactor);
  }

 private:
  static constexpr std::size_t kLanes = 4;
  static constexpr std::size_t kRound = 2 * kLanes * sizeof(std::uint64_t);  // [bytes]
  static constexpr std::uint64_t kFactor = 0xd6e8feb86659fd93u;

  // Both halves of the product: each of its bits comes from all bits of both factors, so that what one word
  // has changed of a lane is not undone by a similar change of another.
  static constexpr std::uint64_t folded(std::uint64_t one, std::uint64_t other) {
    __extension__ using Product = unsigned __int128;
    const Product product = static_cast<Product>(one) * other;
    return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
  }
  static constexpr std::uint64_t mixed(std::uint64_t lane, std::uint64_t first, std::uint64_t second) {
    return folded(lane ^ first, kFactor ^ second);
  }
  void absorb(std::uint64_t word) {
    std::uint64_t& lane = lanes_[count_++ % kLanes];
    lane = mixed(lane, word, 0);
  }

  // Two words for each lane, `round_count` times. The lanes are variables of their own, which compilers keep
  // in registers: as elements of an array they would go to memory and back with every word, and take three
  // times as long.
  void rounds(const unsigned char* from, std::size_t round_count) {
    const auto word = [&from](std::size_t i) {
      std::uint64_t result;
      std::memcpy(&result, from + i * sizeof(result), sizeof(result));
      return result;
    };
    auto [a, b, c, d] = lanes_;
    for (; round_count > 0; --round_count, from += kRound) {
      a = mixed(a, word(0), word(1));
      b = mixed(b, word(2), word(3));
      c = mixed(c, word(4), word(5));
      d = mixed(d, word(6), word(7));
    }
    lanes_ = {a, b, c, d};
  }

  // At first the roots of the first four primes, behind the point: numbers without a pattern.
  std::array<std::uint64_t, kLanes> lanes_{0x6a09e667f3bcc908u, 0xbb67ae8584caa73bu, 0x3c6ef372fe94f82bu,
                                           0xa54ff53a5f1d36f1u};
  std::uint64_t count_ = 0;  // single words and arrays so far; says which lane is next
};

inline std::uint64_t hash_of_bytes(const void* data, std::size_t size) {
  Hasher hasher;
  hasher.bytes(data, size);
  return hasher.digest();
}

}  // namespace lumbrical
