// The hash: the same on every machine, and sensitive to every bit.
#include "base/hash.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <span>
#include <vector>

namespace lumbrical {
namespace {

std::vector<std::uint8_t> random_bytes(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint8_t> bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

std::uint64_t hash_of(const std::vector<std::uint8_t>& bytes) {
  Hasher hasher;
  hasher.array(bytes);
  return hasher.digest();
}

std::uint64_t hash_of_some() {
  Hasher hasher;
  hasher.value(1.5);
  hasher.value(std::uint8_t{7});
  hasher.array(std::span<const std::uint32_t>(std::vector<std::uint32_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  hasher.bytes("lumbrical", 9);
  return hasher.digest();
}

// Recordings carry these hashes: a change of these numbers makes every old recording diverge.
TEST(Hash, IsTheSameOnEveryMachineAndInEveryVersion) {
  EXPECT_EQ(hash_of_some(), 1975423373729727860u);
  EXPECT_EQ(Hasher().digest(), 17673606959391789325u);
}

// Its rounds are of 64 bytes.
TEST(Hash, ChangesWithEveryBitAtEveryLength) {
  for (std::size_t size = 0; size < 270; size += size == 140 ? 110 : 1) {
    std::vector<std::uint8_t> bytes = random_bytes(size, size);
    std::set<std::uint64_t> seen = {hash_of(bytes)};
    for (std::size_t bit = 0; bit < 8 * size; ++bit) {
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      EXPECT_TRUE(seen.insert(hash_of(bytes)).second) << "bit " << bit << " of " << size << " bytes";
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    }
  }
}

TEST(Hash, FlipsHalfOfItsBitsWhenOneBitOfTheInputFlips) {
  std::vector<std::uint8_t> bytes = random_bytes(256, 1);
  const std::uint64_t before = hash_of(bytes);
  std::vector<int> flips(64);
  for (std::size_t bit = 0; bit < 2048; ++bit) {
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    const std::uint64_t change = before ^ hash_of(bytes);
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    for (int i = 0; i < 64; ++i) flips[i] += static_cast<int>((change >> i) & 1);
  }
  // 2048 coins: mean 1024, standard deviation 23.
  for (int i = 0; i < 64; ++i) EXPECT_NEAR(flips[i], 1024, 140) << "bit " << i;
}

TEST(Hash, TellsSymmetricChangesApart) {
  const auto hash = [](const std::vector<double>& values) {
    Hasher hasher;
    hasher.array(values);
    return hasher.digest();
  };
  std::set<std::uint64_t> seen;
  constexpr std::size_t kCount = 36;
  std::vector<double> values(kCount, 1.0);
  EXPECT_TRUE(seen.insert(hash(values)).second);
  for (std::size_t i = 0; i < kCount; ++i) {  // one sign, and every pair of signs
    for (std::size_t j = i; j < kCount; ++j) {
      values.assign(kCount, 1.0);
      values[i] = -1;
      values[j] = -1;
      EXPECT_TRUE(seen.insert(hash(values)).second) << i << ' ' << j;
    }
  }
  for (std::size_t zeros = 0; zeros < 140; ++zeros)
    EXPECT_TRUE(seen.insert(hash(std::vector<double>(zeros, 0.0))).second) << zeros << " zeros";
}

// As where arithmetic is rounded otherwise: a few units in the last place, of two numbers.
TEST(Hash, TellsSmallChangesOfTwoNumbersApart) {
  std::vector<std::uint64_t> words(36);
  for (std::size_t i = 0; i < words.size(); ++i)
    words[i] = std::bit_cast<std::uint64_t>(std::sqrt(2.0 + static_cast<double>(i)));
  const auto hash = [&words] {
    Hasher hasher;
    hasher.words(words);
    return hasher.digest();
  };
  std::set<std::uint64_t> seen = {hash()};
  std::size_t tried = 1;
  for (std::size_t i = 0; i < words.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const std::uint64_t first = words[i], second = words[j];
      for (std::uint64_t a = 1; a <= 3; ++a) {
        for (std::uint64_t b = 1; b <= 6; ++b) {
          words[i] = first + a;
          words[j] = second + b - (b > 3 ? 10 : 0);
          seen.insert(hash());
          ++tried;
        }
      }
      words[i] = second;  // and changed places
      words[j] = first;
      seen.insert(hash());
      ++tried;
      words[i] = first;
      words[j] = second;
    }
  }
  EXPECT_EQ(seen.size(), tried);
}

TEST(Hash, TellsTheBordersOfArraysApart) {
  const auto hash = [](const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    Hasher hasher;
    hasher.array(a);
    hasher.array(b);
    return hasher.digest();
  };
  EXPECT_NE(hash({1, 2}, {3}), hash({1}, {2, 3}));
  EXPECT_NE(hash({}, {0}), hash({0}, {}));
}

TEST(Hash, TellsZerosByTheirSignAndKeepsNaNs) {
  const auto hash = [](double value) {
    Hasher hasher;
    hasher.value(value);
    return hasher.digest();
  };
  EXPECT_NE(hash(0.0), hash(-0.0));
  const double nan = std::bit_cast<double>(std::uint64_t{0x7ff8000000000001});
  EXPECT_EQ(hash(nan), hash(nan));
  EXPECT_NE(hash(nan), hash(std::nan("")));
}

TEST(Hash, DoesNotDependOnAlignment) {
  const std::vector<std::uint8_t> bytes = random_bytes(403, 5);
  const std::uint64_t expected = hash_of(bytes);
  for (std::size_t shift = 0; shift < 16; ++shift) {
    std::vector<std::uint8_t> room(bytes.size() + shift);
    std::copy(bytes.begin(), bytes.end(), room.begin() + static_cast<std::ptrdiff_t>(shift));
    Hasher hasher;
    hasher.bytes(room.data() + shift, bytes.size());
    EXPECT_EQ(hasher.digest(), expected) << shift;
  }
}

}  // namespace
}  // namespace lumbrical
