// The hash of recordings of format versions 1 and 2, only there to replay and check those (hash.h has
// today's). Four lanes, a multiplication for each word.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace lumbrical {

class FormerHasher {
 public:
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void value(T number) {
    std::uint64_t word = 0;
    static_assert(sizeof(T) <= sizeof(word));
    std::memcpy(&word, &number, sizeof(T));
    absorb(word);
  }

  void bytes(const void* data, std::size_t size) {
    const auto* from = static_cast<const unsigned char*>(data);
    std::size_t left = size;
    while (left >= 4 * sizeof(std::uint64_t)) {
      std::array<std::uint64_t, 4> words;
      std::memcpy(words.data(), from, sizeof(words));
      for (std::size_t i = 0; i < 4; ++i) lanes_[i] = mixed(lanes_[i], words[i]);
      from += sizeof(words);
      left -= sizeof(words);
    }
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

  /// As many single values as there are words.
  void words(std::span<const std::uint64_t> values) {
    for (const std::uint64_t word : values) absorb(word);
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void array(std::span<const T> items) { bytes(items.data(), items.size_bytes()); }
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
    std::uint64_t& lane = lanes_[count_++ & 3];
    lane = mixed(lane, word);
  }

  std::array<std::uint64_t, 4> lanes_{0x2545f4914f6cdd1du, 0x9e6c63d0676a9a99u, 0xb5ad4eceda1ce2a9u,
                                      0x8f3c1a5be2d74605u};
  std::uint64_t count_ = 0;  // single words so far; says which lane is next
};

}  // namespace lumbrical
