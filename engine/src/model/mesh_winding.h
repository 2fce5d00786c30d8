// Which triangles of a mesh have to be turned for it to be outside out.
#pragma once

#include <vector>

#include "lumbrical/mesh.h"

namespace lumbrical {

/// Of each triangle: do its last two corners change places? Empty: none does. Fewer than 2^31 triangles,
/// their indices in range. The result does not depend on `threads`.
std::vector<bool> turned_triangles(const Mesh& mesh, Winding winding, std::size_t threads,
                                   WindingReport& report);

/// Brings vertices that count as one there, since only rounding drove them apart, to one place.
void close_cracks(Mesh& mesh);

/// Is it closed everywhere, without a hole, and outside out? Then what is just behind a triangle is inside.
bool is_solid(const Mesh& mesh, std::size_t threads);

}  // namespace lumbrical
