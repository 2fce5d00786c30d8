// Broadphase: which triangles may touch which primitives.
//
// A pair is a candidate unless `certain_misses` discards it. That is a question to the pair alone; grid and
// trees only spare asking it, so candidates are the same whatever the broadphase.
#pragma once

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

/// Sizes the working memory of find_candidates.
void size_candidates(const Model& model, Scratch& scratch);

/// Fills scratch.candidates with all candidates, ascending. Returns false where they don't fit; then they are
/// not to be used.
bool find_candidates(const Model& model, const Primitives& hand, Scratch& scratch);

}  // namespace lumbrical
