// The voxel lists in OpenVDB's tree, which finds those near a capsule and holds the distance field. OpenVDB
// itself is known to one file only, in a module that is loaded when a grid is first asked for.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "index/voxel_lists.h"

namespace lumbrical {

/// [voxels] from the surface, negative inside: the voxels of a narrow band, in plain arrays.
struct DistanceField {
  static constexpr std::int32_t kShift = 8;  ///< added to every coordinate in a key: the band starts below 0
  std::vector<std::uint64_t> key;            ///< voxel_key, ascending
  std::vector<float> value;                  ///< in the middle of that voxel
};

/// A round shape's hull in voxels from the lists' origin.
struct VoxelQuery {
  Vec3 end, axis;
  double per_square = 0;  ///< 1 / |axis|^2; 0: a sphere
  double reach = 0;       ///< its larger radius and what rounding may do
};

/// Immutable once made.
class VoxelGrid {
 public:
  virtual ~VoxelGrid() = default;

  /// Writes the numbers of all voxels whose box, widened by the voxel's reach, may meet the query and that
  /// are the home of a triangle; returns how many. `found` holds as many as there are voxels.
  virtual std::size_t find(const VoxelLists& lists, const VoxelQuery& query,
                           std::vector<std::uint32_t>& found) const = 0;

  /// The voxel's number; -1 where no triangle touches it.
  virtual std::int32_t number_at(VoxelPlace place) const = 0;

  virtual bool has_field() const = 0;

  /// [voxels] the field between its voxels' middles, linearly; `p` in voxels from the lists' origin. Beyond
  /// the band +-3.
  virtual double sample_field(Vec3 p) const = 0;

  /// [bytes] the trees take.
  virtual std::size_t byte_count() const = 0;
};

/// Can a grid be made? Loads the module, the first time.
bool has_openvdb();

/// The field of a watertight surface, by OpenVDB's meshToVolume: three voxels to either side. Distances are
/// exact up to 0.8 voxels; farther away it hands the nearest triangle on from voxel to voxel, so they may be
/// a little too large.
Status make_distance_field(const Triangles& triangles, const VoxelLists& lists, DistanceField& field);

/// An empty field stands for none.
Status make_voxel_grid(const VoxelLists& lists, const DistanceField& field,
                       std::shared_ptr<const VoxelGrid>& grid);

/// What lumbrical_voxel_grid_module() of the module answers.
struct VoxelGridModule {
  decltype(make_distance_field)* distance_field;
  decltype(make_voxel_grid)* grid;
};

}  // namespace lumbrical
