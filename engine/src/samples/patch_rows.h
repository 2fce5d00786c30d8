// From a list of patches to lanes and from lanes to sums.
#pragma once

#include "samples/lattice.h"
#include "samples/sample_kernels.h"

namespace lumbrical::LUMBRICAL_ISA {

/// Sixteen patches, a lane each, relative to a body's origin; lanes without one have no edges.
struct PatchRows {
  static constexpr std::size_t kWidth = PatchBlock::kWidth;
  alignas(64) float corner[3][kWidth];   // [m]
  alignas(64) float edge[2][3][kWidth];  // [m]
};

/// A body's origin, as patches have their corners.
struct SplitOrigin {
  float high[3], low[3];
  explicit SplitOrigin(const Vec3& p) {
    const double at[3] = {p.x, p.y, p.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [h, l] = split_number(at[axis]);
      high[axis] = h;
      low[axis] = l;
    }
  }
};

inline void gather(const PatchList& patches, const SplitOrigin& origin, std::size_t first, std::size_t count,
                   PatchRows& rows) {
  for (std::size_t lane = 0; lane < PatchRows::kWidth; ++lane) {
    const std::uint32_t place = patches.places[first + (lane < count ? lane : 0)];
    const PatchBlock& block = patches.blocks[place / PatchRows::kWidth];
    const std::size_t at = place % PatchRows::kWidth;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows.corner[axis][lane] =
          (block.corner[0][axis][at] - origin.high[axis]) + (block.corner[1][axis][at] - origin.low[axis]);
      rows.edge[0][axis][lane] = block.edge[0][axis][at];
      rows.edge[1][axis][lane] = block.edge[1][axis][at];
    }
  }
  for (std::size_t lane = count; lane < PatchRows::kWidth; ++lane) {
    for (std::size_t axis = 0; axis < 3; ++axis) rows.edge[0][axis][lane] = rows.edge[1][axis][lane] = 0;
  }
}

/// Calls take(rows, lane) for every register of the patches.
template <class V, class Take>
LUMBRICAL_INLINE inline void for_rows(const PatchList& patches, const Take& take) {
  PatchRows rows;
  const SplitOrigin origin(patches.origin);
  for (std::size_t first = 0; first < patches.count; first += PatchRows::kWidth) {
    const std::size_t left = patches.count - first;
    gather(patches, origin, first, left < PatchRows::kWidth ? left : PatchRows::kWidth, rows);
    for (std::size_t lane = 0; lane < PatchRows::kWidth; lane += wide::Lanes<V>::kCount) take(rows, lane);
  }
}

/// A patch seen from a frame.
template <class V>
struct PatchInFrame {
  Wide3<V> corner, edge1, edge2;
  [[nodiscard]] Wide3<V> at(V u, V v) const { return corner + (u * edge1 + v * edge2); }
};

template <class V>
inline Wide3<V> turn_into(const float (&axis)[3][3], Wide3<V> p) {
  return {dot(in_all_lanes<V>(axis[0]), p), dot(in_all_lanes<V>(axis[1]), p),
          dot(in_all_lanes<V>(axis[2]), p)};
}

template <class V>
inline PatchInFrame<V> see_patch(const PatchRows& rows, std::size_t lane, const float (&axis)[3][3],
                                 Wide3<V> origin) {
  return {turn_into(axis, vector_at<V>(rows.corner, lane) - origin),
          turn_into(axis, vector_at<V>(rows.edge[0], lane)),
          turn_into(axis, vector_at<V>(rows.edge[1], lane))};
}

inline std::uint32_t count_of(unsigned lanes) {
  return static_cast<std::uint32_t>(__builtin_popcount(lanes));
}

/// Adds force and moment of a register's patches to a body's sums; returns a bit per lane that has any.
template <class V>
inline unsigned add_wrench(Wide3<V> force, Wide3<V> moment, std::size_t lane, BodySums& sums) {
  constexpr double kRounder = 6755399441055744.0;  // 1.5 * 2^52: its last place is that of units
  const V rows[6] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
  for (std::size_t k = 0; k < 6; ++k) {
    constexpr std::size_t kLanes = wide::Lanes<V>::kCount;
    const double rounder = kRounder * (k < 3 ? sums.force_quantum : sums.moment_quantum);
    alignas(64) float row[kLanes];
    put(row, rows[k]);
    for (std::size_t i = 0; i < kLanes; ++i)
      sums.lane[k][lane + i] += (static_cast<double>(row[i]) + rounder) - rounder;
  }
  const V size = magnitude(force.x) + (magnitude(force.y) + magnitude(force.z));
  return wide::bits_of(size > number<V>(0), number<V>(0));
}

/// The same of a share whose moments are known.
template <class V>
inline unsigned add_share(const PatchInFrame<V>& patch, const LatticeMoments<V>& m, std::size_t lane,
                          BodySums& sums) {
  const Wide3<V> normal = cross(patch.edge1, patch.edge2);
  const Wide3<V> first = m.sum * patch.corner + (m.u * patch.edge1 + m.v * patch.edge2);
  return add_wrench(m.sum * normal, cross(first, normal), lane, sums);
}

}  // namespace lumbrical::LUMBRICAL_ISA
