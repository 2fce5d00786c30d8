// The voxel index as a broadphase: voxel lists in OpenVDB's tree, read from a cache or built.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "index/voxel_grid.h"
#include "lumbrical/voxel.h"
#include "model/primitive.h"

namespace lumbrical {

/// Immutable once built.
struct VoxelIndex {
  VoxelLists lists;  ///< without keys: those are in the grid
  std::shared_ptr<const VoxelGrid> grid;
  SphereTree wide;          ///< of the triangles too wide for voxels
  bool inside_out = false;  ///< a closed surface's triangles face inwards
  VoxelReport report;
};

/// Refuses what build_voxel_lists refuses, and everything in a build without OpenVDB. A cache that is damaged
/// or can't be written is no error: the report's note tells. A scene without triangles has no index.
Status build_voxels(const Triangles& triangles, const Execution& execution,
                    std::shared_ptr<const VoxelIndex>& index);

/// Writes the numbers of the voxels in which triangles are centred that the primitive's hull may meet to
/// `found`, which holds as many as there are voxels; returns how many. Every triangle that is not wide is
/// centred in one voxel only.
std::size_t find_voxels(const VoxelIndex& index, const Primitive& primitive,
                        std::vector<std::uint32_t>& found);

/// The triangles centred in a voxel.
inline std::span<const std::uint32_t> centred_in(const VoxelIndex& index, std::uint32_t voxel) {
  const Voxel& v = index.lists.voxel[voxel];
  return {index.lists.triangle.data() + v.first, v.others - v.first};
}

/// All triangles that touch a voxel.
inline std::span<const std::uint32_t> touching(const VoxelIndex& index, std::uint32_t voxel) {
  const Voxel* const v = &index.lists.voxel[voxel];
  return {index.lists.triangle.data() + v[0].first, v[1].first - v[0].first};
}

}  // namespace lumbrical
