// How a triangle is cut into patches: halved across its longest edge as often as needed, and first, if it is
// a sliver, cut across into strips. `step`: [m] what patches are measured in (kPatchSizes).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/corners.h"

namespace lumbrical {

/// Where in its triangle a patch is: the part of its strips, if it has any, and from a leading 1 on a bit for
/// every halving, which half it is.
struct PatchPath {
  static constexpr std::uint32_t kNoStrips = ~0u;
  std::uint32_t part, halves;
};

/// Into how many patches a triangle is cut; 0: a part would have to be halved more than `most` times in a
/// row, or there would be more than 2^most of its strips.
std::size_t count_parts(const Corners& at, double step, unsigned most);

/// Lists all of them.
void cut_triangle(const Corners& at, double step, std::vector<PatchPath>& paths);

/// One of them.
Corners part_at(Corners at, double step, PatchPath path);

/// How many steps a patch is long. Slivers lie side by side and are all off the same way, so they get finer
/// ones.
double steps_along(const Corners& patch, double step);

}  // namespace lumbrical
