// Union-find: which of many things hang together, known by the lowest number among them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lumbrical {

/// At first everything stands alone. The lowest number of a set is its name, whatever the order of joining.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  /// Shortens the way there as it goes (path halving).
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t k) {
    i = find(i);
    k = find(k);
    parent_[std::max(i, k)] = std::min(i, k);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace lumbrical
