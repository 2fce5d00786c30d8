// A fast 64-bit hash of numbers for stage hashes, state hashes and input checks: the same result on every
// machine.
//
// Words go by pairs round eight independent lanes, so that the multiplications overlap: ten bytes per cycle
// without SIMD. It tells accidental differences, however small or symmetric; it is no protection against
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
    const auto& [a, b, c, d, e, f, g, h] = lanes_;
    // Mixed once more first: what the last word has changed of a lane may be two bits only.
    const auto joined = [](std::uint64_t one, std::uint64_t other) { return mixed(mixed(one, 0), other); };
    const std::uint64_t left = joined(joined(a, b), joined(c, d)), right = joined(joined(e, f), joined(g, h));
    const std::uint64_t result = joined(joined(left, right), count_);
    return mixed(result, result >> 29);
  }

 private:
  static constexpr std::size_t kLanes = 8;
  static constexpr std::size_t kRound = kLanes * sizeof(std::uint64_t);  // [bytes]
  static constexpr std::uint64_t kFactor = 0xd6e8feb86659fd93u;

  // A bijection of the lane for every word and of the word for every lane: nothing that enters is lost, and
  // no change of a single word goes unseen. The multiplication spreads bits to the left only, the rest brings
  // them back; a mere rotation would leave a changed sign one bit, which one changed bit of the next word
  // could undo.
  static constexpr std::uint64_t mixed(std::uint64_t lane, std::uint64_t word) {
    lane = (lane ^ word) * kFactor;
    return lane ^ (lane >> 32);
  }
  void absorb(std::uint64_t word) {
    std::uint64_t& lane = lanes_[count_++ % kLanes];
    lane = mixed(lane, word);
  }

  // A word for each lane, `round_count` times. The lanes are variables of their own, which compilers keep
  // in registers: as elements of an array they would go to memory and back with every word, and take three
  // times as long.
  void rounds(const unsigned char* from, std::size_t round_count) {
    const auto word = [&from](std::size_t i) {
      std::uint64_t result;
      std::memcpy(&result, from + i * sizeof(result), sizeof(result));
      return result;
    };
    auto [a, b, c, d, e, f, g, h] = lanes_;
    for (; round_count > 0; --round_count, from += kRound) {
      a = mixed(a, word(0));
      b = mixed(b, word(1));
      c = mixed(c, word(2));
      d = mixed(d, word(3));
      e = mixed(e, word(4));
      f = mixed(f, word(5));
      g = mixed(g, word(6));
      h = mixed(h, word(7));
    }
    lanes_ = {a, b, c, d, e, f, g, h};
  }

  // At first the roots of the first eight primes, behind the point: numbers without a pattern.
  std::array<std::uint64_t, kLanes> lanes_{0x6a09e667f3bcc908u, 0xbb67ae8584caa73bu, 0x3c6ef372fe94f82bu,
                                           0xa54ff53a5f1d36f1u, 0x510e527fade682d1u, 0x9b05688c2b3e6c1fu,
                                           0x1f83d9abfb41bd6bu, 0x5be0cd19137e2179u};
  std::uint64_t count_ = 0;  // single words and arrays so far; says which lane is next
};

}  // namespace lumbrical
