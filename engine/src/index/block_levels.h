// Blocks of patches as ones, blocks of those, and so on: a level each.
#pragma once

#include <vector>

#include "index/patches.h"
#include "index/sphere_tree.h"

namespace lumbrical {

/// Samples of the blocks of patches, level by level, as long as a segment may take one.
void put_block_levels(const Execution& execution, Patches& patches);

/// A block that is taken as one where its sphere meets a body has to be found there: round those that may be,
/// spheres for each level of the tree; less than nothing where there are none. [m], relative to `origin`.
std::vector<std::vector<Sphere>> spheres_on_skin(const Patches& patches, Vec3 origin);

}  // namespace lumbrical
