// The triangle nearest to a point, by a uniform grid: what the baselines of point contact search with.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lumbrical/mesh.h"

namespace lumbrical::bench {

struct NearestTriangle {
  std::uint32_t triangle = 0;
  double distance = 0;  ///< [m] positive in front of it, negative behind
};

class NearestGrid {
 public:
  explicit NearestGrid(Mesh mesh);
  /// False where none is within `reach` [m].
  bool find(Vec3 p, double reach, NearestTriangle& nearest) const;

 private:
  [[nodiscard]] std::array<std::size_t, 3> cell_at(Vec3 p) const;
  template <class Take>
  void for_cells(Vec3 low, Vec3 high, const Take& take) const;

  Mesh mesh_;
  Vec3 low_;
  double size_ = 0;  // [m] of a cell
  std::array<std::size_t, 3> count_{};
  std::vector<std::uint32_t> begin_, triangle_;  // of each cell, x fastest
};

}  // namespace lumbrical::bench
