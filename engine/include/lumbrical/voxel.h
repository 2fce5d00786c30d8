// What a model's voxel index (Broadphase::voxel) took and gives besides candidates: the distance from the
// surface.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lumbrical/model.h"

namespace lumbrical {

struct VoxelReport {
  double voxel_size = 0;      ///< [m]
  std::uint64_t voxels = 0;   ///< that a triangle touches
  std::uint64_t entries = 0;  ///< triangles in all their lists together
  std::uint64_t wide = 0;     ///< triangles too wide for voxels, in a tree of spheres of their own
  std::uint64_t bytes = 0;    ///< of the whole index
  bool has_distance =
      false;  ///< is there a signed distance? Only round watertight surfaces without wide triangles
  bool from_cache = false;   ///< read from Execution::voxel_cache, not built
  double build_seconds = 0;  ///< to build or read it; differs from run to run
  std::string note;  ///< one sentence: why the cache was not used or not written, why there is no distance
};

/// Nothing, unless the model's broadphase is voxel.
std::optional<VoxelReport> voxel_report(const Model& model);

/// [m] from the point to the nearest triangle, negative inside: to rounding within a voxel of the surface,
/// then off by up to 0.6 voxels, and no more than three voxels. Where solids overlap, the sign within a voxel
/// of a surface is that surface's own. Nothing where the index has no distance or there is no index. `p` [m]
/// in W, finite.
std::optional<double> signed_distance(const Model& model, Vec3 p);

}  // namespace lumbrical
