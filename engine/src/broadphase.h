// Broadphase: which triangles may touch which primitives.
#pragma once

#include "lumbrical/tick.h"
#include "primitive.h"

namespace lumbrical {

/// A sphere round a triangle: its centroid and the farthest corner. The one test every broadphase ends with.
struct TriangleBound {
  Vec3 centre;        ///< [m] W
  double radius = 0;  ///< [m]
};
TriangleBound bound_triangle(const Triangles& triangles, std::uint32_t triangle);

/// Does the triangle's bound reach the primitive's hull (ignoring cuts)?
bool may_touch(const Primitive& primitive, const TriangleBound& bound);

/// Fills scratch.candidates with all pairs that may touch, ascending, the same whatever the broadphase.
/// Returns false where the candidates don't fit; then they are not to be used.
bool find_candidates(const Model& model, const Primitives& hand, Scratch& scratch);

}  // namespace lumbrical
