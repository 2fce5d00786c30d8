// What one thread needs to search for triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace lumbrical {

/// Sized once for a model; a search allocates nothing.
struct SearchMemory {
  std::array<std::vector<std::uint32_t>, 2> frontier;       ///< of a tree's traversal
  std::vector<std::uint32_t> cells;                         ///< voxels that may be met
  std::array<std::vector<std::uint32_t>, 2> open_clusters;  ///< of the clusters' traversal
  std::vector<std::uint32_t> used_clusters;                 ///< that are contacts of one primitive
  std::vector<std::uint32_t> split_leaves;                  ///< the same, triangle by triangle
  std::vector<std::uint64_t> open_leaves;                   ///< a bit for each leaf that is looked into
};

}  // namespace lumbrical
