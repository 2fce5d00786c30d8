// Reproducible random numbers for property tests.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lumbrical/math.h"

namespace lumbrical::test {

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers with every compiler and library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) / 9007199254740992.0;
  }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(bits() % count); }
  Vec3 in_box(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = in_box(1);
      const double length = norm(v);
      if (length > 0.1 && length < 1) return v / length;
    }
  }
  Quat rotation() { return normalized({between(-1, 1), between(-1, 1), between(-1, 1), between(-1, 1)}); }
  Pose pose(double half) { return {in_box(half), rotation()}; }

 private:
  std::uint64_t state_;
};

}  // namespace lumbrical::test
