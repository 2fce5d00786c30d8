// Broadphase: which triangles may touch which primitives.
#pragma once

#include "lumbrical/tick.h"
#include "primitive.h"
#include "triangle_bound.h"

namespace lumbrical {

/// Does the triangle's bound reach the primitive's hull (ignoring cuts)?
bool may_touch(const Primitive& primitive, const TriangleBound& bound);

/// Fills scratch.candidates with all pairs that may touch, ascending, the same whatever the broadphase.
/// Returns false where the candidates don't fit; then they are not to be used.
bool find_candidates(const Model& model, const Primitives& hand, Scratch& scratch);

}  // namespace lumbrical
