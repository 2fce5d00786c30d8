// Voxel lists and distance field as a file: plain little-endian arrays behind a header with two hashes, one
// of what they were made from, one of themselves.
//
// Whatever the file holds, reading it is safe: counts are held against the file's size before memory is
// taken, and every number is checked before use; trees made of it may take more (tree_bytes). The hashes tell
// damage and other scenes, not malice: who may write the folder may make an index that leaves triangles out.
#pragma once

#include <string>

#include "index/voxel_grid.h"

namespace lumbrical {

/// Everything an index depends on: the triangles, the size of the voxels, the version of the format.
std::uint64_t hash_of_source(const Triangles& triangles, const Execution& execution);

/// Where the index of that source is kept in a folder.
std::string cache_path(const std::string& folder, std::uint64_t source);

/// Reads a file of `triangles` triangles made from `source`. On error lists and field are unchanged.
Status read_voxel_cache(const std::string& path, std::uint64_t source, std::size_t triangles,
                        VoxelLists& lists, DistanceField& field);

/// Writes beside the path, then puts the file in its place; makes the folder where it is missing.
Status write_voxel_cache(const std::string& path, std::uint64_t source, const VoxelLists& lists,
                         const DistanceField& field);

}  // namespace lumbrical
