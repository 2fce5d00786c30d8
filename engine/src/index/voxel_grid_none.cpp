// Stands in for voxel_grid_openvdb.cpp in builds without OpenVDB: there is no grid to search.
#include "index/voxel_grid.h"

namespace lumbrical {
namespace {

Status without_openvdb() {
  return Status::error(
      "this build has no voxel index, because it was configured without OpenVDB: install libopenvdb-dev, "
      "libboost-iostreams-dev and zlib1g-dev and configure again, or use broadphase tree or grid");
}

}  // namespace

bool has_openvdb() { return false; }
Status make_distance_field(const Triangles&, const VoxelLists&, DistanceField&) { return without_openvdb(); }
Status make_voxel_grid(const VoxelLists&, const DistanceField&, std::shared_ptr<const VoxelGrid>&) {
  return without_openvdb();
}

}  // namespace lumbrical
