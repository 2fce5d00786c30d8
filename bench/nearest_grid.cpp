#include "nearest_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "index/triangle_distance.h"

namespace lumbrical::bench {
namespace {

constexpr double kLeastCell = 0.002, kMostCells = 1 << 24;

struct Bounds {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(Vec3 p) {
    low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
    high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
  }
};

Bounds bounds_of(const Mesh& mesh, const Triangle& triangle) {
  Bounds bounds;
  for (const std::uint32_t corner : triangle) bounds.add(mesh.vertices[corner]);
  return bounds;
}

}  // namespace

std::array<std::size_t, 3> NearestGrid::cell_at(Vec3 p) const {
  const Vec3 at = (p - low_) / size_;
  const auto along = [](double x, std::size_t count) {
    return static_cast<std::size_t>(clamp(std::floor(x), 0, static_cast<double>(count - 1)));
  };
  return {along(at.x, count_[0]), along(at.y, count_[1]), along(at.z, count_[2])};
}

template <class Take>
void NearestGrid::for_cells(Vec3 low, Vec3 high, const Take& take) const {
  const auto from = cell_at(low), to = cell_at(high);
  for (std::size_t z = from[2]; z <= to[2]; ++z) {
    for (std::size_t y = from[1]; y <= to[1]; ++y) {
      for (std::size_t x = from[0]; x <= to[0]; ++x) take(x + count_[0] * (y + count_[1] * z));
    }
  }
}

NearestGrid::NearestGrid(Mesh mesh) : mesh_(std::move(mesh)) {
  Bounds all;
  double edges = 0;
  for (const Triangle& t : mesh_.triangles) {
    for (const std::uint32_t corner : t) all.add(mesh_.vertices[corner]);
    edges += norm(mesh_.vertices[t[1]] - mesh_.vertices[t[0]]);
  }
  low_ = all.low;
  const Vec3 extent = all.high - all.low;
  size_ = max(kLeastCell, edges / static_cast<double>(mesh_.triangles.size()));
  while ((extent.x / size_ + 1) * (extent.y / size_ + 1) * (extent.z / size_ + 1) > kMostCells) size_ *= 2;
  count_ = {static_cast<std::size_t>(extent.x / size_) + 1, static_cast<std::size_t>(extent.y / size_) + 1,
            static_cast<std::size_t>(extent.z / size_) + 1};
  begin_.assign(count_[0] * count_[1] * count_[2] + 1, 0);
  const auto for_triangles = [&](const auto& take) {
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Bounds own = bounds_of(mesh_, mesh_.triangles[i]);
      for_cells(own.low, own.high, [&](std::size_t cell) { take(i, cell); });
    }
  };
  for_triangles([&](std::uint32_t, std::size_t cell) { ++begin_[cell + 1]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  triangle_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for_triangles([&](std::uint32_t i, std::size_t cell) { triangle_[next[cell]++] = i; });
}

// Cell by cell, in ever larger shells of cells round the point's own, until all that is left is farther away.
bool NearestGrid::find(Vec3 p, double reach, NearestTriangle& nearest) const {
  using Place = std::array<std::ptrdiff_t, 3>;
  const Vec3 at = (p - low_) / size_;
  const Place own = {static_cast<std::ptrdiff_t>(std::floor(at.x)),
                     static_cast<std::ptrdiff_t>(std::floor(at.y)),
                     static_cast<std::ptrdiff_t>(std::floor(at.z))};
  const auto to_wall = [](double x) { return min(x - std::floor(x), std::floor(x) + 1 - x); };
  const double inside = min(to_wall(at.x), min(to_wall(at.y), to_wall(at.z)));
  double least = reach * reach, side = 0;
  bool found = false;
  const auto look_into = [&](const Place& place) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (place[k] < 0 || place[k] >= static_cast<std::ptrdiff_t>(count_[k])) return;
    }
    const auto cell =
        static_cast<std::size_t>(place[0]) +
        count_[0] * (static_cast<std::size_t>(place[1]) + count_[1] * static_cast<std::size_t>(place[2]));
    for (std::uint32_t k = begin_[cell]; k < begin_[cell + 1]; ++k) {
      const Triangle& t = mesh_.triangles[triangle_[k]];
      const Vec3 a = mesh_.vertices[t[0]], b = mesh_.vertices[t[1]], c = mesh_.vertices[t[2]];
      const NearestPoint point = nearest_point(p, a, b, c);
      if (!(point.square < least)) continue;
      least = point.square;
      side = side_of(point, a, b, c);
      nearest.triangle = triangle_[k];
      found = true;
    }
  };
  for (std::ptrdiff_t shell = 0;; ++shell) {
    const double near = size_ * (static_cast<double>(shell - 1) + inside);
    if (shell > 0 && near * near >= least) break;
    for (std::ptrdiff_t z = -shell; z <= shell; ++z) {
      for (std::ptrdiff_t y = -shell; y <= shell; ++y) {
        const bool is_face = std::abs(z) == shell || std::abs(y) == shell;
        for (std::ptrdiff_t x = -shell; x <= shell; x += is_face ? 1 : std::max<std::ptrdiff_t>(2 * shell, 1))
          look_into({own[0] + x, own[1] + y, own[2] + z});
      }
    }
  }
  nearest.distance = (side < 0 ? -1 : 1) * std::sqrt(least);
  return found;
}

}  // namespace lumbrical::bench
