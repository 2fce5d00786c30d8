// What one thread needs to search for triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace lumbrical {

/// Sized once for a model; a search allocates nothing.
struct SearchMemory {
  std::array<std::vector<std::uint32_t>, 2> frontier;  ///< of a tree's traversal
  std::vector<std::uint32_t> cells;                    ///< voxels that may be met
};

}  // namespace lumbrical
