// A second look at patches that a skeleton may come near to: classification asks the sphere round a patch,
// which says little of a large one that the body lies flat on.
#pragma once

#include "samples/body_search.h"

namespace lumbrical {

/// A skeleton that stays on one side of a patch's plane, this many times the body's radius away from it or
/// more, is not near.
inline constexpr float kClearOfPlane = 0.35f;

/// Moves such patches from the classes of those that a skeleton is near to into the others of their sizes;
/// returns how many entries there are then, at most one per patch. `shapes`: sixteen to a block, `origin`:
/// the body's.
std::size_t leave_near(const PatchShape* shapes, const SplitPoint& origin, const FingerBody& finger,
                       FoundPatches* found, std::size_t count);
std::size_t leave_near(const PatchShape* shapes, const SplitPoint& origin, const PalmBody& palm,
                       FoundPatches* found, std::size_t count);

}  // namespace lumbrical
