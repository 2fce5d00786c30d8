// From a posed hand to the patches its bodies may meet: the first pass of the rungs of samples
// (sampled_forces.h). What is found and as what is a question to patch and body alone; in which order it is
// found does not matter.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "samples/body_search.h"
#include "samples/cut_patches.h"

namespace lumbrical {

/// What the search works with, sized once for a model.
struct PatchSearchMemory {
  CutPatches cuts;  ///< of the tick (`cut_near`)
  std::vector<PatchSearcher> searcher;
  std::array<std::span<const FoundPatches>, Bodies::kMostFingers + 1> found;  ///< of each body, the palm last
  std::array<CentroidForce, Bodies::kMostFingers + 1> force;                  ///< on each body
  std::size_t listed = 0;                                                     ///< patches, the last time
};

void size_search(const Model& model, PatchSearchMemory& memory);

/// What each body meets. False where that is more than there is room for.
bool find_patches(const Model& model, const Primitives& hand, const Bodies& bodies,
                  PatchSearchMemory& memory);

/// The same, from what was found for bodies that take larger blocks as ones on the skin and are otherwise the
/// same: those that are too large now are opened.
bool open_patches(const Model& model, const Primitives& hand, const Bodies& bodies,
                  PatchSearchMemory& memory);

bool found_any(const PatchSearchMemory& memory);

/// What bodies feel together by the patches' centroids alone: the sum of their forces' sizes [m^3], of a
/// stiffness of 1. As the last search of all patches has it.
double force_at_centroids(const Bodies& bodies, const PatchSearchMemory& memory);

}  // namespace lumbrical
