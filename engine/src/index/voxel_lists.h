// Which triangles touch which voxels: plain lists, made without OpenVDB and kept in the cache as they are.
#pragma once

#include <cstdint>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

/// A voxel that a triangle touches. Its list starts at `first` and ends where the next voxel's starts; up to
/// `others` stand the triangles whose centroid is in it, then those that only touch it, each part ascending.
struct Voxel {
  std::uint32_t first = 0, others = 0;
  float reach =
      0;  ///< [voxels] largest bounding radius of the triangles centred here; negative: there is none
};

struct VoxelLists {
  Vec3 origin;                          ///< [m] in W: the lower corner of voxel (0, 0, 0)
  double voxel_size = 0;                ///< [m]
  float reach = 0;                      ///< [voxels] the largest of all voxels
  std::vector<std::uint64_t> key;       ///< of each voxel, see voxel_key; ascending
  std::vector<Voxel> voxel;             ///< in the same order, then one more that ends the last list
  std::vector<std::uint32_t> triangle;  ///< the lists, end to end
  std::vector<std::uint32_t> wide;      ///< triangles too wide for voxels, ascending; in no list
};

inline constexpr std::uint64_t kMostVoxels = 1u << 20;  ///< along an axis

/// Cubes of 8 x 8 x 8 voxels (OpenVDB's leaves) stay together, in them voxels in OpenVDB's order: x, y, z.
constexpr std::uint64_t voxel_key(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return (x >> 3) << 45 | (y >> 3) << 27 | (z >> 3) << 9 | (x & 7) << 6 | (y & 7) << 3 | (z & 7);
}
struct VoxelPlace {
  std::int32_t x = 0, y = 0, z = 0;
};
constexpr VoxelPlace voxel_place(std::uint64_t key) {
  const auto part = [&](int leaf, int inside) {
    return static_cast<std::int32_t>((key >> leaf & 0x3ffff) << 3 | (key >> inside & 7));
  };
  return {part(45, 6), part(27, 3), part(9, 0)};
}

/// Voxels are execution.voxel_size wide. If that is 0: twice the bounding radius that three quarters of the
/// triangles stay below. In any case at least the environment's extent / 2^20. A triangle whose bounding
/// radius is over two voxels is wide. There must be a triangle. Refuses what would take more than
/// execution.voxel_memory while it is built.
Status build_voxel_lists(const Triangles& triangles, const Execution& execution, VoxelLists& lists);

/// [bytes] that OpenVDB's tree of voxels takes, from their keys, ascending, `shift` [voxels, whole leaves]
/// taken from each coordinate: far more for a voxel that stands alone than for one among many.
double tree_bytes(const std::vector<std::uint64_t>& keys, std::int32_t shift);

/// The error of an index of that many bytes.
Status voxels_too_large(double bytes, const Execution& execution);

/// [bytes] they take.
std::size_t byte_count(const VoxelLists& lists);

}  // namespace lumbrical
