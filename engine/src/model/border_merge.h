// Finds vertices on open edges that lie so near each other that only rounding can have driven them apart.
#pragma once

#include <cstdint>
#include <vector>

#include "lumbrical/mesh.h"
#include "model/mesh_edges.h"

namespace lumbrical {

/// Takes vertices of edges that one triangle has for one, if all three coordinates differ by less than half
/// of `width`; some that differ by up to `width`, too, and so on from one to the next. `first` names vertices
/// as in vertex_merge.h, or is empty where each has its own name. False, and nothing is changed, where no
/// edge is open, none lie so near, or `width` is no positive number. O(n log n) in the vertices of open
/// edges.
bool merge_borders(const Mesh& mesh, const MeshEdges& edges, double width, std::vector<std::uint32_t>& first);

}  // namespace lumbrical
