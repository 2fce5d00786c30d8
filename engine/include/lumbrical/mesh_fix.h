// A mesh as a model takes it, written to a file: for people who want to repair theirs once.
#pragma once

#include <string>

#include "lumbrical/mesh.h"

namespace lumbrical {

/// What was done for a mesh to be as fixed_mesh makes it.
struct FixReport {
  WindingReport winding;
  std::size_t merged_vertices = 0;       ///< that lay where an earlier one does, or nearly (fixed_mesh)
  std::size_t degenerate_triangles = 0;  ///< left out (MeshReport::degenerate)
  std::size_t duplicate_triangles = 0;   ///< left out: with the corners of an earlier one, wound as it is
};

/// Wound as build_model does, vertices at one position joined, and those of open edges that rounding drove
/// apart (WindingReport); triangles without area and second ones left out. What remains keeps its order and,
/// but for such edges, its bits; nothing else is changed.
Mesh fixed_mesh(const Mesh& mesh, FixReport& report);

/// Writes a mesh as OBJ, which every program reads, with all digits: read again it is the same bit for bit.
/// "-" is standard output; a file that is there already is not written over.
Status save_obj(const std::string& path, const Mesh& mesh);

}  // namespace lumbrical
